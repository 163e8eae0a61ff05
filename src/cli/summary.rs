//! Output for a whole study.

use super::study::Shown;
use super::terminal::merge;
use super::{recommended, words};
use crate::session::{Around, Ended};
use analysis::map::CaptureMap;
use report::answer::lines;
use report::answer::words::{evaluated, volume_unit};
use report::answer::{Answer, Front, command, expectation};
use report::levers;
use serde_json::{Value, json};
use std::path::Path;
use study::{Ending, Recorded, StudyRecord};

/// Output for a study that has ended, as JSON.
pub fn json(ended: &Ended, around: &Around) -> String {
    let Ended { dir, record, ending, known, .. } = ended;
    let answer = Answer::of(record);
    let mut fields = to_json(&answer, *ending, *known);
    fields["answer"] = recommended::answer(&answer, dir);
    fields["levers"] = json!(around.levers.as_ref().map(levers::json));
    let of_map = |map: &CaptureMap| {
        json!({
            "axes": map.axes.each_ref().map(|axis| &axis.name),
            "area": map.area,
            "area_unit": map.area_unit,
            "trials": map.trials,
        })
    };
    fields["maps"] = around.maps.iter().map(of_map).collect();
    fields["robots"] = json!(around.robots);
    fields["study"] = json!(dir);
    format!("{fields}\n")
}

/// Output for a study that has ended, in words.
pub fn text(Ended { dir, record, ending, known, .. }: &Ended, shown: Shown) -> String {
    let answer = Answer::of(record);
    let verbose = if shown.verbose { verbose(&answer, *ending, *known) } else { String::new() };
    told(&answer, dir, &verbose)
}

fn told(answer: &Answer, dir: &Path, verbose: &str) -> String {
    let mut text = format!("{}\n{}\n", answer.verdict.headline(), expectation(answer));
    text += &words::lines(lines::brief(answer));
    text += verbose;
    // To be copied: not wrapped.
    let (command, why) = command::next(answer, dir);
    let page = dir.join(crate::session::PAGE);
    let place = format!("study         {} (see {})\n", dir.display(), page.display());
    format!("{}next          {command}\n              # {why}\n{place}", words::wrapped(&text))
}

/// What follows the answer.
pub fn around(around: &Around) -> String {
    let levers =
        around.levers.iter().map(|levers| format!("levers        {}\n", levers.sentence()));
    let robots = around.robots.iter().map(|found| format!("robot         {}\n", found.words()));
    words::wrapped(&levers.chain(robots).collect::<String>())
}

/// All numbers behind the answer.
fn verbose(answer: &Answer, ending: Ending, known: u64) -> String {
    let record = answer.record;
    let config = &record.config;
    let done = record.evaluations.len();
    let end = match ending {
        Ending::SpaceExhausted => ": every design of the space",
        Ending::Converged => ": the polish has converged",
        Ending::NothingInserts => ": none of them inserts",
        Ending::BudgetSpent | Ending::Interrupted | Ending::Settled => "",
    };
    let (task, method) = (config.task_name(), config.method());
    let mut text = format!("\n{task} with {method}: {done} evaluations{end}\n");
    let first = record.first_current();
    if first > 0 {
        text += &format!(
            "segment       {}, from evaluation {first}: the settings changed, and only these count\n",
            record.segments.len(),
        );
    }
    if let Some(bench) = &record.on_bench {
        text += &words::lines(lines::on_bench(bench));
        text += "by simulation alone:\n";
    }
    // Where none is recommended, what stands first says why.
    let found = answer.recommended.as_ref().filter(|_| answer.named().is_some());
    text += &found.map_or(String::new(), |found| match &answer.front {
        Some(front) => front_text(record, front),
        None => words::lines(lines::recommended(answer, found)),
    });
    if known > 0 {
        text += &format!("cache         {known} evaluations were known from other studies\n");
    }
    text
}

fn front_text(record: &StudyRecord, Front { designs, volume }: &Front) -> String {
    let objectives = &record.config.objective;
    let line = |recorded: &&Recorded| {
        let values = objectives.show(recorded.feasible().unwrap_or_default());
        format!("              {values}: {}\n", evaluated(recorded))
    };
    let size = match designs.len() {
        1 => "one design is the best in all objectives".to_owned(),
        count => {
            format!("{count} designs; none is at least as good as another in all objectives")
        }
    };
    format!(
        "front         {size}\n{}hypervolume   {:.3} {} from the reference {}\n",
        designs.iter().map(line).collect::<String>(),
        volume.hypervolume,
        volume_unit(objectives),
        objectives.show(&volume.reference)
    )
}

