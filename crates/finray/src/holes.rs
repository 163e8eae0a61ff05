//! Screw holes of a finger, through the depth of its base or in a block beyond its end. The gripper clamps base and
//! block rigidly, so the mechanical model ignores the holes.

use super::polygon::Ring;
use crate::outline::Outline;
use crate::printed::PrintedFinger;
use input::units::{self, MM, mm};
use input::{Check, InputError};
use nalgebra::{Point2, Vector2};
use serde::Deserialize;
use std::f64::consts::{PI, TAU};

/// Axis of the finger's frame; as a number, the index of its coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// X, from the tip to the end.
    Length,
    /// Y, from the back to the front.
    Width,
    /// Z, from the first layer to the last.
    Depth,
}

impl Direction {
    const ALL: [Self; 3] = [Direction::Length, Direction::Width, Direction::Depth];

    /// Returns the two perpendicular directions, right-handed with this one.
    pub fn across(self) -> [Self; 2] {
        [1, 2].map(|next| Self::ALL[(self as usize + next) % 3])
    }

    /// Returns the name of the direction in finger files.
    pub fn word(self) -> &'static str {
        ["length", "width", "depth"][self as usize]
    }
}

/// Row of equal holes, m.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Holes {
    /// Direction of the holes' centre lines.
    pub axis: Direction,
    /// Direction in which the holes follow one another.
    pub row: Direction,
    /// Number of holes.
    pub count: u32,
    /// Distance from centre to centre.
    #[serde(rename = "spacing_mm", deserialize_with = "units::read::mm")]
    pub spacing: f64,
    /// Diameter of a hole.
    #[serde(rename = "diameter_mm", deserialize_with = "units::read::mm")]
    pub diameter: f64,
    /// Offset of the middle of the row from the middle of the base or block, along the row and across it.
    #[serde(rename = "offset_mm", deserialize_with = "units::read::mm")]
    pub offset: [f64; 2],
    /// Block that contains the holes; if `None`, they are in the clamped base.
    pub block: Option<Block>,
}

/// Block beyond the end of a finger, of the same depth and in the middle of its width, m.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Length beyond the end.
    #[serde(rename = "length_mm", deserialize_with = "units::read::mm")]
    pub length: f64,
    /// Width.
    #[serde(rename = "width_mm", deserialize_with = "units::read::mm")]
    pub width: f64,
    /// Additional length inside the finger, so that a slicer merges both.
    #[serde(rename = "overlap_mm", deserialize_with = "units::read::mm")]
    pub overlap: f64,
}

/// Largest distance between the polygon of a hole and its circle, m.
const FLAT: f64 = 0.01 * MM;
/// Thickness of the thinnest wall beside a hole, in widths of a printed line.
const WALL_LINES: f64 = 3.0;
/// Tolerance of lengths for rounding errors, m.
const EPSILON: f64 = 1e-9;

impl Holes {
    /// Returns the low and high end along X, Y and Z of the base or block that contains the holes, m: X is 0 at the
    /// tip, Y on the front side (negative inside the finger), Z below the first layer.
    pub fn carrier(&self, outline: &Outline) -> [[f64; 2]; 3] {
        let Outline { length, width, depth, clamped, .. } = *outline;
        let (x, half, middle) = match self.block {
            Some(block) => ([length, length + block.length], block.width / 2.0, -width / 2.0),
            None => ([length - clamped, length], width / 2.0, -width / 2.0),
        };
        [x, [middle - half, middle + half], [0.0, depth]]
    }

    /// Returns the centres of the holes, m.
    pub fn centres(&self, outline: &Outline) -> Vec<[f64; 3]> {
        let middle = self.carrier(outline).map(|[low, high]| (low + high) / 2.0);
        let first = self.offset[0] - self.spacing * f64::from(self.count - 1) / 2.0;
        let centre = |i: u32| {
            let mut centre = middle;
            centre[self.row as usize] += first + self.spacing * f64::from(i);
            centre[self.beside()] += self.offset[1];
            centre
        };
        (0..self.count).map(centre).collect()
    }

