//! CMA-ES after N. Hansen, *The CMA Evolution Strategy: A Tutorial* (arXiv 1604.00772, 2023),
//! in its symbols and with its constants.
//!
//! [`Restarts`] **minimises** on R^n by ask and tell; the optimizer `cma-es` adapts it to a
//! [`Grid`](super::Grid) and **maximises**, like every [`Optimizer`](super::Optimizer).

mod core;
mod grid;
mod parameters;
mod restarts;
mod stop;

pub use self::core::{Solution, StartBox};
pub(crate) use grid::CmaEsOptimizer;
pub use restarts::Restarts;
pub use stop::Tolerances;
