//! The commands of `optimize`, one file each. Written by `scripts/generate.py` from the files in this folder.

pub mod ask_tell;
pub mod calibrate;
pub mod compare;
pub mod completions;
pub mod config;
pub mod evaluate;
pub mod finger;
pub mod identify;
pub mod levers;
pub mod man;
pub mod map;
pub mod next;
pub mod report;
pub mod resume;
pub mod robots;
pub mod sensitivity;
pub mod stiffness;
pub mod study;
pub mod tasks;
pub mod trial;

/// `optimize export`.
pub mod export {
    pub mod finger;
    pub mod mjcf;
}

/// `optimize measure`.
pub mod measure {
    pub mod add;
    pub mod check;
    pub mod sheet;
}

/// `optimize task`.
pub mod task {
    pub mod check;
    pub mod import;
    pub mod new;
    pub mod show;
    pub mod tune;
}

use crate::command::Command;

/// All commands.
pub static COMMANDS: &[Command] = &[
    Command::of::<ask_tell::Request>(&["ask-tell"]),
    Command::of::<calibrate::Request>(&["calibrate"]),
    Command::of::<compare::Request>(&["compare"]),
    Command::of::<completions::Request>(&["completions"]),
    Command::of::<config::Request>(&["config"]),
    Command::of::<evaluate::Request>(&["evaluate"]),
    Command::of::<export::finger::Request>(&["export", "finger"]),
    Command::of::<export::mjcf::Request>(&["export", "mjcf"]),
    Command::of::<finger::Request>(&["finger"]),
    Command::of::<identify::Request>(&["identify"]),
    Command::of::<levers::Request>(&["levers"]),
    Command::of::<man::Request>(&["man"]),
    Command::of::<map::Request>(&["map"]),
    Command::of::<measure::add::Request>(&["measure", "add"]),
    Command::of::<measure::check::Request>(&["measure", "check"]),
    Command::of::<measure::sheet::Request>(&["measure", "sheet"]),
    Command::of::<next::Request>(&["next"]),
    Command::of::<report::Request>(&["report"]),
    Command::of::<resume::Request>(&["resume"]),
    Command::of::<robots::Request>(&["robots"]),
    Command::of::<sensitivity::Request>(&["sensitivity"]),
    Command::of::<stiffness::Request>(&["stiffness"]),
    Command::of::<study::Request>(&["study"]),
    Command::of::<task::check::Request>(&["task", "check"]),
    Command::of::<task::import::Request>(&["task", "import"]),
    Command::of::<task::new::Request>(&["task", "new"]),
    Command::of::<task::show::Request>(&["task", "show"]),
    Command::of::<task::tune::Request>(&["task", "tune"]),
    Command::of::<tasks::Request>(&["tasks"]),
    Command::of::<trial::Request>(&["trial"]),
];
