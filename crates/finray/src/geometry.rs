//! The solid profile of a printed finger: outline, skin and ribs, checked.

use super::FingerError;
use super::infill::{Design, NARROWEST_VOID, RibLines};
use super::polygon::{self, HalfPlane, Ring, without_repeats};
use crate::holes::{Block, Holes};
use crate::printed::{Outline, PrintedFinger};
use input::units::{DEG, MM, PERCENT};
use input::{Check, InputError};
use nalgebra::{Point2, Vector2};

/// Checked profile of a finger, SI units: X from the tip to the base, Y across, 0 on the front side.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Finger file, with the numbers that the design sets in it.
    pub finger: PrintedFinger,
    /// Infill.
    pub design: Design,
    /// Centre lines of the ribs.
    pub lines: RibLines,
    /// Outline, counter-clockwise from the tip along the back, m.
    pub outer: Ring,
    /// Openings between the ribs, clockwise, m.
    pub voids: Vec<Ring>,
    /// Number of ribs with an opening on either side.
    pub ribs: usize,
}

/// Distance below which two corners of an opening are one, m.
const NEAREST_CORNERS: f64 = 0.002 * MM;

impl Geometry {
    /// Profile of a finger with an infill.
    ///
    /// # Errors
    /// If its parts do not fit one another; the message names file and key.
    pub fn new(finger: &PrintedFinger, design: &Design) -> Result<Self, FingerError> {
        let lines = RibLines::new(finger, design);
        let check = Check { file: &finger.file };
        check_outline(check, &finger.outline)?;
        check_ribs(check, finger, design, lines.pitch)?;
        finger.holes.iter().try_for_each(|holes| holes.check(check, finger))?;
        let outer = without_repeats(&ring(&finger.outline, 0.0, finger.outline.length), 1e-9);
        let ribbed = finger.outline.length - finger.outline.solid;
        let inside = ring(&finger.outline, finger.skin, ribbed);
        check_rings(check, finger, &outer, &inside)?;
        let gaps = gaps(&inside, finger, &lines);
        let ribs = gaps.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1).count();
        let voids = gaps.into_iter().flat_map(|(_, voids)| voids).collect();
        Ok(Geometry { finger: finger.clone(), design: *design, lines, outer, voids, ribs })
    }

    /// Outline, openings and holes through the base, mm: the solid lies left of every ring.
    pub fn rings_mm(&self) -> Vec<Vec<[f64; 2]>> {
        let mm = |ring: &Ring| ring.iter().map(|p| [p.x / MM, p.y / MM]).collect();
        std::iter::once(&self.outer).chain(&self.voids).chain(&self.holes()).map(mm).collect()
    }

    /// Holes through the held base, clockwise, m; they are no openings of the mechanics.
    pub fn holes(&self) -> Vec<Ring> {
        let holes = self.finger.holes.as_ref().filter(|holes| holes.block.is_none());
        holes.map_or_else(Vec::new, |holes| holes.rings(&self.finger.outline))
    }

    /// Area of the solid profile, m2.
    pub fn area(&self) -> f64 {
        std::iter::once(&self.outer)
            .chain(&self.voids)
            .chain(&self.holes())
            .map(|ring| polygon::area(ring))
            .sum()
    }

    /// The holes and the block that has them, if they do not run through the held base.
    pub fn block(&self) -> Option<(&Holes, Block)> {
        self.finger.holes.as_ref().and_then(|holes| Some((holes, holes.block?)))
    }

    /// Mass of the printed finger without a block for its holes, kg.
    pub fn mass(&self) -> f64 {
        self.area() * self.finger.outline.depth * self.finger.material.mass_density
    }
}

/// Openings that the ribs leave of the inside, clockwise, by the number of the rib before them.
fn gaps(inside: &Ring, finger: &PrintedFinger, lines: &RibLines) -> Vec<(i64, Vec<Ring>)> {
    let half = finger.ribs.thickness / 2.0;
    let gap = |n: i64| {
        let after = HalfPlane { normal: lines.across, offset: lines.offset(n) + half };
        let before = HalfPlane { normal: -lines.across, offset: half - lines.offset(n + 1) };
        let pieces = after.cut(inside).into_iter().flat_map(|piece| before.cut(&piece));
        let mut voids: Vec<Ring> =
            pieces.map(|piece| without_repeats(&piece, NEAREST_CORNERS)).collect();
        voids.retain(|void| polygon::area(void) > NARROWEST_VOID * polygon::perimeter(void) / 2.0);
        voids.iter_mut().for_each(|void| void.reverse());
        (n, voids)
    };
    lines.range(inside).map(gap).filter(|(_, voids)| !voids.is_empty()).collect()
}

