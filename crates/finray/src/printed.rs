//! Finger files: outline, skin, ribs and material of a printed finger.

use crate::holes::{Holes, RawHoles};
use crate::outline::Outline;
use input::units::{DEG, MM};
use input::{Check, Document, InputError, Place, syntax};
use nalgebra::Point2;
use serde::Deserialize;

/// Printed finger as its file describes it, SI units; a design adds the infill.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintedFinger {
    /// Name, as used on the command line.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// Name of the file, for messages.
    pub file: String,
    /// Table of measured fingers of this shape and material.
    pub measured: Option<String>,
    /// Outline of the profile.
    pub outline: Outline,
    /// Thickness of the skin, m.
    pub skin: f64,
    /// Rule by which ribs fill the finger.
    pub ribs: Ribs,
    /// Material of the print.
    pub material: Material,
    /// Angle between the finger's axis and the assembly direction, rad.
    pub tilt: f64,
    /// Holes for the screws that hold the finger.
    pub holes: Option<Holes>,
    /// Width of a printed line, m.
    pub line_width: f64,
    /// Width of the narrowest gap between ribs that stays open, m.
    pub smallest_gap: f64,
}

/// Rule by which ribs fill a finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ribs {
    /// Thickness of a rib, m.
    pub thickness: f64,
    /// Product of the ribs' pitch and the density (0 to 1), m.
    pub line_spacing: f64,
    /// Point from which ribs are counted, m.
    pub origin: Point2<f64>,
    /// Distance of the first centre line from the origin, m.
    pub phase: f64,
}

/// Linearly elastic material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name, for example `PETG`.
    pub name: String,
    /// Young's modulus, N/m2.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m3.
    pub mass_density: f64,
    /// Source of the values.
    pub source: String,
}

/// Declares the tables of a finger file; other keys are errors.
macro_rules! tables {
    ($($table:ident { $($key:ident: $kind:ty),* $(,)? })*) => {
        $(#[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $table { $($key: $kind),* })*
    };
}

tables! {
    RawFinger {
        name: String,
        description: String,
        measured: Option<String>,
        outline: RawOutline,
        notch: RawNotch,
        skin: RawSkin,
        ribs: RawRibs,
        base: RawBase,
        mount: RawMount,
        holes: Option<RawHoles>,
        material: RawMaterial,
        print: RawPrint,
    }
    RawOutline { length_mm: f64, width_mm: f64, depth_mm: f64, tip_mm: f64, back_radius_mm: f64 }
    RawNotch { pad_mm: f64, pad_deg: f64, roof_mm: f64 }
    RawSkin { thickness_mm: f64 }
    RawRibs { thickness_mm: f64, line_spacing_mm: f64, origin_mm: [f64; 2], phase_mm: f64 }
    RawBase { solid_mm: f64, clamped_mm: f64 }
    RawMount { tilt_deg: f64 }
    RawMaterial {
        name: String,
        modulus_gpa: f64,
        poisson: f64,
        density_kg_per_m3: f64,
        source: String,
    }
    RawPrint { line_width_mm: f64, smallest_gap_mm: f64 }
}

impl PrintedFinger {
    /// Reads and checks a finger; `file` is named in errors. Whether its parts fit together
    /// depends on the design: see [`crate::geometry::Geometry::new`].
    ///
    /// # Errors
    /// If the text is not a finger file, or a value is invalid.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        PrintedFinger::read(&Document::parse(text, file)?)
    }

    /// Reads and checks the finger of a parsed file.
    ///
    /// # Errors
    /// See [`PrintedFinger::parse`].
    pub fn read(document: &Document<'_>) -> Result<Self, InputError> {
        PrintedFinger::checked(document.read()?, document.file())
    }

    /// Checks the finger of a file that has already been read as TOML.
    ///
    /// # Errors
    /// See [`PrintedFinger::parse`].
    pub fn from_table(table: toml::Table, file: &str) -> Result<Self, InputError> {
        PrintedFinger::checked(table.try_into().map_err(|error| syntax(file, "", &error))?, file)
    }

    /// Returns an error about the finger as a whole, not about one of its values.
    pub fn fault(&self, problem: impl ToString) -> InputError {
        Place::file(&self.file).fault(problem.to_string())
    }

    fn checked(raw: RawFinger, file: &str) -> Result<Self, InputError> {
        let check = Check { file };
        let length = |key, value| length(check, key, value);
        let RawFinger { outline, notch, base, skin, ribs, material, mount, print, .. } = raw;
        Ok(PrintedFinger {
            outline: Outline {
                length: length("outline.length_mm", outline.length_mm)?,
                width: length("outline.width_mm", outline.width_mm)?,
                depth: length("outline.depth_mm", outline.depth_mm)?,
                tip: length("outline.tip_mm", outline.tip_mm)?,
                back_radius: length("outline.back_radius_mm", outline.back_radius_mm)?,
                pad: length("notch.pad_mm", notch.pad_mm)?,
                pad_angle: angle(check, "notch.pad_deg", notch.pad_deg)?,
                roof: length("notch.roof_mm", notch.roof_mm)?,
                solid: length("base.solid_mm", base.solid_mm)?,
                clamped: length("base.clamped_mm", base.clamped_mm)?,
            },
            skin: length("skin.thickness_mm", skin.thickness_mm)?,
            ribs: Ribs {
                thickness: length("ribs.thickness_mm", ribs.thickness_mm)?,
                line_spacing: length("ribs.line_spacing_mm", ribs.line_spacing_mm)?,
                origin: check
                    .each("ribs.origin_mm", ribs.origin_mm, Check::finite)?
                    .map(|value| value * MM)
                    .into(),
                phase: check.finite("ribs.phase_mm", ribs.phase_mm)? * MM,
            },
            material: checked_material(check, material)?,
            tilt: angle(check, "mount.tilt_deg", mount.tilt_deg)?,
            holes: raw.holes.map(|holes| holes.checked(check)).transpose()?,
            line_width: length("print.line_width_mm", print.line_width_mm)?,
            smallest_gap: length("print.smallest_gap_mm", print.smallest_gap_mm)?,
            name: raw.name,
            description: raw.description,
            file: file.to_owned(),
            measured: raw.measured,
        })
    }
}

