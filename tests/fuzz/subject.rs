//! Subjects of the mutation, and what is asked of the program about it.

use super::mutation::{Mutation, mutated};
use super::process::{no_number, run};
use crate::common::Ran;
use anyhow::{Context, Result, bail, ensure};
use ask_tell::OptimizerKind;
use connector::mesh::{Surface, read};
use finger_opt::command::parse;
use finger_opt::commands::study;
use finger_opt::failure::Failure;
use finger_opt::studies::ask_tell::{AskTellStudy, NextStep, RejectedResult, perform};
use input::units::MM;
use insertion::trial::NEVER;
use nalgebra::Point3;
use std::fs;
use std::path::{Path, PathBuf};

/// Names of what a case is about.
pub const KINDS: &str = "task space robot uncertainty stiffness finger config journal \
    walk ask-tell command-line trial measurements loop priors cell mesh mesh-size worker";

/// Outcome of a case that is as it should be.
type How = Result<&'static str>;

/// The shipped files in a folder.
fn shipped(folder: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect()
}

/// Files that take a while to make.
pub struct Base {
    /// Plug and socket of each example, as OBJ: where a corner moves its faces follow.
    meshes: [[String; 2]; 2],
    /// A finished study.
    study: tempfile::TempDir,
}

impl Base {
    pub fn new() -> Self {
        let study = tempfile::tempdir().unwrap();
        let ended = at_once(&format!(
            "--task usb,rj45 --engine fake --budget 7 --polish 3 --no-cache --quiet \
             --constraint peak-force<=30 --out {}/study",
            study.path().display()
        ));
        let ended = ended.unwrap();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let meshes = ["keyed", "usb"].map(|pair| ["plug", "socket"].map(|body| obj(pair, body)));
        Base { meshes, study }
    }
}

