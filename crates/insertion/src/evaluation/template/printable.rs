//! Checks, before a study starts, that every finger of a space can be printed and represented by springs.

use super::is_infill;
use super::space::{each_corner, each_extreme};
use crate::finger::file::{infill, is_shape};
use crate::finger::model::{RCC_KEY, TILTING_KEY};
use crate::{Evaluator, FingerFile, FingerSource, Space, Variable};
use finray::geometry::Geometry;
use input::{Check, InputError};

/// Checks that every finger of a space read from `file` can be printed, by every combination of extreme values
/// of infill and finger. Thickness and gaps are monotonic in each number, so the fingers in between are
/// printable, too.
///
/// # Errors
/// If the finger file lacks a key, or a combination cannot be printed.
pub fn check(space: &Space, file: &str, finger: &FingerFile) -> Result<(), InputError> {
    let check = Check { file };
    let shape = |p: &&Variable| is_shape(&p.key);
    each_extreme(check, space.parameters.iter().filter(shape), |alone| {
        Ok(finger.with(alone).map(drop)?)
    })?;
    let sets = |p: &&Variable| shape(p) || is_infill(&p.key);
    let all = (space.parameters.iter().filter(sets), usize::MAX);
    each_corner(check, "parameter", all, "cannot be printed", |design| {
        Ok(Geometry::new(&finger.with(design)?, &infill(design, None)).map(drop)?)
    })
}

/// Checks that springs can represent every finger of a space read from `file` that sets the remote centre or the
/// tilting stiffness of computed fingers. Rotation about a distant centre alone can be softer than the measured
/// finger, so all combinations of extreme values are tried, including those of the infill.
///
/// # Errors
/// If springs cannot represent a combination; the error is about the first one.
pub fn check_springs(evaluator: &Evaluator, space: &Space, file: &str) -> Result<(), InputError> {
    let sets = |key: &str| [RCC_KEY, TILTING_KEY].contains(&key);
    let computed = matches!(evaluator.fingers, FingerSource::Computed(_));
    let first = space.parameters.iter().find(|p| computed && sets(&p.key));
    let Some(first) = first else { return Ok(()) };
    let tried = |p: &&Variable| sets(&p.key) || is_infill(&p.key);
    let all = (space.parameters.iter().filter(tried), usize::MAX);
    each_corner(Check { file }, &first.key, all, "has no springs", |design| {
        let stiffness = evaluator.predict(design)?;
        for template in &evaluator.templates {
            evaluator.fingers.make(&stiffness, design, &template.task)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::SPACES;

    fn shipped(change: [&str; 2]) -> Result<(), InputError> {
        let file = SPACES.iter().find(|space| space.name == "finger").unwrap();
        assert!(file.text.contains(change[0]));
        let space = Space::parse(&file.text.replace(change[0], change[1]), file.file).unwrap();
        check(&space, file.file, &crate::tests::fixtures::finger_file())
    }

    #[test]
    fn every_finger_of_the_shipped_space_can_be_printed() {
        assert_eq!(shipped(["", ""]), Ok(()));
    }

    #[test]
    fn an_unprintable_finger_is_reported_with_its_key() {
        for (change, words) in [
            (["high = 0.76", "high = 1.14"], "ribs.thickness_mm"),
            (["high = 12.0", "high = 20.0"], "notch.roof_mm"),
            (["low = 15.0", "low = 9.0"], "outline.back_radius_mm"),
            (["low = 0.4\n", "low = 0.1\n"], "skin.thickness_mm"),
            (["finger.skin.thickness_mm", "finger.holes.spacing_mm"], "unknown path"),
        ] {
            let error = shipped(change).unwrap_err().to_string();
            assert!(error.starts_with("spaces/finger.toml: "), "{error}");
            assert!(error.contains(words), "{change:?}: {error}");
        }
    }
}
