//! The checked profile of a printed finger: outline, skin and ribs.

use super::infill::{InfillDesign, MIN_VOID_WIDTH, RibLines};
use super::polygon::{self, HalfPlane, Ring, without_repeats};
use crate::holes::{Block, Holes};
use crate::outline::{Outline, ring};
use crate::printed::PrintedFinger;
use input::units::{MM, PERCENT};
use input::{Check, InputError};

/// Checked profile of a finger, SI units, in the axes of [`Outline`].
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Finger, with the values of its file that the design sets.
    pub finger: PrintedFinger,
    /// Infill of the finger.
    pub design: InfillDesign,
    /// Centre lines of the ribs.
    pub lines: RibLines,
    /// Outline, counter-clockwise from the tip along the back, m.
    pub outer: Ring,
    /// Openings between the ribs, clockwise, m.
    pub voids: Vec<Ring>,
    /// Number of ribs with openings on both sides.
    pub ribs: usize,
}

/// Distance below which two corners of an opening are one, m.
const MIN_CORNER_DISTANCE: f64 = 0.002 * MM;

impl Geometry {
    /// Creates the checked profile of a finger with an infill.
    ///
    /// # Errors
    /// If the parts of the finger do not fit together; the message names file and key.
    pub fn new(finger: &PrintedFinger, design: &InfillDesign) -> Result<Self, InputError> {
        let lines = RibLines::new(finger, design);
        let check = Check { file: &finger.file };
        check_outline(check, &finger.outline)?;
        check_ribs(check, finger, design)?;
        if let Some(holes) = &finger.holes {
            holes.check(check, finger)?;
        }
        let outer = without_repeats(&ring(&finger.outline, 0.0, finger.outline.length), 1e-9);
        let ribbed = finger.outline.length - finger.outline.solid;
        let inside = ring(&finger.outline, finger.skin, ribbed);
        check_rings(check, finger, &outer, &inside)?;
        let gaps = gaps(&inside, finger, &lines);
        let ribs = gaps.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1).count();
        let voids = gaps.into_iter().flat_map(|(_, voids)| voids).collect();
        Ok(Geometry { finger: finger.clone(), design: *design, lines, outer, voids, ribs })
    }

    /// Returns the outline, openings and holes through the base, mm: the solid lies left of every ring.
    pub fn rings_mm(&self) -> Vec<Vec<[f64; 2]>> {
        self.rings().map(|ring| ring.iter().map(|p| [p.x / MM, p.y / MM]).collect()).collect()
    }

    fn rings(&self) -> impl Iterator<Item = Ring> {
        std::iter::once(&self.outer).chain(&self.voids).cloned().chain(self.holes())
    }

    /// Returns the holes through the clamped base, clockwise, m; the mechanical model ignores them.
    pub fn holes(&self) -> Vec<Ring> {
        let holes = self.finger.holes.as_ref().filter(|holes| holes.block.is_none());
        holes.map_or_else(Vec::new, |holes| holes.rings(&self.finger.outline))
    }

    /// Returns the area of the solid profile, m2.
    pub fn area(&self) -> f64 {
        self.rings().map(|ring| polygon::area(&ring)).sum()
    }

    /// Returns the holes and their block, if they are in a block.
    pub fn block(&self) -> Option<(&Holes, Block)> {
        self.finger.holes.as_ref().and_then(|holes| Some((holes, holes.block?)))
    }

    /// Returns the mass of the printed finger without a block for its holes, kg.
    pub fn mass(&self) -> f64 {
        self.area() * self.finger.outline.depth * self.finger.material.mass_density
    }
}

/// Returns the openings between the ribs, clockwise, with the number of the rib before them.
fn gaps(inside: &Ring, finger: &PrintedFinger, lines: &RibLines) -> Vec<(i64, Vec<Ring>)> {
    let half = finger.ribs.thickness / 2.0;
    let gap = |n: i64| {
        let after = HalfPlane { normal: lines.across, offset: lines.offset(n) + half };
        let before = HalfPlane { normal: -lines.across, offset: half - lines.offset(n + 1) };
        let pieces = after.cut(inside).into_iter().flat_map(|piece| before.cut(&piece));
        let mut voids: Vec<Ring> =
            pieces.map(|piece| without_repeats(&piece, MIN_CORNER_DISTANCE)).collect();
        voids.retain(|void| polygon::area(void) > MIN_VOID_WIDTH * polygon::perimeter(void) / 2.0);
        voids.iter_mut().for_each(|void| void.reverse());
        (n, voids)
    };
    lines.range(inside).map(gap).filter(|(_, voids)| !voids.is_empty()).collect()
}

