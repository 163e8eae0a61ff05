use super::*;
use crate::answer::words;
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, ROBOTS, STIFFNESS};
use input::units::N_PER_MM;
use insertion::evaluation::robustness::firm::{FirmResult, FirmWindow};
use insertion::evaluation::tolerance::evaluate;
use insertion::outcome::STOP_REMEDY;
use insertion::stiffness::parse;
use insertion::surrogate::{Model, fit};
use insertion::tests::fake::{Altered, FakeRig};
use insertion::{
    Aggregate, Design, EngineKind, Evaluation, FailureClass, Finger, Goals, Grasp, Measure,
    Objectives, Outcome, Robot, Search, Trial,
};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use study::{ByRibs, Provenance, Recorded, Segment, StudyConfig, StudyRecord, Timing, Walked};

fn finray9() -> PrintedFinger {
    PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).unwrap()
}

/// Returns the stiffness model of the shipped measurements, fitted once.
fn model() -> &'static Model {
    static MODEL: OnceLock<Model> = OnceLock::new();
    MODEL.get_or_init(|| {
        fit(&parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap(), &finray9()).unwrap()
    })
}

fn record(evaluations: Vec<Recorded>) -> StudyRecord {
    let hashes = BTreeMap::from([("task_1".to_owned(), "9f86d081884c7d65".repeat(4))]);
    let provenance = Provenance::new(EngineKind::Direct, hashes);
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/study");
    let fixture = StudyRecord::load(&fixture).unwrap();
    let (seed, budget) = (7, evaluations.len() as u64);
    let (own, robot) = (provenance.clone(), "servo".to_owned());
    let config = StudyConfig { seed, budget, robot, provenance: own, ..fixture.config.clone() };
    let segments = vec![Segment { first: 0, provenance }];
    StudyRecord { config, segments, evaluations, confirmation_due: false, ..fixture }
}

fn html(study: &StudyRecord) -> String {
    page(&crate::answer::Answer::of(study), &PageFiles::default()).unwrap()
}

/// Returns a study by the closed-form rig over a coarse grid of infills in scattered order.
fn study() -> StudyRecord {
    let infill = |index: u64| [10.0 + (index * 13 % 21) as f64, (index * 29 % 41) as f64];
    record((0..60).map(|index| walked(index, infill(index))).collect())
}

/// Returns an evaluation by the closed-form rig, walked step by step.
fn walked(index: u64, infill: [f64; 2]) -> Recorded {
    let stiffness = model().predict(infill).unwrap();
    let finger = Finger::new(stiffness.compliance.mean, stiffness.assembly.mean);
    recorded(index, infill, evaluate(&FakeRig::default(), &finger, Search::Walk))
}

fn recorded(index: u64, infill: [f64; 2], evaluation: Evaluation) -> Recorded {
    let stiffness = model().predict(infill).unwrap();
    let objectives = Objectives::of(Measure::Range);
    let goals = Goals { objectives, constraints: Vec::new(), aggregate: Aggregate::Min };
    let score = goals.score(&[&evaluation]);
    let design = Design::infill(infill[0], infill[1]);
    let (tasks, timing) = (vec![evaluation], Timing::default());
    Recorded { index, proposal: None, design, score, stiffness, tasks, timing }
}

#[test]
fn of_very_many_evaluations_the_best_and_some_are_drawn() {
    let few = study();
    let many = (0..20_000u64).map(|index| {
        let one = &few.evaluations[index as usize % few.evaluations.len()];
        Recorded { index, ..one.clone() }
    });
    let many = record(many.collect());
    let shown = super::selection::selected(&many, &many.evaluations, super::selection::LISTED);
    assert!((4000..5100).contains(&shown.len()), "{}", shown.len());
    assert!(shown.windows(2).all(|pair| pair[0].index < pair[1].index));
    let best = many.recommended().unwrap().index;
    assert!(shown.iter().any(|one| one.index == best));
    let widest = |all: &[&Recorded]| {
        let mut values: Vec<f64> = all.iter().filter_map(|one| one.value()).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        values[..500].to_vec()
    };
    assert_eq!(widest(&shown), widest(&many.evaluations.iter().collect::<Vec<_>>()));
    let page = html(&many);
    assert!(page.contains("evaluations.csv has all") && page.len() < 1_000_000, "{}", page.len());
    assert!(!html(&few).contains("evaluations.csv has all"));
}

