//! `optimize task import`: a task from meshes of plug and socket.

use super::super::words::wrapped;
use super::super::{Failure, print, print_json, say};
use super::{check, tune};
use crate::session::{ImportRequest, ImportedTask};
use clap::Args;
use connector::mesh::import::{ALLOWED, MOST_PARTS};
use connector::mesh::place::value;
use input::units::MM;
use insertion::trial::NEVER;
use serde_json::{Value, json};

/// Write a task from meshes of a plug and its socket (STL or OBJ)
///
/// Extruded outlines and all else that can be cut into convex pieces is taken over exactly, the rest
/// is approximated by convex hulls (VHACD), and how far these reach into the clearance is measured.
/// The plug's tip and the middle of the socket's largest opening are laid over one another. Unit,
/// direction and the jaws' axis are found from the shapes and said, unless they are given. Grip and moves are derived from the shapes, or
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
    let request = &arguments.request;
    let found = request.run(&|what| say(what), &NEVER)?;
    let (json, text) = report(request, &found);
    if arguments.json {
        print_json(&json)?
    } else {
        print(&text)?
    }
    check::ended(&found.checked, found.tuned.as_ref())
}

/// What `--json` prints, and `fo.import_parts` gives.
pub fn json(request: &ImportRequest, found: &ImportedTask) -> Value {
    report(request, found).0
}

/// The JSON and the text.
fn report(request: &ImportRequest, found: &ImportedTask) -> (Value, String) {
    let ImportedTask { imported, unit, along, said, inward, tuned, checked } = found;
    let [plug, socket] = imported.parts();
    let (depth, at, of) = match imported.intrusion {
        Some((depth, at, of)) => (depth / MM, at.coords / MM, of),
        None => (0.0, nalgebra::Vector3::zeros(), "plug"),
    };
    let clearance_mm = imported.clearance() / MM;
    let [play, chamfer, body] = [&imported.play[..], &imported.chamfer, &imported.body]
        .map(|lengths| lengths.iter().map(|v| v / MM).collect::<Vec<_>>());
    let exact = imported.exact[usize::from(of == "socket")];
    let warning = (depth > ALLOWED * clearance_mm).then(|| {
        let remedy = if exact { String::new() } else { bridged() };
        format!(
            "parts reach {depth:.3} mm into the clearance of {clearance_mm:.3} mm, more than a tenth{remedy}"
        )
    });
    let json = json!({
        "parts": plug + socket,
        "plug_parts": plug,
        "socket_parts": socket,
        "plug_exact": imported.exact[0],
        "socket_exact": imported.exact[1],
        "largest_intrusion_mm": depth,
        "intrusion_of": of,
        "intrusion_at_mm": [at.x, at.y, at.z],
        "unit": value(*unit),
        "insert_along": value(*along),
        "jaws": value(imported.jaws),
        "found": said.iter().map(|(what, why)| format!("{what} {why}")).collect::<Vec<_>>(),
        "clearance_mm": clearance_mm,
        "clearance_x_mm": play[0],
        "clearance_y_mm": play[1],
        "chamfer_x_mm": chamfer[0],
        "chamfer_y_mm": chamfer[1],
        "chamfer_depth_mm": chamfer[2],
        "body_mm": body,
        "resolution": request.resolution,
        // None is known to do: see `bridged`.
        "resolution_needed": null,
        "plug_was_inward": inward[0],
        "socket_was_inward": inward[1],
        "warning": warning,
        "out": request.out.display().to_string(),
        "tuned": tuned.as_ref().map(tune::brief_json),
        "check": check::json(checked),
    });
    let how = |exact: bool| if exact { "exact" } else { "approximated by hulls" };
    let mut text = format!(
        "written       {}\nplug          {plug} convex parts, {}\nsocket        {socket} convex parts, {}\n\
         clearance     {:.2} mm in y, {:.2} in x; {}; body {:.1} x {:.1} x {:.1} mm\n\
         intrusion     {depth:.4} mm at most",
        request.out.display(),
        how(imported.exact[0]),
        how(imported.exact[1]),
        play[1],
        play[0],
        chamfered(&chamfer),
        body[0],
        body[1],
        body[2],
    );
    if depth > 0.0 {
        text.push_str(&format!(", of the {of}, at [{:.2}, {:.2}, {:.2}] mm", at.x, at.y, at.z));
    }
    text.push('\n');
    for (what, why) in said {
        text.push_str(&format!("{what:<14}{why}\n"));
    }
    for (name, inward) in ["plug", "socket"].into_iter().zip(inward) {
        if *inward {
            text.push_str(&format!("normals       of the {name} pointed inward; turned\n"));
        }
    }
    text.extend(warning.map(|warning| format!("warning       {warning}\n")));
    text.extend(tuned.iter().map(|tuned| tune::brief("strategy", tuned)));
    (json, wrapped(&(text + &check::text(checked))))
}

/// Chamfer of the opening: its widths in x and in y and its depth, mm.
fn chamfered(chamfer: &[f64]) -> String {
    match chamfer {
        [x, y, depth] if *depth > 0.0 => {
            let width = if (x - y).abs() < 0.01 {
                format!("{y:.2} mm")
            } else {
                format!("{y:.2} mm in y, {x:.2} in x")
            };
            format!("chamfer {width} at the opening, {depth:.2} deep")
        }
        _ => "no chamfer at the opening".to_owned(),
    }
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
