//! Tables for terminals.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets::NOTHING};

/// Assumed width of the terminal, columns.
const WIDTH: u16 = 80;

/// Returns a table without a frame, at most 80 columns wide; cells are wrapped where necessary. The
/// first `left` columns are left-aligned, the others right-aligned.
pub fn text_table<const N: usize>(
    left: usize,
    head: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(WIDTH).set_header(head).add_rows(rows);
    for (i, column) in table.column_iter_mut().enumerate() {
        let to = if i < left { CellAlignment::Left } else { CellAlignment::Right };
        column.set_cell_alignment(to);
        column.set_padding((0, if i + 1 < N { 2 } else { 0 }));
    }
    table.trim_fmt() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_long_cells_wrapped() {
        let row = |name: &str, value: &str| [name.to_owned(), value.to_owned()];
        let text = text_table(1, ["name", "mm"], [row("a", "1.5"), row("long", "10.25")]);
        assert_eq!(text, "name     mm\na       1.5\nlong  10.25\n");
        let wrapped = text_table(1, ["name", "mm"], [row(&"word ".repeat(30), "1")]);
        assert!(wrapped.lines().count() == 3 && wrapped.lines().all(|line| line.len() <= 80));
        assert_eq!(wrapped.matches("word").count(), 30, "{wrapped}");
    }
}
