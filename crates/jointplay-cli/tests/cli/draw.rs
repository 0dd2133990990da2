//! Pictures of mechanisms: where they go, what they show, what is refused.

use crate::sandbox::Sandbox;

#[test]
fn a_picture_is_written_where_it_is_asked_for() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.done("draw bennett --figure bennett.svg"), "picture: bennett.svg\n");
    let usual = sandbox.read("bennett.svg");
    for part in [">Bennett's linkage<", ">J4<", ">base<", ">actuated<", ">50 mm<"] {
        assert!(usual.contains(part), "{part}");
    }
    // Without a file it is printed, and nothing is written.
    assert_eq!(sandbox.done("draw bennett"), usual);
    assert_eq!(sandbox.names("."), ["bennett.svg"]);
    // A file that exists is replaced on request only.
    let run = sandbox.run("draw bennett --at J1=120 --figure bennett.svg");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("use --force to replace it"), "{}", run.stderr);
    assert_eq!(sandbox.read("bennett.svg"), usual);
    sandbox.done("draw bennett --at J1=120 --figure bennett.svg --force");
    assert_ne!(sandbox.read("bennett.svg"), usual);
    sandbox.done("draw hexapod --figure hexapod.svg");
    assert!(sandbox.read("hexapod.svg").contains(">P6<"));
    sandbox.done("draw hexapod --figure Hexapod.PNG");
    assert!(std::fs::read(sandbox.file("Hexapod.PNG")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_picture_shows_what_is_asked_for() {
    let sandbox = Sandbox::new();
    let drawn = |options: &str| {
        sandbox.done(&format!("draw four-bar --figure picture.svg --force {options}"));
        sandbox.read("picture.svg")
    };
    let plain = drawn("");
    assert_ne!(drawn("--at A=30"), plain);
    assert_ne!(drawn("--set coupler=0.25"), plain);
    assert_ne!(drawn("--view=-60,25"), plain);
    assert_eq!(drawn("--view=270,65"), plain);
    assert_ne!(drawn("--view 30,-89"), drawn("--view 30,89"));
    let moved = drawn("--ghost A=120");
    assert!(moved.contains(">moved<") && !plain.contains(">moved<"));
    // Title, names and size are as asked for.
    assert!(plain.contains(">A</text>") && plain.contains("width=\"720\""));
    let column = drawn("--no-title --labels links --label A=motor --width 360");
    let shows = |text: &str| column.contains(&format!(">{text}</text>"));
    assert!(shows("coupler") && shows("motor") && !shows("A") && !shows("B"));
    assert!(column.contains("width=\"360\"") && drawn("--title Loop").contains(">Loop</text>"));
    // Virtual joints are drawn, also when displaced.
    sandbox.done("draw gpr-mechanism --figure play.svg");
    assert!(sandbox.read("play.svg").contains(">virtual joint<"));
    sandbox.done("draw gpr-mechanism --figure play.svg --force --ghost \"rod 1=5,rod 2=0\"");
    assert!(sandbox.read("play.svg").contains(">moved<"));
    // The legend shows the play scale.
    let tilted = "draw gpr-mechanism --figure tilted.svg --force --at \"rod 1=5,rod 2=0,rod 3=0\"";
    let shown = |options: &str| {
        sandbox.done(&format!("{tilted} {options}"));
        sandbox.read("tilted.svg")
    };
    let (truth, larger) = (shown(""), shown("--exaggerate 500"));
    assert!(larger.contains(">play scale 500×<") && !truth.contains("play scale"));
    assert_ne!(larger.replace("500", "400"), shown("--exaggerate 400"));
    for (line, message) in [
        ("draw gpr-mechanism --exaggerate 500", "the virtual joints are not displaced"),
        ("draw bennett --exaggerate 500", "the virtual joints are not displaced"),
        ("draw four-bar --label E=motor", "no joint, virtual joint or link has this name"),
        ("draw four-bar --label motor", "expected NAME=TEXT"),
        ("draw four-bar --width 10", "cannot draw the picture: width of the figure"),
        ("draw four-bar --text-scale 0", "text scale is 0, but has to lie from 0.25 to 10"),
        ("draw four-bar --font \";\"", "invalid font family"),
        ("draw four-bar --font Times --figure four-bar.pdf", "--font needs an SVG figure"),
        ("draw gpr-mechanism --exaggerate 0.5", "the play scale must be from 1 to 1e9"),
    ] {
        let run = sandbox.run(line);
        assert_eq!(run.code, 2, "{line}");
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

#[test]
fn figures_have_the_title_size_and_text_that_are_asked_for() {
    let sandbox = Sandbox::new();
    for line in ["draw four-bar", "compare"] {
        let figure = |options: &str| {
            sandbox.done(&format!("{line} --figure figure.svg --force {options}"));
            sandbox.read("figure.svg")
        };
        assert!(figure("--title Loop").contains(">Loop</text>"), "{line}");
        let plain = figure("--no-title --width 360");
        assert!(plain.contains("<svg") && plain.contains(" width=\"360\""), "{line}");
        let large = figure("--no-title --width 360 --text-scale 1.5 --font serif");
        // Drawn 240 px wide, shown 360 px wide.
        assert!(large.contains(" width=\"360\"") && large.contains("viewBox=\"0 0 240 "), "{line}");
        assert!(large.contains("font-family=\"serif, 'DejaVu Sans'"), "{line}");
    }
}

#[test]
fn latex_sets_the_text_of_a_figure() {
    let sandbox = Sandbox::new();
    let line = "draw four-bar --title \"50 % & more\" --label \"A=$\\theta_1$\" --figure loop.tex";
    assert_eq!(sandbox.done(line), "picture: loop.tex\n");
    let source = sandbox.read("loop.tex");
    for part in [
        "{50 \\% \\& more}",
        "{$\\theta_1$}",
        "{loop.pdf}",
        "\\providecommand{\\figurewidth}{180mm}",
    ] {
        assert!(source.contains(part), "{part}: {source}");
    }
    assert!(sandbox.file("loop.pdf").exists());
    // Neither file is replaced.
    let again = sandbox.run(line);
    assert_eq!(again.code, 2, "{}", again.stderr);
}

#[test]
fn every_mechanism_of_the_catalogue_can_be_drawn() {
    let sandbox = Sandbox::new();
    let list = sandbox.done("catalogue");
    let robots = list.lines().skip(1).take_while(|line| !line.is_empty());
    let names = robots.filter_map(|line| line.split_whitespace().next());
    let (mechanisms, robots): (Vec<&str>, Vec<&str>) = names.partition(|name| {
        sandbox.done(&format!("catalogue show {name}")).contains("kind = \"mechanism\"")
    });
    assert_eq!(robots, ["dual-arm", "gpr", "radial-arm", "scara-3r", "scara-4r"]);
    assert!(mechanisms.len() > 24);
    for name in mechanisms {
        sandbox.done(&format!("draw {name}"));
    }
}

#[test]
fn what_cannot_be_drawn() {
    let sandbox = Sandbox::new();
    for (line, code, message) in [
        ("draw bennett --figure bennett.jpg", 2, "must end in .svg, .png, .pdf or .tex"),
        ("draw bennett --figure nowhere/bennett.svg", 2, "its folder does not exist"),
        ("draw bennett --view 30", 2, "expected AZIMUTH,ELEVATION"),
        ("draw bennett --view 30,91", 2, "elevation must be from -90° to 90°"),
        ("draw bennett --view NaN,0", 2, "not a finite number"),
        ("draw bennett --at J9=1", 2, "J9"),
        ("draw four-bar --ghost J9=1", 2, "J9"),
        ("draw spherical-4r --ghost A=90", 1, "before --ghost: stopped at A = 23.2"),
        ("draw dual-arm", 2, "is a robot with arms"),
        ("draw nothing.toml", 2, "cannot read"),
        ("draw", 2, "Usage"),
    ] {
        let run = sandbox.run(line);
        assert_eq!(run.code, code, "{line}: {}", run.stderr);
        assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
        assert!(sandbox.names(".").is_empty(), "{line}");
    }
}
