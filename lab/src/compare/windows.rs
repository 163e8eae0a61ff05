//! Windows by exhaustive search of measured fingers and of fingers drawn at random, and whether
//! those of one program are as near to the truth, at a quarter of the step, as those of another.

use super::Subject;
use ask_tell::GridPoint;
use ask_tell::stream::stream;
use input::InputError;
use insertion::evaluation::robustness::firm::REPEATS;
use insertion::evaluation::robustness::repeat::Repeats;
use insertion::evaluation::tolerance::{self, Search};
use insertion::evaluation::{OffsetStep, grid_mm};
use insertion::finger::computed::AtPad;
use insertion::outcome::Outcome;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Space};
use insertion::stiffness::Measurement;
use insertion::surrogate::Model;
use insertion::trial::{Grasp, Grasped, Rig};
use rand::RngExt;

/// Seed of the streams that fingers are drawn from and repeats vary by.
const SEED: u64 = 0;
/// Number of the first random finger, beyond those of measured ones.
const RANDOM: u32 = 1001;
/// How far beyond an end a start that inserts makes it a gap's, in grid steps from the first that
/// fails: the widest gap that was found.
const GAP: OffsetStep = 4;
/// Largest distance of an end from the reference's, in grid steps.
const ALLOWED: OffsetStep = 1;
const HEADER: &str = "task,design,infill_density_percent,infill_direction_deg,nominal,\
                      negative_mm,positive_mm,negative_end,positive_end";
/// Kinds of ends, the one that counts first.
const KINDS: [&str; 3] = ["firm", "unfirm", "gap"];

/// Window as a row of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Cells that name the finger.
    finger: String,
    nominal: String,
    /// Ends, in grid steps outward; 0 without a window.
    ends: [OffsetStep; 2],
    /// Kinds of the ends, if they were asked for.
    kinds: [String; 2],
}

/// Fingers drawn at random from a space for a task, with the stiffness that the model predicts.
/// More of them begin with the same.
pub fn random(task: &str, space: &Space, model: &Model, count: u32) -> Vec<Measurement> {
    let drawn = |index: u32| {
        let mut random = stream(SEED, u64::from(index), &format!("windows of {task}"));
        let levels = space.levels().into_iter().map(|levels| random.random_range(0..levels));
        let design = space.design(&GridPoint(levels.collect()));
        let [density_percent, direction_deg] =
            [DENSITY_KEY, DIRECTION_KEY].map(|key| design.get(key).unwrap_or_default());
        let predicted = model.predict(density_percent, direction_deg).ok()?;
        let AtPad { compliance, assembly } = AtPad::of(&predicted);
        let design = RANDOM + index;
        Some(Measurement { design, density_percent, direction_deg, assembly, compliance })
    };
    (0..count).filter_map(drawn).collect()
}

/// The window of a finger, each end judged by repeats if there are `coarser` ones to vary the step.
pub fn measure(subject: &Subject, rig: &dyn Rig, coarser: Option<&dyn Rig>) -> Row {
    let window = tolerance::evaluate(rig, &subject.finger, Search::Walk).window;
    let ends = [-window.negative_steps, window.positive_steps];
    let grasp = Grasp::of(&subject.finger);
    let kinds = coarser.map(|coarser| {
        let (grasped, repeats) =
            (rig.hold(grasp), Repeats::new([rig, coarser], grasp, SEED, REPEATS));
        let inserts = window.nominal == Outcome::Inserted;
        [(-1, ends[0]), (1, ends[1])].map(|(sign, end)| match inserts {
            true if ends_in_gap(&*grasped, sign, end) => KINDS[2],
            true => KINDS[usize::from(!repeats.end_within(ALLOWED, sign, end))],
            false => KINDS[usize::from(!repeats.fail_at_nominal())],
        })
    });
    let Measurement { design, density_percent, direction_deg, .. } = subject.design;
    Row {
        finger: format!("{},{design},{density_percent},{direction_deg}", subject.task),
        nominal: window.nominal.word().to_owned(),
        ends,
        kinds: kinds.unwrap_or_default().map(str::to_owned),
    }
}

/// Whether a start a little beyond the first that fails inserts again.
fn ends_in_gap(grasped: &dyn Grasped, sign: OffsetStep, end: OffsetStep) -> bool {
    let inserts = |beyond: OffsetStep| {
        let offset = tolerance::offset(sign * (end + 1 + beyond));
        grasped.trial(offset).outcome == Outcome::Inserted
    };
    (1..=GAP).any(inserts)
}

/// Rows as a CSV file.
pub fn csv(rows: &[Row]) -> String {
    let line = |Row { finger, nominal, ends: [negative, positive], kinds, .. }: &Row| {
        let ends = format!("{},{}", grid_mm(-negative), grid_mm(*positive));
        format!("{finger},{nominal},{ends},{}\n", kinds.join(","))
    };
    format!("{HEADER}\n{}", rows.iter().map(line).collect::<String>())
}

/// Reads such a file.
///
/// # Errors
/// If it is another.
pub fn parse(text: &str, file: &str) -> Result<Vec<Row>, InputError> {
    let fail = |message: String| InputError::Syntax { file: file.to_owned(), line: None, message };
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return Err(fail(format!("the header must be '{HEADER}'")));
    }
    let row = |line: &str| read(line).ok_or_else(|| fail(format!("'{line}' is no window")));
    lines.map(row).collect()
}

