//! The command that runs a study again, option by option.

use crate::study::{FINGER, Provenance, StudyRecord, input_path, sha256_hex};
use input::shipped::{FINGERS, ROBOTS, SPACES, STIFFNESS, Shipped, TASKS, UNCERTAINTIES};
use insertion::evaluation::objective::Aggregate;
use insertion::trial::engine::EngineKind;
use std::path::Path;

/// The command, to be given in the study's folder; what is as shipped goes by its name, other
/// inputs by their copies there.
pub(super) fn words(record: &StudyRecord) -> Vec<String> {
    let config = &record.config;
    let provenance = record.segments.last().map_or(&config.provenance, |last| &last.provenance);
    let segment = record.segments.len().max(1);
    let named = |role: &str, shipped| match name(provenance, role, shipped) {
        Some(name) => name.to_owned(),
        None => input_path(Path::new(""), segment, role).display().to_string(),
    };
    let tasks = (1..=config.tasks.len()).map(|number| named(&format!("task_{number}"), TASKS));
    let mut words = vec![
        "optimize".to_owned(),
        format!("--task {}", tasks.collect::<Vec<_>>().join(",")),
        format!("--space {}", named("space", SPACES)),
        format!("--robot {}", named("robot", ROBOTS)),
    ];
    if name(provenance, "stiffness", STIFFNESS).is_none() {
        words.push(format!("--stiffness-data {}", named("stiffness", &[])));
    }
    words.push(format!("--finger-model {}", config.finger_model.name()));
    if provenance.input_sha256.contains_key(FINGER) {
        words.push(format!("--finger {}", named(FINGER, FINGERS)));
    }
    let engine = &provenance.engine.name;
    if engine != EngineKind::Direct.name() {
        words.push(format!("--engine {engine}"));
    }
    words.push(format!("--optimizer {}", config.optimizer));
    words.push(format!("--objective {}", config.objective));
    words.extend(config.constraints.iter().map(|limit| format!("--constraint '{limit}'")));
    if config.uncertainty.is_some() {
        words.push(format!("--uncertainty {}", named("uncertainty", UNCERTAINTIES)));
    }
    words.extend(config.aggregate.as_ref().map(aggregate));
    words.push(format!("--seed {}", config.seed));
    if !config.settles {
        words.push(format!("--budget {}", config.budget));
    }
    if config.polish > 0 {
        words.push(format!("--polish {}", config.polish));
    }
    words.push(format!("--batch {}", config.batch));
    if config.asynchronous {
        words.push("--async".to_owned());
    }
    words
}

/// The name of the shipped file that an input is.
fn name(provenance: &Provenance, role: &str, shipped: &[Shipped]) -> Option<&'static str> {
    let hash = provenance.input_sha256.get(role)?;
    let own = |one: &&Shipped| sha256_hex(one.text.as_bytes()) == *hash;
    shipped.iter().find(own).map(|one| one.name)
}

fn aggregate(aggregate: &Aggregate) -> String {
    match aggregate {
        Aggregate::Weighted(weights) => {
            let weights: Vec<String> = weights.iter().map(f64::to_string).collect();
            format!("--aggregate weighted --weights {}", weights.join(","))
        }
        other => format!("--aggregate {other}"),
    }
}
