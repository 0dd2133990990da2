//! The view of mechanisms: opening, driving, analyses, the catalogue and the file.

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use serde_json::{Value, json};

use super::{HOST, PORT, answered, get, post, refused, send_to, state};
use crate::mechanism_file::{MechanismFileOnDisk, MechanismSession};
use crate::router;

const OPEN: &str = "/api/v1/mechanism/open";
const DRIVE: &str = "/api/v1/mechanism/drive";

/// A slider crank: crank 40 mm, connecting rod 120 mm, slider along x with limits.
const CRANK: &str = r#"kind = "mechanism"
name = "press"
units = { length = "mm", angle = "deg" }
base = "ground"
[parameters]
r = 40.0
[[joint]]
name = "A"
kind = "revolute"
links = ["ground", "crank"]
point = [0, 0, 0]
axis = [0, 0, 1]
actuated = true
[[joint]]
name = "B"
kind = "revolute"
links = ["crank", "rod"]
point = ["r", 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "C"
kind = "revolute"
links = ["rod", "slider"]
point = ["r + 120", 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "D"
kind = "prismatic"
links = ["ground", "slider"]
axis = [1, 0, 0]
limits = [-60, 5]
"#;

fn source(text: &str) -> Value {
    json!({ "text": text })
}

fn open(text: &str) -> Value {
    answered(OPEN, &json!({ "mechanism": source(text) }).to_string())
}

fn drive(text: &str, from: &Value, to: &Value) -> Value {
    let body = json!({ "mechanism": source(text), "from": from, "to": to });
    answered(DRIVE, &body.to_string())
}

fn entry(name: &str) -> String {
    let all = get("/api/v1/catalogue").json();
    let all = all.as_array().unwrap();
    let found = all.iter().find(|entry| entry["name"] == name).unwrap();
    found["text"].as_str().unwrap().to_owned()
}

#[test]
fn an_opened_mechanism_has_its_joints_limits_and_parameters() {
    let opened = open(CRANK);
    assert_eq!(opened["kind"], "mechanism");
    assert_eq!(opened["text"], CRANK);
    let mechanism = &opened["mechanism"];
    assert_eq!(mechanism["joints"][3]["kind"], "prismatic");
    assert_eq!(mechanism["coordinates"][0]["actuated"], true);
    assert_eq!(mechanism["coordinates"][3]["limits"], json!([-60.0, 5.0]));
    assert_eq!(mechanism["coordinates"][3]["unit"], "mm");
    assert_eq!(mechanism["parameters"], json!([{ "name": "r", "value": 40.0 }]));
    assert!(mechanism["configuration"]["residual"].as_f64().unwrap() < 1e-10);
    // One bar for each link between two joints at different places.
    let bars = |k: usize| mechanism["links"][k]["bars"].as_array().unwrap().len();
    assert_eq!((bars(1), bars(2)), (1, 1));
}

/// A row of 50 parallelograms: cranks and couplers of 100 mm along 5 m.
fn row() -> String {
    use std::fmt::Write;
    let mut text = String::from(
        "kind = \"mechanism\"\nname = \"row\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"rail\"\n",
    );
    let mut joint = |name: String, links: [String; 2], point: [i32; 2]| {
        write!(text, "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nlinks = {links:?}\npoint = [{}, {}, 0]\naxis = [0, 0, 1]\n", point[0], point[1]).unwrap();
    };
    for k in 0..=50 {
        joint(format!("foot {k}"), ["rail".to_owned(), format!("crank {k}")], [100 * k, 0]);
    }
    for k in 0..50 {
        for end in [k, k + 1] {
            let links = [format!("coupler {k}"), format!("crank {end}")];
            joint(format!("pin {k} {end}"), links, [100 * end, 100]);
        }
    }
    text
}

#[test]
fn the_cranks_of_a_row_with_many_loops_turn_together_and_its_couplers_translate() {
    let text = row();
    let opened = &open(&text)["mechanism"];
    let at = &opened["configuration"]["coordinates"];
    let body = json!({ "mechanism": source(&text), "coordinates": at }).to_string();
    let found = answered("/api/v1/mechanism/motions", &body);
    assert_eq!(found["mobility"], 1);
    let steps = found["motions"][0]["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 17);
    let sine = |step: usize, link: usize| steps[step][link]["rotation"][1][0].as_f64().unwrap();
    for (link, described) in opened["links"].as_array().unwrap().iter().enumerate() {
        let name = described["name"].as_str().unwrap();
        let expected = if name.starts_with("crank") { sine(16, 1) } else { 0.0 };
        assert!((sine(16, link) - expected).abs() < 1e-9, "{name}: {}", sine(16, link));
        assert!((sine(0, link) + expected).abs() < 1e-9, "{name}: {}", sine(0, link));
    }
    assert!(sine(16, 1).abs() > 0.01, "{}", sine(16, 1));
    let path = "/api/v1/mechanism/branches";
    let detail = "closure equations, but at most 240 are taken here";
    refused(path, &body, 422, Some("mechanism.text"), detail);
}

#[test]
fn joints_of_many_short_links_do_not_cover_them() {
    let text = row();
    let opened = &open(&text)["mechanism"];
    let radius = opened["joint_radius_m"].as_f64().unwrap();
    assert!(opened["size_m"].as_f64().unwrap() > 2.0, "{opened}");
    // The joints at both ends of a link leave half of it free.
    assert!((0.005..0.025).contains(&radius), "{radius}");
}

#[test]
fn a_crank_is_driven_by_expressions_to_where_trigonometry_places_its_slider() {
    let start = open(CRANK)["mechanism"]["configuration"]["coordinates"].clone();
    let moved = drive(CRANK, &start, &json!({ "A": "180/3 deg" }));
    assert_eq!(moved["stopped"], Value::Null);
    let (sine, cosine) = 60_f64.to_radians().sin_cos();
    let slider = 40.0 * cosine + (120.0_f64.powi(2) - (40.0 * sine).powi(2)).sqrt() - 160.0;
    let found = moved["configuration"]["values"][3].as_f64().unwrap();
    assert!((found - slider).abs() < 1e-9, "{found} {slider}");
    // It continues from there, beyond the limit of the slider at -60 mm.
    let from = &moved["configuration"]["coordinates"];
    let beyond = drive(CRANK, from, &json!({ "A": "150" }));
    let broken = &beyond["configuration"]["limits_broken"][0];
    assert_eq!(broken["limit"], "D");
    assert!(beyond["first_beyond_limits"]["place"].as_str().unwrap().starts_with("A = "));
}

#[test]
fn a_dead_point_stops_the_slider_and_its_configuration_is_reported() {
    let text = CRANK
        .replace("axis = [0, 0, 1]\nactuated = true", "axis = [0, 0, 1]\nguess = 30")
        .replace("axis = [1, 0, 0]\n", "axis = [1, 0, 0]\nactuated = true\n");
    let start = open(&text)["mechanism"]["configuration"]["coordinates"].clone();
    let moved = drive(&text, &start, &json!({ "D": "10" }));
    assert_eq!(moved["stopped"], "locked", "{moved}");
    // The slider cannot be farther than both links in line.
    let reached = moved["configuration"]["values"][3].as_f64().unwrap();
    assert!(reached.abs() < 1e-3, "{reached}");
    assert!(moved["message"].as_str().unwrap().contains("dead point"));
}

#[test]
fn a_changed_parameter_keeps_the_crank_where_it_was() {
    let start = open(CRANK)["mechanism"]["configuration"]["coordinates"].clone();
    let at = drive(CRANK, &start, &json!({ "A": "70" }))["configuration"]["coordinates"].clone();
    let body = json!({ "mechanism": { "text": CRANK, "parameters": { "r": 30 } }, "from": at });
    let changed = answered(OPEN, &body.to_string());
    let values = &changed["mechanism"]["configuration"]["values"];
    assert!((values[0].as_f64().unwrap() - 70.0).abs() < 1e-9);
    let (sine, cosine) = 70_f64.to_radians().sin_cos();
    let slider = 30.0 * cosine + (120.0_f64.powi(2) - (30.0 * sine).powi(2)).sqrt() - 150.0;
    assert!((values[3].as_f64().unwrap() - slider).abs() < 1e-9, "{values}");
}

#[test]
fn invalid_texts_and_other_kinds_of_files_are_answers() {
    let opened = open(&CRANK.replace("\"prismatic\"", "\"prismatik\""));
    assert_eq!(opened["mechanism"], Value::Null);
    assert_eq!(opened["diagnostics"][0]["line"], 28);
    let cell = open("kind = \"cell\"\n");
    assert_eq!((&cell["kind"], &cell["mechanism"]), (&"cell".into(), &Value::Null));
    assert!(cell["note"].as_str().unwrap().contains("a work cell"));
    assert_eq!(open("a,b\n1,2\n")["kind"], "unknown");
    let bad = |body: Value, field: &str, detail: &str| {
        refused(DRIVE, &body.to_string(), 422, Some(field), detail);
    };
    let start = open(CRANK)["mechanism"]["configuration"]["coordinates"].clone();
    let request =
        |from: Value, to: Value| json!({ "mechanism": source(CRANK), "from": from, "to": to });
    bad(request(start.clone(), json!({ "Z": "1" })), "to.Z", "is not known");
    bad(request(start.clone(), json!({ "A": "1 +" })), "to.A", "");
    bad(request(start.clone(), json!({ "A": "3 mm" })), "to.A", "");
    bad(request(start.clone(), json!({})), "to", "at least one");
    bad(request(start.clone(), json!({ "A": "1+".repeat(50_000) })), "to.A", "at most 1000");
    bad(request(json!([0.0]), json!({ "A": "1" })), "from", "expected 4 coordinates");
    refused(
        OPEN,
        &json!({ "mechanism": source(CRANK), "play_scale": 0.5 }).to_string(),
        422,
        Some("play_scale"),
        "from 1 to 1e9",
    );
}

#[test]
fn parameters_are_those_of_the_file_also_for_robots_and_models() {
    let opened = |text: &str, parameters: Value| {
        let body = json!({ "mechanism": { "text": text, "parameters": parameters } });
        answered(OPEN, &body.to_string())
    };
    let paper = jointplay::format::robot::PAPER;
    let (radius, expression) = ("socket_radius_mm = 93.218", "socket_radius_mm = \"r\"");
    assert!(paper.contains(radius));
    let robot = format!("{}\n[parameters]\nr = 80\n", paper.replacen(radius, expression, 1));
    let [same, smaller] = [93.218, 90.0].map(|value| opened(&robot, json!({ "r": value })));
    assert_eq!(
        (&same["kind"], &same["text"]),
        (&"three_rods".into(), &opened(paper, json!({}))["text"])
    );
    assert_ne!(same["text"], smaller["text"]);
    let model = r#"<robot name="one"><link name="base"/></robot>"#;
    for text in [paper, model] {
        let refused = opened(text, json!({ "unknown": 1 }));
        assert_eq!(refused["mechanism"], Value::Null, "{refused}");
        let message = refused["diagnostics"][0]["message"].as_str().unwrap();
        assert!(message.contains("unknown"), "{message}");
    }
}

#[test]
fn a_model_is_converted_and_closed_by_its_loops() {
    let urdf = r#"<robot name="two"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
<joint name="A" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="B" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="D" type="continuous"><parent link="base"/><child link="c"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/></joint></robot>"#;
    let tree = open(urdf);
    assert_eq!(tree["kind"], "model");
    assert!(tree["note"].as_str().unwrap().contains("URDF"), "{tree}");
    assert!(tree["text"].as_str().unwrap().contains("kind = \"mechanism\""));
    let loops = "kind = \"loops\"\nunits = { length = \"m\", angle = \"rad\" }\n[[joint]]\nname = \"C\"\nkind = \"revolute\"\nlinks = [\"b\", \"c\"]\npoint = [0.3, 0.2, 0]\naxis = [0, 0, 1]\n";
    let closed =
        answered(OPEN, &json!({ "mechanism": { "text": urdf, "loops": loops } }).to_string());
    assert_eq!(closed["mechanism"]["joints"].as_array().unwrap().len(), 4, "{closed}");
    // The converted text is the same mechanism.
    let again = open(closed["text"].as_str().unwrap());
    assert_eq!(again["mechanism"]["joints"].as_array().unwrap().len(), 4);
}

#[test]
fn a_suggested_set_applied_makes_the_motion_possible() {
    let text = entry("gpr-mechanism");
    let body = json!({ "mechanism": source(&text) }).to_string();
    let found = answered("/api/v1/mechanism/suggest", &body);
    let sets = found["report"]["sets"].as_array().unwrap();
    assert!(!sets.is_empty() && found["texts"].as_array().unwrap().len() <= sets.len());
    let applied = found["texts"][0].as_str().unwrap();
    let opened = open(applied);
    let mechanism = &opened["mechanism"];
    let virtual_joints = mechanism["virtual_joints"].as_array().unwrap();
    assert_eq!(virtual_joints.len(), sets[0]["virtual_joints"].as_array().unwrap().len());
    let start = &mechanism["configuration"]["coordinates"];
    let moved = drive(applied, start, &json!({ "rod 1": "2" }));
    assert_eq!(moved["stopped"], Value::Null, "{moved}");
    let configuration = &moved["configuration"];
    assert_eq!(configuration["displaced"], true);
    // The play scale changes poses, and nothing else.
    let at = |scale: f64| {
        let body = json!({ "mechanism": source(applied), "coordinates": configuration["coordinates"], "play_scale": scale });
        answered("/api/v1/mechanism/configuration", &body.to_string())
    };
    assert_eq!(at(1.0)["poses"], configuration["poses"]);
    let exaggerated = at(200.0);
    assert_eq!(exaggerated["values"], configuration["values"]);
    assert_ne!(exaggerated["poses"], configuration["poses"]);
    let open_loops = json!({ "mechanism": source(applied), "coordinates": vec![0.01; configuration["coordinates"].as_array().unwrap().len()] });
    refused("/api/v1/mechanism/configuration", &open_loops.to_string(), 409, None, "");
}

#[test]
fn motions_and_modes_are_those_of_the_configuration() {
    let text = entry("four-bar");
    let opened = open(&text);
    let at = &opened["mechanism"]["configuration"]["coordinates"];
    let body = json!({ "mechanism": source(&text), "coordinates": at }).to_string();
    let mobility = answered("/api/v1/mechanism/mobility", &body);
    assert_eq!(mobility["dense"]["finite_mobility"], 1);
    assert_eq!(mobility["sparse"], Value::Null);
    let motions = answered("/api/v1/mechanism/motions", &body);
    let motions = motions["motions"].as_array().unwrap();
    assert_eq!(motions.len(), 1);
    let steps = motions[0]["steps"].as_array().unwrap();
    // The middle step is the configuration itself, and the base stays.
    assert_eq!(steps[8], opened["mechanism"]["configuration"]["poses"]);
    assert_eq!(steps[0][0], steps[16][0]);
    assert_ne!(steps[0][1], steps[16][1]);
    let modes = answered("/api/v1/mechanism/branches", &body);
    // A four-bar linkage has two, mirrored at the diagonal.
    assert_eq!(modes["branches"].as_array().unwrap().len(), 2, "{modes}");
}

#[test]
fn open_configurations_have_no_mobility_and_no_motions() {
    let text = entry("four-bar");
    let body = json!({ "mechanism": source(&text), "coordinates": [0.1, 0.1, 0.1, 0.1] });
    for path in ["mobility", "motions", "configuration"] {
        let path = format!("/api/v1/mechanism/{path}");
        refused(&path, &body.to_string(), 409, None, "close the loops first");
    }
    // A coupling that does not hold is open, too.
    let gears = r#"
kind = "mechanism"
name = "gears"
units = { length = "m", angle = "rad" }
base = "frame"
joint = [
  { name = "A", kind = "revolute", links = ["frame", "a"], point = [0, 0, 0], axis = [0, 0, 1] },
  { name = "B", kind = "revolute", links = ["frame", "b"], point = [1, 0, 0], axis = [0, 0, 1] },
]
coupling = [{ name = "mesh", coordinate = "B", terms = [{ coordinate = "A", ratio = -2 }] }]
"#;
    let path = "/api/v1/mechanism/motions";
    let at =
        |values: [f64; 2]| json!({ "mechanism": source(gears), "coordinates": values }).to_string();
    refused(path, &at([0.1, 0.1]), 409, None, "close the loops first");
    assert_eq!(answered(path, &at([0.1, -0.2]))["motions"].as_array().unwrap().len(), 1);
}

/// Place of a point of a link, for a pose of the link.
fn place(pose: &Value, point: &Value) -> [f64; 3] {
    let number = |value: &Value| value.as_f64().unwrap();
    std::array::from_fn(|i| {
        let turned = (0..3).map(|j| number(&pose["rotation"][i][j]) * number(&point[j]));
        number(&pose["origin_m"][i]) + turned.sum::<f64>()
    })
}

#[test]
fn joints_open_to_second_order_only_along_an_instantaneous_motion() {
    // All three motions of the level robot, two of which are only instantaneous.
    let text = entry("gpr-mechanism");
    let mechanism = open(&text)["mechanism"].clone();
    let body = json!({ "mechanism": source(&text), "coordinates": mechanism["configuration"]["coordinates"] });
    let motions = answered("/api/v1/mechanism/motions", &body.to_string());
    let motions = motions["motions"].as_array().unwrap();
    assert_eq!(motions.len(), 3);
    let balls =
        mechanism["joints"].as_array().unwrap().iter().filter(|joint| joint["kind"] == "spherical");
    for (ball, motion) in balls.flat_map(|ball| motions.iter().map(move |motion| (ball, motion))) {
        let end = |step: usize, side: usize| {
            let link = usize::try_from(ball["links"][side].as_u64().unwrap()).unwrap();
            place(&motion["steps"][step][link], &ball["frames"][side]["origin_m"])
        };
        let apart =
            |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        let [near, far] = [10, 12].map(|step| apart(end(step, 0), end(step, 1)));
        // Twice the displacement, four times the opening.
        assert!((far - 4.0 * near).abs() < 0.05 * far + 1e-12, "{near} {far}");
    }
}

#[test]
fn the_catalogue_has_pictures_of_mechanisms_only() {
    let all = get("/api/v1/catalogue").json();
    let names: Vec<&str> =
        all.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"bennett") && names.contains(&"gpr") && !names.contains(&"scara-3r"));
    let picture = get("/api/v1/catalogue/bennett/picture");
    assert_eq!(picture.header("content-type"), "image/svg+xml");
    assert!(String::from_utf8(picture.bytes).unwrap().contains("<svg"));
    assert_eq!(get("/api/v1/catalogue/scara-3r/picture").status, StatusCode::NOT_FOUND);
    assert_eq!(get("/api/v1/catalogue/none/picture").status, StatusCode::NOT_FOUND);
}

#[test]
fn the_file_of_the_server_is_read_saved_and_not_overwritten_unseen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, CRANK).unwrap();
    let file = MechanismFileOnDisk {
        name: "mine.toml".to_owned(),
        path: Some(path.clone()),
        text: CRANK.to_owned(),
        loops: None,
    };
    let mut state = state(jointplay::format::robot::paper(), None).unwrap();
    state.mechanism = Some(MechanismSession::new(file));
    let send = |method: &str, body: Option<Value>| {
        let request = Request::builder().method(method).uri("/api/v1/mechanism");
        let request =
            request.header(header::HOST, HOST).header(header::CONTENT_TYPE, "application/json");
        let body = body.map_or_else(Body::empty, |body| Body::from(body.to_string()));
        send_to(router::router(state.clone(), PORT), request.body(body).unwrap())
    };
    let read = send("GET", None).json();
    assert_eq!((&read["text"], &read["writable"]), (&CRANK.into(), &true.into()));
    let changed = CRANK.replace("press", "pump");
    let save =
        |replaces: &Value| send("PUT", Some(json!({ "text": changed, "replaces": replaces })));
    let saved = save(&read["version"]);
    assert_eq!(saved.status, StatusCode::OK);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), changed);
    std::fs::write(&path, "# another editor\n").unwrap();
    let conflict = save(&saved.json()["version"]);
    assert_eq!(conflict.status, StatusCode::CONFLICT);
    assert_eq!(conflict.json()["field"], "replaces");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "# another editor\n");
    assert_eq!(get("/api/v1/mechanism").status, StatusCode::NOT_FOUND);
}

