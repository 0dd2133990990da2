//! An archive, a document or an assembly of FreeCAD never panics; one that is imported is written as the same mechanism.

#![no_main]

use std::io::Cursor;

use jointplay::format::mechanism::{self, LengthUnit};
use jointplay::interop::import::{self, document_text};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = match import::is_archive(bytes) {
        true => document_text(Cursor::new(bytes)).ok(),
        false => String::from_utf8(bytes.to_vec()).ok(),
    };
    let Some(text) = text else { return };
    match import::parse_with_unit(&text, LengthUnit::Millimeter) {
        Ok(model) => {
            let written = mechanism::write(&model.mechanism, None);
            let read = mechanism::parse(&written).map_err(|error| error.with_excerpt("written"));
            let read = read.unwrap_or_else(|message| panic!("{message}")).mechanism;
            assert_eq!(read.joint_freedoms(), model.mechanism.joint_freedoms());
            assert_eq!(read.loops(), model.mechanism.loops());
            assert_eq!(read.couplings().len(), model.mechanism.couplings().len());
        }
        Err(error) => drop(error.with_excerpt("assembly")),
    }
});
