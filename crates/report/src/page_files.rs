//! Files and analyses that the page of a study shows or links.

use super::replay;
use crate::answer::RobotWindow;
use analysis::levers::Levers;
use analysis::map::CaptureMap;
use std::path::PathBuf;

/// Largest total size of embedded films (recorded trials), bytes; films beyond it are linked.
const FILMS: usize = 600_000;

/// Files of a study's folder that its page shows or links.
#[derive(Debug, Clone, Default)]
pub struct PageFiles {
    /// The folder, as given to commands.
    pub dir: PathBuf,
    /// Films in the folder, a pair for each task and end of its window.
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
    /// Capture maps: outcomes over two errors.
    pub maps: Vec<CaptureMap>,
    /// Windows with the study's robot and with a different one, for a task of the user.
    pub robots: Vec<RobotWindow>,
}

/// Pair of films at an end of a window: of the last trial that inserts and of the first that fails.
#[derive(Debug, Clone)]
pub struct FilmPair {
    /// Index of the task.
    pub task: usize,
    /// The end, one of [`replay::ENDS`].
    pub end: &'static str,
    /// The recordings as JSON without `<`; `None` if their page is linked instead.
    pub data: Option<String>,
    /// SVG of the last instant of the failed trial, shown until the films are played.
    pub poster: Option<String>,
}

impl PageFiles {
    /// Adds the films of a replay page, embedded unless the total size would be too large.
    pub fn add(&mut self, task: usize, end: &'static str, page: &str, poster: Option<String>) {
        let embedded: usize = self.films.iter().flat_map(|film| &film.data).map(String::len).sum();
        let data = replay::data(page).filter(|data| embedded + data.len() <= FILMS);
        self.films.push(FilmPair { task, end, data: data.map(str::to_owned), poster });
    }
}