/// An example mesh with each corner once.
fn obj(pair: &str, body: &str) -> String {
    let name = format!("{}/examples/meshes/{pair}-{body}.stl", env!("CARGO_MANIFEST_DIR"));
    let bodies = read(&fs::read(&name).unwrap(), &name).unwrap();
    let surface = Surface::new(&bodies[0].triangles, MM).unwrap();
    let corner = |p: &Point3<f64>| format!("v {} {} {}\n", p.x / MM, p.y / MM, p.z / MM);
    let face = |[a, b, c]: &[usize; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    surface.points.iter().map(corner).chain(surface.faces.iter().map(face)).collect()
}

/// Runs a command line without spaces in its words.
fn at_once(line: &str) -> Result<Ran> {
    run(&line.split_whitespace().collect::<Vec<_>>(), b"")
}

/// Runs one case; gives how it ended, or what no case may do.
pub fn run_case(kind: &str, mutations: &[Mutation], number: u64, base: &Base) -> How {
    let dir = tempfile::tempdir()?;
    let (folder, number) = (dir.path().display(), number as usize);
    let file = |text: &str, name: &str| -> Result<String> {
        let path = format!("{folder}/{name}");
        fs::write(&path, mutated(text, mutations))?;
        Ok(path)
    };
    let changed = |folder: &str| {
        let texts = shipped(folder);
        file(&texts[number % texts.len()], "f.toml")
    };
    let out = dir.path().join("study");
    let study = |words: String| {
        let quick = "--engine fake --budget 3 --no-cache --quiet --json";
        let how = ended(&format!("{quick} {words} --out {folder}/study"))?;
        if how == "accepted" {
            read_again(&out)?;
        }
        Ok(how)
    };
    match kind {
        "task" => study(format!("--task {}", changed("tasks")?)),
        "space" => study(format!("--task usb --space {}", changed("spaces")?)),
        "robot" if number.is_multiple_of(7) => {
            let robot = changed("robots")?;
            ended(&format!("trial --task usb --json --density 20 --direction 10 --robot {robot}"))
        }
        "robot" => study(format!("--task usb --robot {}", changed("robots")?)),
        "uncertainty" => {
            let goal = ["success-rate", "robust-range"][number / 2 % 2];
            let file = changed("uncertainties")?;
            study(format!("--task usb --objective {goal} --uncertainty {file}"))
        }
        "stiffness" => {
            let data = file(include_str!("../../data/measured_stiffness.csv"), "f.csv")?;
            let how =
                ended(&format!("stiffness --json --stiffness-data {data} --svg {folder}/f.svg"))?;
            drawing(&dir.path().join("f.svg"))?;
            Ok(how)
        }
        "finger" => {
            let finger = changed("fingers")?;
            ended(&format!("finger --json --density 20 --direction 10 --finger {finger}"))
        }
        "config" => kept("study.toml", mutations, base, &out),
        "journal" => kept("journal.jsonl", mutations, base, &out),
        "walk" => kept("walk.json", mutations, base, &out),
        "ask-tell" => talk(mutations, number),
        "command-line" => command_line(mutations, number, dir.path()),
        "trial" => {
            let task = changed("tasks")?;
            ended(&format!("trial --json --density 20 --direction 10 --task {task}"))
        }
        "measurements" => {
            let path = file(include_str!("../../data/published_bench.csv"), "f.csv")?;
            match number % 4 {
                0 => ended(&format!("{CALIBRATE} --measurements {path}")),
                _ => ended(&format!("measure check --json {path}")),
            }
        }
        // Measured, changed, measured again.
        "loop" => {
            let few = "--task ket8 --simulations 16 --samples 20 --measurements";
            let head = include_str!("../../data/published_bench.csv").lines().take(3 + number % 10);
            let head: String = head.map(|line| line.to_owned() + "\n").collect();
            let whole = format!("{folder}/whole.csv");
            fs::write(&whole, &head)?;
            study(format!("{few} {whole}"))?;
            study(format!("{few} {} --accept-changed", file(&head, "f.csv")?))
        }
        "priors" => {
            let priors = file(include_str!("../../priors/bench.toml"), "f.toml")?;
            ended(&format!("{CALIBRATE} --measurements published --priors {priors}"))
        }
        "cell" => {
            let cell = file(include_str!("../fixtures/v0.5.0/cell.toml"), "f.toml")?;
            ended(&format!("trial --json --task usb --density 20 --direction 10 --cell {cell}"))
        }
        "mesh" => {
            let bodies = &base.meshes[number % 2];
            let changed = number / 2 % 2;
            let mut paths = [0, 1].map(|_| format!("{folder}/other.obj"));
            fs::write(&paths[0], &bodies[1 - changed])?;
            paths[changed] = file(&bodies[changed], "changed.obj")?;
            let [plug, socket] = paths;
            ended(&format!("{IMPORT} --plug {plug} --socket {socket} --out {folder}/task.toml"))
        }
        "mesh-size" => {
            let plug = format!("{folder}/plug.stl");
            fs::write(&plug, lathe(3 + number % 400, 1 + number / 400 % 100))?;
            let socket = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/meshes/keyed-socket.stl");
            let files = format!("--plug {plug} --socket {socket} --out {folder}/task.toml");
            ended(&format!("{IMPORT} --unit mm {files}"))
        }
        "worker" => damaged_results(mutations, &out),
        other => bail!("no kind is called {other}"),
    }
}

/// A round peg with a domed tip of so many rings, of so many flats, as a text STL.
fn lathe(flats: usize, rings: usize) -> String {
    let dome = (0..=rings).map(|j| std::f64::consts::FRAC_PI_2 * j as f64 / rings as f64);
    let mut profile: Vec<[f64; 2]> =
        dome.map(|a| [4.0 * libm::sin(a), 4.0 - 4.0 * libm::cos(a)]).collect();
    profile.extend([[4.0, 12.0], [7.0, 12.0], [7.0, 30.0], [0.0, 30.0]]);
    let corner = |i: usize, k: usize| {
        let (a, [r, z]) = (std::f64::consts::TAU * (k % flats) as f64 / flats as f64, profile[i]);
        format!("vertex {} {} {z}\n", r * libm::cos(a), r * libm::sin(a))
    };
    let mut text = "solid s\n".to_owned();
    for (i, k) in (1..profile.len()).flat_map(|i| (0..flats).map(move |k| (i, k))) {
        let [a, b, c, d] =
            [(i - 1, k), (i - 1, k + 1), (i, k + 1), (i, k)].map(|(i, k)| corner(i, k));
        for face in [[&a, &b, &c], [&a, &c, &d]] {
            text += &format!("facet\n{}{}{}endfacet\n", face[0], face[1], face[2]);
        }
    }
    text
}

/// A study whose results are damaged on the way: a damaged one is refused.
fn damaged_results(mutations: &[Mutation], out: &Path) -> How {
    let line = "--task usb --engine fake --budget 3".split(' ');
    let failed = |failure: Failure| anyhow::anyhow!("{failure}");
    let mut request: study::Request = parse(line).map_err(failed)?;
    request.out = Some(out.to_owned());
    let mut guided = request.open(None).and_then(AskTellStudy::new).map_err(failed)?;
    let mut how = "accepted";
    loop {
        let works = match guided.next_step(&NEVER).map_err(failed)? {
            NextStep::Evaluate(works) => works,
            NextStep::Wait => bail!("it waits for a result that nobody was asked for"),
            NextStep::Finish(ending) => {
                guided.finish(ending, &NEVER).map_err(failed)?;
                break;
            }
        };
        for (proposal, work) in works {
            let result = perform(&work, "a worker", &NEVER).map_err(failed)?;
            let damaged = mutated(std::str::from_utf8(&result)?, mutations);
            match guided.take(proposal, &damaged) {
                Ok(_) => {}
                Err(RejectedResult::Failed(failure)) => return Err(failed(failure)),
                Err(RejectedResult::Refused(_)) => {
                    how = "refused";
                    let taken = guided.take(proposal, &result);
                    ensure!(matches!(taken, Ok(true)), "the true result is refused");
                }
            }
        }
    }
    drop(guided);
    read_again(out)?;
    Ok(how)
}

/// As little of it as there may be, of the formula in place of an engine.
const CALIBRATE: &str =
    "calibrate --task usb --engine fake --simulations 16 --samples 20 --no-cache --json";

const IMPORT: &str = "task import --engine fake --json";

fn ended(line: &str) -> How {
    judged(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
}

fn judged(arguments: &[String]) -> How {
    let ended = run(arguments, b"")?;
    if ended.code != Some(0) {
        return Ok("refused");
    }
    if arguments.iter().any(|word| word == "--json") {
        serde_json::from_str::<serde_json::Value>(&ended.stdout)
            .with_context(|| format!("no JSON: {arguments:?}: {}", ended.stdout))?;
    }
    Ok("accepted")
}

/// An accepted study can be read again: its report is made from the files.
fn read_again(out: &Path) -> Result<()> {
    for words in ["report", "resume --quiet --json"] {
        let again = at_once(&format!("{words} {}", out.display()))?;
        ensure!(again.code == Some(0), "was accepted, but `{words}` fails: {}", again.stderr);
    }
    drawing(&out.join("convergence.svg"))?;
    let journal = fs::read_to_string(out.join("journal.jsonl"))?;
    // JSON has no NaN and no infinity, but in texts, where they are no numbers.
    let read = |line: &str| serde_json::from_str::<serde_json::Value>(line).map(drop);
    journal.lines().try_for_each(read).context("a line of the journal")
}

/// A drawing, if there is one, is XML with numbers only.
fn drawing(path: &Path) -> Result<()> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(()) };
    roxmltree::Document::parse(&text).context("no XML")?;
    ensure!(!no_number(&text), "{}: holds what is no number", path.display());
    Ok(())
}

