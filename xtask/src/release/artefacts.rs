//! The files of a release: their checksums, and where they would be uploaded.

use std::path::PathBuf;
use std::{fs, io};

use sha2::{Digest as _, Sha256};

use super::place::Place;
use super::program::file_name;

/// The list of checksums, as `sha256sum --check` reads it.
const CHECKSUMS: &str = "SHA256SUMS";

/// Writes the checksums of all files and prints them with sizes and destinations.
pub(super) fn list(place: &Place) -> io::Result<()> {
    let mut files: Vec<PathBuf> =
        place.out.read_dir()?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    files.retain(|file| file.is_file() && file_name(file) != CHECKSUMS);
    files.sort();
    let mut sums = String::new();
    println!("\n{:<64} {:>12}  destination", "file", "bytes");
    for file in &files {
        let bytes = fs::read(file)?;
        let name = file_name(file);
        sums += &format!("{}  {name}\n", hexadecimal(&Sha256::digest(&bytes)));
        println!("{name:<64} {:>12}  {}", bytes.len(), destination(&name));
    }
    fs::write(place.out.join(CHECKSUMS), sums)?;
    println!(
        "\nrelease: {} files and {CHECKSUMS} in {}; nothing was uploaded",
        files.len(),
        place.out.display()
    );
    Ok(())
}

/// Where a file is uploaded by a release.
fn destination(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("crate") => "Cargo registry",
        Some("whl") => "Python registry",
        Some("gz") if !name.contains("-unknown-") && !name.contains("-vendored") => {
            "Python registry"
        }
        _ => "release page",
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_and_destinations_of_files() {
        let root = std::env::temp_dir().join(format!("xtask-artefacts-{}", std::process::id()));
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join("a.whl"), "abc").unwrap();
        let place = Place {
            root: root.clone(),
            out: root.clone(),
            work: root.clone(),
            time: String::new(),
        };
        list(&place).unwrap();
        list(&place).unwrap();
        let sums = fs::read_to_string(root.join(CHECKSUMS)).unwrap();
        fs::remove_dir_all(&root).unwrap();
        // FIPS 180-2, B.1.
        let expect = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sums, format!("{expect}  a.whl\n"));
        assert_eq!(destination("jointplay-0.1.0.tar.gz"), "Python registry");
        assert_eq!(destination("jointplay-0.1.0-x86_64-unknown-linux-gnu.tar.gz"), "release page");
        assert_eq!(destination("jointplay_0.1.0_amd64.deb"), "release page");
    }
}
