//! Files beside the page in the folder of a study.

use super::replay;
use crate::answer::UnderRobot;
use std::path::PathBuf;

/// Bytes of films that a page holds; others it links to.
const FILMS: usize = 600_000;

/// Files beside the page in the folder of a study.
#[derive(Debug, Clone, Default)]
pub struct Beside {
    /// The folder, as commands name it.
    pub dir: PathBuf,
    /// Its films.
    pub films: Vec<Film>,
    /// Those of [`printer::FILES`](super::printer::FILES) that are there.
    pub files: Vec<&'static str>,
    /// Where nothing inserts, an SVG of the design that comes nearest at the nominal start.
    pub nominal: Option<String>,
    /// Levers of the window: a sentence and an SVG.
    pub levers: Option<(String, String)>,
    /// The window under two robots.
    pub robots: Vec<UnderRobot>,
    /// Maps of what the window is over two errors: captions and SVGs.
    pub maps: Vec<(String, String)>,
}

/// A film at an end of a window.
#[derive(Debug, Clone)]
pub struct Film {
    /// Place of the task.
    pub task: usize,
    /// The end, one of [`replay::ENDS`].
    pub end: &'static str,
    /// Its recordings as JSON without a `<`; `None` if the page only links to it.
    pub data: Option<String>,
}

impl Beside {
    /// Takes in a film by its page, as long as there is room for it.
    pub fn add(&mut self, task: usize, end: &'static str, page: &str) {
        let held: usize = self.films.iter().flat_map(|film| &film.data).map(String::len).sum();
        let data = replay::data(page).filter(|data| held + data.len() <= FILMS);
        self.films.push(Film { task, end, data: data.map(str::to_owned) });
    }
}
