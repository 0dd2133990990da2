//! Has the crate built anew when the page has been.

#![expect(clippy::print_stdout, reason = "cargo is spoken to by printing")]

fn main() {
    // A folder that is not there counts as changed each time: until it appears, what it appears in is watched.
    let (page, around) = ("../../studio/dist", "../../studio");
    let built = std::path::Path::new(page).is_dir();
    println!("cargo::rerun-if-changed={}", if built { page } else { around });
}
