//! Finger files whose numbers (shape and material) a design may set.
//!
//! A key is `finger.`, then the path in the finger file (`finger.skin.thickness_mm`); values are
//! in the unit of the key. They are inserted into the file before its checks.

use crate::{DENSITY_KEY, DIRECTION_KEY, Design};
use finray::infill;
use finray::printed::PrintedFinger;
use input::numbers::NumberFile;
use input::{Document, InputError};

/// Finger file whose numbers a design may set.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerFile {
    /// Numbers of the file, by their keys.
    pub numbers: NumberFile,
    /// Finger of the file, unchanged.
    pub finger: PrintedFinger,
}

/// Returns whether a key sets a number of a finger file, of shape or material (`finger.skin.thickness_mm`). Such a key
/// names a table of the file; a key of the springs (`finger.rcc_mm`) does not.
pub fn is_shape(key: &str) -> bool {
    key.strip_prefix("finger.").is_some_and(|path| path.contains('.'))
}

/// Returns the infill of a design; `phase_mm` is the position of the first rib (phase of the rib pattern), by default
/// that of the finger file.
/// Numbers that the design does not set are NaN, which is invalid in a finger.
pub fn infill(design: &Design, phase_mm: Option<f64>) -> infill::InfillDesign {
    let value = |key| design.get(key).unwrap_or(f64::NAN);
    let [density_percent, direction_deg] = [DENSITY_KEY, DIRECTION_KEY].map(value);
    infill::InfillDesign { density_percent, direction_deg, phase_mm }
}

impl FingerFile {
    /// Reads and checks a finger file; `file` is named in errors.
    ///
    /// # Errors
    /// Same as for [`PrintedFinger::parse`].
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, file)?;
        let finger = PrintedFinger::read(&document)?;
        Ok(FingerFile { numbers: NumberFile::read("finger", &document)?, finger })
    }

    /// Returns the finger with the numbers of the file that a design sets; other keys are ignored.
    ///
    /// # Errors
    /// If a key does not exist, or a value is invalid.
    pub fn with(&self, design: &Design) -> Result<PrintedFinger, InputError> {
        if !design.0.keys().any(|key| is_shape(key)) {
            return Ok(self.finger.clone());
        }
        let values = design.0.iter().map(|(key, &value)| (key.as_str(), value));
        let table = self.numbers.with(values.filter(|(key, _)| is_shape(key)), &[])?;
        PrintedFinger::from_table(table, &self.numbers.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{finger_file, refused};
    use input::units::MM;

    fn with(key: &str, value: f64) -> Result<PrintedFinger, InputError> {
        finger_file().with(&Design([(key.to_owned(), value)].into()))
    }

    #[test]
    fn a_design_sets_what_it_names_and_nothing_else() {
        let file = finger_file();
        assert_eq!(file.with(&Design::infill(20.0, 10.0)).unwrap(), file.finger);
        assert_eq!(with("finger.rcc_mm", 3.0).unwrap(), file.finger);
        let mut expected = file.finger.clone();
        expected.skin = 0.8 * MM;
        assert_eq!(with("finger.skin.thickness_mm", 0.8).unwrap(), expected);
        let modulus = with("finger.material.modulus_gpa", 0.5).unwrap().material.modulus;
        assert_eq!(modulus, 0.5e9);
        assert_eq!(file.numbers.number("finger.outline.back_radius_mm"), Some(23.0));
        assert_eq!(file.numbers.number("finger.outline.radius_mm"), None);
    }

    #[test]
    fn impossible_values_and_unknown_keys_are_named() {
        for (key, value, words) in [
            ("finger.skin.thickness_mm", 0.0, "fingers/finray9.toml: skin.thickness_mm: is 0"),
            ("finger.material.modulus_gpa", 2e3, "material.modulus_gpa: is 2000"),
            ("finger.skin.thick_mm", 1.0, "`finger.skin.` continues with thickness_mm"),
        ] {
            refused(with(key, value), &[words]);
        }
    }
}
