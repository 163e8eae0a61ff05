//! Changes of a text that know what a number, a word in quotes and a line are.

use proptest::prelude::*;

/// Numbers, and what stands in their places.
const VALUES: [&str; 26] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "0.5",
    "2",
    "100",
    "-1000",
    "1e-9",
    "1e-12",
    "1e-300",
    "1e9",
    "-1e9",
    "1e160",
    "1e300",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "null",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "true",
    "[1.0, 2.0]",
];

/// Words, and what stands in theirs.
const WORDS: [&str; 11] = [
    "",
    "x",
    "usb",
    "gp",
    "\\u001b[31m",
    "../../etc/passwd",
    "a/b",
    "range",
    "ä€😀",
    "\\n",
    "infill_density_percent",
];

/// One change; places are taken modulo what there is.
#[derive(Debug, Clone)]
pub enum Mutation {
    /// The n-th number.
    Number(usize, &'static str),
    /// The n-th text in quotes.
    Word(usize, &'static str),
    /// The n-th text in quotes, made long.
    LongWord(usize),
    /// Without the n-th line.
    Drop(usize),
    /// The n-th line so many times more.
    Repeat(usize, u8),
    /// Two lines in each other's places.
    Swap(usize, usize),
    /// The text up to there.
    Cut(usize),
    /// A byte changed.
    Byte(usize, u8),
}

/// One change or a few.
pub fn mutations() -> impl Strategy<Value = Vec<Mutation>> {
    let at = any::<usize>;
    let one = prop_oneof![
        8 => (at(), prop::sample::select(VALUES.to_vec())).prop_map(|(n, v)| Mutation::Number(n, v)),
        3 => (at(), prop::sample::select(WORDS.to_vec())).prop_map(|(n, w)| Mutation::Word(n, w)),
        1 => at().prop_map(Mutation::LongWord),
        2 => at().prop_map(Mutation::Drop),
        2 => (at(), any::<u8>()).prop_map(|(n, times)| Mutation::Repeat(n, times)),
        1 => (at(), at()).prop_map(|(a, b)| Mutation::Swap(a, b)),
        1 => at().prop_map(Mutation::Cut),
        1 => (at(), any::<u8>()).prop_map(|(n, byte)| Mutation::Byte(n, byte)),
    ];
    prop::collection::vec(one, 0..4)
}

/// The text with all changes, one after the other.
pub fn mutated(text: &str, mutations: &[Mutation]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for mutation in mutations {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        bytes = apply(&text, mutation);
    }
    bytes
}

fn apply(text: &str, mutation: &Mutation) -> Vec<u8> {
    let lines = || text.split_inclusive('\n').map(str::to_owned).collect::<Vec<_>>();
    let with_lines = |change: &dyn Fn(&mut Vec<String>)| {
        let mut lines = lines();
        if !lines.is_empty() {
            change(&mut lines);
        }
        lines.concat().into_bytes()
    };
    match *mutation {
        Mutation::Number(n, value) => replaced(text, &numbers(text), n, value),
        Mutation::Word(n, word) => replaced(text, &words(text), n, word),
        Mutation::LongWord(n) => replaced(text, &words(text), n, &"long ".repeat(10_000)),
        Mutation::Drop(n) => with_lines(&|lines| {
            let at = n % lines.len();
            lines.remove(at);
        }),
        Mutation::Repeat(n, times) => with_lines(&|lines| {
            let at = n % lines.len();
            lines[at] = lines[at].repeat(usize::from(times) + 1);
        }),
        Mutation::Swap(a, b) => with_lines(&|lines| {
            let count = lines.len();
            lines.swap(a % count, b % count);
        }),
        Mutation::Cut(at) => text.as_bytes()[..at % (text.len() + 1)].to_vec(),
        Mutation::Byte(at, byte) => {
            let mut bytes = text.as_bytes().to_vec();
            if !bytes.is_empty() {
                let at = at % bytes.len();
                bytes[at] = byte;
            }
            bytes
        }
    }
}

fn replaced(text: &str, spans: &[(usize, usize)], n: usize, by: &str) -> Vec<u8> {
    if spans.is_empty() {
        return text.as_bytes().to_vec();
    }
    let (from, to) = spans[n % spans.len()];
    [&text[..from], by, &text[to..]].concat().into_bytes()
}

/// Where numbers stand that are no part of a word.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let part = |b: u8| b.is_ascii_alphanumeric() || b"._-+".contains(&b);
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if !part(bytes[at]) {
            at += 1;
            continue;
        }
        let end = (at..bytes.len()).find(|&i| !part(bytes[i])).unwrap_or(bytes.len());
        if text[at..end].parse::<f64>().is_ok() {
            found.push((at, end));
        }
        at = end;
    }
    found
}

/// What stands between double quotes on one line.
fn words(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut begin = 0;
    for line in text.split_inclusive('\n') {
        let quotes: Vec<usize> = line.match_indices('"').map(|(at, _)| begin + at).collect();
        found.extend(quotes.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])));
        begin += line.len();
    }
    found
}
