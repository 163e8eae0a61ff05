//! The finger as a space frame of beams along the middle of its walls.

use super::frame::{Beam, Frame};
use super::infill;
use crate::geometry::Geometry;
use crate::infill::RibLines;
use crate::mechanics::compute;
use crate::outline::ring;
use crate::stiffness::{CrossStiffness, PlanarStiffness};
use nalgebra::{Matrix3, Matrix6, Point2};

/// The frame of a finger; joints at X >= the solid base are fixed, those on the pad are held.
fn frame(geometry: &Geometry) -> Matrix6<f64> {
    let finger = &geometry.finger;
    let outline = &finger.outline;
    let end = outline.length - outline.solid;
    let skin = ring(outline, finger.skin / 2.0, end);
    let RibLines { across, first, pitch, .. } = geometry.lines;
    let mut frame = Frame {
        joints: Vec::new(),
        beams: Vec::new(),
        depth: outline.depth,
        modulus: finger.material.modulus,
        poisson: finger.material.poisson,
    };
    // Joints on each rib: (number of the rib, place along it, joint).
    let mut on_ribs: Vec<(i64, f64, usize)> = Vec::new();
    for (i, from) in skin.iter().enumerate() {
        let to = skin[(i + 1) % skin.len()];
        frame.joints.push(*from);
        let at = |p: &Point2<f64>| (across.dot(&p.coords) - first) / pitch;
        let (start, stop) = (at(from), at(&to));
        let mut crossed: Vec<i64> =
            (start.min(stop).ceil() as i64..=start.max(stop).floor() as i64).collect();
        if stop < start {
            crossed.reverse();
        }
        // The skin's end in the solid base is no wall.
        if from.x > end - 1e-9 && to.x > end - 1e-9 {
            continue;
        }
        for rib in crossed {
            let share = (rib as f64 - start) / (stop - start);
            let joint = from + (to - from) * share;
            on_ribs.push((rib, joint.y, frame.joints.len()));
            frame.joints.push(joint);
        }
    }
    let count = frame.joints.len();
    for i in 0..count {
        let ends = [i, (i + 1) % count];
        if ends.iter().any(|&joint| frame.joints[joint].x < end - 1e-9) {
            frame.beams.push(Beam { ends, width: finger.skin });
        }
    }
    on_ribs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    for pair in on_ribs.chunk_by(|a, b| a.0 == b.0).flat_map(|rib| rib.chunks_exact(2)) {
        let ends = [pair[0].2, pair[1].2];
        frame.beams.push(Beam { ends, width: finger.ribs.thickness });
    }
    let on_pad = |joint: usize| {
        let from_tip = frame.joints[joint] - outline.tip_point();
        (outline.out_of_pad().dot(&from_tip) + finger.skin / 2.0).abs() < 1e-6
    };
    frame.condensed(outline.pad_middle(), on_pad, |joint| frame.joints[joint].x > end - 1e-9)
}

/// A frame's stiffness in the axes of the pad: in the plane (y, z, rx), across (x, ry, rz).
fn in_pad_axes(geometry: &Geometry, frame: &Matrix6<f64>) -> (PlanarStiffness, CrossStiffness) {
    let (y, z) = (geometry.finger.outline.out_of_pad(), geometry.finger.outline.along_pad());
    let mut axes = Matrix6::zeros();
    // Columns y, z, rx; x, ry, rz in terms of X, Y, Z; x = -Z.
    for (column, rows) in [(0, y), (1, z)] {
        axes.fixed_view_mut::<2, 1>(0, column).copy_from(&rows);
    }
    axes[(5, 2)] = -1.0;
    axes[(2, 3)] = -1.0;
    axes.fixed_view_mut::<2, 1>(3, 4).copy_from(&y);
    axes.fixed_view_mut::<2, 1>(3, 5).copy_from(&z);
    let turned = axes.transpose() * frame * axes;
    let block = |at: usize| -> Matrix3<f64> { turned.fixed_view::<3, 3>(at, at).into_owned() };
    (PlanarStiffness::new(block(0)).unwrap(), CrossStiffness::new(block(3)).unwrap())
}

/// Deflection across the plane is bending and shear of the walls: beams meet it. (Turning
/// also twists walls that hold one another from warping, which these beams leave out.)
/// In the plane, beams between the middles of walls come close, not within the few percent
/// asked for: walls are a fifth to a half as thick as they are long, and overlap at joints.
#[test]
fn the_finger_is_as_stiff_as_its_frame() {
    for (density, direction) in [(10.0, 0.0), (20.0, 0.0), (20.0, 20.0), (30.0, 40.0)] {
        let geometry = infill(density, direction);
        let (plane, cross) = in_pad_axes(&geometry, &frame(&geometry));
        let found = compute(&geometry).unwrap();
        for (beams, found, tolerance) in [
            (cross.in_depth, found.cross.in_depth, 0.1),
            (plane.in_compliance(), found.pad.in_compliance(), 0.15),
            (plane.in_assembly(), found.pad.in_assembly(), 0.15),
            (plane.tilting(), found.pad.tilting(), 0.15),
        ] {
            let ratio = beams / found;
            assert!((ratio - 1.0).abs() < tolerance, "{density} %, {direction} degrees: {ratio}");
        }
    }
}
