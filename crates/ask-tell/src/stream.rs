//! Named random streams: a random number depends on the name of its stream and its place in it, never on draws
//! from other streams.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// Returns the generator of the stream named by `(study_seed, evaluation, purpose)`; `evaluation` is any counter, for
/// example of evaluations, calls or runs.
///
/// Two different names give independent streams (SHA-256 of the name seeds ChaCha8); the same name gives the same bits
/// on every platform.
pub fn stream(study_seed: u64, evaluation: u64, purpose: &str) -> ChaCha8Rng {
    let mut hash = Sha256::new();
    hash.update(study_seed.to_le_bytes());
    hash.update(evaluation.to_le_bytes());
    hash.update(purpose.as_bytes());
    ChaCha8Rng::from_seed(hash.finalize().into())
}