const REACH: &str = "/api/v1/mechanism/reach";

#[test]
fn a_point_of_the_crank_is_moved_to_the_nearest_position_within_the_limits() {
    let start = open(CRANK)["mechanism"]["configuration"]["coordinates"].clone();
    let reach = |to: Value, more: Value| {
        let mut body = json!({ "mechanism": source(CRANK), "from": start, "link": "crank", "point_m": [0.04, 0, 0], "to_m": to });
        for (key, value) in more.as_object().unwrap() {
            body[key] = value.clone();
        }
        body.to_string()
    };
    let none = json!({});
    // Without a wanted position, the point is measured.
    let here = answered(REACH, &reach(Value::Null, none.clone()));
    assert_eq!((&here["position_m"], &here["message"]), (&json!([0.04, 0.0, 0.0]), &Value::Null));
    // The nearest point of a circle of 40 mm.
    let found = answered(REACH, &reach(json!([0.3, 0.4, 0]), none.clone()));
    let number = |value: &Value| value.as_f64().unwrap();
    assert!(
        (number(&found["configuration"]["values"][0]) - 0.8_f64.atan2(0.6).to_degrees()).abs()
            < 1e-5
    );
    assert!((number(&found["distance_m"]) - 0.46).abs() < 1e-9);
    let message = found["message"].as_str().unwrap();
    assert!(
        message.starts_with("The nearest reachable position is 460.")
            && message.ends_with("mm away."),
        "{message}"
    );
    // The slider stops at -60 mm: the crank angle by the law of cosines.
    let bounded = answered(REACH, &reach(json!([-1, 0.1, 0]), none.clone()));
    assert_eq!(bounded["at_limits"], json!(["D"]));
    assert!((number(&bounded["configuration"]["values"][3]) + 60.0).abs() < 1e-6);
    let cosine = (40.0_f64.powi(2) + 100.0_f64.powi(2) - 120.0_f64.powi(2)) / (2.0 * 40.0 * 100.0);
    assert!(
        (number(&bounded["configuration"]["values"][0]) - cosine.acos().to_degrees()).abs() < 1e-5
    );
    assert!(bounded["message"].as_str().unwrap().contains("within the limits of D"));
    assert_eq!(bounded["configuration"]["limits_broken"], json!([]));
    let at = || json!([0, 0, 0]);
    refused(REACH, &reach(json!([1e9, 0, 0]), none), 422, Some("to_m[0]"), "within ±1000 m");
    refused(REACH, &reach(at(), json!({ "link": "no" })), 422, Some("link"), "unknown link \"no\"");
    refused(REACH, &reach(at(), json!({ "from": [0.0] })), 422, Some("from"), "4 coordinates");
    refused(REACH, &reach(at(), json!({ "play_scale": 0 })), 422, Some("play_scale"), "from 1");
}

