//! `modelDescription.xml`.

use super::instance::Fmu;
use super::variable::{Causality, Variable, is_structured};
use crate::export::mechanism::xml::{Xml, number};

/// Versions of the Functional Mock-up Interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0
    V2,
    /// FMI 3.0
    V3,
}

/// Categories of log messages.
const CATEGORIES: [(&str, &str); 3] = [
    ("logStatusDiscard", "steps without a solution"),
    ("logStatusError", "invalid calls and values"),
    ("logStatusFatal", "errors of the library itself"),
];

/// The description of a unit.
///
/// # Arguments
/// * `name` – name of the model
/// * `identifier` – name of the libraries, see [`super::model_identifier`]
///
/// # Source
/// \[FMI2\], section 2.2; \[FMI3\], section 2.4
#[must_use]
pub fn model_description(fmu: &Fmu, name: &str, identifier: &str, version: FmiVersion) -> String {
    let mut xml = Xml::new();
    let named = |name: &'static str, value: &str| (name, value.to_owned());
    let structured = fmu.variables().iter().all(|one| is_structured(&one.name));
    let (number_of_version, token) = match version {
        FmiVersion::V2 => ("2.0", "guid"),
        FmiVersion::V3 => ("3.0", "instantiationToken"),
    };
    xml.open(
        "fmiModelDescription",
        &[
            named("fmiVersion", number_of_version),
            named("modelName", name),
            named(token, fmu.token()),
            named(
                "description",
                "positions with loops closed and virtual joints at their least displacement",
            ),
            named("generationTool", concat!("jointplay ", env!("CARGO_PKG_VERSION"))),
            named("variableNamingConvention", if structured { "structured" } else { "flat" }),
        ],
    );
    let yes = |name: &'static str| named(name, "true");
    let common =
        [named("modelIdentifier", identifier), yes("canHandleVariableCommunicationStepSize")];
    let of_version = match version {
        FmiVersion::V2 => [
            yes("canGetAndSetFMUstate"),
            yes("canSerializeFMUstate"),
            yes("providesDirectionalDerivative"),
            yes("canNotUseMemoryManagementFunctions"),
        ]
        .to_vec(),
        FmiVersion::V3 => [
            yes("canGetAndSetFMUState"),
            yes("canSerializeFMUState"),
            yes("providesDirectionalDerivatives"),
        ]
        .to_vec(),
    };
    xml.empty("CoSimulation", &[&common[..], &of_version[..]].concat());
    xml.open("UnitDefinitions", &[]);
    for unit in ["m", "rad"] {
        xml.open("Unit", &[named("name", unit)]);
        xml.empty("BaseUnit", &[(unit, "1".to_owned())]);
        xml.close();
    }
    xml.close();
    xml.open("LogCategories", &[]);
    for (name, description) in CATEGORIES {
        xml.empty("Category", &[named("name", name), named("description", description)]);
    }
    xml.close();
    xml.empty("DefaultExperiment", &[named("startTime", "0"), named("stepSize", "0.001")]);
    xml.open("ModelVariables", &[]);
    if version == FmiVersion::V3 {
        xml.empty(
            "Float64",
            &[
                named("name", "time"),
                named("valueReference", "0"),
                named("causality", "independent"),
                named("variability", "continuous"),
                named("description", "time of the simulation"),
            ],
        );
    }
    for variable in fmu.variables() {
        write_variable(&mut xml, variable, version);
    }
    xml.close();
    let outputs = fmu.variables().iter().filter(|one| one.causality == Causality::Output);
    // By default each output depends on all inputs.
    match version {
        FmiVersion::V2 => {
            xml.open("ModelStructure", &[]);
            for list in ["Outputs", "InitialUnknowns"] {
                xml.open(list, &[]);
                for output in outputs.clone() {
                    // The first variable has the reference 1, and the index 1.
                    xml.empty("Unknown", &[("index", output.reference.to_string())]);
                }
                xml.close();
            }
            xml.close();
        }
        FmiVersion::V3 => {
            xml.open("ModelStructure", &[]);
            for tag in ["Output", "InitialUnknown"] {
                for output in outputs.clone() {
                    xml.empty(tag, &[("valueReference", output.reference.to_string())]);
                }
            }
            xml.close();
        }
    }
    xml.close();
    xml.text
}

fn write_variable(xml: &mut Xml, variable: &Variable, version: FmiVersion) {
    let Variable { name, reference, causality, quantity, description, start, limits } = variable;
    let causality = match causality {
        Causality::Input => "input",
        Causality::Output => "output",
    };
    let attributes = [
        ("name", name.clone()),
        ("valueReference", reference.to_string()),
        ("causality", causality.to_owned()),
        ("variability", "continuous".to_owned()),
        ("description", description.clone()),
    ];
    let mut of_type = Vec::new();
    of_type.extend(quantity.unit().map(|unit| ("unit", unit.to_owned())));
    if let Some([least, greatest]) = limits {
        let ends = [("min", *least), ("max", *greatest)].into_iter();
        let finite = ends.filter(|(_, end)| end.is_finite());
        of_type.extend(finite.map(|(name, end)| (name, number(end))));
    }
    of_type.extend(start.map(|value| ("start", number(value))));
    match version {
        FmiVersion::V2 => {
            xml.open("ScalarVariable", &attributes);
            xml.empty("Real", &of_type);
            xml.close();
        }
        FmiVersion::V3 => xml.empty("Float64", &[&attributes[..], &of_type[..]].concat()),
    }
}
