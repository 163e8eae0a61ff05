//! Terms of the page, explained on hover and touch in the words of the guide.

use maud::{Markup, html};

/// Terms, each with its explanation, which is also a passage of `start.md` or `objectives.md` in `docs/guide`.
pub(crate) const TERMS: [(&str, &str); 12] = [
    (
        "firm",
        "between the outermost starts that insert in all repeats, with friction, start and time step \
         slightly varied",
    ),
    (
        "single trials",
        "the interval of start shifts along y, on a grid of 0.1 mm, from which the trial inserts",
    ),
    ("from its ribs", "the window with springs computed from the ribs"),
    ("similar fingers", "fingers of similar stiffness on the publication's robot"),
    ("in repeats", "its repeated range"),
    ("lost early (1)", "the fingers lost the plug during grasp, manipulation or approach"),
    ("missed (2)", "at the end of the search, the plug's leading edge was not in the opening"),
    ("jammed (3)", "the leading edge was in the opening, but the plug did not seat"),
    ("lost (4)", "the fingers lost the plug during the search or the push"),
    (
        "Ties",
        "designs whose firm range, measured or expected, is smaller by at most --indifference-mm",
    ),
    ("peak force", "largest contact force between plug and socket in the trials that insert"),
    ("robust range", "range under sampled errors: mean minus one standard deviation"),
];

/// Returns a text as HTML, with an explanation of each term.
pub(super) fn explained(text: &str) -> Markup {
    let found = TERMS.iter().filter_map(|(term, tip)| Some((position(text, term)?, *term, *tip)));
    let Some((at, term, tip)) = found.min_by_key(|(at, ..)| *at) else { return html! { (text) } };
    let (before, after) = (&text[..at], &text[at + term.len()..]);
    html! {
        (before)
        // Focus replaces hover on devices without a pointer.
        span.term tabindex="0" data-tip=(tip) aria-label={ (term) ": " (tip) } { (term) }
        (explained(after))
    }
}

/// Returns the position of a term in a text as a whole word.
fn position(text: &str, term: &str) -> Option<usize> {
    let apart = |at: &usize| {
        let letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
        let (before, after) = (&text[..*at], &text[*at + term.len()..]);
        !letter(before.chars().next_back()) && !letter(after.chars().next())
    };
    text.match_indices(term).map(|(at, _)| at).find(apart)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_guide_has_the_same_explanations() {
        let pages = [
            include_str!("../../../docs/guide/start.md"),
            include_str!("../../../docs/guide/objectives.md"),
        ];
        let guide = pages.concat().replace(['*', '`'], "").to_lowercase();
        let guide = guide.split_whitespace().collect::<Vec<_>>().join(" ");
        for (term, tip) in TERMS {
            assert!(guide.contains(&tip.to_lowercase()), "{term}: {tip}");
        }
        let shown = explained("simulated: firm -4.4 to +5.7 mm & more").into_string();
        assert!(shown.starts_with("simulated: <span class=\"term\""), "{shown}");
        assert!(shown.ends_with("&amp; more"), "{shown}");
        let ends = explained("jammed (3), peak force").into_string();
        assert_eq!(ends.matches("data-tip=\"").count(), 2, "{ends}");
        let plain = "simulated: -5.3 to +2.0 mm, not confirmed";
        assert_eq!(explained(plain).into_string(), plain);
    }
}
