//! Separation of plug and socket that one file contains in their mated pose.

use crate::failure::Failure;
use crate::setup::mated::unit;
use connector::body::{extent, width};
use connector::mating::plugs;
use connector::mesh::axes::Unit;
use connector::mesh::{Body, Triangle, pick, shells};
use input::units::MM;

/// Largest number of bodies that a message lists.
const MAX_LISTED: usize = 12;

/// Plug and socket, and the names of the plug's bodies.
pub type Split = ([Vec<Triangle>; 2], String);

/// Returns the plug, which can be withdrawn, and the socket of an assembly.
///
/// # Errors
/// If no body can be withdrawn from the others, or if several can.
pub fn split(file: &str, bodies: Vec<Body>, given: Option<Unit>) -> Result<Split, Failure> {
    let bodies = if bodies.len() > 1 { bodies } else { shells(&bodies) };
    let whole: Vec<Triangle> = bodies.iter().flat_map(|body| body.triangles.clone()).collect();
    let (unit, _) = unit([file, file], [&whole, &whole], given)?;
    let metres = unit.metres();
    let scaled = |body: &Body| body.triangles.iter().map(|t| t.map(|p| p * metres)).collect();
    let found = plugs(&bodies.iter().map(scaled).collect::<Vec<Vec<Triangle>>>());
    let names = |of: &[usize]| of.iter().map(|i| bodies[*i].name.clone()).collect::<Vec<_>>();
    let problem = match found.as_deref() {
        Ok([plug]) => {
            let picked = pick(&bodies, &names(plug), file).map_err(Failure::input)?;
            return Ok((picked, quoted(&names(plug))));
        }
        Ok(several) => {
            let sets: Vec<_> = several.iter().map(|of| quoted(&names(of))).collect();
            format!("several bodies can be withdrawn: {}", sets.join("; or "))
        }
        Err(error) => format!("{error}; it has {}", listed(&bodies, metres)),
    };
    Err(Failure::in_file(file, format!("{problem}; name those of the plug with --plug-body")))
}

/// Formats names of bodies.
fn quoted(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(MAX_LISTED).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + &more(names.len())
}

/// Formats names and sizes of bodies.
fn listed(bodies: &[Body], metres: f64) -> String {
    let size = |body: &Body| {
        let side = |axis| width(extent(body.triangles.iter().flatten(), axis)) * metres / MM;
        format!("`{}` ({:.1} x {:.1} x {:.1} mm)", body.name, side(0), side(1), side(2))
    };
    let shown: Vec<_> = bodies.iter().take(MAX_LISTED).map(size).collect();
    shown.join(", ") + &more(bodies.len())
}

fn more(count: usize) -> String {
    let more = count.saturating_sub(MAX_LISTED);
    if more > 0 { format!(" and {more} more") } else { String::new() }
}
