//! `kinstep plot`, the pictures of plans, studies and sweeps, and how much the program says.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, SMALL};

fn planned() -> Desk {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "saved"]).expect(0);
    desk
}

fn read(desk: &Desk, name: &str) -> String {
    std::fs::read_to_string(desk.path(name)).unwrap()
}

fn is_drawing(name: &str) -> bool {
    std::path::Path::new(name).extension().is_some_and(|extension| extension == "svg")
}

#[test]
fn a_saved_plan_is_drawn_as_it_would_have_been() {
    let desk = planned();
    desk.run(&["plan", "s.toml", "--out", "again", "--figures"]).expect(0);
    let run = desk.run(&["plot", "saved", "--json"]).expect(0).json();
    let names = desk.names("again/figures");
    assert_eq!(desk.names("saved/figures"), names);
    assert_eq!(run["written"].as_array().unwrap().len(), names.len());
    for kind in
        ["motion", "paths-left", "errors", "joints-left", "velocities-left", "manipulability", "condition"]
    {
        for ending in ["svg", "csv"] {
            let name = format!("{kind}.{ending}");
            assert!(names.contains(&name), "{name} is not among {names:?}");
        }
        // The errors of the two are computed by two ways: in the drawing they are the same but for round-off.
        if !kind.starts_with("errors") {
            let file = format!("figures/{kind}.csv");
            assert_eq!(
                read(&desk, &format!("saved/{file}")),
                read(&desk, &format!("again/{file}")),
                "{kind}"
            );
        }
    }
    let svg = read(&desk, "saved/figures/errors.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let says =
        |tag: &str| document.descendants().find(|node| node.has_tag_name(tag)).and_then(|node| node.text());
    assert_eq!(says("title"), Some("position error over time"));
    assert!(says("desc").unwrap().contains("la6-wang-guo"), "{svg}");
    assert!(svg.contains("start: 4 steps"), "{svg}");
}

#[test]
fn arms_joints_times_and_sizes_are_chosen() {
    let desk = planned();
    let plot =
        |more: &[&str]| desk.run(&[&["plot", "saved", "--out", "chosen", "--force"][..], more].concat());
    plot(&[
        "--figure",
        "joints,velocities",
        "--joint",
        "j2",
        "--from",
        "0.5",
        "--to",
        "1",
        "--size",
        "400x300",
    ])
    .expect(0);
    assert_eq!(
        desk.names("chosen"),
        ["joints-left.csv", "joints-left.svg", "velocities-left.csv", "velocities-left.svg"]
    );
    let csv = read(&desk, "chosen/joints-left.csv");
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    assert!(rows.iter().all(|row| row.starts_with("j2,")), "{csv}");
    assert_eq!(
        (rows.len(), rows[0].split(',').nth(1), rows[50].split(',').nth(1)),
        (51, Some("0.5"), Some("1"))
    );
    let svg = read(&desk, "chosen/joints-left.svg");
    assert!(svg.contains(r#"width="400" height="300""#), "{}", &svg[..200]);
    for (wrong, told) in [
        (&["--figure", "nothing"][..], "there are motion, paths, errors"),
        (&["--arm", "middle"], "there are left"),
        (&["--joint", "j9"], "there are j1, j2, j3, j4"),
        (&["--from", "5"], "less than two samples"),
        (&["--size", "big"], "800x600"),
        (&["--size", "1x1"], "from 160 to 8000"),
    ] {
        let error = plot(wrong).expect(2).err;
        assert!(error.contains(told), "{wrong:?}: {error}");
    }
    desk.run(&["plot", "saved", "--out", "all"]).expect(0);
    desk.run(&["plot", "saved", "--out", "all"]).expect(6);
}

#[test]
fn what_was_not_saved_by_a_command_is_not_drawn() {
    let desk = Desk::new(&[("s.toml", SMALL), ("t.csv", "t,left.j1\n0,1\n"), ("order-x.json", "{}")]);
    for (name, told) in [
        ("nowhere", "can not be read"),
        ("s.toml", "nothing here was saved by a command"),
        ("t.csv", "not what kinstep sweep --out has saved"),
        ("order-x.json", "not what kinstep order --out has saved"),
    ] {
        let error = desk.run(&["plot", name]).expect(6).err;
        assert!(error.contains(told), "{name}: {error}");
    }
    let desk = planned();
    std::fs::write(desk.path("saved/trajectory.csv"), "t,left.j1\n0,0\n1,x\n").unwrap();
    assert!(desk.run(&["plot", "saved"]).expect(2).err.contains("trajectory.csv:3:3"), "the place is told");
}

#[test]
fn pixels_and_pages_come_with_the_feature() {
    let desk = planned();
    let run = desk.run(&["plot", "saved", "--figure", "motion", "--format", "png,pdf", "--size", "300x200"]);
    if cfg!(feature = "raster") {
        run.expect(0);
        let start = |name: &str| std::fs::read(desk.path(name)).unwrap()[..4].to_vec();
        assert_eq!(start("saved/figures/motion.png"), b"\x89PNG");
        assert_eq!(start("saved/figures/motion.pdf"), b"%PDF");
    } else {
        assert!(run.expect(2).err.contains("--features raster"));
    }
}

#[test]
fn a_stopped_run_of_two_samples_and_one_that_diverged_are_drawn() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let plan =
        |more: &[&str]| desk.run(&[&["plan", "s.toml", "--figures", "--force", "--out"][..], more].concat());
    plan(&["diverged", "--set", "law.h=3", "--set", "allow_unstable=true", "--set", "sigma=0.02"]);
    plan(&["singular", "--set", "arm.left.q0=[0, 0, 0, 0]"]);
    for folder in ["diverged/figures", "singular/figures"] {
        let names = desk.names(folder);
        assert!(names.contains(&"joints-left.svg".to_owned()), "{folder}: {names:?}");
        for name in names.iter().filter(|name| is_drawing(name)) {
            let svg = read(&desk, &format!("{folder}/{name}"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{folder}/{name}");
        }
    }
}

#[test]
fn a_long_run_has_small_pictures() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--set", "sigma=2e-5", "--out", "long", "--figures"]).expect(0);
    for name in desk.names("long/figures") {
        let bytes = std::fs::metadata(desk.path(&format!("long/figures/{name}"))).unwrap().len();
        let most = if is_drawing(&name) { 200_000 } else { 1_500_000 };
        assert!(bytes < most, "{name} has {bytes} bytes");
    }
}

#[test]
fn a_sweep_is_drawn_as_a_map_and_its_table_again() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let grid = ["sweep", "s.toml", "--vary", "law.h=0.1,0.2,0.4", "--vary", "sigma=0.02,0.01", "--out"];
    desk.run(&[&grid[..], &["grid.csv", "--plot", "pictures"]].concat()).expect(0);
    assert_eq!(
        desk.names("pictures"),
        ["sweep-lines.csv", "sweep-lines.svg", "sweep-map.csv", "sweep-map.svg"]
    );
    desk.run(&["plot", "grid.csv", "--out", "again"]).expect(0);
    desk.run(&[&grid[..], &["grid.json"]].concat()).expect(0);
    desk.run(&["plot", "grid.json", "--out", "json"]).expect(0);
    let map = read(&desk, "pictures/sweep-map.csv");
    assert_eq!((map.lines().count(), &map), (7, &read(&desk, "again/sweep-map.csv")));
    let sorted = |text: &str| {
        let mut lines: Vec<String> =
            text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().to_owned()).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted(&map), sorted(&read(&desk, "json/sweep-map.csv")));
    assert!(desk.run(&["plot", "grid.csv", "--arm", "left"]).expect(2).err.contains("is a sweep"));
}

#[test]
fn quiet_says_warnings_and_failures_only_and_verbose_what_joints_do() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let run = desk.run(&["plan", "s.toml", "--quiet"]).expect(0);
    assert_eq!((run.out.as_str(), run.err.as_str()), ("", ""));
    let stopped = desk.run(&["plan", "s.toml", "--quiet", "--set", "arm.left.q0=[0, 0, 0, 0]"]).expect(5);
    assert!(stopped.out.is_empty() && stopped.err.contains("stopped, "), "{}", stopped.err);
    assert_eq!(desk.run(&["plan", "s.toml", "--quiet", "--json"]).expect(0).json()["status"], "completed");
    assert!(desk.run(&["plan", "no.toml", "--quiet"]).expect(6).err.contains("no.toml"));
    let robot = desk.run(&["robot", "export", "planar4", "--quiet"]).expect(0);
    assert!(robot.out.contains("<robot"), "a document is no report");
    let verbose = desk.run(&["plan", "s.toml", "-v"]).expect(0);
    assert!(verbose.out.contains("peak velocity") && verbose.err.contains("planning "), "{}", verbose.out);
    desk.run(&["plan", "s.toml", "-v", "--quiet"]).expect(2);
}