type Checked = Result<(), InputError>;

/// Checks that a value, m, is below a limit, m; `because` explains the limit.
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
    let in_base = "the clamped part is solid";
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
             at {base:.3}: choose a smaller radius or a longer finger"
        );
        return check.fail("outline.back_radius_mm", problem);
    }
    let to_side = tip / libm::sin(outline.pad_angle);
    below(check, "notch.pad_mm", pad, to_side, "the pad ends behind the front")?;
    let to_base = ribbed / libm::cos(outline.pad_angle);
    below(check, "notch.pad_mm", pad, to_base, "the notch ends before the solid base")?;
    below(check, "notch.roof_mm", roof, outline.roof_length(), "that is the length of the roof")
}

/// Checks that the ribs can be printed and leave room between them.
fn check_ribs(check: Check<'_>, finger: &PrintedFinger, design: &InfillDesign) -> Checked {
    let pitch = RibLines::new(finger, design).pitch;
    let PrintedFinger { ribs, line_width, smallest_gap, skin, .. } = finger;
    let InfillDesign { density_percent, direction_deg, phase_mm } = *design;
    let (key, fits) = ("infill_density_percent", density_percent > 0.0 && density_percent < 100.0);
    check.require(key, density_percent, fits, "be above 0 and below 100")?;
    let (key, fits) = ("infill_direction_deg", (-80.0..=80.0).contains(&direction_deg));
    check.require(key, direction_deg, fits, "be from -80 to 80 (degrees)")?;
    if !phase_mm.is_none_or(f64::is_finite) {
        return check.fail("phase_mm", "must be a finite number");
    }
    let gap = smallest_gap.max(MIN_VOID_WIDTH);
    if pitch - ribs.thickness < gap {
        let most = ribs.line_spacing / (ribs.thickness + gap) / PERCENT;
        let problem = format!(
            "is {:.3}; at {density_percent} % infill the ribs lie {:.3} mm apart and merge, \
             their gaps below print.smallest_gap_mm = {:.3}: choose thinner ribs, or a density \
             of at most {most:.1} %",
            ribs.thickness / MM,
            pitch / MM,
            gap / MM,
        );
        return check.fail("ribs.thickness_mm", problem);
    }
    let walls = [("ribs.thickness_mm", ribs.thickness), ("skin.thickness_mm", *skin)];
    let thin = walls.into_iter().find(|(_, thickness)| *thickness < 0.5 * line_width);
    let Some((key, thickness)) = thin else { return Ok(()) };
    let problem = format!(
        "is {:.3}; a line of print.line_width_mm = {:.3} does not print thinner than half of it",
        thickness / MM,
        line_width / MM
    );
    check.fail(key, problem)
}

/// Checks that outline and inside (the outline less skin and base) are simple rings.
fn check_rings(check: Check<'_>, finger: &PrintedFinger, outer: &Ring, inside: &Ring) -> Checked {
    if polygon::crosses_itself(outer) || polygon::area(outer) <= 0.0 {
        let problem = "its sides cross one another; check outline.length_mm, \
                       outline.width_mm, outline.tip_mm and notch.pad_mm";
        return check.fail("outline", problem);
    }
    // If the inset is too large, sides change places and the ring crosses itself.
    let finite = inside.iter().all(|p| p.x.is_finite() && p.y.is_finite());
    let hollow = inside.first().is_some_and(|tip| tip.x < finger.outline.corner().x);
    if !finite || !hollow || polygon::crosses_itself(inside) || polygon::area(inside) <= 0.0 {
        let problem = format!(
            "is {:.3}; it is thicker than the tip and leaves no room for ribs behind the pad: \
             choose a thinner skin",
            finger.skin / MM
        );
        return check.fail("skin.thickness_mm", problem);
    }
    Ok(())
}
