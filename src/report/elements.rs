//! Building blocks of the page's sections.

use super::theme::inline;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A page that fetches nothing.
pub(super) fn document(title: &str, style: &str, body: Markup) -> String {
    let policy =
        "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(policy);
                title { (title) }
                style { (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

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
