//! The commands of README and guide, run in their order: each page in a folder of its own, with the files that the
//! reader has by then. Studies run on the fake engine with a small budget; all else as written.

use crate::common::{FRICTION, Studies, command, logged, read, root, run};
use std::fs;

/// A block of code and its language.
struct Block {
    language: String,
    lines: Vec<String>,
}

fn blocks(page: &str) -> Vec<Block> {
    let text = read(&root(page)).replace("\\\n", "");
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let inside = lines.by_ref().take_while(|line| *line != "```");
            let (language, lines) = (language.to_owned(), inside.map(str::to_owned).collect());
            blocks.push(Block { language, lines });
        }
    }
    blocks
}

/// The words of a command: studies, tuning and shares of variance on the fake engine, identification of few numbers.
fn quick(line: &str) -> Vec<String> {
    let words = line.split_whitespace().skip(1);
    let mut words: Vec<_> = words.map(|word| word.replace('\'', "")).collect();
    if let Some(at) = words.iter().position(|word| word == "--budget") {
        words[at + 1] = "8".to_owned();
    }
    let more = match words[0].as_str() {
        "task" if words[1] == "tune" => ["--engine", "fake"],
        "sensitivity" | "next" => ["--engine", "fake"],
        "identify" => ["--priors", "few.toml"],
        study if study.starts_with("--") => ["--engine", "fake"],
        _ => return words,
    };
    words.extend(more.map(str::to_owned));
    words
}

/// Runs the commands of a page in a folder; gives how many there were.
fn follow(page: &str, folder: &Studies) -> usize {
    let (mut count, mut printed) = (0, String::new());
    for block in blocks(page) {
        match block.language.as_str() {
            "sh" => {
                printed.clear();
                for line in block.lines.iter().filter(|line| line.starts_with("optimize ")) {
                    let ran = run(command(&[]).args(quick(line)).current_dir(&folder.0));
                    assert_eq!(ran.code, Some(0), "{page}: {line}\n{}{}", ran.stdout, ran.stderr);
                    printed += &ran.stdout;
                    count += 1;
                }
            }
            // A line to be added to the project file.
            "toml" if block.lines[0].starts_with("cell = ") => {
                let project = folder.read("finger-opt.toml");
                folder.file("finger-opt.toml", format!("{project}\n{}\n", block.lines[0]));
            }
            "text" if block.lines[0].starts_with("success rate") => {
                for line in &block.lines {
                    assert!(printed.contains(line), "{page}: `{line}` is not in:\n{printed}");
                }
            }
            _ => {}
        }
    }
    count
}

/// Copies the project's file to a name in the folder.
fn copied(folder: &Studies, from: &str, to: &str) {
    folder.file(to, read(&root(from)));
}

#[test]
fn the_readme() {
    let folder = Studies::new();
    assert!(follow("README.md", &folder) >= 4);
}

#[test]
fn fingers() {
    let folder = Studies::new();
    copied(&folder, "data/measured_stiffness.csv", "mine.csv");
    copied(&folder, "fingers/finray9.toml", "mine.toml");
    folder.study("results/usb-gp-seed0", 8, &["--task", "usb"]).succeeds();
    assert!(follow("docs/guide/fingers.md", &folder) >= 5);
}

#[test]
fn objectives() {
    let folder = Studies::new();
    copied(&folder, "uncertainties/typical.toml", "my_cell.toml");
    assert!(follow("docs/guide/objectives.md", &folder) >= 6);
}

#[test]
fn studies() {
    assert!(follow("docs/guide/studies.md", &Studies::new()) >= 5);
}

#[test]
fn tasks() {
    let folder = Studies::new();
    for file in ["keyed-plug.stl", "keyed-socket.stl"] {
        let name = format!("examples/meshes/{file}");
        let to = folder.dir(&name);
        fs::create_dir_all(to.parent().expect("a folder")).expect("it is made");
        fs::copy(root(&name), to).expect("the mesh is copied");
    }
    assert!(follow("docs/guide/tasks.md", &folder) >= 5);
}

/// The logs that `measure_window` writes in the guide come from `trial` here.
#[test]
fn measuring() {
    let folder = Studies::new();
    folder.file("finger-opt.toml", blocks("docs/guide/measuring.md").remove(0).lines.join("\n"));
    fs::create_dir(folder.dir("logs")).expect("it is made");
    let runs = logged(&folder, "logs/", [[10, 6], [11, 40]], ["", "-1", "0", "1"], "");
    folder.file("runs.csv", runs);
    folder.file("few.toml", FRICTION);
    assert!(follow("docs/guide/measuring.md", &folder) >= 9);
}
