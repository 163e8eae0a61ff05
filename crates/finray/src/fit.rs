//! Checks that the parts of a finger fit one another.

use super::infill::{Design, NARROWEST_VOID};
use super::polygon::{self, Ring};
use crate::printed::{Outline, PrintedFinger};
use input::units::{MM, PERCENT};
use input::{Check, InputError};

/// Checks that the parts of a finger fit one another.
pub(super) struct Fit<'a> {
    pub finger: &'a PrintedFinger,
    pub design: &'a Design,
}

type Checked = Result<(), InputError>;

impl Fit<'_> {
    fn fail(&self, key: &str, problem: impl Into<String>) -> Checked {
        Check { file: &self.finger.file }.fail(key, problem)
    }

    /// Refuses a value of the key, m, that is not below a limit.
    fn below(&self, key: &str, value: f64, limit: f64, because: &str) -> Checked {
        if value < limit {
            return Ok(());
        }
        let (value, limit) = (value / MM, limit / MM);
        self.fail(key, format!("is {value:.3}; it must be below {limit:.3}: {because}"))
    }

    /// Checks that tip, arc, notch and base fit into the outline.
    pub fn outline(&self) -> Checked {
        let outline = &self.finger.outline;
        let Outline { length, width, tip, back_radius, pad, roof, solid, clamped, .. } = *outline;
        self.below("outline.tip_mm", tip, width, "the tip lies in front of the back")?;
        self.below("base.solid_mm", solid, length, "the base is a part of the finger")?;
        let in_base = "what is clamped is solid";
        self.below("base.clamped_mm", clamped, solid * (1.0 + 1e-9), in_base)?;
        let (radius, rise, ribbed) = (back_radius / MM, (width - tip) / MM, length - solid);
        let Some(centre) = outline.arc_centre() else {
            let problem = format!(
                "is {radius:.3}; it must be above {rise:.3}: the arc leads from the tip to the back"
            );
            return self.fail("outline.back_radius_mm", problem);
        };
        if centre.x >= ribbed {
            let (end, base) = (centre.x / MM, ribbed / MM);
            let problem = format!(
                "is {radius:.3}; the arc would end at X = {end:.3}, in the solid base that begins \
                 at {base:.3}: a smaller radius, or a longer finger"
            );
            return self.fail("outline.back_radius_mm", problem);
        }
        let to_side = tip / outline.pad_angle.sin();
        self.below("notch.pad_mm", pad, to_side, "the pad ends behind the front")?;
        let to_base = ribbed / outline.pad_angle.cos();
        self.below("notch.pad_mm", pad, to_base, "the notch ends before the solid base")?;
        self.below("notch.roof_mm", roof, outline.roof_length(), "the roof is no longer")
    }

    /// Checks that ribs at this pitch, m, can be printed and leave room between them.
    pub fn ribs(&self, pitch: f64) -> Checked {
        let PrintedFinger { ribs, line_width, smallest_gap, skin, .. } = self.finger;
        let Design { density_percent, direction_deg, phase_mm } = *self.design;
        let check = Check { file: &self.finger.file };
        let (key, fits) =
            ("infill_density_percent", density_percent > 0.0 && density_percent < 100.0);
        check.require(key, density_percent, fits, "be above 0 and below 100")?;
        let (key, fits) = ("infill_direction_deg", (-80.0..=80.0).contains(&direction_deg));
        check.require(key, direction_deg, fits, "be from -80 to 80 (degrees)")?;
        if !phase_mm.is_none_or(f64::is_finite) {
            return self.fail("phase_mm", "must be a finite number");
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
            return self.fail("ribs.thickness_mm", problem);
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
        self.fail(key, problem)
    }

    /// Checks that outline and inside are simple rings.
    pub fn rings(&self, outer: &Ring, inside: &Ring) -> Checked {
        if polygon::crosses_itself(outer) || polygon::area(outer) <= 0.0 {
            let problem = "its sides cross one another; check outline.length_mm, \
                           outline.width_mm, outline.tip_mm and notch.pad_mm";
            return self.fail("outline", problem);
        }
        // Moved inwards by too much, sides change places and the ring crosses itself.
        let finite = inside.iter().all(|p| p.x.is_finite() && p.y.is_finite());
        let hollow = inside.first().is_some_and(|tip| tip.x < self.finger.outline.corner().x);
        if !finite || !hollow || polygon::crosses_itself(inside) || polygon::area(inside) <= 0.0 {
            let problem = format!(
                "is {:.3}; it is thicker than the tip and leaves no room for ribs behind the pad: a \
                 thinner one",
                self.finger.skin / MM
            );
            return self.fail("skin.thickness_mm", problem);
        }
        Ok(())
    }
}
