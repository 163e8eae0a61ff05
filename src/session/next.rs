//! Which finger to print next.

use super::calibration::{BenchRequest, HowCalibrated, Prepared};
use super::failure::not_stopped;
use super::{Failure, Watch, measured};
use ask_tell::stream::stream;
use calibration::bench::sampled;
use calibration::next::{Advice, advise};
use calibration::subject::Subject;
use input::shipped::Source;
use insertion::space::Design;
use insertion::stiffness::designs;
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
#[derive(Debug, Clone, clap::Args)]
pub struct NextRequest {
    /// Task and measurements; one task.
    #[command(flatten)]
    pub bench: BenchRequest,
    /// Fingers to print at a time
    #[arg(long, value_name = "K", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(1..=100))]
    pub count: u16,
    /// Fingers that may be printed
    #[arg(long, value_enum, default_value = "space")]
    pub among: Among,
    /// Gain of range that is worth the print and the measurement, mm; below it: stop
    #[arg(long, value_name = "MM", default_value_t = 0.1, value_parser = cost)]
    pub print_cost_mm: f64,
    /// How it is computed.
    #[command(flatten)]
    pub how: HowCalibrated,
}

fn cost(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(mm) if mm.is_finite() && mm >= 0.0 => Ok(mm),
        _ => Err("a cost is a number, 0 or above, in mm of range".to_owned()),
    }
}

/// Fingers to print, and those they are chosen from.
pub struct Advised {
    /// The task's fingers.
    pub subject: Subject,
    /// Which of them to print.
    pub advice: Advice,
    /// Whether the file of measurements is not there yet.
    pub missing: bool,
}

impl NextRequest {
    /// Says which finger to print next.
    pub fn run(&self, stop: &AtomicBool, watch: &mut Watch<'_>) -> Result<Advised, Failure> {
        if self.bench.setup.tasks.len() > 1 {
            return Err(Failure::usage("give one --task: a finger is printed for one"));
        }
        let published = match self.among {
            Among::Space => Vec::new(),
            Among::Published => designs()
                .iter()
                .map(|design| Design::infill(design.density_percent, design.direction_deg))
                .collect(),
        };
        let file = &self.bench.measurements;
        let missing = measured::is_missing(file);
        let source = match missing {
            true => Source { file: file.clone(), text: String::new() },
            false => measured::file(file)?,
        };
        let prepared = self.how.prepare((&self.bench, &source), &published, stop, watch)?;
        let Prepared { mut subjects, layout, settings } = prepared;
        let benches = layout.benches(&subjects);
        let one = subjects.first().zip(benches.first());
        let (subject, bench) = one.ok_or_else(|| Failure::usage("give one --task"))?;
        let among: Vec<usize> = match self.among {
            Among::Space => (0..subject.of_space).collect(),
            Among::Published => {
                published.iter().filter_map(|design| subject.finger(design)).collect()
            }
        };
        let mut random = stream(settings.seed, 0, "next");
        let posterior = sampled(&benches, layout.dimension(), &settings, &mut random);
        let (count, cost_mm) = (usize::from(self.count), self.print_cost_mm);
        let advice = advise(bench, &posterior, &among, count, cost_mm, &mut random);
        not_stopped(stop)?;
        Ok(Advised { subject: subjects.swap_remove(0), advice, missing })
    }
}
