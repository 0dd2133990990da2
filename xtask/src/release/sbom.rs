//! The list of libraries in our binaries, in the format CycloneDX.

use serde_json::{Value, json};

use super::components::Component;

/// The software bill of materials of a release; the same components give the same text.
pub(super) fn document(components: &[Component], version: &str) -> String {
    let own = format!("pkg:cargo/jointplay-cli@{version}");
    let document = json!({
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": { "component": {
            "type": "application",
            "bom-ref": own,
            "name": "jointplay",
            "version": version,
            "purl": own,
            "licenses": [{ "expression": "MIT OR Apache-2.0" }],
        }},
        "components": components.iter().map(component).collect::<Vec<_>>(),
        "dependencies": [{
            "ref": own,
            "dependsOn": components.iter().map(Component::url).collect::<Vec<_>>(),
        }],
    });
    format!("{document:#}\n")
}

fn component(component: &Component) -> Value {
    let url = component.url();
    let mut value = json!({
        "type": "library",
        "bom-ref": url,
        "name": component.name,
        "version": component.version,
        "purl": url,
        "licenses": [{ "expression": component.licence }],
    });
    if let Some(checksum) = &component.checksum {
        value["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
    }
    if component.repository.starts_with("http") {
        value["externalReferences"] = json!([{ "type": "vcs", "url": component.repository }]);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_library_is_listed_with_its_checksum() {
        let component = Component {
            registry: "cargo",
            name: "libm".to_owned(),
            version: "0.2.1".to_owned(),
            licence: "MIT".to_owned(),
            repository: "https://example.org/libm".to_owned(),
            checksum: Some("ab".repeat(32)),
            files: Vec::new(),
        };
        let document: Value = serde_json::from_str(&document(&[component], "0.1.0")).unwrap();
        let listed = &document["components"][0];
        assert_eq!(listed["purl"], "pkg:cargo/libm@0.2.1");
        assert_eq!(listed["hashes"][0]["content"], "ab".repeat(32).as_str());
        assert_eq!(document["dependencies"][0]["dependsOn"], json!(["pkg:cargo/libm@0.2.1"]));
    }
}