/// A study's folder in which one file was changed.
fn kept(name: &str, mutations: &[Mutation], base: &Base, out: &Path) -> How {
    let from = base.study.path().join("study");
    fs::create_dir_all(out.join("inputs"))?;
    for folder in ["", "inputs"] {
        for entry in fs::read_dir(from.join(folder))?.flatten() {
            if entry.path().is_file() {
                fs::copy(entry.path(), out.join(folder).join(entry.file_name()))?;
            }
        }
    }
    let path = out.join(name);
    fs::write(&path, mutated(&fs::read_to_string(&path)?, mutations))?;
    let how = ended(&format!("report {}", out.display()))?;
    drawing(&out.join("convergence.svg"))?;
    if ended(&format!("resume --quiet --json {}", out.display()))? == "accepted" {
        read_again(out)?;
    }
    Ok(how)
}

/// A conversation, each line answered with a line of JSON.
fn talk(mutations: &[Mutation], number: usize) -> How {
    let optimizers: Vec<OptimizerKind> = OptimizerKind::all().collect();
    let optimizer = optimizers[number % optimizers.len()];
    let text = format!(
        r#"{{"parameters":[{{"name":"x","low":-5,"high":5}},{{"name":"n","low":1,"high":9,"step":2}}],"optimizer":"{optimizer}","seed":1,"direction":"minimize"}}
{{"tell":[{{"values":{{"x":0.5,"n":3}},"value":1.5}}]}}
{{"ask":3}}
{{"tell":[{{"id":0,"value":0.5}},{{"id":1,"value":null}},{{"id":2,"value":-3}}]}}
{{"ask":2}}
{{"tell":[{{"id":3,"value":1e3}},{{"id":4,"value":2}}]}}
{{"ask":4}}
"#
    );
    let ended = run(&["ask-tell"], &mutated(&text, mutations))?;
    let mut how = "accepted";
    for line in ended.stdout.lines() {
        let answer: serde_json::Value =
            serde_json::from_str(line).with_context(|| format!("no JSON: {line}"))?;
        if answer.get("error").is_some() {
            how = "refused";
        }
    }
    ensure!(ended.code == Some(0), "a conversation ends with {:?}: {}", ended.code, ended.stderr);
    Ok(how)
}

