//! Licences and notices of the libraries in our binaries, as one text.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use super::components::Component;

/// The licence text where a package that is under the MIT licence has none of its own.
const MIT: &str = include_str!("mit.txt");

/// The text of all licences and notices; packages with the same text are listed together.
///
/// # Errors
/// If a file cannot be read, or a package has no licence text and none of the licences that are known here.
pub(super) fn text(components: &[Component], root: &Path) -> io::Result<String> {
    let apache = fs::read_to_string(root.join("LICENSE-APACHE"))?;
    let mut packages: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for component in components {
        for text in texts(component, &apache)? {
            let line = format!(
                "{} {} ({}) {}",
                component.name, component.version, component.licence, component.repository
            );
            packages.entry(text).or_default().push(line.trim_end().to_owned());
        }
    }
    let font = root.join("crates/jointplay-plot/fonts/LICENSE-DejaVu.txt");
    packages
        .entry(tidied(&fs::read_to_string(font)?))
        .or_default()
        .push("DejaVu Sans (font)".to_owned());
    let mut sections: Vec<(Vec<String>, String)> =
        packages.into_iter().map(|(text, names)| (names, text)).collect();
    sections.sort();
    let mut all =
        "Third-party software in the binaries of jointplay, and its licences.\n".to_owned();
    for (names, text) in sections {
        let rule = "=".repeat(80);
        all += &format!("\n{rule}\n{}\n{rule}\n\n{text}\n", names.join("\n"));
    }
    Ok(all)
}

/// The licence texts of one package: of its choice of licences those that we take.
fn texts(component: &Component, apache: &str) -> io::Result<Vec<String>> {
    let is_choice = !component.licence.contains(" AND ");
    let named = |file: &Path, word: &str| {
        file.file_name().unwrap_or_default().to_string_lossy().to_uppercase().contains(word)
    };
    let takes_mit = is_choice && component.files.iter().any(|file| named(file, "MIT"));
    let taken = component.files.iter().filter(|file| {
        !takes_mit || ["MIT", "NOTICE", "COPYRIGHT"].iter().any(|word| named(file, word))
    });
    let read = |file: &std::path::PathBuf| Ok(tidied(&String::from_utf8_lossy(&fs::read(file)?)));
    let found: Vec<String> = taken.map(read).collect::<io::Result<_>>()?;
    if !found.is_empty() {
        return Ok(found);
    }
    let mut words = component.licence.split(" OR ").map(|word| word.trim_matches(['(', ')']));
    match words.find(|word| ["MIT", "Apache-2.0"].contains(word)) {
        Some("MIT") => Ok(vec![tidied(MIT)]),
        Some(_) => Ok(vec![tidied(apache)]),
        None => Err(io::Error::other(format!(
            "{} has no licence text, and is under {}",
            component.name, component.licence
        ))),
    }
}

/// The text with one kind of line end, and without blanks at ends of lines.
fn tidied(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_matches('\n').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn component(name: &str, licence: &str, files: &[PathBuf]) -> Component {
        Component {
            registry: "cargo",
            name: name.to_owned(),
            version: "1.0.0".to_owned(),
            licence: licence.to_owned(),
            repository: String::new(),
            checksum: None,
            files: files.to_vec(),
        }
    }

    #[test]
    fn one_licence_of_a_choice_is_taken_and_all_of_a_conjunction() {
        let root = std::env::temp_dir().join(format!("xtask-notices-{}", std::process::id()));
        fs::create_dir_all(&root).unwrap();
        let write = |name: &str, text: &str| {
            fs::write(root.join(name), text).unwrap();
            root.join(name)
        };
        let files = [
            write("LICENSE-MIT", "mit  \r\n"),
            write("LICENSE-APACHE", "apache"),
            write("NOTICE", "notice"),
        ];
        let check = |licence: &str, files: &[PathBuf], expect: &[&str]| {
            assert_eq!(
                texts(&component("a", licence, files), "Apache\n").unwrap(),
                expect,
                "{licence}"
            );
        };
        check("MIT OR Apache-2.0", &files, &["mit", "notice"]);
        check("MIT AND Apache-2.0", &files, &["mit", "apache", "notice"]);
        check("Apache-2.0", &files[1..2], &["apache"]);
        check("Apache-2.0", &[], &["Apache"]);
        check("Zlib OR MIT", &[], &[tidied(MIT).as_str()]);
        let unknown = texts(&component("a", "GPL-3.0", &[]), "").unwrap_err().to_string();
        assert_eq!(unknown, "a has no licence text, and is under GPL-3.0");
        fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn packages_with_the_same_text_are_listed_together() {
        let all = [component("b", "MIT", &[]), component("a", "MIT", &[])];
        let text = text(&all, &crate::root::find()).unwrap();
        assert!(text.contains("\nb 1.0.0 (MIT)\na 1.0.0 (MIT)\n"), "{text}");
        assert_eq!(text.matches("MIT License\n\nPermission is hereby").count(), 1);
        assert!(text.contains("DejaVu Sans (font)") && text.contains("Bitstream"));
    }
}
