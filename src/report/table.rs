//! Plain text tables.

use crate::problem::visible;

/// Lines of a table with aligned columns, indented by two spaces. A heading that starts with `>`
/// (not shown) aligns its column to the right; columns without any content are left out.
pub(super) fn render(headings: &[&str], rows: &[Vec<String>]) -> String {
    let seen = |row: &Vec<String>| row.iter().map(|cell| visible(cell)).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(seen).collect();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        match cells.max() {
            None | Some(0) => 0,
            Some(cells) => cells.max(headings[column].trim_start_matches('>').chars().count()),
        }
    };
    let widths: Vec<usize> = (0..headings.len()).map(width).collect();
    let mut out = String::new();
    let mut line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut text = String::new();
        for ((cell, heading), &width) in cells.zip(headings).zip(&widths) {
            if width == 0 {
                continue;
            }
            text.push_str("  ");
            if heading.starts_with('>') {
                text.push_str(&format!("{cell:>width$}"));
            } else {
                text.push_str(&format!("{cell:<width$}"));
            }
        }
        out.push_str(text.trim_end());
        out.push('\n');
    };
    line(&mut headings.iter().map(|h| h.trim_start_matches('>')));
    for row in &rows {
        line(&mut row.iter().map(String::as_str));
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn columns_are_aligned_and_empty_ones_left_out() {
        let rows = [["a", "1", ""], ["bcd", "10", ""]].map(|r| r.map(str::to_owned).to_vec());
        let text = super::render(&["name", ">value", "note"], &rows);
        assert_eq!(text, "  name  value\n  a         1\n  bcd      10\n");
    }
}
