//! No tracked or new file is large.

use crate::finding::Finding;
use crate::tree::{MAX_SIZE, Tree};

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let large = tree.files().filter(|(_, file)| file.size > MAX_SIZE);
    let message = |size: u64| format!("{size} bytes, more than {MAX_SIZE}");
    large.map(|(path, file)| Finding::new(path, 1, message(file.size))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_megabyte_is_the_most() {
        let (most, more) = ("a".repeat(1_000_000), "a".repeat(1_000_001));
        let found = check(&Tree::of(&[("most.csv", &most), ("more.csv", &more)]));
        assert_eq!(found.iter().map(|f| f.path.as_str()).collect::<Vec<_>>(), ["more.csv"]);
    }
}
