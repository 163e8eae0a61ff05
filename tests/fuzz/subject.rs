//! What is mutated, and what is asked of the program about it.

use super::mutation::{Mutation, mutated};
use super::process::{CPU_S, TRIAL_S, Verdict, run};
use finger_opt::connector::mesh::read;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Task,
    Space,
    Robot,
    Uncertainty,
    Stiffness,
    Finger,
    Config,
    Journal,
    SealedJournal,
    Walk,
    AskTell,
    CommandLine,
    Trial,
    Measurements,
    Priors,
    Mesh,
}

impl Kind {
    pub const ALL: [Kind; 16] = [
        Kind::Task,
        Kind::Space,
        Kind::Robot,
        Kind::Uncertainty,
        Kind::Stiffness,
        Kind::Finger,
        Kind::Config,
        Kind::Journal,
        Kind::SealedJournal,
        Kind::Walk,
        Kind::AskTell,
        Kind::CommandLine,
        Kind::Trial,
        Kind::Measurements,
        Kind::Priors,
        Kind::Mesh,
    ];
}

/// The shipped files in a folder, by their kind.
fn shipped(folder: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect()
}

/// What mutations begin with.
pub struct Base {
    tasks: Vec<String>,
    spaces: Vec<String>,
    robots: Vec<String>,
    uncertainties: Vec<String>,
    fingers: Vec<String>,
    /// Plug and socket of each example, as OBJ: where a corner moves its faces follow.
    meshes: Vec<[String; 2]>,
    /// A finished study.
    study: tempfile::TempDir,
}

impl Base {
    pub fn new() -> Self {
        let study = tempfile::tempdir().unwrap();
        let words = "--task usb,rj45 --engine fake --budget 7 --polish 3 --no-cache --quiet \
                     --constraint peak-force<=30 --out";
        let ended = run(&with_path(words, &study.path().join("study")), b"", CPU_S).unwrap();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        Base {
            tasks: shipped("tasks"),
            spaces: shipped("spaces"),
            robots: shipped("robots"),
            uncertainties: shipped("uncertainties"),
            fingers: shipped("fingers"),
            meshes: ["keyed", "usb"]
                .map(|pair| ["plug", "socket"].map(|body| obj(pair, body)))
                .to_vec(),
            study,
        }
    }
}

/// An example mesh with each corner once.
fn obj(pair: &str, body: &str) -> String {
    let name = format!("{}/examples/meshes/{pair}-{body}.stl", env!("CARGO_MANIFEST_DIR"));
    let triangles = read(&fs::read(&name).unwrap(), &name).unwrap();
    let (mut corners, mut faces): (Vec<String>, String) = Default::default();
    for triangle in triangles {
        faces.push('f');
        for p in triangle {
            let corner = format!("v {} {} {}\n", p.x, p.y, p.z);
            let known = corners.iter().position(|other| *other == corner);
            let at = known.unwrap_or(corners.len());
            if known.is_none() {
                corners.push(corner);
            }
            faces.push_str(&format!(" {}", at + 1));
        }
        faces.push('\n');
    }
    corners.concat() + &faces
}

fn with_path(words: &str, path: &Path) -> Vec<String> {
    let words = words.split_whitespace().map(str::to_owned);
    words.chain([path.display().to_string()]).collect()
}