    /// Returns the low and high end of each hole along X, Y and Z, m.
    pub fn boxes(&self, outline: &Outline) -> Vec<[[f64; 2]; 3]> {
        let radius = self.diameter / 2.0;
        let boxed = |middle: [f64; 3]| {
            let mut ends = middle.map(|at| [at - radius, at + radius]);
            ends[self.axis as usize] = self.carrier(outline)[self.axis as usize];
            ends
        };
        self.centres(outline).into_iter().map(boxed).collect()
    }

    /// Returns the holes as polygons, clockwise in the plane of [`Direction::across`], m.
    pub fn rings(&self, outline: &Outline) -> Vec<Ring> {
        let radius = self.diameter / 2.0;
        let [u, v] = self.axis.across().map(|direction| direction as usize);
        // A multiple of four, so that calipers measure between corners along both axes.
        let flats = 4 * (PI / libm::acos(1.0 - FLAT / radius) / 4.0).ceil() as u32;
        let offset = |i: u32| {
            let angle = -TAU * f64::from(i) / f64::from(flats);
            Vector2::new(libm::cos(angle), libm::sin(angle)) * radius
        };
        let ring = |p: [f64; 3]| (0..flats).map(|i| Point2::new(p[u], p[v]) + offset(i)).collect();
        self.centres(outline).into_iter().map(ring).collect()
    }

    /// Returns the index of the direction perpendicular to the holes and to their row.
    fn beside(&self) -> usize {
        3 - self.axis as usize - self.row as usize
    }

    /// Checks that the holes fit into a finger.
    pub(super) fn check(&self, check: Check<'_>, finger: &PrintedFinger) -> Result<(), InputError> {
        let PrintedFinger { outline, line_width, .. } = finger;
        if self.row == self.axis {
            let [one, other] = self.axis.across().map(Direction::word);
            let problem = format!("is the axis of the holes; it must be \"{one}\" or \"{other}\"");
            return check.fail("holes.row", problem);
        }
        if self.block.is_none() && self.axis != Direction::Depth {
            let problem = "is missing; holes along the length or the width are in a block \
                           beyond the finger's end: length_mm, width_mm, overlap_mm";
            return check.fail("holes.block", problem);
        }
        if let Some(Block { overlap, .. }) = self.block {
            let held = format!("be at most base.clamped_mm, {}", mm(outline.clamped));
            let fits = overlap <= outline.clamped + EPSILON;
            check.require("holes.block.overlap_mm", overlap / MM, fits, &held)?;
        }
        self.check_walls(check, outline, WALL_LINES * line_width)
    }

    fn check_walls(&self, check: Check, outline: &Outline, least: f64) -> Result<(), InputError> {
        let Holes { axis, row, diameter, spacing, count, .. } = *self;
        let left = |direction: usize, span: f64, offset: f64| {
            let [low, high] = self.carrier(outline)[direction];
            (high - low - span - diameter) / 2.0 - offset.abs()
        };
        let span = spacing * f64::from(count - 1);
        let walls = [
            ("between them", if count > 1 { spacing - diameter } else { f64::INFINITY }),
            ("at the ends of their row", left(row as usize, span, self.offset[0])),
            ("beside their row", left(self.beside(), 0.0, self.offset[1])),
        ];
        if let Some((place, wall)) = walls.into_iter().find(|(_, wall)| *wall < least - EPSILON) {
            let problem = format!(
                "leave a wall of {} mm {place}; it must be at least {} mm, {WALL_LINES} printed \
                 lines; change diameter_mm, spacing_mm, offset_mm or count, or make more room",
                mm(wall),
                mm(least)
            );
            return check.fail("holes", problem);
        }
        let covered = |middle: &[f64; 3]| {
            [0.0, -outline.width].iter().any(|side| (middle[1] - side).abs() < diameter / 2.0)
        };
        if axis == Direction::Length && self.centres(outline).iter().any(covered) {
            let problem = "puts a part of a hole behind the finger's end; a hole must lie completely \
                           behind it or completely beside it";
            return check.fail("holes.offset_mm", problem);
        }
        Ok(())
    }
}
