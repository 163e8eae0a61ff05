//! Building blocks of the page's sections.

use super::glossary::explained;
use super::theme::{inline, variables};
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

/// Returns a page without external resources, in the style of the report.
pub(super) fn document(title: &str, body: Markup) -> String {
    let (light, dark) = (variables(false), variables(true));
    let style = format!(
        ":root{{color-scheme:light dark;{light}}}\n@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{}",
        include_str!("style.css")
    );
    styled(title, &style, body)
}

/// Returns a page without external resources, with a given style sheet.
pub(super) fn styled(title: &str, style: &str, body: Markup) -> String {
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

/// Returns an SVG as a `data:` URL for an image element; scripts in such an SVG do not run.
pub(super) fn data_url(svg: &str) -> String {
    let escapes = [('%', "%25"), ('#', "%23"), ('<', "%3C"), ('>', "%3E"), ('"', "%22")];
    let svg = escapes.iter().fold(svg.to_owned(), |svg, (sign, code)| svg.replace(*sign, code));
    format!("data:image/svg+xml,{svg}")
}

/// Returns names and their values as a definition list.
pub(super) fn definitions(pairs: &[(String, String)]) -> Markup {
    html! {
        dl { @for (name, value) in pairs { dt { (explained(name)) } dd { (value) } } }
    }
}

/// Returns a table, which scrolls horizontally if it is wider than the page.
pub(super) fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr { @for name in head { th { (name) } } } }
                tbody { @for row in rows { tr { @for cell in row { td { (cell) } } } } }
            }
        }
    }
}

/// Returns a table whose cells are stacked with their headings on a phone.
pub(super) fn stacked(head: &[&str], rows: impl IntoIterator<Item = Vec<impl Render>>) -> Markup {
    html! {
        table.stacked {
            thead { tr { @for name in head { th { (name) } } } }
            tbody {
                @for row in rows {
                    tr { @for (name, cell) in head.iter().zip(row) { td data-of=(name) { (cell) } } }
                }
            }
        }
    }
}

/// Returns a plot with its label for screen readers.
pub(super) fn figure(svg: &str, label: &str, caption: &str) -> Markup {
    html! {
        figure {
            div role="img" aria-label=(label) { (PreEscaped(inline(svg))) }
            figcaption { (caption) }
        }
    }
}
