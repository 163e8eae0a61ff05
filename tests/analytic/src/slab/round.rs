//! Shapes of peg and hole with rounded edges.

use crate::planar::{Chamfer, Hole, Peg, V2};
use contact::scene::{Geom, Pose, Shape};
use input::units::MM;
use nalgebra::{Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Size of the peg in y, m; that of the hole is twice as much.
pub const THICKNESS: f64 = 4.0 * MM;
/// Length of the peg, depth and width of the bodies beside the hole, m.
const PEG: f64 = 60.0 * MM;
const HOLE: f64 = 30.0 * MM;

/// Representation of a rounded edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// Hull with so many flats, tangent to the arc, between the two faces.
    Flats(usize),
    /// Core with a radius.
    Core,
}

impl Rounding {
    /// Returns the representation of a word: `core`, or a number of flats.
    pub fn named(word: &str) -> Option<Self> {
        if word == "core" { Some(Rounding::Core) } else { word.parse().ok().map(Rounding::Flats) }
    }

    /// Returns the peg, with the middle of its tip at the origin.
    pub fn peg(self, peg: &Peg) -> Geom {
        let half = peg.half_width;
        if peg.radius <= 0.0 {
            return brick("peg", V2::new(-half, 0.0), V2::new(half, PEG), THICKNESS);
        }
        if self == Rounding::Core {
            return core("peg", V2::new(-half, 0.0), V2::new(half, PEG), peg.radius, THICKNESS);
        }
        let edge = |side: f64| {
            (
                V2::new(side * (half - peg.radius), peg.radius),
                V2::new(side, 0.0),
                V2::new(0.0, -1.0),
            )
        };
        let top = [V2::new(-half, PEG), V2::new(half, PEG)];
        self.geom("peg", &[edge(-1.0), edge(1.0)], peg.radius, &top, THICKNESS)
    }

    /// Returns the bodies on the left and on the right of the hole; a chamfer has sharp edges.
    pub fn hole(self, hole: &Hole) -> [Geom; 2] {
        [(-1.0, "left"), (1.0, "right")].map(|(side, name)| {
            let (wall, far) = (side * hole.half_width, side * (hole.half_width + HOLE));
            let others = [V2::new(far, 0.0), V2::new(far, -HOLE), V2::new(wall, -HOLE)];
            if let Some(Chamfer { width, angle }) = hole.chamfer {
                let low = V2::new(wall, -width * libm::tan(angle));
                let points = [V2::new(wall + side * width, 0.0), low];
                return self.geom(
                    name,
                    &[],
                    0.0,
                    &[&others[..], &points].concat(),
                    2.0 * THICKNESS,
                );
            }
            if hole.radius <= 0.0 {
                return brick(name, V2::new(wall, -HOLE), V2::new(far, 0.0), 2.0 * THICKNESS);
            }
            if self == Rounding::Core {
                let (from, to) = (V2::new(wall, -HOLE), V2::new(far, 0.0));
                return core(name, from, to, hole.radius, 2.0 * THICKNESS);
            }
            let middle = V2::new(wall + side * hole.radius, -hole.radius);
            let rim = (middle, V2::new(-side, 0.0), V2::new(0.0, 1.0));
            self.geom(name, &[rim], hole.radius, &others, 2.0 * THICKNESS)
        })
    }

    /// Returns a slab of rounded edges, each by its core and the normals of its two faces, and of
    /// other corners.
    fn geom(
        self,
        name: &str,
        rounded: &[(V2, V2, V2)],
        radius: f64,
        others: &[V2],
        thickness: f64,
    ) -> Geom {
        let flats = if let Rounding::Flats(flats) = self { flats } else { 0 };
        let corners = rounded.iter().flat_map(|&(core, first, second)| {
            arc_corners(radius, flats).into_iter().map(move |[a, b]| core + first * a + second * b)
        });
        let corners: Vec<V2> = corners.chain(others.iter().copied()).collect();
        let side = |y: f64| corners.iter().map(move |corner| Point3::new(corner.x, y, corner.y));
        let points = side(-thickness / 2.0).chain(side(thickness / 2.0)).collect();
        Geom {
            name: name.into(),
            shape: Shape::Hull { points },
            pose: Pose::identity(),
            friction: None,
        }
    }
}

/// Returns a box between two corners.
fn brick(name: &str, from: V2, to: V2, thickness: f64) -> Geom {
    let (half, middle) = ((to - from).abs() / 2.0, (to + from) / 2.0);
    let half = Vector3::new(half.x, thickness / 2.0, half.y);
    let pose = Pose::translation(middle.x, 0.0, middle.y);
    Geom { name: name.into(), shape: Shape::Box { half }, pose, friction: None }
}

/// Returns a box between two corners whose edges are round; its core is as thick as the slab.
fn core(name: &str, from: V2, to: V2, radius: f64, thickness: f64) -> Geom {
    let mut geom = brick(name, from, to, thickness);
    if let Shape::Box { half } = geom.shape {
        let core = Vector3::new(half.x - radius, half.y, half.z - radius);
        geom.shape = Shape::RoundBox { core, radius };
    }
    geom
}

/// Returns the corners of the flats that are tangent to a quarter of a circle, with those to the
/// faces at its ends.
fn arc_corners(radius: f64, flats: usize) -> Vec<[f64; 2]> {
    if radius <= 0.0 {
        return vec![[0.0, 0.0]];
    }
    let between = FRAC_PI_2 / (flats + 1) as f64;
    let far = radius / libm::cos(between / 2.0);
    let corner = |i: usize| {
        let (sin, cos) = libm::sincos(between * (i as f64 + 0.5));
        [far * cos, far * sin]
    };
    (0..=flats).map(corner).collect()
}
