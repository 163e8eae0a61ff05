//! Bayesian optimization with an exact Gaussian process.
//!
//! Values standardised and warped; Matern 5/2 with one length scale per axis; a constant mean,
//! unknown and integrated out; fitted noise; hyperparameters by maximum a posteriori; log
//! expected improvement (Ament et al. 2023, arXiv 2310.20708)
//! maximised over the grid; batches by the kriging believer. With constraints a model for each of
//! them, and the improvement times the probability of keeping them; with several objectives a
//! model for each, and the expected hypervolume improvement.
//!
//! The linear algebra is nalgebra's, and only what it does without `matrixmultiply`, which
//! chooses its kernels by the processor: factors, triangular solutions and scalar products, but
//! no product of two matrices.

mod acquisition;
mod data;
mod fit;
mod hyperparameters;
mod lbfgs;
mod likelihood;
mod local_search;
mod model;
mod neighbours;
mod optimizer;
mod outlook;
mod search;
mod trained;
mod training;
mod warp;
pub use fit::{FitEffort, fit, fit_until};
pub use hyperparameters::Hyperparameters;
pub use model::Gp;
pub use optimizer::DEFAULT_NOISE_FLOOR;
pub(crate) use optimizer::GpOptimizer;
pub use outlook::{Advice, Confirmed, Gain, Outlook};