/// Runs one case; gives how it ended, or what no case may do.
fn run_case(
    kind: Kind,
    mutations: &[Mutation],
    number: u64,
    base: &Base,
) -> Result<&'static str, String> {
    let dir = tempfile::tempdir().map_err(|error| error.to_string())?;
    let of = |texts: &[String]| texts[number as usize % texts.len()].clone();
    let file = |text: &str, name: &str| -> Result<PathBuf, String> {
        let path = dir.path().join(name);
        fs::write(&path, mutated(text, mutations)).map_err(|error| error.to_string())?;
        Ok(path)
    };
    let study = "--engine fake --budget 3 --no-cache --quiet --json";
    let out = dir.path().join("study");
    match kind {
        Kind::Task => {
            let path = file(&of(&base.tasks), "f.toml")?;
            accepted(&with_path(&format!("{study} --task {} --out", path.display()), &out), &out)
        }
        Kind::Space => {
            let path = file(&of(&base.spaces), "f.toml")?;
            let words = format!("{study} --task usb --space {} --out", path.display());
            accepted(&with_path(&words, &out), &out)
        }
        Kind::Robot => {
            let path = file(&of(&base.robots), "f.toml")?;
            if number.is_multiple_of(7) {
                let words = "trial --task usb --json --density 20 --direction 10 --robot";
                return ended(&with_path(words, &path), b"");
            }
            let words = format!("{study} --task usb --robot {} --out", path.display());
            accepted(&with_path(&words, &out), &out)
        }
        Kind::Uncertainty => {
            let path = file(&of(&base.uncertainties), "f.toml")?;
            let goal = ["success-rate", "robust-range"][number as usize / 2 % 2];
            let words = format!(
                "{study} --task usb --objective {goal} --uncertainty {} --out",
                path.display()
            );
            accepted(&with_path(&words, &out), &out)
        }
        Kind::Stiffness => {
            let text = include_str!("../../data/measured_stiffness.csv");
            let path = file(text, "f.csv")?;
            let svg = dir.path().join("f.svg");
            let words = format!("stiffness --json --stiffness-data {} --svg", path.display());
            let how = ended(&with_path(&words, &svg), b"")?;
            drawing(&svg)?;
            Ok(how)
        }
        Kind::Finger => {
            let path = file(&of(&base.fingers), "f.toml")?;
            let words = "finger --json --density 20 --direction 10 --finger";
            ended(&with_path(words, &path), b"")
        }
        Kind::Config | Kind::Journal | Kind::SealedJournal | Kind::Walk => {
            kept(kind, mutations, base, &out)
        }
        Kind::AskTell => talk(mutations, number),
        Kind::CommandLine => command_line(mutations, number, dir.path()),
        Kind::Trial => {
            let path = file(&of(&base.tasks), "f.toml")?;
            let words = "trial --json --density 20 --direction 10 --task";
            ended(&with_path(words, &path), b"")
        }
        Kind::Measurements => {
            let path = file(include_str!("../../data/published_bench.csv"), "f.csv")?;
            let words = match number % 4 {
                0 => &format!("{CALIBRATE} --measurements"),
                _ => "measure check --json",
            };
            ended(&with_path(words, &path), b"")
        }
        Kind::Priors => {
            let path = file(include_str!("../../priors/bench.toml"), "f.toml")?;
            let words = format!("{CALIBRATE} --measurements published --priors");
            ended(&with_path(&words, &path), b"")
        }
        Kind::Mesh => {
            let [plug, socket] = &base.meshes[number as usize % base.meshes.len()];
            let changed = file([plug, socket][number as usize / 2 % 2], "changed.obj")?;
            let other = dir.path().join("other.obj");
            fs::write(&other, [socket, plug][number as usize / 2 % 2])
                .map_err(|e| e.to_string())?;
            let [plug, socket] = match number / 2 % 2 {
                0 => [changed, other],
                _ => [other, changed],
            };
            let words = format!(
                "task import --engine fake --json --unit mm --resolution 32 --plug {} --socket {} --out",
                plug.display(),
                socket.display()
            );
            ended(&with_path(&words, &dir.path().join("task.toml")), b"")
        }
    }
}

/// As little of it as there may be, of the formula in place of an engine.
const CALIBRATE: &str =
    "calibrate --task usb --engine fake --simulations 16 --samples 20 --no-cache --json";

/// Runs one case and judges it.
pub fn judge(kind: Kind, mutations: &[Mutation], number: u64, base: &Base) -> Verdict {
    match run_case(kind, mutations, number, base) {
        Ok(how) => Verdict::Fine(how),
        Err(what) => Verdict::Wrong(what),
    }
}

fn ended(arguments: &[String], input: &[u8]) -> Result<&'static str, String> {
    let cpu_s = match arguments {
        [command, ..] if command == "trial" => TRIAL_S,
        _ => CPU_S,
    };
    let ended = run(arguments, input, cpu_s)?;
    if ended.code == Some(0) && arguments.iter().any(|word| word == "--json") {
        serde_json::from_str::<serde_json::Value>(&ended.stdout)
            .map_err(|error| format!("no JSON: {error}: {arguments:?}: {}", ended.stdout))?;
    }
    Ok(if ended.code == Some(0) { "accepted" } else { "refused" })
}

/// What is accepted can be read again: its report is made from the files.
fn accepted(arguments: &[String], out: &Path) -> Result<&'static str, String> {
    let how = ended(arguments, b"")?;
    if how == "accepted" {
        read_again(out)?;
    }
    Ok(how)
}

fn read_again(out: &Path) -> Result<(), String> {
    for words in ["report", "resume --quiet --json"] {
        let again = run(&with_path(words, out), b"", CPU_S)?;
        if again.code != Some(0) {
            return Err(format!("was accepted, but `{words}` fails: {}", again.stderr));
        }
    }
    drawing(&out.join("convergence.svg"))?;
    let journal = fs::read_to_string(out.join("journal.jsonl")).map_err(|e| e.to_string())?;
    // JSON has no NaN and no infinity, but in texts, where they are no numbers.
    let read = |line: &str| serde_json::from_str::<serde_json::Value>(line).map(drop);
    journal.lines().try_for_each(read).map_err(|error| format!("a line of the journal: {error}"))
}

