//! `optimize task import`: a task from meshes of plug and socket.

use super::super::{Failure, print, print_json, say};
use super::check;
use crate::connector::mesh::import::{ALLOWED, MOST_PARTS};
use crate::session::{ImportRequest, ImportedTask};
use clap::Args;
use input::units::MM;
use insertion::trial::NEVER;
use serde_json::json;

/// Write a task from meshes of a plug and its socket (STL or OBJ)
///
/// Extruded outlines and all else that can be cut into convex pieces is taken over exactly, the rest
/// is approximated by convex hulls (VHACD), and how far these reach into the clearance is measured.
/// The plug's tip and the middle of the socket's largest opening are laid over one another. The jaws
/// close along y (x, if the plug goes in along y). Grip and moves are derived from the shapes, or
/// taken from another task with --like.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: ImportRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { request, json } = arguments;
    report(request, *json, &request.run(&|what| say(what), &NEVER)?)
}

fn report(request: &ImportRequest, as_json: bool, found: &ImportedTask) -> Result<(), Failure> {
    let ImportedTask { imported, inward, checked } = found;
    let [plug, socket] = imported.parts();
    let (depth, at, of) = match imported.intrusion {
        Some((depth, at, of)) => (depth / MM, at.coords / MM, of),
        None => (0.0, nalgebra::Vector3::zeros(), "plug"),
    };
    let clearance_mm = imported.clearance / MM;
    let exact = imported.exact[usize::from(of == "socket")];
    let warning = (depth > ALLOWED * clearance_mm).then(|| {
        let remedy = if exact { String::new() } else { bridged() };
        format!(
            "parts reach {depth:.3} mm into the clearance of {clearance_mm:.3} mm, more than a tenth{remedy}"
        )
    });
    if as_json {
        return print_json(&json!({
            "parts": plug + socket,
            "plug_parts": plug,
            "socket_parts": socket,
            "plug_exact": imported.exact[0],
            "socket_exact": imported.exact[1],
            "largest_intrusion_mm": depth,
            "intrusion_of": of,
            "intrusion_at_mm": [at.x, at.y, at.z],
            "clearance_mm": clearance_mm,
            "resolution": request.resolution,
            // None is known to do: see `bridged`.
            "resolution_needed": null,
            "plug_was_inward": inward[0],
            "socket_was_inward": inward[1],
            "warning": warning,
            "out": request.out.display().to_string(),
            "check": check::json(checked),
        }));
    }
    let how = |exact: bool| if exact { "exact" } else { "approximated by hulls" };
    let mut text = format!(
        "written       {}\nplug          {plug} convex parts, {}\nsocket        {socket} convex parts, {}\n\
         clearance     {clearance_mm:.3} mm (opening less plug)\n\
         intrusion     {depth:.4} mm at most",
        request.out.display(),
        how(imported.exact[0]),
        how(imported.exact[1]),
    );
    if depth > 0.0 {
        text.push_str(&format!(", of the {of}, at [{:.2}, {:.2}, {:.2}] mm", at.x, at.y, at.z));
    }
    text.push('\n');
    for (name, inward) in ["plug", "socket"].into_iter().zip(inward) {
        if *inward {
            text.push_str(&format!("normals       of the {name} pointed inward; turned\n"));
        }
    }
    text.extend(warning.map(|warning| format!("warning       {warning}\n")));
    print(&(text + &check::text(checked)))
}

/// Remedy where hulls reach into the clearance. Two voxels across a tenth of it would be more than
/// there is time for, and hulls bridge what is hollow by more than that (docs/guide/tasks.md).
fn bridged() -> String {
    format!(
        ": hulls bridge what is hollow, and no --resolution mends that; export the mesh with fewer flats \
         (what makes up to {MOST_PARTS} convex pieces is cut exactly), begin with `optimize task new --round`, \
         or write the parts about it by hand (docs/guide/tasks.md)"
    )
}
