//! Which finger to print next.

use super::Failure;
use super::calibration::CalibrateRequest;
use super::failure::{not_stopped, within};
use super::{Prepared, Watch};
use crate::calibration::bench::sampled;
use crate::calibration::next::{Advice, advise};
use crate::calibration::published;
use crate::calibration::subject::Subject;
use ask_tell::stream::stream;
use insertion::space::Design;
use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;

/// Fingers that may be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Among {
    /// Those of the space
    Space,
    /// The 11 of the publication
    Published,
}

/// Which fingers may be printed, and what a print costs.
#[derive(Debug, Clone)]
pub struct NextRequest {
    /// Task, measurements, effort; one task.
    pub calibration: CalibrateRequest,
    /// Fingers to print at a time.
    pub count: u16,
    /// Fingers that may be printed.
    pub among: Among,
    /// Gain of range that is worth the print and the measurement, mm.
    pub print_cost_mm: f64,
}

/// What to print, of which fingers.
pub struct Advised {
    /// The task's fingers.
    pub subject: Subject,
    /// Which of them to print.
    pub advice: Advice,
}

impl NextRequest {
    /// Fingers to print at a time.
    pub const COUNTS: RangeInclusive<u16> = 1..=100;

    /// Whether a print may be worth so much range, mm.
    ///
    /// # Errors
    /// What would be right.
    pub fn given_cost(mm: f64) -> Result<f64, String> {
        match mm.is_finite() && mm >= 0.0 {
            true => Ok(mm),
            false => Err("a cost is a number, 0 or above, in mm of range".to_owned()),
        }
    }

    /// Says which finger to print next.
    ///
    /// # Errors
    /// As [`CalibrateRequest::run`].
    pub fn run(&self, stop: &AtomicBool, watch: &mut Watch<'_>) -> Result<Advised, Failure> {
        if self.calibration.setup.tasks.len() != 1 {
            return Err(Failure::usage("give one --task: a finger is printed for one"));
        }
        within("--count", self.count, &Self::COUNTS)?;
        let cost_mm = Self::given_cost(self.print_cost_mm).map_err(Failure::usage)?;
        let published = match self.among {
            Among::Space => Vec::new(),
            Among::Published => infills(),
        };
        let mut prepared = self.calibration.prepare(&published, stop, watch)?;
        let advice = self.advise(&prepared, &published, cost_mm)?;
        not_stopped(stop)?;
        let subject = prepared.subjects.swap_remove(0);
        Ok(Advised { subject, advice })
    }

    fn advise(
        &self,
        prepared: &Prepared<'_>,
        published: &[Design],
        cost_mm: f64,
    ) -> Result<Advice, Failure> {
        let benches = prepared.layout.benches(&prepared.subjects);
        let one = prepared.subjects.first().zip(benches.first());
        let (subject, bench) = one.ok_or_else(|| Failure::usage("give one --task"))?;
        let among: Vec<usize> = match self.among {
            Among::Space => (0..subject.of_space).collect(),
            Among::Published => {
                published.iter().filter_map(|design| subject.finger(design)).collect()
            }
        };
        let (dimension, settings) = (prepared.layout.dimension(), &prepared.settings);
        let mut random = stream(settings.seed, 0, "next");
        let posterior = sampled(&benches, dimension, settings, &mut random);
        let count = usize::from(self.count);
        Ok(advise(bench, &posterior, &among, count, cost_mm, &mut random))
    }
}

/// The published fingers.
fn infills() -> Vec<Design> {
    let designs = published::designs().into_iter();
    designs.map(|design| Design::infill(design.density_percent, design.direction_deg)).collect()
}
