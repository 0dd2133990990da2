//! `cargo xtask interface`: whether the public interface of the libraries is the recorded one.
//!
//! Items, their declarations, methods and implemented traits are taken from the pages of rustdoc, one a line, so that a change of them is a readable difference.
//! With `--update`, the files in `xtask/interface` are written; the format is that of rustdoc, so they also change with the compiler.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use crate::process;

/// Folder of the recorded interfaces.
const FOLDER: &str = "xtask/interface";

/// Libraries whose interface is recorded: those that Rust programs depend on.
const CRATES: [&str; 8] = [
    "jointplay",
    "jointplay-cell",
    "jointplay-core",
    "jointplay-format",
    "jointplay-interop",
    "jointplay-plot",
    "jointplay-report",
    "jointplay-study",
];

/// Most differences that are printed for a library.
const SHOWN: usize = 20;

/// Compares or writes the interfaces of the workspace at `root`; true if all are as recorded.
pub(crate) fn run(root: &Path, update: bool) -> bool {
    let found = document(root).and_then(|()| {
        CRATES.iter().map(|name| compared(root, name, update)).collect::<io::Result<Vec<_>>>()
    });
    match found {
        Ok(all) => all.into_iter().all(|same| same),
        Err(error) => {
            eprintln!("interface: {error}");
            false
        }
    }
}

/// Makes the pages, as `cargo xtask test` makes them.
fn document(root: &Path) -> io::Result<()> {
    let mut doc = process::cargo();
    doc.args(["doc", "--quiet", "--workspace", "--all-features", "--no-deps"]).current_dir(root);
    process::succeed(doc.env("RUSTDOCFLAGS", "-D warnings"))
}

/// Whether the interface of a library is as recorded; prints the differences, or writes it.
fn compared(root: &Path, name: &str, update: bool) -> io::Result<bool> {
    let pages = process::target(root).join("doc").join(name.replace('-', "_"));
    let present = interface(&pages)?;
    let file = root.join(FOLDER).join(format!("{name}.txt"));
    let lines = present.lines().count();
    if update {
        fs::create_dir_all(root.join(FOLDER))?;
        fs::write(file, &present)?;
        println!("interface: {name}: {lines} lines written");
        return Ok(true);
    }
    let recorded = fs::read_to_string(&file)
        .map_err(|error| io::Error::other(format!("{}: {error}", file.display())))?;
    let differences = differences(&recorded, &present);
    for line in differences.iter().take(SHOWN) {
        println!("interface: {name}: {line}");
    }
    if differences.len() > SHOWN {
        println!("interface: {name}: and {} more", differences.len() - SHOWN);
    }
    if differences.is_empty() {
        println!("interface: {name}: {lines} lines as recorded");
    } else {
        println!("interface: run `cargo xtask interface --update`, and read the difference");
    }
    Ok(differences.is_empty())
}

/// Lines that only one of two interfaces has.
fn differences(recorded: &str, present: &str) -> Vec<String> {
    let (old, new): (BTreeSet<&str>, BTreeSet<&str>) =
        (recorded.lines().collect(), present.lines().collect());
    let removed = old.difference(&new).map(|line| format!("removed: {line}"));
    removed.chain(new.difference(&old).map(|line| format!("added: {line}"))).collect()
}

/// The interface of a library by its pages, a line for each declaration, method and implemented trait.
fn interface(pages: &Path) -> io::Result<String> {
    let index = fs::read_to_string(pages.join("all.html"))?;
    let list = index.split("class=\"all-items\"").skip(1);
    let links = list.flat_map(|list| {
        let list = list.split("</ul>").next().unwrap_or_default();
        list.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next())
    });
    let mut out = String::new();
    for link in links.collect::<BTreeSet<_>>() {
        let page = fs::read_to_string(pages.join(link))?;
        let module = link.rsplit_once('/').map_or("", |(module, _)| module).replace('/', "::");
        let lines = declarations(&page);
        if lines.is_empty() {
            return Err(io::Error::other(format!("{link} has no declaration that is known here")));
        }
        for line in lines {
            let _ = writeln!(out, "{module}: {line}");
        }
    }
    Ok(out)
}

/// The declaration of an item on its page, its methods and its traits.
fn declarations(page: &str) -> Vec<String> {
    let mut lines: Vec<String> =
        between(page, "<pre class=\"rust item-decl\"><code>", "</code></pre>");
    // Implementations that the compiler derives for all types are excluded.
    let written = page.split("id=\"synthetic-implementations\"").next().unwrap_or(page);
    let written = written.split("id=\"blanket-implementations\"").next().unwrap_or(written);
    let (own, traits) = match written.split_once("id=\"trait-implementations\"") {
        Some((own, traits)) => (own, traits),
        None => (written, ""),
    };
    // Methods of another type, such as those of slices, change with the compiler.
    let own = own.split("id=\"deref-methods").next().unwrap_or(own);
    let own = own.split_once("id=\"implementations\"").map_or("", |(_, own)| own);
    lines.extend(between(own, "<h4 class=\"code-header\">", "</h4>"));
    let traits = between(traits, "<h3 class=\"code-header\">", "</h3>");
    lines.extend(traits);
    lines
}