type Checked = Result<(), InputError>;

/// Refuses a value of the key, m, that is not below a limit.
fn below(check: Check<'_>, key: &str, value: f64, limit: f64, because: &str) -> Checked {
    if value < limit {
        return Ok(());
    }
    let (value, limit) = (value / MM, limit / MM);
    check.fail(key, format!("is {value:.3}; it must be below {limit:.3}: {because}"))
}

/// Checks that tip, arc, notch and base fit into the outline.
fn check_outline(check: Check<'_>, outline: &Outline) -> Checked {
    let Outline { length, width, tip, back_radius, pad, roof, solid, clamped, .. } = *outline;
    below(check, "outline.tip_mm", tip, width, "the tip lies in front of the back")?;
    below(check, "base.solid_mm", solid, length, "the base is a part of the finger")?;
    let in_base = "what is clamped is solid";
    below(check, "base.clamped_mm", clamped, solid * (1.0 + 1e-9), in_base)?;
    let (radius, rise, ribbed) = (back_radius / MM, (width - tip) / MM, length - solid);
    let Some(centre) = outline.arc_centre() else {
        let problem = format!(
            "is {radius:.3}; it must be above {rise:.3}: the arc leads from the tip to the back"
        );
        return check.fail("outline.back_radius_mm", problem);
    };
    if centre.x >= ribbed {
        let (end, base) = (centre.x / MM, ribbed / MM);
        let problem = format!(
            "is {radius:.3}; the arc would end at X = {end:.3}, in the solid base that begins \
             at {base:.3}: a smaller radius, or a longer finger"
        );
        return check.fail("outline.back_radius_mm", problem);
    }
    let to_side = tip / libm::sin(outline.pad_angle);
    below(check, "notch.pad_mm", pad, to_side, "the pad ends behind the front")?;
    let to_base = ribbed / libm::cos(outline.pad_angle);
    below(check, "notch.pad_mm", pad, to_base, "the notch ends before the solid base")?;
    below(check, "notch.roof_mm", roof, outline.roof_length(), "the roof is no longer")
}

/// Checks that ribs at this pitch, m, can be printed and leave room between them.
fn check_ribs(check: Check<'_>, finger: &PrintedFinger, design: &Design, pitch: f64) -> Checked {
    let PrintedFinger { ribs, line_width, smallest_gap, skin, .. } = finger;
    let Design { density_percent, direction_deg, phase_mm } = *design;
    let (key, fits) = ("infill_density_percent", density_percent > 0.0 && density_percent < 100.0);
    check.require(key, density_percent, fits, "be above 0 and below 100")?;
    let (key, fits) = ("infill_direction_deg", (-80.0..=80.0).contains(&direction_deg));
    check.require(key, direction_deg, fits, "be from -80 to 80 (degrees)")?;
    if !phase_mm.is_none_or(f64::is_finite) {
        return check.fail("phase_mm", "must be a finite number");
    }
    let gap = smallest_gap.max(NARROWEST_VOID);
    if pitch - ribs.thickness < gap {
        let most = ribs.line_spacing / (ribs.thickness + gap) / PERCENT;
        let problem = format!(
            "is {:.3}; at {density_percent} % infill the ribs lie {:.3} mm apart and merge, \
             their gaps below print.smallest_gap_mm = {:.3}: thinner ribs, or a density of at \
             most {most:.1} %",
            ribs.thickness / MM,
            pitch / MM,
            gap / MM,
        );
        return check.fail("ribs.thickness_mm", problem);
    }
    let walls = [("ribs.thickness_mm", ribs.thickness), ("skin.thickness_mm", *skin)];
    let Some((key, thickness)) = walls.into_iter().find(|(_, t)| *t < 0.5 * line_width) else {
        return Ok(());
    };
    let problem = format!(
        "is {:.3}; a line of print.line_width_mm = {:.3} does not print thinner than half of it",
        thickness / MM,
        line_width / MM
    );
    check.fail(key, problem)
}

