//! Changes of a text that know what a number, a word in quotes and a line are.

use proptest::prelude::*;

/// Values in place of numbers.
const VALUES: &str = "0 -0.0 1 -1 0.5 2 100 -1000 1e-9 1e-12 1e-300 1e9 -1e9 1e160 1e300 1e308 nan inf \
    -inf null 4294967295 4294967296 9223372036854775807 18446744073709551615 true [1.0,2.0]";

/// Texts in place of those in quotes.
const WORDS: &str =
    " x usb gp \\u001b[31m ../../etc/passwd a/b range ä€😀 \\n infill_density_percent";

/// One change; places are taken modulo what there is.
#[derive(Debug, Clone)]
pub struct Mutation {
    kind: Kind,
    /// Number, text, line or byte.
    at: usize,
    /// Value, word, line, count or byte.
    by: usize,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    /// A number becomes one of [`VALUES`].
    Number,
    /// A text in quotes becomes one of [`WORDS`].
    Word,
    /// A text in quotes is made long.
    LongWord,
    /// A line is left out.
    Drop,
    /// A line is repeated.
    Repeat,
    /// Two lines change places.
    Swap,
    /// The text ends.
    Cut,
    /// A byte is changed.
    Byte,
}

/// No change or a few.
pub fn mutations() -> impl Strategy<Value = Vec<Mutation>> {
    let kind = prop_oneof![
        8 => Just(Kind::Number),
        3 => Just(Kind::Word),
        1 => Just(Kind::LongWord),
        2 => Just(Kind::Drop),
        2 => Just(Kind::Repeat),
        1 => Just(Kind::Swap),
        1 => Just(Kind::Cut),
        1 => Just(Kind::Byte),
    ];
    let one = (kind, any::<usize>(), any::<usize>());
    prop::collection::vec(one.prop_map(|(kind, at, by)| Mutation { kind, at, by }), 0..4)
}

/// The text with all changes, one after the other.
pub fn mutated(text: &str, mutations: &[Mutation]) -> Vec<u8> {
    let change = |bytes: Vec<u8>, mutation| apply(&String::from_utf8_lossy(&bytes), mutation);
    mutations.iter().fold(text.as_bytes().to_vec(), change)
}

fn apply(text: &str, &Mutation { kind, at, by }: &Mutation) -> Vec<u8> {
    let mut lines: Vec<String> = text.split_inclusive('\n').map(str::to_owned).collect();
    let mut bytes = text.as_bytes().to_vec();
    let count = lines.len();
    match kind {
        Kind::Number => return replaced(text, &numbers(text), at, one_of(VALUES, by)),
        Kind::Word => return replaced(text, &words(text), at, one_of(WORDS, by)),
        Kind::LongWord => return replaced(text, &words(text), at, &"long ".repeat(10_000)),
        _ if count == 0 => {}
        Kind::Drop => drop(lines.remove(at % count)),
        Kind::Repeat => lines[at % count] = lines[at % count].repeat(by % 256 + 1),
        Kind::Swap => lines.swap(at % count, by % count),
        Kind::Cut => {
            bytes.truncate(at % (text.len() + 1));
            return bytes;
        }
        Kind::Byte => {
            bytes[at % text.len()] = by as u8;
            return bytes;
        }
    }
    lines.concat().into_bytes()
}

fn one_of(words: &'static str, n: usize) -> &'static str {
    let words: Vec<&str> = words.split(' ').collect();
    words[n % words.len()]
}

fn replaced(text: &str, spans: &[(usize, usize)], n: usize, by: &str) -> Vec<u8> {
    if spans.is_empty() {
        return text.as_bytes().to_vec();
    }
    let (from, to) = spans[n % spans.len()];
    [&text[..from], by, &text[to..]].concat().into_bytes()
}

/// Places of numbers that are no part of a word, nor of a sentence in quotes, which may say anything.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let sentences = words(text).into_iter().filter(|&(from, to)| text[from..to].contains(' '));
    let sentences: Vec<_> = sentences.collect();
    let other = |c: char| !(c.is_ascii_alphanumeric() || "._-+".contains(c));
    let mut next = 0;
    let number = |piece: &str| {
        let from = next;
        next += piece.len();
        let word = piece.trim_end_matches(other);
        let said = sentences.iter().any(|&(begin, end)| (begin..end).contains(&from));
        (!said && word.parse::<f64>().is_ok()).then_some((from, from + word.len()))
    };
    text.split_inclusive(other).filter_map(number).collect()
}

/// Places of what stands between double quotes on one line.
fn words(text: &str) -> Vec<(usize, usize)> {
    let mut next = 0;
    let in_line = |line: &str| {
        let quotes: Vec<usize> = line.match_indices('"').map(|(at, _)| next + at).collect();
        next += line.len();
        quotes.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])).collect::<Vec<_>>()
    };
    text.split_inclusive('\n').flat_map(in_line).collect()
}
