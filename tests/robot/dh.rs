//! Denavit-Hartenberg tables: equal to the same robots as URDF, and refused with the place of what is wrong.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3, Vector6};
use kinstep::robot::{
    Chain, DhConvention, DhError, DhRow, DhTable, JointKind, Limits, Robot, UrdfOptions, embedded,
};

/// Numbers that look random and are the same every time.
fn samples(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|n| (n as f64 * 0.754_877_666_246_692_7).fract() * 2.0 - 1.0)
}

fn example(name: &str) -> Robot {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/dh").join(name);
    Robot::from_file(path, &UrdfOptions::default()).unwrap()
}

/// The largest difference of poses and Jacobians of two chains at 200 configurations.
fn difference(one: &Chain, other: &Chain) -> f64 {
    let dof = one.dof();
    assert_eq!(one.joints(), other.joints(), "names, kinds and limits");
    let mut numbers = samples(200 * dof);
    let run = |chain: &Chain, q: &[f64]| {
        let mut columns = vec![Vector6::zeros(); dof];
        let mut scratch = chain.scratch();
        let posed = chain.forward(q, &mut scratch);
        posed.geometric_jacobian(&mut columns);
        (posed.pose(), columns)
    };
    let mut worst = 0.0_f64;
    for _ in 0..200 {
        let q: Vec<f64> = numbers.by_ref().take(dof).map(|x| 3.0 * x).collect();
        let ((pose, columns), (other_pose, other_columns)) = (run(one, &q), run(other, &q));
        worst = worst.max((pose.translation.vector - other_pose.translation.vector).amax());
        worst = worst.max((pose.rotation.matrix() - other_pose.rotation.matrix()).amax());
        let pairs = columns.iter().zip(&other_columns);
        worst = pairs.map(|(a, b)| (a - b).amax()).fold(worst, f64::max);
    }
    worst
}

#[test]
fn the_modified_table_of_the_panda_is_its_urdf() {
    let (table, urdf) = (example("panda.toml"), embedded::get("panda").unwrap());
    for (base, tip) in [("panda_link0", "panda_link8"), ("panda_link7", "panda_link2")] {
        let off = difference(&table.chain(base, tip).unwrap(), &urdf.chain(base, tip).unwrap());
        assert!(off < 1e-12, "{base} to {tip}: {off:e}");
    }
}

#[test]
fn the_standard_table_of_the_ur5e_is_its_urdf() {
    let (table, urdf) = (example("ur5e.toml"), embedded::get("ur5e").unwrap());
    let off = difference(&table.chain("base", "tool0").unwrap(), &urdf.chain("base", "tool0").unwrap());
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn four_unit_lengths_are_the_planar_arm() {
    let table = Robot::from_dh(&DhTable::planar("planar4", &[1.0; 4])).unwrap();
    let urdf = embedded::get("planar4").unwrap();
    for (base, tip) in [("base", "tip"), ("link3", "link1"), ("link2", "tip")] {
        assert_eq!(difference(&table.chain(base, tip).unwrap(), &urdf.chain(base, tip).unwrap()), 0.0);
    }
    let planar = example("planar3.toml");
    assert_eq!(planar.name(), "planar3");
    let chain = planar.chain("base", "tip").unwrap();
    assert!((chain.reach() - 2.8).abs() < 1e-15);
    let limit = 5.0 * std::f64::consts::PI / 6.0;
    assert!(
        chain.joints().iter().all(|joint| joint.limits
            == Limits { lower: -limit, upper: limit, velocity: 2.0, ..Limits::UNLIMITED })
    );
}

fn turn_x(angle: f64) -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(
        Translation3::identity(),
        Rotation3::from_axis_angle(&Vector3::x_axis(), angle),
    )
}

fn turn_z(angle: f64) -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(
        Translation3::identity(),
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle),
    )
}

