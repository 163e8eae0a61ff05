//! CMA-ES after N. Hansen, *The CMA Evolution Strategy: A Tutorial* (arXiv 1604.00772, 2023),
//! in its symbols and with its constants.
//!
//! Three layers, each usable alone:
//!
//! - [`CmaEs`]: one run on R^n by ask and tell. **Minimises.**
//! - [`Restarts`]: IPOP and BIPOP restarts around it. **Minimises.**
//! - [`CmaEsOptimizer`]: the adapter to a [`Grid`](super::Grid). **Maximises**, like every
//!   [`Optimizer`](super::Optimizer).

mod core;
mod grid;
mod parameters;
mod restarts;
mod stop;

pub use self::core::{CmaEs, Solution, Start};
pub use grid::CmaEsOptimizer;
pub use parameters::{Parameters, default_lambda};
pub use restarts::{FinishedRun, Restarts, StartBox, Strategy};
pub use stop::{Stop, Tolerances};