fn read(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split(',').collect();
    let &[task, design, density, direction, nominal, negative, positive, below, above] = &cells[..]
    else {
        return None;
    };
    let steps = |cell: &str| Some((cell.parse::<f64>().ok()? * 10.0).round() as OffsetStep);
    Some(Row {
        finger: [task, design, density, direction].join(","),
        nominal: nominal.to_owned(),
        ends: [-steps(negative)?, steps(positive)?],
        kinds: [below, above].map(str::to_owned),
    })
}

/// Ends that are off by more than 0.1 mm, of all, by kind; then each of them. Rows of whose finger
/// the reference has no window do not count.
pub fn compare(reference: &[Row], rows: &[Row]) -> String {
    let mut counts = [[0; 2]; 3];
    let mut off = String::new();
    for row in rows {
        let same = |truth: &&Row| truth.finger == row.finger;
        let Some(truth) = reference.iter().find(same) else { continue };
        for (side, name) in ["negative", "positive"].into_iter().enumerate() {
            let [is, should] = [row, truth].map(|row| row.ends[side]);
            let kind = KINDS.iter().position(|&kind| kind == truth.kinds[side]).unwrap_or(1);
            let wrong = (is - should).abs() > ALLOWED || row.nominal != truth.nominal;
            counts[kind][0] += usize::from(wrong);
            counts[kind][1] += 1;
            if wrong {
                let (kind, [is, should]) = (KINDS[kind], [is, should].map(grid_mm));
                let finger = &row.finger;
                off += &format!("{finger} {name}, {kind}: {is} mm outward, not {should} mm\n");
            }
        }
    }
    let [firm, unfirm, gap] = counts.map(|[wrong, all]| format!("{wrong} of {all}"));
    format!("ends off by more than 0.1 mm: firm {firm}, unfirm {unfirm}, at gaps {gap}\n{off}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::{FINGERS, SPACES};
    use input::units::{MM, N_PER_MM};
    use insertion::task::finger::FingerModel;
    use insertion::trial::Trial;
    use insertion::trial::fake::{Altered, FakeRig};

    fn subject() -> Subject {
        let [compliance, assembly] = [3.0, 20.0].map(|k| k * N_PER_MM);
        let (density_percent, direction_deg) = (20.0, 7.0);
        let design =
            Measurement { design: 3, density_percent, direction_deg, assembly, compliance };
        Subject::new("usb", &FingerModel::default(), design)
    }

    /// The lower end, -3.33 mm, moves with friction; the upper, 1.4 mm, with the start alone.
    #[test]
    fn ends_are_firm_unless_friction_moves_them_or_a_gap_ends_there() {
        let rig = FakeRig::default();
        let row = measure(&subject(), &rig, Some(&rig));
        let text = csv(std::slice::from_ref(&row));
        assert!(text.ends_with("\nusb,3,20,7,inserted,-3.3,1.4,unfirm,firm\n"), "{text}");
        assert_eq!(parse(&text, "w.csv").unwrap(), [row]);
        let beyond = Altered(|_: &Grasp, offset: f64, trial: Trial| {
            let inserts = offset > 1.7 * MM && offset < 1.9 * MM;
            Trial { outcome: if inserts { Outcome::Inserted } else { trial.outcome }, ..trial }
        });
        assert_eq!(measure(&subject(), &beyond, Some(&beyond)).kinds, ["unfirm", "gap"]);
        assert!(parse("task\n", "w.csv").unwrap_err().to_string().contains("w.csv"));
        assert!(parse(&format!("{HEADER}\nusb,3\n"), "w.csv").is_err());
    }

    #[test]
    fn ends_that_are_off_are_counted_by_their_kind() {
        let rig = FakeRig::default();
        let truth = measure(&subject(), &rig, Some(&rig));
        let moved = |by: [OffsetStep; 2]| {
            let ends = [truth.ends[0] + by[0], truth.ends[1] + by[1]];
            compare(std::slice::from_ref(&truth), &[Row { ends, ..truth.clone() }])
        };
        let said = "ends off by more than 0.1 mm: firm 0 of 1, unfirm 0 of 1, at gaps 0 of 0\n";
        assert_eq!(moved([-1, 1]), said);
        let said = moved([2, -2]);
        assert!(said.contains("firm 1 of 1, unfirm 1 of 1, at gaps 0 of 0\n"), "{said}");
        assert!(
            said.ends_with("usb,3,20,7 positive, firm: 1.2 mm outward, not 1.4 mm\n"),
            "{said}"
        );
        let other = Row { finger: "usb,4,20,7".to_owned(), ..truth.clone() };
        assert!(compare(std::slice::from_ref(&truth), &[other]).contains("firm 0 of 0"));
        let fails = Row { nominal: "failed".to_owned(), ..truth.clone() };
        assert!(compare(&[truth], &[fails]).contains("firm 1 of 1, unfirm 1 of 1"));
    }

    #[test]
    fn more_random_fingers_begin_with_the_same() {
        let infill = SPACES.iter().find(|space| space.name == "infill").unwrap();
        let space = Space::parse(infill.text, infill.file).unwrap();
        let designs = insertion::stiffness::designs();
        let printed = finray::printed::PrintedFinger::parse(FINGERS[0].text, "f.toml").unwrap();
        let model = insertion::surrogate::fit(&designs, &printed).unwrap();
        let [few, more] = [2, 5].map(|count| random("usb", &space, &model, count));
        assert_eq!(few, more[..2]);
        assert_ne!(random("ket8", &space, &model, 2), few);
    }
}