/// Command lines of known words with values that may mean nothing.
fn command_line(mutations: &[Mutation], number: usize, dir: &Path) -> How {
    const LINES: [&str; 15] = [
        "--task \"usb\" --engine \"fake\" --budget 3 --batch 2 --seed 1 --threads 2 --no-cache",
        "--task \"usb,rj45\" --engine \"fake\" --budget 2 --aggregate \"weighted\" --weights \"1,2\" --no-cache",
        "--task \"usb\" --engine \"fake\" --budget 3 --objective \"range,peak-force\" --constraint \"slip<=1\" --no-cache",
        "--task \"usb\" --engine \"fake\" --budget 3 --polish 2 --space \"codesign\" --no-cache",
        "--task \"usb\" --engine \"fake\" --budget 3 --optimizer \"cma-es\" --no-cache",
        "evaluate --task \"usb\" --engine \"fake\" --density 20 --direction 10 --json",
        "evaluate --task \"usb\" --engine \"fake\" --stiffness-compliance 2 --stiffness-assembly 40",
        "evaluate --task \"usb\" --engine \"fake\" --density 20 --direction 10 --set \"task.strategy.tilt_deg=8\"",
        "evaluate --task \"usb\" --engine \"fake\" --density 20 --direction 10 --uncertainty \"typical\" --seed 3",
        "trial --task \"ket12\" --engine \"fake\" --density 10 --direction 0 --offset-mm 0.5 --json",
        "trial --task \"ket12\" --engine \"fake\" --density 10 --direction 0 --repeat 3",
        "finger --density 20 --direction 20 --phase-mm 0.5 --json",
        "tasks --json",
        "robots --json",
        "export \"mjcf\" --task \"usb\" --density 20 --direction 10 --out \"scene.xml\"",
    ];
    let line = LINES[number % LINES.len()];
    let text = String::from_utf8_lossy(&mutated(line, mutations)).into_owned();
    let plain = |c: char| c == '\0' || c == '"' || c == '\n';
    let mut words: Vec<String> = text.split(' ').map(|word| word.replace(plain, "")).collect();
    // Nothing may be written outside the folder of the case.
    let outside =
        |word: &String| word.contains("..") || word.starts_with('/') || word.contains("results");
    // Linux starts nothing with an argument of 128 KiB.
    let starts = |word: &String| word.len() < 128 * 1024;
    words.retain(|word| !outside(word) && starts(word) && word != "direct" && word != "rapier");
    // Nor simulated: that takes its time.
    if words.iter().any(|word| word == "--task") && line.contains("fake") {
        words.retain(|word| word != "--engine" && word != "fake");
        words.extend(["--engine".to_owned(), "fake".to_owned()]);
    }
    let study = words.first().is_some_and(|word| word.starts_with("--"));
    if study {
        words.extend(["--out".to_owned(), dir.join("study").display().to_string()]);
    }
    if let Some(at) = words.iter().position(|word| word == "scene.xml") {
        words[at] = dir.join("scene.xml").display().to_string();
    }
    judged(&words)
}
