//! Text output of a study.

use super::open::Ended;
use super::report::PAGE;
use crate::layout;
use analysis::levers::Levers;
use report::PostAnalysis;
use report::answer::lines;
use report::answer::words::{evaluated, volume_unit};
use report::answer::{Answer, Front, command, expectation};
use std::path::Path;
use study::{Ending, Recorded, StudyRecord};

/// Returns the answer of a study that has ended as text; with `all`, every number on which it is based.
pub fn ended(ended: &Ended, answer: &Answer, all: bool) -> String {
    let verbose = if all { verbose(answer, ended.ending, ended.cached) } else { String::new() };
    answer_text(answer, &verbose)
}

/// Returns the text of the analyses after a study.
pub fn analyses(PostAnalysis { levers, robots, .. }: &PostAnalysis) -> String {
    let line = |name: &str, text: String| (name.to_owned(), text);
    let least = levers.iter().filter_map(Levers::uncertainty).map(|text| line("uncertain", text));
    let levers = levers.iter().map(|levers| line("levers", levers.sentence()));
    let robots = robots.iter().map(|found| line("robot", found.words()));
    layout::wrapped(&layout::lines(least.chain(levers).chain(robots)))
}

/// Returns the text of the answer.
fn answer_text(answer: &Answer, verbose: &str) -> String {
    // First, since the following lines may recommend printing the finger.
    let mut text = layout::lines(lines::first(answer));
    text += &format!("{}\n{}\n", answer.headline(), expectation(answer));
    text += &layout::lines(lines::brief(answer));
    layout::wrapped(&(text + verbose))
}

/// Returns the next command and the folder of the study as text; the command is not wrapped, so that it can be copied.
pub fn next(answer: &Answer, dir: &Path) -> String {
    let (command, why) = command::next(answer, dir);
    let place = format!("study         {} (see {PAGE})\n", dir.display());
    format!("next          {command}\n              # {why}\n{place}")
}

/// Returns all numbers on which the answer is based.
fn verbose(answer: &Answer, ending: Ending, cached: u64) -> String {
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
    if let Some(bench) = &record.on_bench {
        text += &layout::lines([lines::accuracy(bench)]);
        text += "by simulation alone:\n";
    }
    // If no design is recommended, the headline gives the reason.
    let found = answer.recommended.as_ref().filter(|_| answer.design_to_print().is_some());
    text += &found.map_or(String::new(), |found| match &answer.front {
        Some(front) => front_text(record, front),
        None => layout::lines(lines::recommended(answer, found)),
    });
    if cached > 0 {
        text += &format!("cache         {cached} evaluations were reused from other studies\n");
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the lines of the committed studies exactly.
    #[test]
    fn the_summary_is_that_of_the_reference() {
        for task in ["ket8", "rj45", "usb"] {
            let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reference").join(task);
            let record = StudyRecord::load(&dir).unwrap();
            let answer = Answer::of(&record);
            let lines = answer_text(&answer, "") + &next(&answer, &dir);
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
