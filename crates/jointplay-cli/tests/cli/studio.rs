//! The studio's server: started, asked, and ended as a person would.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, ChildStdout, Command, Stdio};

use crate::sandbox::Sandbox;

/// A running server; killed where a test fails before it is ended.
struct Studio {
    child: Child,
    output: BufReader<ChildStdout>,
    address: String,
}

impl Studio {
    fn start(sandbox: &Sandbox, flags: &str) -> Self {
        let mut command = sandbox.command(&format!("studio --no-open {flags}"));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        output.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("studio: http://").unwrap_or_else(|| {
            let mut error = String::new();
            child.stderr.take().unwrap().read_to_string(&mut error).unwrap();
            panic!("{line}{error}")
        });
        let address = address.trim_end_matches('/').to_owned();
        Self { child, output, address }
    }

    /// The whole answer to a request.
    fn ask(&self, request: &str) -> String {
        self.exchange(request, "")
    }

    fn exchange(&self, head: &str, body: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let head = format!("{head}Host: {}\r\nConnection: close\r\n\r\n{body}", self.address);
        stream.write_all(head.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    /// The JSON that a question with a body is answered with.
    fn post(&self, path: &str, body: &str) -> serde_json::Value {
        let length = body.len();
        let head = format!(
            "POST /api/v1/{path} HTTP/1.1\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n"
        );
        let answer = self.exchange(&head, body);
        let (_, json) = answer.split_once("\r\n\r\n").unwrap();
        serde_json::from_str(json).unwrap_or_else(|_| panic!("{answer}"))
    }

    /// Presses Ctrl-C; how the server then ended, and what else it had printed.
    fn interrupt(mut self) -> (Option<i32>, String) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let code = self.child.wait().unwrap().code();
        let mut rest = String::new();
        self.output.read_to_string(&mut rest).unwrap();
        (code, rest)
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}

#[test]
fn a_mechanism_a_model_with_its_loops_and_a_name_are_opened() {
    let sandbox = Sandbox::new();
    let opened = |flags: &str| {
        let studio = Studio::start(&sandbox, flags);
        let answer = studio.ask("GET /api/v1/mechanism HTTP/1.1\r\n");
        let (_, json) = answer.split_once("\r\n\r\n").unwrap();
        let file: serde_json::Value = serde_json::from_str(json).unwrap();
        let body =
            serde_json::json!({ "mechanism": { "text": file["text"], "loops": file["loops"] } });
        let opened = studio.post("mechanism/open", &body.to_string());
        (file, opened["mechanism"]["joints"].as_array().map_or(0, Vec::len))
    };
    let (file, joints) = opened("hexapod --port 0");
    assert_eq!((&file["name"], &file["writable"]), (&"hexapod".into(), &false.into()));
    assert_eq!(joints, 18);
    let text = jointplay::format::catalogue::find("bennett").unwrap().text;
    sandbox.write("mine.toml", text);
    let (file, joints) = opened("--mechanism mine.toml --port 0");
    assert_eq!((&file["writable"], joints), (&true.into(), 4));
    sandbox.write("arm.urdf", r#"<robot name="arm"><link name="base"/><link name="a"/><joint name="A" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint></robot>"#);
    sandbox.write("loops.toml", "kind = \"loops\"\nunits = { length = \"m\", angle = \"rad\" }\n[[joint]]\nname = \"B\"\nkind = \"revolute\"\nlinks = [\"base\", \"a\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\n");
    let (file, joints) = opened("arm.urdf --loops loops.toml --port 0");
    assert_eq!((&file["writable"], joints), (&false.into(), 2));
}

#[test]
fn a_file_is_as_long_as_its_kind_allows() {
    let sandbox = Sandbox::new();
    let padding = "# One of many lines.\n".repeat(70_000);
    let text = jointplay::format::catalogue::find("bennett").unwrap().text;
    sandbox.write("long.toml", &format!("{text}\n{padding}"));
    let studio = Studio::start(&sandbox, "long.toml --port 0");
    let answer = studio.ask("GET /api/v1/mechanism HTTP/1.1\r\n");
    assert!(answer.contains("\"name\":\"long.toml\""), "{answer:.1000}");
    sandbox.write("long.toml", &format!("{}\n{padding}", jointplay::format::cell::EXAMPLE));
    let run = sandbox.run("studio --no-open --port 0 long.toml");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("at most 1000000 bytes are allowed"), "{}", run.stderr);
}

#[test]
fn it_serves_until_it_is_interrupted() {
    let sandbox = Sandbox::new();
    let studio = Studio::start(&sandbox, "--port 0");
    assert!(studio.address.starts_with("127.0.0.1:"), "{}", studio.address);
    let robot = studio.ask("GET /api/v1/robot HTTP/1.1\r\n");
    assert!(robot.starts_with("HTTP/1.1 200 OK\r\n"), "{robot}");
    assert!(robot.contains("GPR of the paper"), "{robot}");
    assert!(studio.ask("GET / HTTP/1.1\r\n").contains("<title>"));
    // A browser keeps its connections open; that must not keep the server.
    let _idle = TcpStream::connect(&studio.address).unwrap();
    let (code, rest) = studio.interrupt();
    assert_eq!((code, rest.as_str()), (Some(0), "  press Ctrl-C to stop\n"));
    assert_eq!(sandbox.names(""), [""; 0]);
}

#[test]
fn a_port_that_is_taken() {
    let sandbox = Sandbox::new();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let run = sandbox.run(&format!("studio --no-open --port {port}"));
    assert_eq!(run.code, 2);
    let message = format!("cannot serve on port {port} of 127.0.0.1");
    assert!(run.stderr.contains(&message) && run.stderr.contains("--port"), "{}", run.stderr);
    // Two servers without a port to insist on go side by side.
    let (first, second) = (Studio::start(&sandbox, ""), Studio::start(&sandbox, ""));
    assert_ne!(first.address, second.address);
    assert!(second.ask("GET /api/v1/robot HTTP/1.1\r\n").contains("200 OK"));
    assert_eq!((first.interrupt().0, second.interrupt().0), (Some(0), Some(0)));
}

#[test]
fn a_running_studio_is_found_by_its_port() {
    let sandbox = Sandbox::new();
    let studio = Studio::start(&sandbox, "--port 0");
    let port = studio.address.rsplit(':').next().unwrap().to_owned();
    let found = sandbox.run(&format!("studio --ping --port {port}"));
    assert_eq!(
        (found.code, found.stdout.as_str()),
        (0, &*format!("studio: http://127.0.0.1:{port}/\n"))
    );
    assert_eq!(
        sandbox.json(&format!("studio --ping --port {port}"))["url"],
        format!("http://127.0.0.1:{port}/")
    );
    assert_eq!(studio.interrupt().0, Some(0));
    let run = sandbox.run(&format!("studio --ping --port {port}"));
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    assert!(run.stderr.contains(&format!("no studio answers on port {port}")), "{}", run.stderr);
    // Other programs on the port: one that answers something else, and one that hangs up.
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = other.local_addr().unwrap().port();
    let answers = std::thread::spawn(move || {
        let ok = "HTTP/1.1 200 OK\r\nServer: another\r\n\r\n{}";
        for answer in ["SSH-2.0-OpenSSH_9.6\r\n", "HTTP/1.1 404 Not Found\r\n\r\n", ok, ""] {
            let (mut stream, _) = other.accept().unwrap();
            let _ = stream.read(&mut [0; 1024]).unwrap();
            stream.write_all(answer.as_bytes()).unwrap();
        }
    });
    for what in ["SSH-2.0", "404", "200 OK", "is not that of a studio"] {
        let run = sandbox.run(&format!("studio --ping --port {port}"));
        assert_eq!(run.code, 1);
        assert!(run.stderr.contains(what), "{}", run.stderr);
    }
    answers.join().unwrap();
    assert_eq!(sandbox.run("studio --ping --no-open").code, 2);
}

#[test]
fn another_robot() {
    let sandbox = Sandbox::new();
    let own = jointplay::format::robot::PAPER.replace("GPR of the paper", "My robot");
    sandbox.write("mine.toml", &own);
    let studio = Studio::start(&sandbox, "--port 0 --robot mine.toml");
    assert!(studio.ask("GET /api/v1/robot HTTP/1.1\r\n").contains("\"name\":\"My robot\""));
    assert_eq!(studio.interrupt().0, Some(0));
    sandbox.write("bad.toml", &own.replace("tilt_deg = 1.5", "tilt_deg = 95"));
    let run = sandbox.run("studio --no-open --robot bad.toml");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("bad.toml:28:12: the largest tilt is 95°"), "{}", run.stderr);
}

#[test]
fn a_mesh_that_is_not_there() {
    let sandbox = Sandbox::new();
    let own = jointplay::format::robot::PAPER;
    sandbox.write("mine.toml", &own.replacen("kind = ", "base_mesh = \"base.stl\"\nkind = ", 1));
    let run = sandbox.run("studio --no-open --robot mine.toml");
    assert_eq!(run.code, 2);
    let message = "mine.toml:6:13: the mesh \"base.stl\" cannot be read";
    assert!(run.stderr.contains(message), "{}", run.stderr);
    sandbox.write("base.stl", "solid base");
    let studio = Studio::start(&sandbox, "--port 0 --robot mine.toml");
    assert!(studio.ask("GET /api/v1/meshes/base HTTP/1.1\r\n").ends_with("solid base"));
    assert_eq!(studio.interrupt().0, Some(0));
}

/// The same question by the command line and by the server.
#[track_caller]
fn same(sandbox: &Sandbox, studio: &Studio, line: &str, path: &str, body: &str) {
    let run = sandbox.run(&format!("{line} --format json"));
    assert_eq!(run.code, 0, "{line}: {}", run.stderr);
    let answer: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(studio.post(path, body), answer, "{line}");
}

#[test]
fn the_server_answers_what_the_command_line_answers() {
    let sandbox = Sandbox::new();
    let studio = Studio::start(&sandbox, "--port 0");
    let same = |line: &str, path: &str, body: &str| same(&sandbox, &studio, line, path, body);
    same("forward --q-mm 500,501,502", "forward", r#"{"rods_m": [0.5, 0.501, 0.502]}"#);
    same(
        "forward --q-mm 500,501,502 --virtualization polar --solver newton --metric radius",
        "forward",
        r#"{"rods_m": [0.5, 0.501, 0.502], "model": {"virtualization": "polar", "solver": "newton", "metric": "radius"}}"#,
    );
    let (azimuth, tilt_angle) = (17.0_f64.to_radians(), 1.5_f64.to_radians());
    let tilt = |height: &str| {
        format!(
            r#"{{"command": {{"kind": "tilt", "azimuth_rad": {azimuth}, "tilt_rad": {tilt_angle}, "height": {{"kind": "{height}", "value_m": 0.5}}}}}}"#
        )
    };
    same("inverse --azimuth-deg 17 --tilt-deg 1.5", "inverse", &tilt("axis"));
    same("inverse --azimuth-deg 17 --tilt-deg 1.5 --height-of center", "inverse", &tilt("center"));
    same("sensitivity --azimuth-deg 17 --tilt-deg 1.5", "sensitivity", &tilt("axis"));
    same("mobility", "mobility", "{}");
    same(
        "mobility --q-mm 500,501,502 --virtualization polar",
        "mobility",
        r#"{"rods_m": [0.5, 0.501, 0.502], "virtualization": "polar"}"#,
    );
    let tilt_angles: Vec<String> = [0.0_f64, 0.5, 1.0, 1.5]
        .iter()
        .map(|tilt_angle| tilt_angle.to_radians().to_string())
        .collect();
    same(
        "compare --tilt-deg 0:1.5:0.5 --metric 2",
        "compare",
        &format!(
            r#"{{"tilts_rad": [{}], "characteristic_length_m": 0.002}}"#,
            tilt_angles.join(", ")
        ),
    );
    assert_eq!(studio.interrupt().0, Some(0));
}
