//! Finger files: outline, skin, ribs and material of a printed finger.

use crate::holes::Holes;
use crate::outline::Outline;
use input::units::read::{gpa, mm};
use input::units::{DEG, MM};
use input::{Document, InputError, Place, syntax};
use parameters::numbers::check_file;
use serde::Deserialize;
use toml::{Table, Value};

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
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ribs {
    /// Thickness of a rib, m.
    #[serde(rename = "thickness_mm", deserialize_with = "mm")]
    pub thickness: f64,
    /// Product of the ribs' pitch and the density (0 to 1), m.
    #[serde(rename = "line_spacing_mm", deserialize_with = "mm")]
    pub line_spacing: f64,
    /// Point from which ribs are counted, m.
    #[serde(rename = "origin_mm", deserialize_with = "mm")]
    pub origin: [f64; 2],
    /// Distance of the first centre line from the origin, m.
    #[serde(rename = "phase_mm", deserialize_with = "mm")]
    pub phase: f64,
}

/// Linearly elastic material.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Name, for example `PETG`.
    pub name: String,
    /// Young's modulus, N/m2.
    #[serde(rename = "modulus_gpa", deserialize_with = "gpa")]
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m3.
    #[serde(rename = "density_kg_per_m3")]
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
        ribs: Ribs,
        base: RawBase,
        mount: RawMount,
        holes: Option<Holes>,
        material: Material,
        print: RawPrint,
    }
    RawOutline { length_mm: f64, width_mm: f64, depth_mm: f64, tip_mm: f64, back_radius_mm: f64 }
    RawNotch { pad_mm: f64, pad_deg: f64, roof_mm: f64 }
    RawSkin { thickness_mm: f64 }
    RawBase { solid_mm: f64, clamped_mm: f64 }
    RawMount { tilt_deg: f64 }
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
        let raw = document.read()?;
        check_file("finger", &document.read()?, document.file())?;
        Ok(PrintedFinger::new(raw, document.file()))
    }

    /// Checks the finger of a file that has already been read as TOML.
    ///
    /// # Errors
    /// See [`PrintedFinger::parse`].
    pub fn from_table(table: Table, file: &str) -> Result<Self, InputError> {
        let table = Value::Table(table);
        check_file("finger", &table, file)?;
        let raw = table.try_into().map_err(|error| syntax(file, "", &error))?;
        Ok(PrintedFinger::new(raw, file))
    }

    /// Returns an error about the finger as a whole, not about one of its values.
    pub fn fault(&self, problem: impl ToString) -> InputError {
        Place::file(&self.file).fault(problem.to_string())
    }

    fn new(raw: RawFinger, file: &str) -> Self {
        let RawFinger { outline, notch, base, .. } = raw;
        PrintedFinger {
            name: raw.name,
            description: raw.description,
            file: file.to_owned(),
            measured: raw.measured,
            outline: Outline {
                length: outline.length_mm * MM,
                width: outline.width_mm * MM,
                depth: outline.depth_mm * MM,
                tip: outline.tip_mm * MM,
                back_radius: outline.back_radius_mm * MM,
                pad: notch.pad_mm * MM,
                pad_angle: notch.pad_deg * DEG,
                roof: notch.roof_mm * MM,
                solid: base.solid_mm * MM,
                clamped: base.clamped_mm * MM,
            },
            skin: raw.skin.thickness_mm * MM,
            ribs: raw.ribs,
            material: raw.material,
            tilt: raw.mount.tilt_deg * DEG,
            holes: raw.holes,
            line_width: raw.print.line_width_mm * MM,
            smallest_gap: raw.print.smallest_gap_mm * MM,
        }
    }
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
            ("modulus_gpa = 2.0", "modulus_gpa = 0.0", ["material.modulus_gpa", "0.0001 .. 500"]),
            ("modulus_gpa = 2.0", "modulus_gpa = 2000.0", ["modulus_gpa: is 2000", ".. 500"]),
            ("pad_mm = 9.0", "pad_mm = 0.0", ["notch.pad_mm", "1e-9 .. 500"]),
            ("length_mm = 52.8", "length_mm = 52800.0", ["outline.length_mm", "1e-9 .. 500"]),
            ("poisson = 0.4", "poisson = 0.6", ["material.poisson", "0 .. 0.5"]),
            ("pad_deg = 10.0", "pad_deg = 80.0", ["notch.pad_deg", "0 .. 60"]),
            ("pad_mm = 9.0", "pad = 9.0", ["unknown field", "pad_mm"]),
            ("tilt_deg = 10.0", "tilt_deg = -1.0", ["mount.tilt_deg", "0 .. 60"]),
        ] {
            let error = error(from, to);
            assert!(parts.into_iter().chain([FILE]).all(|part| error.contains(part)), "{error}");
        }
    }
}