/// A drawing, if there is one, is XML with numbers only.
fn drawing(path: &Path) -> Result<(), String> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(()) };
    roxmltree::Document::parse(&text).map_err(|error| format!("no XML: {error}"))?;
    let number = |word: &str| word == "NaN" || word == "inf";
    match text.split(|c: char| !c.is_alphanumeric()).any(number) {
        true => Err(format!("{}: holds what is no number", path.display())),
        false => Ok(()),
    }
}

/// A study's folder in which one file was changed.
fn kept(
    kind: Kind,
    mutations: &[Mutation],
    base: &Base,
    out: &Path,
) -> Result<&'static str, String> {
    let from = base.study.path().join("study");
    let io = |error: std::io::Error| error.to_string();
    fs::create_dir_all(out.join("inputs")).map_err(io)?;
    for folder in ["", "inputs"] {
        for entry in fs::read_dir(from.join(folder)).map_err(io)?.flatten() {
            if entry.path().is_file() {
                let to = out.join(folder).join(entry.file_name());
                fs::copy(entry.path(), to).map_err(io)?;
            }
        }
    }
    let name = match kind {
        Kind::Config => "study.toml",
        Kind::Walk => "walk.json",
        _ => "journal.jsonl",
    };
    let path = out.join(name);
    let mut text = mutated(&fs::read_to_string(&path).map_err(io)?, mutations);
    if kind == Kind::SealedJournal {
        text = sealed(&String::from_utf8_lossy(&text)).into_bytes();
    }
    fs::write(&path, text).map_err(io)?;
    let how = ended(&with_path("report", out), b"")?;
    drawing(&out.join("convergence.svg"))?;
    let resumed = ended(&with_path("resume --quiet --json", out), b"")?;
    if resumed == "accepted" {
        read_again(out)?;
    }
    Ok(how)
}

/// A journal all of whose checks fit again.
fn sealed(text: &str) -> String {
    let line = |line: &str| match line.rsplit_once(",\"check\":\"") {
        Some((content, rest)) if rest.len() > 16 && rest.is_char_boundary(16) => {
            let digest = Sha256::digest(content.as_bytes());
            let check: String = digest[..8].iter().map(|byte| format!("{byte:02x}")).collect();
            format!("{content},\"check\":\"{check}{}\n", &rest[16..])
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// A conversation, each line answered with a line of JSON.
fn talk(mutations: &[Mutation], number: u64) -> Result<&'static str, String> {
    let optimizer = ["gp", "cma-es", "random", "sobol", "grid"][number as usize % 5];
    let asked = "{\"ask\":3}\n{\"tell\":[{\"id\":0,\"value\":0.5},{\"id\":1,\"value\":null},{\"id\":2,\"value\":-3}]}\n";
    let more =
        "{\"ask\":2}\n{\"tell\":[{\"id\":3,\"value\":1e3},{\"id\":4,\"value\":2}]}\n{\"ask\":4}\n";
    let text = format!(
        "{{\"parameters\":[{{\"name\":\"x\",\"low\":-5,\"high\":5}},{{\"name\":\"n\",\"low\":1,\"high\":9,\"step\":2}}],\
         \"optimizer\":\"{optimizer}\",\"seed\":1,\"direction\":\"minimize\"}}\n\
         {{\"tell\":[{{\"values\":{{\"x\":0.5,\"n\":3}},\"value\":1.5}}]}}\n{asked}{more}"
    );
    let ended = run(&["ask-tell".to_owned()], &mutated(&text, mutations), CPU_S)?;
    let mut errors = false;
    for line in ended.stdout.lines() {
        let answer: serde_json::Value =
            serde_json::from_str(line).map_err(|error| format!("no JSON: {error}: {line}"))?;
        errors |= answer.get("error").is_some();
    }
    match ended.code {
        Some(0) => Ok(if errors { "refused" } else { "accepted" }),
        _ => Err(format!("a conversation ends with {:?}: {}", ended.code, ended.stderr)),
    }
}

/// Command lines of known words with values that may mean nothing.
fn command_line(mutations: &[Mutation], number: u64, dir: &Path) -> Result<&'static str, String> {
    const LINES: [&str; 14] = [
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
        "export \"mjcf\" --task \"usb\" --density 20 --direction 10 --out \"scene.xml\"",
    ];
    let line = LINES[number as usize % LINES.len()];
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
    ended(&words, b"")
}
