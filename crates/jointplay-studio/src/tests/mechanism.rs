//! Poses of links of mechanisms.

use super::{answered, refused};

const PATH: &str = "/api/v1/mechanism/poses";

#[test]
fn links_of_a_slider_crank_are_where_trigonometry_places_them() {
    // Crank 40 mm about A, connecting rod 120 mm, slider along x.
    let text = r#"kind = "mechanism"\nname = "crank"\nunits = { length = "mm", angle = "deg" }\nbase = "ground"\n[[joint]]\nname = "A"\nkind = "revolute"\nlinks = ["ground", "crank"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true\n[[joint]]\nname = "B"\nkind = "revolute"\nlinks = ["crank", "rod"]\npoint = [40, 0, 0]\naxis = [0, 0, 1]\n[[joint]]\nname = "C"\nkind = "revolute"\nlinks = ["rod", "slider"]\npoint = [160, 0, 0]\naxis = [0, 0, 1]\n[[joint]]\nname = "D"\nkind = "prismatic"\nlinks = ["ground", "slider"]\naxis = [1, 0, 0]\nlimits = [-30, 0]\n"#;
    let body = format!(
        r#"{{"mechanism": {{"text": "{}"}}, "at": {{"A": 1.2}}}}"#,
        text.replace('"', "\\\"")
    );
    let document = answered(PATH, &body);
    let x = |k: usize| document["frames"][k]["pose"]["origin_m"][0].as_f64().unwrap();
    let names: Vec<&str> =
        (0..3).map(|k| document["frames"][k]["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["crank", "rod", "slider"]);
    let (sine, cosine) = 1.2_f64.sin_cos();
    let stroke = 0.04 * cosine + (0.12_f64.powi(2) - (0.04 * sine).powi(2)).sqrt() - 0.16;
    assert!((x(2) - stroke).abs() < 1e-12, "{} {stroke}", x(2));
    let rotation = document["frames"][0]["pose"]["rotation"][1][0].as_f64().unwrap();
    assert!((rotation - sine).abs() < 1e-12);
    assert_eq!(document["coordinates"][3]["unit"], "m");
    // 30.3 mm inwards, of 30 allowed.
    assert_eq!(document["limits_broken"][0]["limit"], "D");
}

#[test]
fn a_platform_is_tilted_with_its_play() {
    let document =
        answered(PATH, r#"{"catalogue": "gpr", "at": {"rod 1": 0.002, "rod 2": 0, "rod 3": 0}}"#);
    let pose = super::answered(
        "/api/v1/pose",
        r#"{"command": {"kind": "rods", "rods_m": [0.502, 0.5, 0.5]}, "models": [{"virtualization": "planar"}]}"#,
    );
    let expected = &pose["models"][0]["answer"]["pose"];
    let frames = document["frames"].as_array().unwrap();
    let found = frames.iter().find(|one| one["name"] == "platform").unwrap();
    for axis in 0..3 {
        let [a, b] = [&found["pose"]["origin_m"][axis], &expected["origin_m"][axis]]
            .map(|value| value.as_f64().unwrap());
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn invalid_requests_name_their_field() {
    let bad = |body: &str, field: Option<&str>, detail: &str| {
        refused(PATH, body, 422, field, detail);
    };
    let either = "either `mechanism` or `catalogue`";
    bad("{}", None, either);
    bad(r#"{"catalogue": "gpr", "mechanism": {"text": ""}}"#, None, either);
    bad(r#"{"catalogue": "four-baar"}"#, Some("catalogue"), "unknown entry");
    bad(r#"{"catalogue": "four-bar", "at": {"Z": 1}}"#, Some("at.Z"), "is not known");
    bad(r#"{"mechanism": {"text": "kind = 3"}}"#, Some("mechanism.text"), "kind");
    bad(r#"{"text": "kind = 3"}"#, Some("text"), "unknown field");
    refused(PATH, r#"{"catalogue": "slider-crank", "at": {"cylinder": 90}}"#, 409, None, "");
}
