//! Reads the paths out of a folder tree drawn in a fenced block.
//!
//! ```text
//! top/                      a line without branch is not read
//! ├─ a.md · b.md  remark    several names with · between, then a remark
//! └─ c/
//!    └─ d.rs                c/d.rs
//! ```

use crate::markdown::Line;

/// Paths of all drawn trees of a document, each with its line.
pub(super) fn paths(lines: &[Line<'_>]) -> Vec<(usize, String)> {
    let mut paths = Vec::new();
    // The folders above the current line: column of the branch, and name without `/`.
    let mut above: Vec<(usize, &str)> = Vec::new();
    for line in lines {
        if !line.fenced {
            above.clear();
        }
        let Some((column, names)) = branch(line.text).filter(|_| line.fenced) else { continue };
        above.retain(|(other, _)| *other < column);
        let folder: String = above.iter().map(|(_, name)| format!("{name}/")).collect();
        paths.extend(names.iter().map(|name| (line.number, format!("{folder}{name}"))));
        if let Some(name) = names.first() {
            above.push((column, name.trim_end_matches('/')));
        }
    }
    paths
}

/// Column of a line's branch and the names on it.
fn branch(line: &str) -> Option<(usize, Vec<&str>)> {
    let drawn = line.trim_start_matches(|c: char| c == '│' || c.is_whitespace());
    let column = line.chars().count() - drawn.chars().count();
    let text = drawn.strip_prefix(['├', '└'])?;
    let text = text.strip_prefix('─')?.trim_start_matches('─');
    let mut words = text.split_whitespace();
    let mut names = vec![words.next()?];
    while words.next() == Some("·") {
        names.extend(words.next());
    }
    Some((column, names))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::markdown;

    fn check(text: &str, expect: &[(usize, &str)]) {
        let found = paths(&markdown::lines(text));
        let found: Vec<_> = found.iter().map(|(line, path)| (*line, path.as_str())).collect();
        assert_eq!(found, expect, "{text}");
    }

    #[test]
    fn nested() {
        let text = "```text\ntop/\n├─ a/  remark\n│  ├─ b.rs  remark\n│  └─ c/\n│      └─ d.rs\n└── e.md\n```";
        check(text, &[(3, "a/"), (4, "a/b.rs"), (5, "a/c/"), (6, "a/c/d.rs"), (7, "e.md")]);
    }

    #[test]
    fn several_names_and_remark_lines() {
        check(
            "```\n├─ A · B  remark · C\n│     more about it\n└─ d/\n```",
            &[(2, "A"), (2, "B"), (4, "d/")],
        );
        check("```\n└─ a/  remark\n   goes on\n   │\n   └─ b\n```", &[(2, "a/"), (5, "a/b")]);
    }

    #[test]
    fn a_tree_ends_with_its_block() {
        check("```\n└─ a/\n```\n\n```\n   └─ b\n```", &[(2, "a/"), (6, "b")]);
    }

    #[test]
    fn other_text_is_no_tree() {
        check("├─ outside a fence", &[]);
        check("```\ncore ├─ study\n  a -- b\n```", &[]);
    }
}
