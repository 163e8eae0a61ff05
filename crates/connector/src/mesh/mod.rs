//! Plug and socket from triangle meshes: read, mated, covered with convex parts, checked.

pub mod axes;
pub mod mated;
mod mend;
mod read;
mod reduce;
pub mod skin;
mod solid;
mod surface;

pub use read::{Body, Triangle, is_step, pick, read, separate};
pub use reduce::{TOLERANCE, reduced};
pub use surface::{SIZES, Surface};

/// Names of the files of plug and socket, for messages.
pub type Files<'a> = [&'a str; 2];

/// Returns the representative of an element's set: the element that is its own parent.
fn root(parent: &mut [usize], mut of: usize) -> usize {
    while parent[of] != of {
        parent[of] = parent[parent[of]];
        of = parent[of];
    }
    of
}