/// Raised when a key changes its meaning or goes.
const SCHEMA_VERSION: u32 = 1;

fn to_json(answer: &Answer, ending: Ending, known: u64) -> Value {
    let record = answer.record;
    let config = &record.config;
    let ending = match ending {
        Ending::BudgetSpent => "budget_spent",
        Ending::SpaceExhausted => "space_exhausted",
        Ending::Converged => "converged",
        Ending::Interrupted => "interrupted",
        Ending::Settled => "settled",
        Ending::NothingInserts => "nothing_inserts",
    };
    let best = record.best().filter(|_| answer.front.is_none());
    let mut fields = json!({
        "schema_version": SCHEMA_VERSION,
        "task": config.task_name(),
        "space": config.space.name,
        "robot": config.robot,
        "engine": record.segments.last().map(|segment| &segment.provenance.engine.name),
        "optimizer": config.optimizer,
        "objective": config.objective,
        "seed": config.seed,
        "budget": config.budget,
        "polish": config.polish,
        "evaluations": record.evaluations.len(),
        "settled": record.settled,
        "cached": known,
        "ending": ending,
        "best": best.map(|best| recorded_json(record, best)),
    });
    merge(&mut fields, recommended::json(answer));
    if !answer.walked.is_empty() {
        let one = |&(design, firm_range_mm): &(&Recorded, f64)| {
            let mut fields = recorded_json(record, design);
            fields["firm_range_mm"] = json!(firm_range_mm);
            fields
        };
        fields["walked"] = answer.walked.iter().map(one).collect();
    }
    if record.segments.len() > 1 {
        fields["segments"] = json!(record.segments);
    }
    if !config.constraints.is_empty() {
        fields["constraints"] = json!(config.constraints);
        fields["feasible"] = json!(answer.feasible);
    }
    if let Some(aggregate) = &config.aggregate {
        fields["aggregate"] = json!(aggregate);
    }
    if let Some(Front { designs, volume }) = &answer.front {
        fields["front"] = designs.iter().map(|r| recorded_json(record, r)).collect();
        fields["hypervolume"] = json!(volume.hypervolume);
        let reference = volume.reference.iter().map(|&value| json!(value));
        fields["hypervolume_reference"] =
            config.objective.keys().into_iter().zip(reference).collect();
    }
    fields
}

pub fn recorded_json(record: &StudyRecord, recorded: &Recorded) -> Value {
    let config = &record.config;
    let mut fields = json!({
        "evaluation": recorded.index,
        "stiffness": recorded.stiffness,
    });
    if let Some(score) = &recorded.score {
        let keys = config.objective.keys().into_iter();
        let values = keys.zip(score.values.iter().map(|&value| json!(value)));
        merge(&mut fields, Value::Object(values.collect()));
        if !score.violations.is_empty() {
            fields["violations"] = json!(score.violations);
        }
    }
    merge(&mut fields, json!(recorded.design));
    if !config.several_tasks() {
        merge(&mut fields, json!(recorded.tasks.first()));
    } else {
        let of = |(task, evaluation)| {
            let mut fields = json!({"task": task});
            merge(&mut fields, json!(evaluation));
            fields
        };
        fields["tasks"] = config.tasks().zip(recorded.tasks()).map(of).collect();
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of the committed studies, to the letter.
    #[test]
    fn the_summary_is_that_of_the_reference() {
        for task in ["ket8", "rj45", "usb"] {
            let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reference").join(task);
            let record = StudyRecord::load(&dir).unwrap();
            let lines = told(&Answer::of(&record), &dir, "");
            let (lines, _) = lines.split_once("study   ").unwrap();
            let file = dir.join("summary.txt");
            if std::env::var_os("RENEW").is_some() {
                std::fs::write(&file, lines).unwrap();
            }
            let expected = std::fs::read_to_string(&file).unwrap();
            assert_eq!(
                lines, expected,
                "{task}: after a change of its words, RENEW=1 writes it anew"
            );
        }
    }
}