#[test]
fn colours_are_those_that_were_asked_for() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let plain = desk.run(&["plan", "s.toml"]).expect(0).out;
    assert!(!plain.contains('\u{1b}'));
    assert_eq!(desk.run(&["plan", "s.toml", "--color", "never"]).expect(0).out, plain);
    let painted = desk.run(&["plan", "s.toml", "--color", "always"]).expect(0).out;
    assert!(painted.contains("\u{1b}[32mcompleted\u{1b}[0m"), "{painted}");
    assert!(!desk.run(&["plan", "s.toml", "--color", "always", "--json"]).expect(0).out.contains('\u{1b}'));
}

#[test]
fn a_study_is_drawn_again() {
    let desk = Desk::new(&[]);
    desk.run(&["order", "kepler", "--formula", "ab4", "--out", "study"]);
    desk.run(&["plot", "study", "--out", "again"]).expect(0);
    assert_eq!(desk.names("again"), ["order-kepler.csv", "order-kepler.svg"]);
    let svg = read(&desk, "again/order-kepler.svg");
    assert!(
        svg.contains("ab4: order ") && svg.contains("sampling gap"),
        "the window that was fitted is named"
    );
    assert!(svg == read(&desk, "study/order-kepler.svg"), "it is not the picture that was written");
}

#[test]
fn a_study_is_drawn_again_by_its_own_criteria() {
    let desk = Desk::new(&[]);
    let study = |floor_margin: &str, out: &str| {
        let set = format!("study.floor_margin={floor_margin}");
        desk.run(&["order", "kepler", "--formula", "ab4", "--set", &set, "--out", out]);
        desk.run(&["plot", out]).expect(0);
        let [own, again] =
            ["", "figures/"].map(|folder| read(&desk, &format!("{out}/{folder}order-kepler.svg")));
        assert!(own == again, "with a floor margin of {floor_margin} another picture is drawn");
        own
    };
    // By a margin so wide most rungs lie near the floor and are left out of the fit.
    assert!(study("100", "usual") != study("1e8", "wide"), "the margin makes no difference here");
}
