//! Named random streams: every random number is a function of the study seed,
//! the evaluation it serves and its purpose, never of what was drawn before.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// The generator of the stream named by `(study_seed, evaluation, purpose)`.
///
/// Two different names give independent streams (SHA-256 of the name seeds
/// ChaCha8); the same name gives the same stream on every platform.
pub fn stream(study_seed: u64, evaluation: u64, purpose: &str) -> ChaCha8Rng {
    let mut hash = Sha256::new();
    hash.update(study_seed.to_le_bytes());
    hash.update(evaluation.to_le_bytes());
    hash.update(purpose.as_bytes());
    ChaCha8Rng::from_seed(hash.finalize().into())
}

/// One standard normal number by Box and Muller, from two uniform ones.
pub fn normal(random: &mut impl Rng) -> f64 {
    // 1 - u lies in (0, 1], so the logarithm is finite.
    let (radius, angle) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(2.0 * std::f64::consts::PI * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_of_the_name_changes_the_stream() {
        let first = |seed, evaluation, purpose| stream(seed, evaluation, purpose).next_u64();
        let base = first(1, 2, "ask");
        assert_eq!(base, first(1, 2, "ask"));
        assert_ne!(base, first(0, 2, "ask"));
        assert_ne!(base, first(1, 3, "ask"));
        assert_ne!(base, first(1, 2, "restart"));
    }
}
