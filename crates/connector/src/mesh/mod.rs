//! Import of plug and socket from triangle meshes: reading, cleaning, convex parts and their check.

pub mod axes;
pub mod mated;
mod mend;
mod read;
mod reduce;
pub mod skin;
mod solid;
mod surface;

pub use read::{Body, Triangle, is_step, pick, read, shells};
pub use reduce::{TOLERANCE, reduced};
pub(crate) use solid::solid_of;
pub use surface::{SIZES, Surface};

/// File names of plug and socket for messages.
pub type Files<'a> = [&'a str; 2];

/// Returns the edges of a triangle, each from a corner to the next.
fn edges([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Returns the root of an element in a union-find forest, and shortens the path to it.
fn root(parent: &mut [usize], mut of: usize) -> usize {
    while parent[of] != of {
        parent[of] = parent[parent[of]];
        of = parent[of];
    }
    of
}