#[test]
fn a_dragged_point_is_where_it_is_drawn_at_a_play_scale() {
    let text = entry("gpr-mechanism");
    let suggested =
        answered("/api/v1/mechanism/suggest", &json!({ "mechanism": source(&text) }).to_string());
    let text = suggested["texts"][0].as_str().unwrap().to_owned();
    let opened = open(&text);
    let links = opened["mechanism"]["links"].as_array().unwrap();
    let platform = links.iter().position(|link| link["name"] == "platform").unwrap();
    let mut from = opened["mechanism"]["configuration"]["coordinates"].clone();
    let origin = opened["mechanism"]["configuration"]["poses"][platform]["origin_m"].clone();
    let mut to: Vec<f64> = serde_json::from_value(origin).unwrap();
    to[2] += 0.004;
    let mut drawn = vec![];
    for _ in 0..4 {
        let body = json!({ "mechanism": source(&text), "from": from, "link": "platform", "point_m": [0.1, 0, 0], "to_m": [to[0] + 0.1, to[1], to[2]], "as_drawn": true, "play_scale": 100 });
        let found = answered(REACH, &body.to_string());
        from = found["configuration"]["coordinates"].clone();
        let pose = &found["configuration"]["poses"][platform];
        let at = |k: usize| {
            pose["origin_m"][k].as_f64().unwrap() + 0.1 * pose["rotation"][k][0].as_f64().unwrap()
        };
        drawn = vec![at(0) - to[0] - 0.1, at(1) - to[1], at(2) - to[2]];
    }
    assert!(drawn[2].abs() < 2e-4, "{drawn:?}");
}