/// Both customs from their definitions, frame after frame.
fn product(table: &DhTable, q: &[f64]) -> Vec<IsometryMatrix3<f64>> {
    let mut pose = IsometryMatrix3::identity();
    let mut poses = Vec::new();
    for (row, &q) in table.rows.iter().zip(q) {
        let (theta, d) = match row.kind {
            JointKind::Prismatic => (row.theta, row.d + q),
            JointKind::Fixed => (row.theta, row.d),
            _ => (row.theta + q, row.d),
        };
        let (z, x) =
            (IsometryMatrix3::translation(0.0, 0.0, d), IsometryMatrix3::translation(row.a, 0.0, 0.0));
        pose *= match table.convention {
            DhConvention::Standard => turn_z(theta) * z * x * turn_x(row.alpha),
            DhConvention::Modified => turn_x(row.alpha) * x * turn_z(theta) * z,
        };
        poses.push(pose);
    }
    poses
}

#[test]
fn every_frame_of_a_random_table_is_the_product_of_its_rows() {
    let mut numbers = samples(100_000);
    let kinds = [JointKind::Revolute, JointKind::Prismatic, JointKind::Continuous, JointKind::Fixed];
    for case in 0..100 {
        let convention = if case % 2 == 0 { DhConvention::Standard } else { DhConvention::Modified };
        let rows: Vec<DhRow> = (0..7)
            .map(|i| DhRow {
                joint: format!("j{i}"),
                link: format!("l{i}"),
                kind: if i == 0 { JointKind::Revolute } else { kinds[(case * 7 + i * i) % 4] },
                a: numbers.next().unwrap(),
                alpha: 3.0 * numbers.next().unwrap(),
                d: numbers.next().unwrap(),
                theta: 3.0 * numbers.next().unwrap(),
                flip: false,
                limits: Limits::UNLIMITED,
            })
            .collect();
        let table = DhTable { name: "random".into(), base: "base".into(), convention, rows };
        let robot = Robot::from_dh(&table).unwrap();
        let q: Vec<f64> = numbers.by_ref().take(7).collect();
        for (row, expected) in product(&table, &q).iter().enumerate() {
            let chain = robot.chain("base", &format!("l{row}")).unwrap();
            let moving = (0..=row).filter(|&i| table.rows[i].kind != JointKind::Fixed).map(|i| q[i]);
            let pose = chain.forward(&moving.collect::<Vec<_>>(), &mut chain.scratch()).pose();
            let off = (pose.translation.vector - expected.translation.vector).amax()
                + (pose.rotation.matrix() - expected.rotation.matrix()).amax();
            assert!(off < 1e-13, "case {case}, frame {row}: {off:e}");
        }
    }
}

