//! Tables of texts.

/// A table of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextTable {
    /// Title of the table.
    pub title: &'static str,
    /// Its columns.
    pub columns: Vec<TableColumn>,
    /// Rows with a cell for each column.
    pub rows: Vec<Vec<String>>,
}

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableColumn {
    /// Heading, with the unit.
    pub heading: &'static str,
    /// Whether it holds numbers, which are aligned to the right.
    pub is_number: bool,
}

impl TableColumn {
    /// A column of text.
    #[must_use]
    pub const fn text(heading: &'static str) -> Self {
        Self { heading, is_number: false }
    }

    /// A column of numbers.
    #[must_use]
    pub const fn number(heading: &'static str) -> Self {
        Self { heading, is_number: true }
    }
}

impl TextTable {
    /// The table with a heading for its columns, columns separated by two spaces, lines indented by two.
    #[must_use]
    pub fn to_text(&self) -> String {
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| row[column].chars().count());
            cells.fold(self.columns[column].heading.chars().count(), usize::max)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let headings: Vec<&str> = self.columns.iter().map(|column| column.heading).collect();
        let mut text = format!("{}\n", self.title);
        let rows = self.rows.iter().map(|row| row.iter().map(String::as_str).collect());
        for row in std::iter::once(headings).chain(rows) {
            let mut line = String::new();
            for ((cell, column), &width) in row.iter().zip(&self.columns).zip(&widths) {
                let aligned = if column.is_number {
                    format!("  {cell:>width$}")
                } else {
                    format!("  {cell:<width$}")
                };
                line.push_str(&aligned);
            }
            // Columns may have no headings.
            if !line.trim().is_empty() {
                text.push_str(line.trim_end());
                text.push('\n');
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_a_table_are_aligned_and_as_wide_as_their_content() {
        let table = TextTable {
            title: "two",
            columns: vec![TableColumn::text("name"), TableColumn::number("µm")],
            rows: vec![
                vec!["long name".to_owned(), "1.5".to_owned()],
                vec!["b".to_owned(), "12.25".to_owned()],
            ],
        };
        assert_eq!(
            table.to_text(),
            "two\n  name          µm\n  long name    1.5\n  b          12.25\n"
        );
    }
}
