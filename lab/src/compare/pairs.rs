//! Windows of the same fingers in two settings, and the differences of their ends.

use super::{Setting, Subject, TaskSettings, each, window_words};
use ask_tell::statistics::mean;
use insertion::{Evaluation, Measurement, OffsetStep, Window, grid_mm};
use report::text_table;

/// Windows of a finger in two settings.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowPair {
    pub subject: Subject,
    pub settings: [String; 2],
    pub windows: [Window; 2],
    pub trials: [u32; 2],
}

impl WindowPair {
    pub fn new(subject: &Subject, settings: &[Setting; 2], found: [&Evaluation; 2]) -> Self {
        WindowPair {
            subject: subject.clone(),
            settings: settings.each_ref().map(|setting| setting.name.clone()),
            windows: found.map(|evaluation| evaluation.window.clone()),
            trials: found.map(|evaluation| evaluation.trials),
        }
    }

    /// Returns the outward shift of the negative and the positive end from the first setting to the second, mm.
    pub fn moved_mm(&self) -> [f64; 2] {
        self.moved().map(grid_mm)
    }

    fn moved(&self) -> [OffsetStep; 2] {
        let [first, second] = &self.windows;
        [first.negative_steps - second.negative_steps, second.positive_steps - first.positive_steps]
    }

    /// Returns whether the nominal outcomes are equal and no end moves by more than `allowed` grid steps.
    pub fn agrees(&self, allowed: OffsetStep) -> bool {
        self.windows[0].nominal == self.windows[1].nominal
            && self.moved().iter().all(|moved| moved.abs() <= allowed)
    }
}

/// Returns the pair of windows for every design on every task.
pub fn simulate(tasks: &[TaskSettings], designs: &[Measurement]) -> Vec<WindowPair> {
    each(tasks, designs, |subject, settings| {
        let found = settings.each_ref().map(|setting| setting.evaluate(&subject.finger));
        WindowPair::new(subject, settings, found.each_ref())
    })
}

/// Returns a table at most 80 columns wide with a summary; with verdicts, if an `allowed` shift of an end is given, in
/// grid steps.
pub fn text(pairs: &[WindowPair], allowed: Option<OffsetStep>) -> String {
    let first = pairs.first().map_or("", |pair| &pair.settings[0]);
    let rows = pairs.iter().map(|pair| {
        let [below, above] = pair.moved_mm();
        let [a, b] = pair.windows.each_ref().map(window_words);
        let verdict = match allowed.map(|allowed| pair.agrees(allowed)) {
            None => "",
            Some(true) => "ok",
            Some(false) => "FAIL",
        };
        let subject = &pair.subject;
        let [task, setting] = [&subject.task, &pair.settings[1]].map(ToString::to_string);
        let moved = format!("{below:+.1} {above:+.1}");
        let number = subject.design.design.to_string();
        [task, number, subject.infill(), setting, a, b, moved, verdict.to_owned()]
    });
    let first = format!("{first}\nmm");
    let head = ["task", "no.", "infill", "compared", &first, "its window\nmm", "ends move\nmm", ""];
    text_table(4, head, rows) + &summary(pairs)
}

fn summary(pairs: &[WindowPair]) -> String {
    let differences: Vec<f64> = pairs
        .iter()
        .map(|pair| (pair.windows[0].range_mm() - pair.windows[1].range_mm()).abs())
        .collect();
    let [first, second] =
        [0, 1].map(|setting| pairs.iter().map(|pair| pair.trials[setting]).sum::<u32>());
    let (same, all) = (pairs.iter().filter(|pair| pair.agrees(0)).count(), pairs.len());
    let average = mean(&differences).unwrap_or(0.0);
    let most = differences.into_iter().fold(0.0, f64::max);
    format!(
        "same ends in {same} of {all}; ranges differ by {average:.2} mm in the mean, {most:.1} mm at most\n\
         trials: {first} against {second}\n"
    )
}