/// Checks that outline and inside are simple rings.
fn check_rings(check: Check<'_>, finger: &PrintedFinger, outer: &Ring, inside: &Ring) -> Checked {
    if polygon::crosses_itself(outer) || polygon::area(outer) <= 0.0 {
        let problem = "its sides cross one another; check outline.length_mm, \
                       outline.width_mm, outline.tip_mm and notch.pad_mm";
        return check.fail("outline", problem);
    }
    // Moved inwards by too much, sides change places and the ring crosses itself.
    let finite = inside.iter().all(|p| p.x.is_finite() && p.y.is_finite());
    let hollow = inside.first().is_some_and(|tip| tip.x < finger.outline.corner().x);
    if !finite || !hollow || polygon::crosses_itself(inside) || polygon::area(inside) <= 0.0 {
        let problem = format!(
            "is {:.3}; it is thicker than the tip and leaves no room for ribs behind the pad: a \
             thinner one",
            finger.skin / MM
        );
        return check.fail("skin.thickness_mm", problem);
    }
    Ok(())
}

/// Largest distance of the arc of the back from its chords, m.
const SAGITTA: f64 = 0.001 * MM;

impl Outline {
    /// Tip of the finger, m.
    pub fn tip_point(&self) -> Point2<f64> {
        Point2::new(0.0, -self.tip)
    }

    /// Unit vector along the pad, from the tip to the notch's corner: the assembly direction z.
    pub fn along_pad(&self) -> Vector2<f64> {
        Vector2::new(libm::cos(self.pad_angle), libm::sin(self.pad_angle))
    }

    /// Unit vector out of the pad's face towards the part: the compliance direction y.
    pub fn out_of_pad(&self) -> Vector2<f64> {
        let z = self.along_pad();
        Vector2::new(-z.y, z.x)
    }

    /// Corner between pad and roof, m.
    pub fn corner(&self) -> Point2<f64> {
        self.tip_point() + self.along_pad() * self.pad
    }

    /// Middle of the pad, where stiffness is stated, m.
    pub fn pad_middle(&self) -> Point2<f64> {
        self.tip_point() + self.along_pad() * (self.pad / 2.0)
    }

    /// Length of the roof, from the corner to the front side, m.
    pub fn roof_length(&self) -> f64 {
        -self.corner().y / self.out_of_pad().y
    }

    /// X at which the arc of the back ends and the straight back begins, m.
    pub fn arc_end(&self) -> f64 {
        self.arc_centre().unwrap_or_default().x
    }

    /// Centre of the arc, m, if the radius reaches from the tip to the back.
    fn arc_centre(&self) -> Option<Point2<f64>> {
        let rise = self.width - self.tip;
        let square = rise * (2.0 * self.back_radius - rise);
        (square > 0.0 && rise < self.back_radius)
            .then(|| Point2::new(square.sqrt(), self.back_radius - self.width))
    }
}

/// Outline moved inwards by `inset` and cut off at X = `end`, m, counter-clockwise from the tip.
/// Lines and arc are moved each for itself and meet in mitred corners.
pub(super) fn ring(outline: &Outline, inset: f64, end: f64) -> Ring {
    let (z, y) = (outline.along_pad(), outline.out_of_pad());
    let centre = outline.arc_centre().unwrap_or_default();
    let radius = outline.back_radius - inset;
    let pad = outline.tip_point() - y * inset;
    // Where the pad's line meets the arc, on the tip's side.
    let to_pad = pad - centre;
    let half = z.dot(&to_pad);
    let tip = pad - z * (half + (half * half - to_pad.norm_squared() + radius * radius).sqrt());
    let start = libm::atan2((tip - centre).y, (tip - centre).x).rem_euclid(360.0 * DEG);
    let sweep = 270.0 * DEG - start;
    let chords = (sweep / (8.0 * SAGITTA / radius).sqrt()).ceil().max(1.0);
    let mut ring: Ring = (0..=chords as usize)
        .map(|i| {
            let angle = start + sweep * i as f64 / chords;
            centre + radius * Vector2::new(libm::cos(angle), libm::sin(angle))
        })
        .collect();
    let corner = outline.corner() + (z - y) * inset;
    let roof_top = corner + y * ((-inset - corner.y) / y.y);
    ring.extend([Point2::new(end, inset - outline.width), Point2::new(end, -inset), roof_top]);
    if inset == 0.0 {
        ring.push(outline.corner() + y * outline.roof);
    }
    ring.push(corner);
    ring
}