/// Largest length, mm; above it the unit is wrong.
const MAX_LENGTH_MM: f64 = 500.0;
/// Accepted moduli, GPa: silicone has about 0.001, steel 210.
const MODULI_GPA: std::ops::RangeInclusive<f64> = 1e-4..=500.0;
/// Largest angle, degrees; above it there is no notch.
const MAX_ANGLE_DEG: f64 = 60.0;

/// Checks a length, mm; returns it in m.
pub(super) fn length(check: Check<'_>, key: &str, value: f64) -> Result<f64, InputError> {
    let fits = check.positive(key, value)? <= MAX_LENGTH_MM;
    let must = format!("be at most {MAX_LENGTH_MM} (millimetres)");
    Ok(check.require(key, value, fits, &must)? * MM)
}

fn angle(check: Check<'_>, key: &str, value: f64) -> Result<f64, InputError> {
    let fits = check.not_negative(key, value)? <= MAX_ANGLE_DEG;
    let must = format!("be from 0 to {MAX_ANGLE_DEG} (degrees)");
    Ok(check.require(key, value, fits, &must)? * DEG)
}

fn checked_material(check: Check<'_>, raw: RawMaterial) -> Result<Material, InputError> {
    let modulus = check.positive("material.modulus_gpa", raw.modulus_gpa)?;
    let (least, most) = (MODULI_GPA.start(), MODULI_GPA.end());
    let must = format!("be from {least} to {most} (gigapascals; PETG has 2)");
    check.require("material.modulus_gpa", modulus, MODULI_GPA.contains(&modulus), &must)?;
    let poisson = check.not_negative("material.poisson", raw.poisson)?;
    check.require("material.poisson", poisson, poisson < 0.5, "be at least 0 and below 0.5")?;
    Ok(Material {
        modulus: modulus * 1e9,
        poisson,
        mass_density: check.positive("material.density_kg_per_m3", raw.density_kg_per_m3)?,
        name: raw.name,
        source: raw.source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "fingers/finray9.toml";
    const TEXT: &str = include_str!("../../../fingers/finray9.toml");

    fn error(from: &str, to: &str) -> String {
        assert!(TEXT.contains(from), "{from}");
        PrintedFinger::parse(&TEXT.replace(from, to), FILE).unwrap_err().to_string()
    }

    #[test]
    fn the_shipped_finger_is_read_in_si_units() {
        let finger = PrintedFinger::parse(TEXT, FILE).unwrap();
        assert_eq!(finger.name, "finray9");
        assert_eq!(finger.material.modulus, 2e9);
        assert_eq!(finger.outline.length, 52.8 * MM);
        assert_eq!(finger.tilt, 10.0 * DEG);
        assert_eq!(finger.measured.as_deref(), Some("data/measured_stiffness.csv"));
    }

    #[test]
    fn errors_name_file_key_and_accepted_values() {
        for (from, to, parts) in [
            ("modulus_gpa = 2.0", "modulus_gpa = 0.0", ["material.modulus_gpa", "above 0"]),
            ("modulus_gpa = 2.0", "modulus_gpa = 2000.0", ["material.modulus_gpa", "gigapascals"]),
            ("pad_mm = 9.0", "pad_mm = 0.0", ["notch.pad_mm", "above 0"]),
            ("length_mm = 52.8", "length_mm = 52800.0", ["outline.length_mm", "millimetres"]),
            ("poisson = 0.4", "poisson = 0.5", ["material.poisson", "below 0.5"]),
            ("pad_deg = 10.0", "pad_deg = 80.0", ["notch.pad_deg", "degrees"]),
            ("pad_mm = 9.0", "pad = 9.0", ["unknown field", "pad_mm"]),
            ("tilt_deg = 10.0", "tilt_deg = -1.0", ["mount.tilt_deg", "0 or above"]),
        ] {
            let error = error(from, to);
            assert!(parts.into_iter().chain([FILE]).all(|part| error.contains(part)), "{error}");
        }
    }
}
