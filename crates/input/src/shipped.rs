//! Files embedded in the program, so that it runs from any folder.

use crate::files::{self, LARGEST_INPUT};
use crate::place::{Place, RequestError};
use std::path::Path;
use strsim::osa_distance;

/// File embedded in the program.
#[derive(Debug, Clone, Copy)]
pub struct Shipped {
    /// Name on the command line.
    pub name: &'static str,
    /// Path in the project, for messages.
    pub file: &'static str,
    /// Text of the file.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal: $file:literal),* $(,)?) => {
        &[$(Shipped {
            name: $name,
            file: $file,
            text: include_str!(concat!("../../../", $file)),
        }),*]
    };
}

/// Connector insertion tasks of the paper in which the shipped fingers were measured.
pub const TASKS: &[Shipped] = shipped! {
    "ket8": "tasks/ket8.toml",
    "ket12": "tasks/ket12.toml",
    "rj45": "tasks/rj45.toml",
    "usb": "tasks/usb.toml",
};

/// Tasks with the mechanisms and clearances of commercial RJ45 and USB connectors.
pub const COMMERCIAL: &[Shipped] = shipped! {
    "rj45_latch": "tasks/rj45_latch.toml",
    "usb_a": "tasks/usb_a.toml",
};

/// Search spaces of finger and strategy.
pub const SPACES: &[Shipped] = shipped! {
    "infill": "spaces/infill.toml",
    "codesign": "spaces/codesign.toml",
    "finger": "spaces/finger.toml",
};

/// Robots, the likelier before the other of two alike.
pub const ROBOTS: &[Shipped] = shipped! {
    "servo": "robots/servo.toml",
    "rigid": "robots/rigid.toml",
    "ur5e_position": "robots/ur5e_position.toml",
    "ur5e": "robots/ur5e.toml",
};

/// Geometry and material of printed fingers.
pub const FINGERS: &[Shipped] = shipped! { "finray9": "fingers/finray9.toml" };

/// Distributions of the errors of an insertion.
pub const UNCERTAINTIES: &[Shipped] = shipped! { "typical": "uncertainties/typical.toml" };

/// Priors of the unmeasured parameters of a robot cell, for `calibrate`.
pub const PRIORS: &[Shipped] = shipped! { "bench": "priors/bench.toml" };

/// Adjustable parameters of a robot cell other than the infill, for `levers`.
pub const LEVERS: &[Shipped] = shipped! { "levers": "priors/levers.toml" };

/// Measured stiffness of printed fingers.
pub const STIFFNESS: &[Shipped] = shipped! { "measured": "data/measured_stiffness.csv" };

/// Published results of the paper's experiments on a physical test bench.
pub const MEASUREMENTS: &[Shipped] = shipped! { "published": "data/published_bench.csv" };

/// Text of a file with its name for messages.
#[derive(Debug, Clone, PartialEq, Eq, serde::Deserialize)]
pub struct Source {
    /// File name as given by the user, or [`Shipped::file`].
    pub file: String,
    /// Text of the file.
    pub text: String,
}

impl Source {
    /// Reads a file; `kind` is what it holds, for errors.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(kind: &str, path: &Path) -> Result<Self, RequestError> {
        let file = path.display().to_string();
        let unreadable = |error| {
            let text = format!("{file}: cannot read the {kind}: {error}");
            RequestError { place: Place::file(&file), text }
        };
        let text = files::read_text(path, LARGEST_INPUT).map_err(unreadable)?;
        Ok(Source { file, text })
    }
}

/// Returns the shipped file of that name or, if `name` looks like a path (it has a separator or an
/// extension), the file at that path.
///
/// # Errors
/// If there is no such file or it cannot be read; the message about an unknown name lists the names that begin with it
/// and a file of that name, else the nearest name, and all names.
pub fn resolve(kind: &str, shipped: &[Shipped], name: &str) -> Result<Source, RequestError> {
    if let Some(found) = shipped.iter().find(|shipped| shipped.name == name) {
        return Ok(Source { file: found.file.to_owned(), text: found.text.to_owned() });
    }
    if name.contains(['/', '\\']) || Path::new(name).extension().is_some() {
        return Source::read(kind, Path::new(name));
    }
    let names: Vec<&'static str> = shipped.iter().map(|shipped| shipped.name).collect();
    let begins = |other: &&str| !name.is_empty() && other.starts_with(name);
    let mut near: Vec<&str> = names.iter().copied().filter(begins).collect();
    let extension = shipped.first().and_then(|known| known.file.split('.').next_back());
    let file = format!("{name}.{}", extension.unwrap_or_default());
    near.extend(Some(&*file).filter(|file| !name.is_empty() && Path::new(file).is_file()));
    if near.is_empty() {
        near.extend(nearest(name, &names));
    }
    let hint = format!(" (did you mean `{}`?)", near.join("` or `"));
    let hint = if near.is_empty() { "" } else { &hint };
    let list = if kind == "robot" { " (see `optimize robots`)" } else { "" };
    let text = format!(
        "unknown {kind} `{name}`{hint}\navailable{list}: {}, or give the path of a file",
        names.join(", ")
    );
    Err(RequestError { place: Place::default().key(&kind.replace(' ', "_")), text })
}

/// Returns the name with the smallest edit distance from `name`, if that is at most half the length of `name`.
pub fn nearest<'a>(name: &str, names: &[&'a str]) -> Option<&'a str> {
    let distance = |other: &&&str| osa_distance(name, other);
    let best = names.iter().min_by_key(distance)?;
    (2 * osa_distance(name, best) <= name.chars().count()).then_some(*best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_which_more_than_half_differs_is_not_near() {
        assert_eq!(nearest("hexapod", &["usb", "rj45"]), None);
    }

    #[test]
    fn the_beginning_of_names_suggests_them_all() {
        let error = |name: &str| resolve("robot", ROBOTS, name).unwrap_err().to_string();
        let text = "unknown robot `ur5` (did you mean `ur5e_position` or `ur5e`?)\navailable (see `optimize robots`): \
                    servo, rigid, ur5e_position, ur5e, or give the path of a file";
        assert_eq!(error("ur5"), text);
        assert!(error("rigit").contains("(did you mean `rigid`?)"));
        assert!(error("").contains("robot ``\navailable"));
        // A file of the folder of this crate.
        assert!(error("Cargo").contains("(did you mean `Cargo.toml`?)"));
    }
}
