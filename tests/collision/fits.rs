//! Capsules contain what they were fitted to.

use kinstep::collision::CollisionModel;
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Vector3};
use kinstep::robot::Robot;
use proptest::prelude::*;
use std::fmt::Write as _;

fn fitted(geometry: &str, folder: Option<&std::path::Path>) -> CollisionModel {
    let urdf = format!(
        r#"<robot name="r"><link name="l"><collision><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/>
           <geometry>{geometry}</geometry></collision></link></robot>"#
    );
    CollisionModel::from_urdf(&Robot::from_urdf(&urdf).unwrap(), &urdf, folder)
}

fn origin() -> IsometryMatrix3<f64> {
    let turn = Rotation3::from_euler_angles(0.4, -0.5, 0.6);
    IsometryMatrix3::from_parts(Vector3::new(0.1, -0.2, 0.3).into(), turn)
}

/// How far a point of the shape, in the shape's own axes, is outside of the one capsule.
fn outside(model: &CollisionModel, point: Vector3<f64>) -> f64 {
    let [capsule] = model.capsules() else { panic!("{:?}", model.missing()) };
    capsule.capsule.distance_to(&(origin().rotation * point + origin().translation.vector))
}

fn unit() -> impl Strategy<Value = f64> {
    -1.0..=1.0_f64
}

proptest! {
    #[test]
    fn boxes_are_inside(sides in prop::array::uniform3(0.01..1.0_f64)) {
        let [a, b, c] = sides;
        let model = fitted(&format!(r#"<box size="{a} {b} {c}"/>"#), None);
        for corner in 0..8 {
            let sign = |bit: usize| if corner & (1 << bit) == 0 { -0.5 } else { 0.5 };
            prop_assert!(outside(&model, Vector3::from_fn(|i, _| sides[i] * sign(i))) < 1e-12);
        }
        let ratio = model.fits()[0].volume_ratio.unwrap();
        prop_assert!(ratio >= 1.0);
        // No larger than the sphere around the box.
        let sphere = 4.0 / 3.0 * std::f64::consts::PI * (Vector3::from(sides).norm() / 2.0).powi(3);
        prop_assert!(ratio * a * b * c < 1.001 * sphere);
    }

    #[test]
    fn cylinders_are_inside(radius in 0.01..0.5_f64, length in 0.01..1.0_f64, angle in 0.0..6.3_f64, part in 0.0..=1.0_f64, height in unit()) {
        let model = fitted(&format!(r#"<cylinder radius="{radius}" length="{length}"/>"#), None);
        let (sine, cosine) = angle.sin_cos();
        for (part, height) in [(part, height), (1.0, 1.0), (1.0, -1.0)] {
            let point = Vector3::new(radius * part * cosine, radius * part * sine, height * length / 2.0);
            prop_assert!(outside(&model, point) < 1e-12);
        }
        // The plain way, with half spheres on both ends, is never tighter.
        let plain = 1.0 + 4.0 / 3.0 * radius / length;
        prop_assert!(model.fits()[0].volume_ratio.unwrap() <= plain * (1.0 + 1e-9));
    }

    #[test]
    fn spheres_and_capsules_are_exact(radius in 0.01..0.5_f64, length in 0.01..1.0_f64) {
        for geometry in [format!(r#"<sphere radius="{radius}"/>"#), format!(r#"<capsule radius="{radius}" length="{length}"/>"#)] {
            let model = fitted(&geometry, None);
            prop_assert!((model.fits()[0].volume_ratio.unwrap() - 1.0).abs() < 1e-12);
            prop_assert!((outside(&model, Vector3::new(radius, 0.0, 0.0))).abs() < 1e-12);
        }
    }

    #[test]
    fn the_corners_of_meshes_are_inside(corners in prop::collection::vec(prop::array::uniform3(-100_i32..=100), 3..40)) {
        let folder = tempfile::tempdir().unwrap();
        let mut obj = String::new();
        for [x, y, z] in &corners {
            let _ = writeln!(obj, "v {x} {y} {z}");
        }
        for last in 3..=corners.len() {
            let _ = writeln!(obj, "f {} {} {last}", last - 2, last - 1);
        }
        std::fs::write(folder.path().join("body.obj"), obj).unwrap();
        let model = fitted(r#"<mesh filename="body.obj" scale="0.001 0.002 -0.003"/>"#, Some(folder.path()));
        for [x, y, z] in corners {
            let point = Vector3::new(0.001 * f64::from(x), 0.002 * f64::from(y), -0.003 * f64::from(z));
            prop_assert!(outside(&model, point) < 1e-9);
        }
    }
}

#[test]
fn a_mesh_of_a_rod_becomes_a_rod() {
    let folder = tempfile::tempdir().unwrap();
    // A closed box of 10 cm by 2 cm by 2 cm.
    let corner = |i: usize| [i & 1, (i >> 1) & 1, (i >> 2) & 1].map(|bit| bit as f64);
    let vertex = |i: usize| {
        let [x, y, z] = corner(i);
        format!("v {} {} {}\n", 0.1 * x, 0.02 * y, 0.02 * z)
    };
    let corners = (0..8).map(vertex).collect::<Vec<_>>().concat();
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    std::fs::write(folder.path().join("rod.obj"), corners + faces).unwrap();
    let model = fitted(r#"<mesh filename="rod.obj"/>"#, Some(folder.path()));
    let fit = &model.fits()[0];
    assert!((0.009..0.0145).contains(&(fit.radius)) || fit.radius < 0.02, "{fit:?}");
    assert!(fit.length > 0.05 && fit.volume_ratio.unwrap() < 2.5, "{fit:?}");
}

#[test]
fn what_can_not_be_fitted_is_said() {
    let reason = |geometry: &str, folder| fitted(geometry, folder).missing()[0].reason.clone();
    let mesh = r#"<mesh filename="package://arm/lost.stl"/>"#;
    assert!(reason(mesh, None).contains("from where to look for it is not known"));
    let here = tempfile::tempdir().unwrap();
    assert!(
        reason(mesh, Some(here.path())).contains("is in no file that was found; give the link a capsule")
    );
    assert!(reason(r#"<sphere radius="-1"/>"#, None).contains("whose `radius` is -1"));
    assert!(reason(r#"<sphere radius="1e9"/>"#, None).contains("beyond any arm"));
    assert!(fitted(mesh, None).capsules().is_empty());
}
