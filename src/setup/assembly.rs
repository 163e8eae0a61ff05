//! Plug and socket of one file that holds them in their mated pose.

use crate::failure::Failure;
use crate::setup::mated::unit;
use connector::body::{extent, width};
use connector::mating::plugs;
use connector::mesh::axes::Unit;
use connector::mesh::{Body, Triangle, pick, separate};
use input::units::MM;

/// Most bodies that a message names.
const MOST_NAMED: usize = 12;

/// Plug and socket, and the names of the plug's bodies.
pub type Split = ([Vec<Triangle>; 2], String);

/// Returns the plug, which can be withdrawn, and the socket of an assembly.
///
/// # Errors
/// If no body, or several in turn, can be withdrawn.
pub fn split(file: &str, bodies: Vec<Body>, given: Option<Unit>) -> Result<Split, Failure> {
    let bodies = separate(bodies);
    let whole: Vec<Triangle> = bodies.iter().flat_map(|body| body.triangles.clone()).collect();
    let (unit, _) = unit([file, file], [&whole, &whole], given)?;
    let metres = unit.metres();
    let scaled = |body: &Body| body.triangles.iter().map(|t| t.map(|p| p * metres)).collect();
    let found = plugs(&bodies.iter().map(scaled).collect::<Vec<Vec<Triangle>>>());
    let names = |of: &[usize]| of.iter().map(|i| bodies[*i].name.clone()).collect::<Vec<_>>();
    match found.as_deref() {
        Ok([plug]) => {
            let picked = pick(&bodies, &names(plug), file).map_err(Failure::input)?;
            Ok((picked, quoted(&names(plug))))
        }
        Ok(several) => {
            let sets: Vec<_> = several.iter().map(|of| quoted(&names(of))).collect();
            let problem = format!(
                "several bodies can be withdrawn: {}; name those of the plug with --plug-body",
                sets.join("; or ")
            );
            Err(Failure::in_file(file, problem))
        }
        Err(error) => {
            let problem = format!(
                "{error}; it has {}; name those of the plug with --plug-body",
                listed(&bodies, metres)
            );
            Err(Failure::in_file(file, problem))
        }
    }
}

fn quoted(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(MOST_NAMED).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + &more(names.len())
}

/// Names and sizes of bodies.
fn listed(bodies: &[Body], metres: f64) -> String {
    let size = |body: &Body| {
        let side = |axis| width(extent(body.triangles.iter().flatten(), axis)) * metres / MM;
        format!("`{}` ({:.1} x {:.1} x {:.1} mm)", body.name, side(0), side(1), side(2))
    };
    let shown: Vec<_> = bodies.iter().take(MOST_NAMED).map(size).collect();
    shown.join(", ") + &more(bodies.len())
}

fn more(count: usize) -> String {
    let more = count.saturating_sub(MOST_NAMED);
    if more > 0 { format!(" and {more} more") } else { String::new() }
}