#[test]
fn a_motion_of_a_joint_is_a_table_or_a_scene_unless_it_stops_or_leaves_limits() {
    const EXPORT: &str = "/api/v1/mechanism/export";
    let body = |from: &str, to: &str, format: &str, steps: usize| {
        json!({ "mechanism": source(CRANK), "drive": "A", "from": from, "to": to, "steps": steps, "format": format }).to_string()
    };
    let table = post(EXPORT, &body("10", "30 deg", "csv", 4));
    assert_eq!(table.status, StatusCode::OK, "{}", String::from_utf8_lossy(&table.bytes));
    let table = String::from_utf8(table.bytes.to_vec()).unwrap();
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 5, "{table}");
    for (k, row) in rows.iter().enumerate() {
        let angle = 10.0 + 5.0 * f64::from(u8::try_from(k).unwrap());
        let (sine, cosine) = angle.to_radians().sin_cos();
        let slider = 40.0 * cosine + (120.0_f64.powi(2) - (40.0 * sine).powi(2)).sqrt() - 160.0;
        assert!((row[0] - angle).abs() < 1e-9 && (row[3] - slider).abs() < 1e-6, "{row:?}");
    }
    assert_eq!(&post(EXPORT, &body("0", "30", "gltf", 4)).bytes[..4], b"glTF");
    // The slider leaves its limit of -60 mm.
    refused(EXPORT, &body("0", "150", "csv", 60), 409, None, "leaves limits at A = ");
    refused(EXPORT, &body("0", "0 deg", "csv", 60), 422, Some("to"), "equal");
    refused(EXPORT, &body("0", "1 mm", "csv", 60), 422, Some("to.A"), "");
    refused(EXPORT, &body("0", "1", "csv", 0), 422, Some("steps"), "1 to 20000");
    refused(EXPORT, &body("0", "1", "pdf", 1), 422, Some("format"), "pdf");
}
