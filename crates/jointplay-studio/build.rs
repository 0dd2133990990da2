//! Compresses the files that the server sends: the page, and the description of its requests.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::{env, fs};

use flate2::Compression;
use flate2::write::GzEncoder;

/// Files and folders of this crate that are sent, and where.
const SENT: [(&str, &str); 2] = [("openapi.json", "/api/v1/openapi.json"), ("page", "")];

fn main() -> io::Result<()> {
    let folder = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?;
    let folder = PathBuf::from(folder);
    let mut files = Vec::new();
    for (sent, path) in SENT {
        println!("cargo::rerun-if-changed={sent}");
        collect(Path::new(sent), path, &mut files)?;
    }
    files.sort();
    let mut table = String::from("&[\n");
    for (index, (path, file)) in files.iter().enumerate() {
        let compressed = folder.join(format!("{index}.gz"));
        let mut encoder = GzEncoder::new(fs::File::create(&compressed)?, Compression::best());
        encoder.write_all(&fs::read(file)?)?;
        encoder.finish()?;
        writeln!(table, "    ({path:?}, include_bytes!({compressed:?})),")
            .map_err(io::Error::other)?;
    }
    table.push(']');
    fs::write(folder.join("files.rs"), table)
}

/// Adds the path of a file, or those of all files of a folder.
fn collect(from: &Path, path: &str, files: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    if !from.is_dir() {
        files.push((path.to_owned(), from.to_owned()));
        return Ok(());
    }
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        collect(&entry.path(), &format!("{path}/{}", name.to_string_lossy()), files)?;
    }
    Ok(())
}
