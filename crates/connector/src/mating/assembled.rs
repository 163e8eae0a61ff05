//! Direction in which the plug of an assembly leaves.

use super::{Mate, MatingError};
use crate::mesh::Triangle;

/// Finds the direction in which the plug of an assembly can be withdrawn; both in the frame of the assembly, m.
///
/// # Errors
/// If a part is empty or the plug is blocked.
pub fn assembled(_plug: &[Triangle], _socket: &[Triangle]) -> Result<Mate, MatingError> {
    Err(MatingError::Blocked)
}
