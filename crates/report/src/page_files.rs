//! Files shown or linked by the page of a study.

use super::replay;
use crate::answer::RobotWindow;
use analysis::levers::Levers;
use analysis::map::CaptureMap;
use std::path::PathBuf;

/// Largest total size of embedded films, bytes; further ones are linked.
const FILMS: usize = 600_000;

/// Files of a study's folder that its page shows or links.
#[derive(Debug, Clone, Default)]
pub struct PageFiles {
    /// The folder, as given to commands.
    pub dir: PathBuf,
    /// Films in the folder, by end of a window.
    pub films: Vec<FilmPair>,
    /// Files of [`printer::FILES`](super::printer::FILES) that exist.
    pub files: Vec<&'static str>,
    /// SVG of the nominal start of the design that is nearest to inserting, if nothing inserts.
    pub nominal: Option<String>,
    /// Analyses of the recommended finger.
    pub analyses: PostAnalysis,
}

/// Analyses of the recommended finger.
#[derive(Debug, Clone, Default)]
pub struct PostAnalysis {
    /// One-at-a-time sensitivity analysis.
    pub levers: Option<Levers>,
    /// Outcomes over two errors of the start.
    pub maps: Vec<CaptureMap>,
    /// Windows under the study's robot and under a different one, for a task of the user.
    pub robots: Vec<RobotWindow>,
}

/// Films at an end of a window: of the last trial that inserts and of the first that fails.
#[derive(Debug, Clone)]
pub struct FilmPair {
    /// Index of the task.
    pub task: usize,
    /// The end, one of [`replay::ENDS`].
    pub end: &'static str,
    /// The recordings as JSON without `<`; `None` if their page is linked instead.
    pub data: Option<String>,
    /// SVG of the end of the failed trial.
    pub poster: Option<String>,
}

impl PageFiles {
    /// Adds the films of a page, embedded unless the total size would be too large.
    pub fn add(&mut self, task: usize, end: &'static str, page: &str, poster: Option<String>) {
        let embedded: usize = self.films.iter().flat_map(|film| &film.data).map(String::len).sum();
        let data = replay::data(page).filter(|data| embedded + data.len() <= FILMS);
        self.films.push(FilmPair { task, end, data: data.map(str::to_owned), poster });
    }
}