fn refusals(text: &str) -> Vec<String> {
    match DhTable::from_toml(text) {
        Err(DhError::Text(found)) => found.iter().map(ToString::to_string).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn everything_that_is_wrong_with_a_table_is_said_with_its_place() {
    let text = "convention = \"craig\"\ncolour = 3\n[[joint]]\nalhpa = 1\na = \"pie\"\n[[joint]]\nkind = \"ball\"\n[[joint]]\n\
                limits = [2, 1]\n[[joint]]\nd = 1e7\nlimits = 3\n[[joint]]\nkind = \"continuous\"\nlimits = [0, 1]\n";
    assert_eq!(
        refusals(text),
        [
            "1:14: error: `craig` is no convention: \"standard\" is Rz(theta) Tz(d) Tx(a) Rx(alpha), \"modified\" (Craig) is \
             Rx(alpha) Tx(a) Rz(theta) Tz(d)",
            "2:1: error: a table of a robot has no key `colour`; it has `name`, `base`, `convention`, `joint`, `planar`, \
             `limits`, `velocity`, `acceleration` and `jerk`",
            "4:1: error: a row has no key `alhpa`; did you mean `alpha`?",
            "5:5: error: `a`: \"pie\", column 1: 'pie' is not known; known are pi and functions such as sin, atan2, sqrt, min",
            "7:8: error: `ball` is no kind of joint; rows are `revolute`, `continuous`, `prismatic` or `fixed`",
            "9:10: error: joint `joint3`: its lower limit 2 is greater than its upper limit 1",
            "11:5: error: `d`: 1e7 is beyond any arm; lengths [m] and angles [rad] are at most 1e6 in size",
            "12:10: error: `limits`: expected two numbers, [lower, upper], found the integer `3`",
            "15:10: error: joint `joint5`: a continuous joint has no limits; make it revolute, or leave them out",
        ]
    );
}

#[test]
fn a_table_without_an_arm_says_what_to_write() {
    for (text, said) in [
        ("", "there is no arm in this file"),
        ("name = \"x\"", "there is no arm in this file"),
        ("convention = ", "not TOML"),
        ("[[joint]]\na = 1", "the key `convention` is missing"),
        ("planar = [1]\n[[joint]]\na = 1", "both describe the arm"),
        ("planar = \"long\"", "expected a list of numbers"),
        ("planar = [1, nan]", "this is not a number"),
        ("planar = []", "no row of the table moves"),
        (
            "planar = [1]\nlimits = [1, -1]",
            "2:10: error: its lower limit 1 is greater than its upper limit -1",
        ),
        ("planar = [1]\nvelocity = 0", "2:12: error: its velocity limit 0 lets it never move"),
        ("planar = [1]\nbase = \"\"", "2:8: error: `base` is empty"),
        (
            "planar = [1]\nbase = \"j1\"\nname = \"a\\u0000\"",
            r"3:8: error: `name` holds the character `\u{0}`",
        ),
        ("planar = [1]\nbase = \"link1\"", "1:10: error: link `link1` is there already"),
        ("convention = \"standard\"\njoint = [3]", "expected rows that are tables"),
        ("convention = \"standard\"\njoint = 3", "each begun by a line [[joint]]"),
        ("convention = \"standard\"\nvelocity = 3\n[[joint]]\na = 1", "belongs into the rows"),
        ("convention = \"standard\"\n[[joint]]\nkind = \"fixed\"", "no row of the table moves"),
        ("[joint.j2]\nzero = 0.01", "looks like a calibration"),
        ("sigma = 0.01\n[[arm]]\nname = \"left\"", "looks like a scenario"),
    ] {
        let found = refusals(text);
        assert!(found.iter().any(|found| found.contains(said)), "{text:?}: {found:?}");
    }
}

#[test]
fn names_are_checked_at_their_rows() {
    let row = "[[joint]]\nlimits = [-1, 1]\n";
    let text = format!(
        "convention = \"standard\"\nbase = \"a\\u001b[31mb\\u0000\"\n{row}name = \"one\"\n{row}name = \"one\"\n{row}link = \"\"\n{row}velocity = 0\n"
    );
    assert_eq!(
        refusals(&text),
        [
            r"2:8: error: `base` holds the character `\u{1b}`, which no URDF can hold",
            "14:12: error: joint `joint4`: its velocity limit 0 lets it never move; give a positive one",
        ],
        "a base without a name leaves the others open"
    );
    let text = text
        .replace("base = \"a\\u001b[31mb\\u0000\"", "base = \"link4_axis\"")
        .replace("velocity = 0\n", "link = \"link4\"\n");
    assert_eq!(
        refusals(&text),
        [
            "6:1: error: joint `one` is there already; every joint needs its own name",
            "9:1: error: the name of its link is empty",
            "12:1: error: link `link4_axis` is there already; every link needs its own name",
        ]
    );
    // What a table may be called can be written down and read.
    let odd = "planar = [1]\nbase = \"a <b> &\\n$\\u009b\"\nname = \"c d\"";
    let robot = Robot::from_dh(&DhTable::from_toml(odd).unwrap()).unwrap();
    let again = Robot::from_urdf(&robot.to_urdf().unwrap()).unwrap();
    assert_eq!((again.name(), again.links()), (robot.name(), robot.links()));
}

#[test]
fn a_table_made_by_a_program_is_checked_as_one_from_a_file() {
    let arm = DhTable::planar("arm", &[1.0, 1.0]);
    let refused = |change: &dyn Fn(&mut DhTable)| {
        let mut table = arm.clone();
        change(&mut table);
        Robot::from_dh(&table).unwrap_err().to_string()
    };
    assert!(refused(&|table| table.rows.clear()).contains("0 rows, 0 of which move"));
    assert!(refused(&|table| table.rows[1].a = f64::NAN).starts_with("row 2 of the table: `a` is NaN"));
    assert!(refused(&|table| table.rows[1].kind = JointKind::Floating).contains("can not be floating"));
    assert!(refused(&|table| table.rows[1].joint = "j1".into()).contains("joint `j1` is there already"));
    assert!(refused(&|table| table.rows[1].link = "base".into()).contains("link `base` is there already"));
    assert!(refused(&|table| table.rows[0].link = " ".into()).contains("the name of its link is empty"));
    assert_eq!(
        refused(&|table| table.base = "\u{0}".into()),
        r"`base` of the table holds the character `\u{0}`, which no URDF can hold"
    );
    assert!(
        refused(&|table| table.rows[1].limits.upper = f64::NEG_INFINITY).contains("no position lies between")
    );
}

#[test]
fn a_file_is_known_by_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        Robot::from_file(folder.path().join(name), &UrdfOptions::default())
    };
    assert_eq!(read("arm.toml", "planar = [1]").unwrap().name(), "arm");
    assert_eq!(read("arm", "\u{feff}# two links\nplanar = [1, 2]\nname = \"two\"").unwrap().name(), "two");
    let urdf = embedded::text("planar4").unwrap();
    assert_eq!(read("misnamed.toml", urdf).unwrap().joints(), embedded::get("planar4").unwrap().joints());
    let yaml = read("arm.urdf", "robot:\n  name: arm\n").unwrap_err().to_string();
    assert!(yaml.contains("this is not XML"), "{yaml}");
    let wrong = read("wrong.toml", "planar = [1]\ncolor = 1").unwrap_err();
    assert!(wrong.to_string().contains("wrong.toml:2:1: a table of a robot has no key `color`"), "{wrong}");
    assert_eq!(wrong.diagnostics().len(), 1);
}