/// Texts between two marks, without markup.
fn between(page: &str, start: &str, end: &str) -> Vec<String> {
    let parts = page.split(start).skip(1).filter_map(|rest| rest.split(end).next());
    parts.map(|part| without_content(text(part))).collect()
}

/// A declaration without the content of a constant text of several lines, such as an example file: programs depend on its name and type.
fn without_content(declaration: String) -> String {
    match declaration.split_once(": &str = ") {
        Some((named, content)) if content.contains("\\n") => format!("{named}: &str;"),
        _ => declaration,
    }
}

/// The text of a piece of a page on one line, without the titles of long lists, such as "Show 13 variants".
fn text(html: &str) -> String {
    let mut out = String::new();
    let mut is_markup = false;
    let untitled: String = html
        .split("<summary")
        .enumerate()
        .map(|(number, part)| match part.split_once("</summary>") {
            Some((_, after)) if number > 0 => after,
            _ => part,
        })
        .collect();
    for c in untitled.chars() {
        match c {
            '<' => is_markup = true,
            '>' => is_markup = false,
            // The sign of a note about traits.
            'ⓘ' => {}
            _ if is_markup => {}
            _ => out.push(c),
        }
    }
    for (entity, sign) in [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&nbsp;", " "),
        ("&amp;", "&"),
    ] {
        out = out.replace(entity, sign);
    }
    out.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "<pre class=\"rust item-decl\"><code>pub struct A&lt;T&gt; {\n    pub <b>x</b>: f64,\n}</code></pre>\
        <h2 id=\"implementations\"><h3 class=\"code-header\">impl A</h3><h4 class=\"code-header\">pub fn <a>new</a>() -&gt; Self <a>ⓘ</a></h4>\
        <h2 id=\"deref-methods-%5BT%5D\"><h4 class=\"code-header\">pub fn len(&amp;self) -&gt; usize</h4>\
        <h2 id=\"trait-implementations\"><h3 class=\"code-header\">impl Clone for A</h3><h4 class=\"code-header\">fn clone(&amp;self) -&gt; Self</h4>\
        <h2 id=\"synthetic-implementations\"><h3 class=\"code-header\">impl Send for A</h3>";

    #[test]
    fn a_page_is_read_as_declaration_methods_and_traits() {
        let expect =
            ["pub struct A<T> { pub x: f64, }", "pub fn new() -> Self", "impl Clone for A"];
        assert_eq!(declarations(PAGE), expect);
    }

    #[test]
    fn the_content_of_a_file_is_no_interface_but_a_value_is() {
        let page = |item| format!("<pre class=\"rust item-decl\"><code>{item}</code></pre>");
        let example =
            page("pub const EXAMPLE: &amp;str = &quot;kind = \\&quot;cell\\&quot;\\n&quot;;");
        assert_eq!(declarations(&example), ["pub const EXAMPLE: &str;"]);
        for value in ["pub const MOST: usize = 240;", "pub const KIND: &str = \"hybrid\";"] {
            assert_eq!(declarations(&page(value)), [value]);
        }
    }

    #[test]
    fn a_long_list_has_no_title() {
        let list = "pub enum A {<details><summary class=\"hideme\"><span>Show 13 variants</span></summary> B,\n</details>}";
        assert_eq!(text(list), "pub enum A { B, }");
    }

    #[test]
    fn removed_and_added_lines_are_reported() {
        let found = differences("m: a\nm: b\n", "m: b\nm: c\n");
        assert_eq!(found, ["removed: m: a", "added: m: c"]);
        assert!(differences("a", "a").is_empty());
    }

    #[test]
    fn pages_of_an_unknown_form_are_an_error() {
        let folder = std::env::temp_dir().join(format!("xtask-interface-{}", std::process::id()));
        fs::create_dir_all(folder.join("m")).unwrap();
        let index = "<ul class=\"all-items\"><li><a href=\"m/struct.A.html\">A</a></li></ul>";
        fs::write(folder.join("all.html"), index).unwrap();
        fs::write(folder.join("m/struct.A.html"), PAGE).unwrap();
        let found = interface(&folder).unwrap();
        fs::write(folder.join("m/struct.A.html"), "another form").unwrap();
        let refused = interface(&folder).unwrap_err().to_string();
        fs::remove_dir_all(&folder).unwrap();
        assert!(found.starts_with("m: pub struct A<T>") && found.lines().count() == 3, "{found}");
        assert!(refused.contains("m/struct.A.html"), "{refused}");
    }
}
