//! Names of the files of a part.

use crate::study_table::TableKind;

/// Extension of records.
const RECORD: &str = "json";

/// Names of the files of a part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartNames {
    /// Its table.
    pub table: String,
    /// Its record.
    pub record: String,
}

impl PartNames {
    /// Of a part.
    #[must_use]
    pub fn of(part: u64, kind: TableKind) -> Self {
        let name = |ending: &str| format!("part-{part:06}.{ending}");
        Self { table: name(kind.ending()), record: name(RECORD) }
    }

    /// The number of the part whose record has this name; `None` for any other name.
    #[must_use]
    pub fn part_of_record(name: &str) -> Option<u64> {
        let digits = name.strip_prefix("part-")?.strip_suffix(RECORD)?.strip_suffix('.')?;
        let part =
            digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())??;
        (Self::of(part, TableKind::Csv).record == name).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_recognised_by_their_names() {
        for part in [0, 17, 999_999, 1_000_000, u64::MAX] {
            let names = PartNames::of(part, TableKind::Parquet);
            assert_eq!(PartNames::part_of_record(&names.record), Some(part));
            assert_eq!(PartNames::part_of_record(&names.table), None);
        }
        for other in ["study.json", "part-17.json", "part-+00017.json", "part-000017.json.new", ""]
        {
            assert_eq!(PartNames::part_of_record(other), None, "{other}");
        }
    }
}
