//! Output on the finger and the task of a trial or an evaluation.

use super::words;
use crate::session::Chosen;
use input::units::{MM, N_PER_MM};
use insertion::evaluation::evaluator::Specimen;
use insertion::finger::model::{CentreFrom, FingerModelKind, RCC_KEY};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};
use report::answer::lines;
use serde_json::{Value, json};

/// The keys that say what was measured.
pub fn json(chosen: &Chosen) -> Value {
    let Chosen { specimen, .. } = chosen;
    json!({
        "task": specimen.task.name,
        "robot": chosen.robot,
        "cell": chosen.cell,
        "infill_density_percent": chosen.design.get(DENSITY_KEY),
        "infill_direction_deg": chosen.design.get(DIRECTION_KEY),
        "set": chosen.set,
        "finger_model": chosen.finger_model.name(),
        "rcc_mm": specimen.finger.rcc / MM,
        "rcc_from": from_word(specimen.centre),
        "tilting_nm_per_rad": specimen.finger.rotation[0],
        "stiffness": chosen.specimen.stiffness,
    })
}

/// Settings and stiffness, in lines that are ended.
pub fn text(chosen: &Chosen) -> String {
    let stiffness = &chosen.specimen.stiffness;
    let stiffness = match chosen.given {
        false => words::lines(lines::stiffness(stiffness)),
        true => format!(
            "stiffness     compliance {} N/mm, assembly {} N/mm, as given\n",
            stiffness.compliance.mean / N_PER_MM,
            stiffness.assembly.mean / N_PER_MM
        ),
    };
    let finger = finger_text(chosen);
    let design = match chosen.design.0.is_empty() {
        true => String::new(),
        false => format!("design        {}\n", chosen.design.labelled()),
    };
    format!("{design}{stiffness}{finger}")
}

/// Results of the finger model, if it is not the paper's.
fn finger_text(chosen: &Chosen) -> String {
    let Specimen { finger, centre, .. } = &chosen.specimen;
    if chosen.finger_model == FingerModelKind::Paper {
        return String::new();
    }
    let (below, ahead) = (finger.rcc / MM, finger.ahead / MM);
    let given = match centre {
        CentreFrom::Model => String::new(),
        CentreFrom::TaskFile => ", as the task file says, not computed".to_owned(),
        CentreFrom::Design => format!(", as {RCC_KEY} says, not computed"),
    };
    format!(
        "finger        computed: tilting {:.2} N m/rad, remote centre {ahead:.1} mm in front of \
         the pad\n              and {below:.1} mm below the grasp point{given}\n",
        finger.rotation[0]
    )
}

fn from_word(centre: CentreFrom) -> &'static str {
    match centre {
        CentreFrom::Model => "finger-model",
        CentreFrom::TaskFile => "task",
        CentreFrom::Design => "design",
    }
}
