//! Who may import whom: the table.

/// Allowed imports of one crate.
pub(super) struct Rule {
    /// The package's name.
    pub(super) name: &'static str,
    /// Its ring, as shown in messages.
    pub(super) ring: &'static str,
    /// Crates of this workspace it may import.
    pub(super) ours: &'static [&'static str],
    /// Libraries from outside it may import.
    pub(super) outside: Outside,
}

/// A choice among the libraries from outside.
#[derive(Clone, Copy)]
pub(super) enum Outside {
    /// These and no other.
    Only(&'static [&'static str]),
    /// Every one but these and their companions: `clap` includes `clap_complete`.
    AllBut(&'static [&'static str]),
}

impl Outside {
    /// Whether the library `name` is in the choice.
    pub(super) fn allows(self, name: &str) -> bool {
        let companion =
            |family: &str| name.strip_prefix(family).is_some_and(|end| end.starts_with(['-', '_']));
        match self {
            Self::Only(names) => names.contains(&name),
            Self::AllBut(names) => !names.iter().any(|family| name == *family || companion(family)),
        }
    }
}

const CORE: &str = "jointplay-core";
const STUDY: &str = "jointplay-study";
const CELL: &str = "jointplay-cell";
const FORMAT: &str = "jointplay-format";
const REPORT: &str = "jointplay-report";
const INTEROP: &str = "jointplay-interop";
const PLOT: &str = "jointplay-plot";
const FACADE: &str = "jointplay";
const STUDIO: &str = "jointplay-studio";
const FILES: &str = "jointplay-files";
const COMMANDS: &str = "jointplay-commands";

/// `zmij` finds the shortest decimal of a number.
const MATHEMATICS: Outside = Outside::Only(&["nalgebra", "thiserror", "pulp", "libm", "zmij"]);
const STUDIES: Outside = Outside::Only(&["rayon", "nalgebra", "thiserror", "chacha20", "libm"]);
/// Jerk-limited profiles and distances of bodies are others' crafts.
const CELLS: Outside =
    Outside::Only(&["nalgebra", "thiserror", "pulp", "rsruckig", "parry3d-f64", "rayon"]);
/// Arguments, catch-all errors and Python belong to ring 4, servers to the studio.
const LIBRARIES: Outside = Outside::AllBut(&["clap", "anyhow", "pyo3", "tokio", "axum"]);
const NONE: Outside = Outside::Only(&[]);
const ANY: Outside = Outside::AllBut(&[]);
const CHORES: Outside = Outside::AllBut(&["clap", "anyhow", "pyo3"]);

const TABLE: [Rule; 18] = [
    Rule { name: CORE, ring: "ring 0", ours: &[], outside: MATHEMATICS },
    Rule { name: STUDY, ring: "ring 1", ours: &[CORE], outside: STUDIES },
    Rule { name: CELL, ring: "ring 1", ours: &[CORE], outside: CELLS },
    Rule { name: FORMAT, ring: "ring 2", ours: &[CORE, STUDY, CELL], outside: LIBRARIES },
    Rule { name: REPORT, ring: "ring 2", ours: &[CORE, STUDY, CELL, FORMAT], outside: LIBRARIES },
    Rule {
        name: INTEROP,
        ring: "ring 2",
        ours: &[CORE, CELL, FORMAT, PLOT, REPORT],
        outside: LIBRARIES,
    },
    Rule { name: PLOT, ring: "ring 2", ours: &[CORE, STUDY, CELL], outside: LIBRARIES },
    Rule {
        name: FACADE,
        ring: "ring 3",
        ours: &[CORE, STUDY, CELL, FORMAT, REPORT, INTEROP, PLOT],
        outside: NONE,
    },
    // One rule for the files that input may name, and for files that are written whole.
    Rule { name: FILES, ring: "ring 4", ours: &[], outside: Outside::Only(&["tempfile"]) },
    // One of the commands starts the studio's server.
    Rule { name: COMMANDS, ring: "ring 4", ours: &[FACADE, FILES, STUDIO], outside: ANY },
    Rule { name: "jointplay-cli", ring: "ring 4", ours: &[COMMANDS], outside: NONE },
    Rule { name: STUDIO, ring: "ring 4", ours: &[FACADE, FILES], outside: ANY },
    // Its package includes the commands.
    Rule {
        name: "jointplay-python",
        ring: "ring 4",
        ours: &[FACADE, FILES, COMMANDS],
        outside: ANY,
    },
    Rule { name: "jointplay-c", ring: "ring 4", ours: &[FACADE], outside: ANY },
    // Without the standard library, which the façade needs.
    Rule { name: "jointplay-wasm", ring: "ring 4", ours: &[CORE], outside: NONE },
    Rule { name: "jointplay-bench", ring: "ring 4", ours: &[FACADE], outside: ANY },
    Rule { name: "jointplay-validation", ring: "ring 4", ours: &[FACADE], outside: ANY },
    Rule { name: "xtask", ring: "outside the rings", ours: &[], outside: CHORES },
];

/// The rule for a package, if the table has one.
pub(super) fn rule(name: &str) -> Option<&'static Rule> {
    TABLE.iter().find(|rule| rule.name == name)
}

/// Names, as code writes them, of our crates that ring 4 may not import.
pub(super) fn crates_below_facade() -> impl Iterator<Item = String> {
    let below = TABLE.iter().filter(|rule| matches!(rule.ring, "ring 0" | "ring 1" | "ring 2"));
    below.map(|rule| rule.name.replace('-', "_"))
}
