//! Bayesian optimization with an exact Gaussian process.
//!
//! Values standardised and warped; Matern 5/2 with one length scale per axis; a constant mean,
//! unknown and integrated out; fitted noise; hyperparameters by maximum a posteriori; log
//! expected improvement (Ament et al. 2023, arXiv 2310.20708)
//! maximised over the grid; batches by the kriging believer. Each constraint has its own model,
//! and the expected improvement is multiplied by the probability of feasibility. Several objectives
//! have a model each, and the acquisition function is the expected hypervolume improvement.
//!
//! Linear algebra uses nalgebra, but no product of two matrices: those use `matrixmultiply`, which
//! chooses its kernels by processor, so that results would differ between machines.

mod acquisition;
mod data;
mod fit;
mod hyperparameters;
mod lbfgs;
mod likelihood;
mod local_models;
mod local_search;
mod model;
mod optimizer;
mod search;
mod stopping;
mod trained;
mod training;
mod warp;
pub use fit::{FitEffort, fit};
pub use hyperparameters::Hyperparameters;
pub use model::Gp;
pub use optimizer::DEFAULT_NOISE_FLOOR;
pub(crate) use optimizer::GpOptimizer;
pub use stopping::{Advice, Confirmed, StoppingCriterion};
