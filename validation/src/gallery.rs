//! `docs/reference/catalogue.md`: every mechanism of the catalogue, its picture and its numbers.

use std::error::Error;
use std::fmt::Write as _;

use jointplay::format::catalogue::{self, Entry};
use jointplay::format::mechanism::{MechanismFile, kind_of, parse};
use jointplay::mechanism::{assemble, guess};
use jointplay::plot::MechanismPicture;

/// Text above the list.
const HEAD: &str = "\
# Catalogue of mechanisms

For users who need a mechanism to start from, or a known result to compare with: this page lists all mechanisms that are included.
`jointplay catalogue` prints the same list, and each name can be used in place of a mechanism file.

```sh
jointplay draw bennett --figure bennett.svg
jointplay draw four-bar --at A=30 --ghost A=120 --figure four-bar.png
jointplay mobility bennett
jointplay catalogue copy bennett my-mechanisms
```

In the pictures, the base is hatched, actuated joints are orange, and virtual joints are purple.
A sleeve is a revolute joint, a sleeve with a shaft through it a cylindrical joint, a block on a rail a prismatic joint, a ball a spherical joint, and a cross a universal joint.
Each file names its source by a key of [REFERENCES.md](../../REFERENCES.md); dimensions that the source does not give are invented.

`cargo run -p jointplay-validation --bin figures` generates this page and its pictures.
Tests compare the numbers with those of the program and with those of an independent program.

- f: the sum of the freedoms of all joints.
- rank: the rank of the constraint Jacobian.
- Kutzbach, instantaneous, finite: the three [mobilities](../explanation/mobility.md).
- redundancy: the number of redundant loop equations.
";

/// The mechanism files of the catalogue.
///
/// # Panics
/// If one of them cannot be read.
#[must_use]
pub fn mechanisms() -> Vec<(&'static Entry, MechanismFile)> {
    let of_mechanisms = catalogue::entries()
        .iter()
        .filter(|entry| kind_of(entry.text).as_deref() == Some("mechanism"));
    of_mechanisms
        .map(|entry| (entry, parse(entry.text).expect("files that are included")))
        .collect()
}

/// The picture of a mechanism, without a title: the page has one.
///
/// # Errors
/// Those of [`assemble`].
pub fn picture(file: &MechanismFile) -> Result<MechanismPicture<'_>, jointplay::Error> {
    let mechanism = &file.mechanism;
    let closed = assemble(mechanism, &guess(mechanism), &[], 0)?.coordinates;
    Ok(MechanismPicture::new(mechanism, closed).with_title("").with_width(560.0))
}

/// The page as Markdown.
///
/// # Errors
/// None but those of writing into memory.
pub fn page() -> Result<String, Box<dyn Error>> {
    let mechanisms = mechanisms();
    let mut page = format!(
        "{HEAD}\n| name | mechanism | f | rank | Kutzbach | instantaneous | finite | redundancy |\n"
    );
    page.push_str("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (entry, file) in &mechanisms {
        let (name, what) = (entry.name, file.mechanism.name());
        writeln!(page, "| [`{name}`](#{name}) | {what} | {} |", cells(file).join(" | "))?;
    }
    for (entry, file) in &mechanisms {
        let (name, what) = (entry.name, file.mechanism.name());
        writeln!(page, "\n## {name}\n\n![{what}](../figures/catalogue/{name}.svg)\n")?;
        writeln!(page, "{}", description(entry))?;
        if let Some(note) = &file.expected.note {
            writeln!(page, "{note}")?;
        }
        if let Some(source) = &file.source {
            writeln!(page, "Source: {source}.")?;
        }
        let [f, rank, kutzbach, first, real, redundancy] = cells(file);
        writeln!(
            page,
            "f = {f}, rank {rank}; mobility: Kutzbach {kutzbach}, instantaneous {first}, finite {real}; redundancy {redundancy}."
        )?;
    }
    Ok(page)
}

/// The first sentence of the comment at the head of a file.
fn description(entry: &Entry) -> String {
    let comment = entry.text.lines().map_while(|line| line.strip_prefix('#'));
    let text = comment.map(str::trim).collect::<Vec<_>>().join(" ");
    match text.split_once(". ") {
        Some((sentence, _)) => format!("{sentence}."),
        None => text,
    }
}

/// Freedoms, rank, the three mobilities, redundancy.
fn cells(file: &MechanismFile) -> [String; 6] {
    let expected = &file.expected;
    let number = |value: Option<usize>| value.map_or("–".to_owned(), |value| value.to_string());
    [
        number(expected.freedoms),
        number(expected.rank),
        expected.kutzbach.map_or("–".to_owned(), |value| value.to_string().replace('-', "−")),
        number(expected.instantaneous),
        number(expected.finite),
        number(expected.redundancy),
    ]
}
