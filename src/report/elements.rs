//! What sections of the page are made of.

use super::theme::inline;
use maud::{Markup, PreEscaped, html};

/// A list of names and values.
pub(super) fn definitions(pairs: &[(String, String)]) -> Markup {
    html! {
        dl { @for (name, value) in pairs { dt { (name) } dd { (value) } } }
    }
}

/// A table, which scrolls sideways where it is wider than the page.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr { @for name in head { th { (name) } } } }
                tbody { @for row in rows { tr { @for cell in row { td { (cell) } } } } }
            }
        }
    }
}

/// A drawn plot; a reader that cannot see it gets `label`.
pub(super) fn figure(svg: &str, label: &str, caption: &str) -> Markup {
    html! {
        figure {
            div role="img" aria-label=(label) { (PreEscaped(inline(svg))) }
            figcaption { (caption) }
        }
    }
}