/// Returns an evaluation in which every trial, the nominal start included, has the outcome `nominal`.
fn at_nominal(index: u64, infill: [f64; 2], nominal: Outcome) -> Recorded {
    let ends = Altered(move |_: &Grasp, _: f64, trial: Trial| Trial { outcome: nominal, ..trial });
    let finger = Finger::new(2.0 * N_PER_MM, 40.0 * N_PER_MM);
    recorded(index, infill, evaluate(&ends, &finger, Search::Walk))
}

/// Returns the page of a study after checking that it has its sections and loads nothing from elsewhere.
fn whole(study: &StudyRecord) -> String {
    let page = html(study);
    for id in ["convergence", "provenance"] {
        assert_eq!(page.matches(&format!("<section id=\"{id}\">")).count(), 1, "{id}");
    }
    for word in ["http:", "https:", "@import", "url(", "src=", "NaN", "inf "] {
        assert!(!page.contains(word), "{word}");
    }
    assert_eq!(page.matches("<svg ").count(), page.matches("</svg>").count());
    for tag in ["section", "table", "dl", "figure", "details", "p"] {
        let opened =
            page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    assert!(!page.contains("fill=\"#") && !page.contains("stroke=\"#"), "a fixed colour");
    page
}

#[test]
fn the_page_is_whole_and_its_numbers_are_the_records() {
    let study = study();
    let html = whole(&study);
    let best = study.best().unwrap();
    let window = &best.tasks[0].window;
    for number in [
        format!("not supported by measurements: {}; ", words::design(&best.design)),
        format!("simulated: {} mm, not confirmed", words::span(words::ends_mm(window))),
        format!("compliance {:.2} ± ", best.stiffness.compliance.mean / N_PER_MM),
        words::mm(window.range_mm()),
        "<pre><code>optimize next --task".to_owned(),
        "jammed (class 3)".to_owned(),
        "plug missed (class 2)".to_owned(),
        "9f86d081884c7d65".repeat(4),
    ] {
        assert!(html.contains(&number), "{number}");
    }
    assert_eq!(html.matches("<div role=\"img\"").count(), 2, "the finger and the convergence");
    assert_eq!(html.matches("<script").count(), 2, "the data and what shows it");
    assert!(html.contains("default-src 'none'"));
}

#[test]
fn an_unfinished_study_is_told_and_continued() {
    let mut study = study();
    let told = |study: &StudyRecord| {
        let html = whole(study);
        let told = html.contains(" (unfinished, after 60 of 200 evaluations); simulated");
        assert_eq!(html.contains("<pre><code>optimize resume"), told);
        told
    };
    assert!(!told(&study));
    study.config.budget = 200;
    assert!(told(&study));
    study.settled = true;
    assert!(!told(&study));
}

#[test]
fn the_convergence_ends_at_the_search_and_marks_the_confirmed_value() {
    let mut study = study();
    let best = study.best().unwrap().clone();
    let (index, searched) = (best.index, words::mm(best.value().unwrap()));
    study.walked = vec![Walked { recorded: best, firm: Vec::new(), by_ribs: None }];
    let mut drawn = |firm_mm: f64| {
        study.firm_values.insert(index, firm_mm);
        let text = convergence::section(&study, (356, 300)).unwrap().into_string();
        let words =
            format!("the best has {firm_mm:.1} mm. The line ends at {searched}, the best of");
        assert!(text.contains(&words), "{text}");
        convergence_svg(&study, (356, 300)).unwrap()
    };
    assert_ne!(drawn(2.0), drawn(3.0));
}

#[test]
fn a_measured_design_shows_its_range_on_a_robot() {
    let html = whole(&record(vec![walked(0, [20.0, 20.0])]));
    assert!(html.contains("measured on a robot, 20 % infill at 20°: 4.1 mm"));
    assert!(html.contains("<td>4.1 mm</td>"));
    assert!(html.contains("Measured: best 30 % infill at 20°: 6.1 mm (model"));
    assert!(html.contains("ranks 11 fingers no better than chance (Spearman -0.07)"));
    let best = "30 % infill at 20° now: the best of 11 measured fingers, 6.1 mm on a robot";
    assert!(html.contains(&format!("<h1>Use {best}</h1>")));
    assert!(html.contains("Best in simulation, not supported by measurements: "));
    assert!(html.contains(", best in simulation, "));
    let best = whole(&record(vec![walked(0, [30.0, 20.0])]));
    assert!(best.contains("<h1>Print the finger with 30 % infill at 20°</h1>"));
    let (_, ranges) = html.split_once("Ranges without their ends").expect("ranges below the scale");
    let (name, bar) = ranges.split_once("<div class=\"track range\">").expect("a bar");
    let (bar, _) = bar.split_once("</div>").expect("its end");
    assert!(name.contains("20°: 4.1 mm, ends not recorded") && bar.contains("left:0.0%"), "{bar}");
    assert!(!bar.contains("<b"), "no start to be offset from: {bar}");
}

fn other_input(config: &mut StudyConfig, role: &str) {
    config.provenance.input_sha256.insert(role.to_owned(), "other".to_owned());
}

#[test]
fn a_published_finger_is_recommended_for_the_setup_of_the_publication_only() {
    type Change = fn(&mut StudyConfig);
    let recommended = |change: Change| {
        let mut study = record(vec![walked(0, [20.0, 20.0])]);
        change(&mut study.config);
        crate::answer::Answer::of(&study).use_now().is_some()
    };
    let changes: [(Change, bool); 7] = [
        (|config| config.robot = "ur5e".to_owned(), true),
        (|config| config.robot = "rigid".to_owned(), false),
        (|config| config.conclusion.robot_file = "robots/servo.toml".to_owned(), false),
        (|config| config.conclusion.task_files = vec!["usb.toml".to_owned()], false),
        (|config| other_input(config, "stiffness"), false),
        (|config| other_input(config, "cell"), false),
        (|config| other_input(config, "finger"), false),
    ];
    for (at, (change, expected)) in changes.into_iter().enumerate() {
        assert_eq!(recommended(change), expected, "{at}");
    }
}

#[test]
fn stops_that_end_most_trials_are_the_headline() {
    let mut study = record(vec![walked(0, [20.0, 20.0])]);
    let evaluation = &study.evaluations[0].tasks[0];
    let (trials, failures) = (evaluation.trials, evaluation.failure_counts.iter().sum::<u32>());
    // Each failure may have stopped the robot.
    let half = failures + (trials - failures) / 2;
    for (stops, most) in [(half, false), (half + 1, true)] {
        study.evaluations[0].tasks[0].robot_stops = stops;
        let answer = crate::answer::Answer::of(&study);
        let (headline, lines) = (answer.headline(), crate::answer::lines::brief(&answer));
        let first = format!("Not usable as it is: the robot stops in {stops} of {trials} trials; ");
        assert_eq!(headline.starts_with(&first), most, "{headline}");
        assert_eq!(answer.verdict_key() == "robot_stops", most);
        let with = |words: &str| lines.iter().filter(|(_, line)| line.contains(words)).count();
        let ends = format!("robot stop in {stops} of {trials} trials: a plug seated by then is ");
        assert_eq!([with(&ends), with(STOP_REMEDY)], [usize::from(!most), usize::from(most)]);
        let (command, _) = crate::answer::command::next(&answer, Path::new("study"));
        let evaluate = command.starts_with("optimize evaluate --task ")
            && command.ends_with(" --density 20 --direction 20");
        assert_eq!(evaluate, most, "{command}");
        assert!(html(&study).contains(&format!("<h1>{headline}</h1>")));
    }
    study.config.tasks.push("usb".to_owned());
    let mut second = study.evaluations[0].tasks[0].clone();
    (study.evaluations[0].tasks[0].robot_stops, second.robot_stops) = (0, trials);
    study.evaluations[0].tasks.push(second);
    let headline = crate::answer::Answer::of(&study).headline();
    let named = format!("the robot stops in {trials} of {trials} trials on usb; best finger: 20 %");
    assert!(headline.contains(&named), "{headline}");
}

#[test]
fn a_finger_whose_repeats_fail_at_the_nominal_start_is_not_usable() {
    // Two that tie: without a firm window, no tie is as good as another.
    let mut study = record(vec![walked(0, [20.0, 20.0]), walked(1, [22.0, 20.0])]);
    study.firm_values = BTreeMap::from([(0, 0.0), (1, 0.0)]);
    for (window, usable) in [(Some(FirmWindow::default()), true), (None, false)] {
        let walked = |recorded: &Recorded| {
            let firm = vec![FirmResult { window, trials: 12 }];
            Walked { recorded: recorded.clone(), firm, by_ribs: None }
        };
        study.walked = study.evaluations.iter().map(walked).collect();
        let answer = crate::answer::Answer::of(&study);
        // The headline names the best published finger.
        let text = crate::answer::expectation(&answer);
        assert_eq!(text.starts_with("Not usable as it is: with slightly varied "), !usable);
        assert_eq!(answer.verdict_key() == "not_repeatable", !usable, "{text}");
        assert_eq!(matches!(answer.verdict, crate::answer::Verdict::Any { .. }), usable, "{text}");
    }
}

#[test]
fn without_measurements_no_print_is_recommended_by_headline_json_and_page() {
    let headline = |study: &StudyRecord| {
        let answer = crate::answer::Answer::of(study);
        let (page, headline) = (whole(study), answer.headline());
        assert!(page.contains(&format!("<h1>{headline}</h1>")), "{headline}");
        let printed = answer.verdict_key() != "simulated";
        assert!(page.contains("drawing of the finger") && !page.contains("finger to print"));
        assert_eq!(headline.contains("rint "), printed, "{headline}");
        headline
    };
    let mut study = study();
    study.config.tasks = vec!["mine".to_owned()];
    assert!(headline(&study).starts_with("Best in simulation, not measured yet: "));
    // 6.0 and 5.4 mm differ by more than the indifference, but less than the simulation error.
    let mut alike = record(vec![walked(0, [12.0, 20.0]), walked(1, [20.0, 20.0])]);
    alike.config.tasks = vec!["mine".to_owned()];
    assert!(
        headline(&alike).starts_with("2 fingers differ by less than the simulation error, not ")
    );
    alike.config.indifference_mm = 1.0;
    assert!(headline(&alike).starts_with("2 fingers tie in simulation, not measured yet: "));
    // A front of one finger.
    let mut front = record(vec![walked(0, [20.0, 21.0])]);
    front.config.objective = "range,peak-force".parse().unwrap();
    let goals = front.config.goals();
    for one in &mut front.evaluations {
        one.score = goals.score(&one.tasks());
    }
    // The other objective was not measured: no measured finger is recommended.
    assert!(headline(&front).starts_with("Best in simulation, not supported by measurements: "));
    front.evaluations[0].design = Design::infill(30.0, 20.0);
    assert!(headline(&front).ends_with(": best in all objectives"), "the best measured one");
}

#[test]
fn windows_about_a_given_and_a_taught_start_are_not_compared() {
    let given = walked(0, [20.0, 20.0]).tasks.remove(0);
    let taught = Evaluation { taught: Some(5), ..given.clone() };
    let text = |ribs: &Evaluation, measured: &Evaluation| {
        let ribs = ByRibs::Measured(vec![ribs.clone()]);
        crate::answer::lines::by_ribs(&ribs, (0, measured)).unwrap().1
    };
    assert!(text(&taught, &given).starts_with("not compared"));
    let range = words::mm(given.window.range_mm());
    for same in [&given, &taught] {
        assert!(text(same, same).starts_with(&range), "{}", text(same, same));
    }
}

#[test]
fn the_widest_searched_design_is_named_beside_another_recommended_one() {
    let mut study = study();
    let best = study.best().map(|best| (best.index, best.value().unwrap())).unwrap();
    let widest = |study: &StudyRecord| {
        let mut answer = crate::answer::Answer::of(study);
        let found = answer.recommended.as_mut().unwrap();
        found.design = study.evaluations.iter().find(|other| other.index != best.0).unwrap();
        answer.verdict = crate::answer::Verdict::NoneFeasible;
        let line = crate::answer::lines::widest(&answer);
        line.map(|(_, text)| text)
    };
    assert_eq!(widest(&study), None, "not repeated");
    study.firm_values.insert(best.0, 3.0);
    let said = format!("{:.1} mm in the search, 3.0 mm in repeats", best.1);
    assert!(widest(&study).is_some_and(|text| text.ends_with(&said)));
    assert!(!whole(&study).contains("Widest in the search"), "the best itself is recommended");
}

#[test]
fn a_best_design_outside_the_hull_is_warned_of() {
    let recorded = walked(0, [10.0, 40.0]);
    let distance =
        format!("extrapolated by {:.2} of the measured span", recorded.stiffness.hull_distance);
    assert!(html(&record(vec![recorded])).contains(&distance), "{distance}");
}

#[test]
fn a_rigid_robot_is_remarked_once_by_terminal_and_page() {
    let mut study = study();
    let remark = "the robot `rigid` does not yield";
    for (robot, count) in [(&ROBOTS[0], 0), (&ROBOTS[1], 1)] {
        study.limits.robot = Some(Robot::parse(robot.text, robot.file).unwrap());
        let lines = crate::answer::lines::brief(&crate::answer::Answer::of(&study));
        assert_eq!(lines.iter().filter(|(_, text)| text.contains(remark)).count(), count);
        assert_eq!(html(&study).matches(remark).count(), count);
    }
}

#[test]
fn empty_failed_and_diverged_studies_still_have_a_page() {
    let jammed = Outcome::Failed(FailureClass::Jammed);
    for (evaluations, words) in [
        (vec![], "<h1>No design can be recommended</h1>"),
        (vec![at_nominal(0, [10.0, 0.0], Outcome::Diverged)], "<h1>No finger inserts on"),
        (
            vec![at_nominal(0, [10.0, 0.0], jammed)],
            "nominal start ends with <b>jammed (class 3)</b>",
        ),
        (
            (0..5).map(|i| at_nominal(i, [10.0 + i as f64, 5.0], jammed)).collect(),
            "Check the clearance of plug and socket",
        ),
    ] {
        let study = record(evaluations);
        let html = whole(&study);
        assert!(html.contains(words) && !html.contains("finger.stl"), "{words}");
        assert!(convergence_svg(&study, (880, 480)).unwrap().contains("evaluation"));
    }
}

#[test]
fn what_comes_from_files_is_escaped_and_unknown_tasks_are_told() {
    let mut study = study();
    study.config.tasks = vec!["<img onerror=x>&\"'".to_owned()];
    study.config.uncertainty = Some("<b>errors".to_owned());
    study.evaluations[0].design.0.insert("<i>key".to_owned(), 1.0);
    study.segments[0].provenance.input_sha256.insert("<u>".to_owned(), "<s>".to_owned());
    let html = whole(&study);
    for raw in ["<img", "<b>errors", "<i>", "<u>", "<s>"] {
        assert!(!html.contains(raw), "{raw}");
    }
    assert!(html.contains("&lt;img onerror") && !html.contains("published"));
}

/// Two objectives and a constraint, on two tasks with the same evaluation.
#[test]
fn fronts_constraints_and_tasks_have_their_places_on_the_page() {
    let mut study = study();
    study.config.objective = "range,peak-force".parse().unwrap();
    study.config.constraints = vec!["range<=6".parse().unwrap()];
    study.config.tasks.push("<s>other".to_owned());
    study.config.aggregate = Some(Aggregate::Mean);
    let goals = study.config.goals();
    for recorded in &mut study.evaluations {
        recorded.tasks.push(recorded.tasks[0].clone());
        recorded.score = goals.score(&recorded.tasks());
    }
    let html = whole(&study);
    assert!(html.contains("along y on &lt;s&gt;other, mm"));
    assert!(!html.contains("<s>other") && html.contains("range&lt;=6"));
    let front = study.front();
    let ranges: Vec<f64> = front.iter().filter_map(|recorded| recorded.value()).collect();
    assert!(ranges.is_sorted_by(|a, b| a > b) && ranges[0] <= 6.0, "{ranges:?}");
    assert!(html.contains(&format!("{} of 60 evaluated designs are on the front", front.len())));
    assert!(front_svg(&study, (880, 480)).unwrap().unwrap().contains("range (mm)"));
    let volumes = convergence::best_so_far(&study);
    assert!(volumes.len() == 60 && volumes.windows(2).all(|pair| pair[0].1 <= pair[1].1));
    for recorded in &mut study.evaluations {
        recorded.score.as_mut().unwrap().violations = vec![1.0 + recorded.index as f64];
    }
    let html = self::html(&study);
    assert!(html.contains("<h1>No design can be recommended</h1>"));
    assert!(html.contains("(evaluation 0)"), "the one that violates least");
    assert!(study.best().is_none() && study.front().is_empty());
}

/// Evaluations are counted from 0, as in the journal and on the command line.
#[test]
fn convergence_never_falls_and_ends_at_the_best() {
    let study = study();
    let steps = convergence::best_so_far(&study);
    assert!(steps.windows(2).all(|pair| pair[0].1 <= pair[1].1));
    let best = study.best().unwrap();
    assert_eq!((steps[0].0, steps.last().copied()), (0.0, Some((59.0, best.value().unwrap()))));
    let fact = format!("\"best\":{}", best.index);
    assert!(html(&study).contains(&fact), "{fact}");
    let svg = convergence_svg(&study, (880, 480)).unwrap();
    for word in ["best of the search", "range (mm)", "each evaluation"] {
        assert!(svg.contains(word), "{word}");
    }
}

#[test]
fn the_stiffness_report_has_every_model_and_both_axes() {
    let model = model();
    let table = stiffness::table(model);
    for word in ["1.64", "10.00", "<- used", "RMSE N/mm", "assembly (z)", "compliance (y)"] {
        assert!(table.contains(word), "{word}: {table}");
    }
    let json = stiffness::json(model);
    assert_eq!(json["models"].as_array().map(Vec::len), Some(8));
    let percent = json["models"][0]["loo_mean_absolute_percent"].as_f64().unwrap();
    assert!((percent - 1.64).abs() < 0.01);
    let svg = stiffness::svg(model).unwrap();
    for word in ["stiffness in compliance (y) (N/mm)", "density 20 %", "direction 40°"] {
        assert!(svg.contains(word), "{word}");
    }
}

/// Shipped inputs are given by name, others by their copies; every setting that affects the result is contained.
#[test]
fn the_command_that_repeats_a_study_names_all_that_decides() {
    let mut study = study();
    let text = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    let inputs = study::Inputs::from([
        text("task_1", input::shipped::TASKS[3].text),
        text("task_2", "mine"),
        text("space", input::shipped::SPACES[0].text),
        text("robot", input::shipped::ROBOTS[1].text),
        text("stiffness", "my measurements"),
        text("finger", FINGERS[0].text),
    ]);
    let provenance = Provenance::new(EngineKind::Rapier, study::sha256(&inputs));
    study.segments[0].provenance = provenance;
    study.config.tasks.push("mine".to_owned());
    study.config.aggregate = Some(Aggregate::weighted(vec![2.0, 1.0], 2).unwrap());
    study.config.finger_model = insertion::finger::model::FingerModelKind::Computed;
    let command = crate::answer::command::rerun(&study).join(" ");
    assert_eq!(
        command,
        "optimize --task usb,inputs/task_2.toml --space infill --robot rigid --stiffness-data \
         inputs/stiffness.csv --finger-model computed --finger finray9 --engine rapier --optimizer \
         gp --objective range --aggregate weighted --weights 2,1 --seed 7 --budget 60 --batch 4"
    );
}

#[test]
fn levers_are_drawn_largest_first_and_grey_where_they_matter_little() {
    use super::levers;
    let lever = |name: &str, ends: [Option<f64>; 2]| {
        json!({"name": name, "key": name, "unit": "mm", "value": 2.0, "low": 1.0, "high": 3.0,
               "source": "made <up>", "range_mm": ends})
    };
    let found = json!({
        "task": "a<b", "design": {}, "base": {"range_mm": 4.0, "taught_start_mm": 0.0},
        "infill_range_mm": [3.0, 4.0], "left_out": ["speed"], "windows": 7,
        "levers": [lever("tilt", [None, Some(4.5)]), lever("grip", [Some(3.9), Some(4.1)])],
    });
    let found = serde_json::from_value(found).unwrap();
    let svg = levers::svg(&found).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<_> =
        document.descendants().filter_map(|node| node.text()).map(str::trim).collect();
    let at = |text: &str| texts.iter().position(|&found| found == text).unwrap();
    assert!(at("tilt") < at("none at 1 mm"));
    assert!(at("tilt") < at("infill") && at("infill") < at("grip"));
    let bars = document.descendants().filter(|node| node.has_tag_name("rect"));
    let bars = bars.filter_map(|node| node.attribute("opacity")).filter(|share| *share < "1");
    assert_eq!(bars.collect::<Vec<_>>(), ["0.85", "0.85", "0.85", "0.85", "0.45", "0.45"]);
    let text = levers::text(&found);
    assert!(text.contains("7 windows; not evaluated: speed") && text.contains("grip: made <up>"));
}
