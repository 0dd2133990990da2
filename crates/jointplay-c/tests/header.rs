//! The header is generated from the source, and the declarations for other languages agree with it.
#![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

fn read(path: &str) -> String {
    let path = Path::new(FOLDER).join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn generated() -> String {
    let configuration = cbindgen::Config::from_file(Path::new(FOLDER).join("cbindgen.toml"));
    let mut builder = cbindgen::Builder::new().with_config(configuration.unwrap());
    for name in ["status", "text", "virtualization", "robot", "mechanism"] {
        builder = builder.with_src(Path::new(FOLDER).join("src").join(name).with_extension("rs"));
    }
    let mut bytes = Vec::new();
    builder.generate().unwrap().write(&mut bytes);
    // The section of Rust's documentation that lists what callers have to ensure.
    String::from_utf8(bytes).unwrap().replace(" # Safety\n", " Arguments:\n")
}

/// `INSTA_UPDATE=always cargo test -p jointplay-c` writes the header.
#[test]
fn the_header_is_that_of_the_source() {
    let header = generated();
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        fs::write(Path::new(FOLDER).join("include/jointplay.h"), &header).unwrap();
    }
    let advice = "write it by `INSTA_UPDATE=always cargo test -p jointplay-c`";
    assert!(read("include/jointplay.h") == header, "include/jointplay.h is stale: {advice}");
}

/// Type of a result or an argument, independent of the language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Nothing,
    Int,
    Size,
    Double,
    /// A handle, a text, or numbers to read or write.
    Pointer,
}

/// Result and arguments by the name of the function.
type Functions = BTreeMap<String, (Type, Vec<Type>)>;

/// The text between two marks, and what follows the second.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<(&'a str, &'a str)> {
    let start = text.find(from)? + from.len();
    let end = start + text[start..].find(to)?;
    Some((&text[start..end], &text[end + to.len()..]))
}

fn arguments(list: &str, of: impl Fn(&str) -> Type) -> Vec<Type> {
    let listed = list.split(',').map(str::trim).filter(|one| !one.is_empty() && *one != "void");
    listed.map(of).collect()
}

fn in_header(header: &str) -> Functions {
    let of = |declared: &str| match declared {
        pointer if pointer.contains('*') => Type::Pointer,
        text if text.starts_with("int32_t") => Type::Int,
        text if text.starts_with("size_t") => Type::Size,
        text if text.starts_with("double") => Type::Double,
        text if text.starts_with("void") => Type::Nothing,
        other => panic!("unknown type: {other}"),
    };
    let mut functions = Functions::new();
    // Comments have no declarations.
    let mut code = String::new();
    let mut rest = header;
    while let Some(start) = rest.find("/*") {
        code += &rest[..start];
        rest = &rest[start..][rest[start..].find("*/").unwrap() + 2..];
    }
    code += rest;
    for declaration in code.split(';') {
        let Some(open) = declaration.find('(').filter(|_| declaration.contains("jp_")) else {
            continue;
        };
        let name = declaration[declaration.find("jp_").unwrap()..open].to_owned();
        let before = declaration[..declaration.find("jp_").unwrap()].trim();
        let result = before.lines().last().unwrap().trim();
        let list = &declaration[open + 1..declaration.rfind(')').unwrap()];
        functions.insert(name, (of(result), arguments(list, of)));
    }
    functions
}

fn in_csharp(source: &str) -> Functions {
    let of = |declared: &str| {
        let declared = declared.trim_start_matches("[In]").trim_start_matches("[Out]");
        let declared = declared.trim_start_matches("[In, Out]").trim();
        match declared.rsplit_once(' ').map_or(declared, |(kind, _)| kind) {
            "int" => Type::Int,
            "UIntPtr" => Type::Size,
            "double" => Type::Double,
            "void" => Type::Nothing,
            "IntPtr" | "out IntPtr" | "byte[]" | "double[]" | "int[]" => Type::Pointer,
            other => panic!("unknown type: {other}"),
        }
    };
    let mut functions = Functions::new();
    let mut rest = source;
    while let Some((declaration, after)) = between(rest, "static extern ", ";") {
        let (head, list) = declaration.split_once('(').unwrap();
        let (result, name) = head.rsplit_once(' ').unwrap();
        let list = list.trim_end_matches(')').replace("[In, Out]", "");
        let previous = functions.insert(name.to_owned(), (of(result), arguments(&list, of)));
        assert_eq!(previous, None, "{name} is declared twice");
        rest = after;
    }
    functions
}

fn in_vba(source: &str) -> Functions {
    let of = |declared: &str| {
        let kind = declared.rsplit(" As ").next().unwrap().trim();
        match (kind, declared.starts_with("ByVal ")) {
            ("Long", true) => Type::Int,
            ("Double", true) => Type::Double,
            ("LongPtr", true) if declared.starts_with("ByVal size") => Type::Size,
            ("LongPtr", true) => Type::Pointer,
            ("Long" | "Double" | "LongPtr" | "Byte", false) => Type::Pointer,
            other => panic!("unknown type: {other:?} in {declared}"),
        }
    };
    let source = source.replace(" _\n", " ");
    let mut functions = Functions::new();
    for line in source.lines().filter(|line| line.contains("Declare PtrSafe")) {
        let (head, rest) = line.split_once(" Lib \"jointplay.dll\" (").unwrap();
        let (list, result) = rest.rsplit_once(')').unwrap();
        let (kind, name) = head.rsplit_once(' ').unwrap();
        let result = match (kind.ends_with("Sub"), result.trim()) {
            (true, "") => Type::Nothing,
            (false, "As Long") => Type::Int,
            (false, "As Double") => Type::Double,
            (false, "As LongPtr") if name.ends_with("_name") || name == "jp_version" => {
                Type::Pointer
            }
            (false, "As LongPtr") => Type::Size,
            other => panic!("unknown result of {name}: {other:?}"),
        };
        functions.insert(name.to_owned(), (result, arguments(list, of)));
    }
    functions
}

#[test]
fn declarations_of_csharp_and_vba_agree_with_the_header() {
    let header = in_header(&read("include/jointplay.h"));
    assert!(header.len() > 20, "{} functions", header.len());
    assert_eq!(header["jp_robot_working_height"], (Type::Double, vec![Type::Pointer]));
    assert_eq!(in_csharp(&read("bindings/Jointplay.cs")), header);
    assert_eq!(in_vba(&read("bindings/Jointplay.bas")), header);
}

/// Constants of the header have the same values in the other languages.
#[test]
fn constants_agree_with_the_header() {
    let (csharp, vba) = (read("bindings/Jointplay.cs"), read("bindings/Jointplay.bas"));
    let header = read("include/jointplay.h");
    let mut count = 0;
    for line in header.lines().filter(|line| line.starts_with("#define JP_")) {
        let (name, value) = line["#define ".len()..].split_once(' ').unwrap();
        assert!(csharp.contains(&format!("{name} = {value}")), "C#: {name}");
        assert!(vba.contains(&format!("{name} As Long = {value}")), "VBA: {name}");
        count += 1;
    }
    assert_eq!(count, 9);
}
