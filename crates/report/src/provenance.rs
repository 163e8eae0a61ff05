//! Provenance of a study, and further numbers of the recommended finger.

use super::elements::definitions;
use crate::answer::{Answer, command, lines};
use maud::{Markup, html};
use study::{Provenance, StudyRecord};

/// Names of lines that are omitted here, because other sections of the page show them.
const ELSEWHERE: [&str; 8] = [
    "best design",
    "firm range",
    "window",
    "ends",
    "from its ribs",
    "ties",
    "safe choice",
    "least force",
];

/// Returns further numbers and settings, collapsed, and the command that reproduces the study.
pub(super) fn section(answer: &Answer) -> Markup {
    // With measurements `lines::recommended` already contains the lines of `lines::simulated`.
    let alone = answer.recommended.iter().filter(|_| answer.record.on_bench.is_none());
    let all = answer.recommended.iter().flat_map(|found| lines::recommended(answer, found));
    let found = alone.flat_map(|found| lines::simulated(answer, found)).chain(all);
    let found = found.filter(|_| answer.verdict.finger().is_some());
    let more: Vec<_> = found.filter(|(name, _)| !ELSEWHERE.contains(&name.as_str())).collect();
    html! {
        @if !more.is_empty() {
            details { summary { "More about the finger recommended by simulation" } (definitions(&more)) }
        }
        details { summary { "Program and hashes" } (provenance(answer.record)) }
        p {
            @for file in ["study.toml", "evaluations.csv", "journal.jsonl"] { a href=(file) { (file) } " " }
            "The same study again, in its folder:"
        }
        pre { code { (command::rerun(answer.record).join(" ")) } }
    }
}

/// Returns program, engine and hashes of the input files of each segment.
fn provenance(record: &StudyRecord) -> Markup {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, value: String| rows.push((name.to_owned(), value));
    for (i, segment) in record.segments.iter().enumerate() {
        let of = match record.segments.len() {
            1 => String::new(),
            _ => format!(", segment {} (from evaluation {})", i + 1, segment.first),
        };
        let Provenance { program, source_sha256, input_sha256, engine, .. } = &segment.provenance;
        add(&format!("finger-opt{of}"), format!("{program}, sources {source_sha256}"));
        add(&format!("contact engine{of}"), engine.version.clone());
        let settings = engine.settings.iter().map(|(key, value)| format!("{key} = {value}"));
        add(&format!("engine settings{of}"), settings.collect::<Vec<_>>().join(", "));
        for (role, hash) in input_sha256 {
            add(&format!("SHA-256 of the {role} file{of}"), hash.clone());
        }
    }
    definitions(&rows)
}