#[test]
fn degrees_and_millimetres_in_a_table_are_questioned() {
    let folder = std::env::temp_dir().join(format!("kinstep-units-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let said = |rows: &str| {
        let path = folder.join("arm.toml");
        std::fs::write(&path, format!("convention = \"standard\"\njoint = [{rows}]\n")).unwrap();
        let robot = Robot::from_file(&path, &kinstep::robot::UrdfOptions::default()).unwrap();
        robot.diagnostics().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let found = said("{ a = 400, alpha = 90, limits = [-180, 180] }");
    let words = ["`a`: 400 m is long", "`alpha`: 90 looks like degrees", "`limits`: -180 looks like degrees"];
    assert!(
        found.len() == 3 && found.iter().zip(words).all(|(found, words)| found.contains(words)),
        "{found:?}"
    );
    assert!(said("{ a = 0.4, alpha = \"pi/2\", limits = [-6.5, 6.5] }").is_empty());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn offsets_and_flips_are_those_of_the_robotics_toolbox() {
    // RevoluteDH turns by -q + offset when flipped, PrismaticDH slides by q + offset.
    let text = "convention = \"standard\"\njoint = [{ a = 0.5, alpha = \"pi/2\", offset = 0.3, flip = true }, { kind = \"prismatic\", offset = 0.2, limits = [0, 1] }]\n";
    let robot = Robot::from_dh(&DhTable::from_toml(text).unwrap()).unwrap();
    let chain = robot.chain("base", "tip").unwrap();
    let by_hand = "convention = \"standard\"\njoint = [{ a = 0.5, alpha = \"pi/2\" }, { kind = \"prismatic\", limits = [-2, 2] }]\n";
    let plain = Robot::from_dh(&DhTable::from_toml(by_hand).unwrap()).unwrap().chain("base", "tip").unwrap();
    for (q, slide) in [(0.0, 0.0), (0.4, 0.1), (-1.3, 0.7)] {
        let own = chain.forward(&[q, slide], &mut chain.scratch()).pose();
        let other = plain.forward(&[-q + 0.3, slide + 0.2], &mut plain.scratch()).pose();
        assert!((own.to_homogeneous() - other.to_homogeneous()).norm() < 1e-15);
    }
}
