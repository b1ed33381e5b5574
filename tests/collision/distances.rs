//! Distances are proved by what convex shapes have: a direction in which their shadows are as far apart as is claimed.

use kinstep::collision::{Capsule, Cuboid, HalfSpace, Separation, Shape, ShapeError};
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Vector3};
use proptest::prelude::*;

/// What rounding may do to shapes of a few metres [m].
const ROUNDING: f64 = 1e-12;

/// Coordinates that often coincide, and often do not.
fn coordinate() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![(-4_i8..=4).prop_map(|quarters| f64::from(quarters) / 4.0), -1.0..1.0_f64]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> + Clone {
    prop::array::uniform3(coordinate()).prop_map(Vector3::from)
}

/// Capsules, and spheres as often.
fn capsules() -> impl Strategy<Value = Capsule> {
    (vector(), vector(), 0.0..0.5_f64, any::<bool>()).prop_map(|(from, to, radius, is_sphere)| {
        Capsule::new(from, if is_sphere { from } else { to }, radius).unwrap()
    })
}

/// Shapes of every kind; the axes of boxes often are those of the world.
fn shapes() -> impl Strategy<Value = Shape> {
    let turn = prop_oneof![Just(Vector3::zeros()), vector()];
    let size = prop::array::uniform3(0.1..1.5_f64).prop_map(Vector3::from);
    let boxes = (vector(), turn, size).prop_map(|(center, turn, size)| {
        let pose = IsometryMatrix3::from_parts(center.into(), Rotation3::new(turn));
        Cuboid::new(pose, size).unwrap().into()
    });
    let solids = (vector(), vector())
        .prop_filter_map("a normal", |(point, normal)| HalfSpace::new(point, normal).ok().map(Shape::from));
    prop_oneof![capsules().prop_map(Shape::from), boxes, solids]
}

/// The furthest that a shape reaches in a direction; infinite where it has no end.
fn reach(shape: &Shape, direction: &Vector3<f64>) -> f64 {
    match shape {
        Shape::Capsule(capsule) => {
            capsule.from().dot(direction).max(capsule.to().dot(direction)) + capsule.radius()
        }
        Shape::Box(cuboid) => {
            let own = cuboid.pose().rotation.inverse() * direction;
            cuboid.pose().translation.vector.dot(direction) + cuboid.half_sides().dot(&own.abs())
        }
        Shape::HalfSpace(solid) => {
            let foot = -solid.normal() * solid.height_of(&Vector3::zeros());
            if (solid.normal() - direction).norm() < 1e-9 { foot.dot(direction) } else { f64::INFINITY }
        }
        _ => unreachable!(),
    }
}

/// How far the shadows of a capsule and a shape are apart on a unit vector that points to the capsule.
fn gap(capsule: &Capsule, shape: &Shape, direction: &Vector3<f64>) -> f64 {
    -reach(&Shape::from(*capsule), &-direction) - reach(shape, direction)
}

fn shifted(capsule: &Capsule, by: Vector3<f64>) -> Capsule {
    Capsule::new(capsule.from() + by, capsule.to() + by, capsule.radius()).unwrap()
}

fn is_finite(separation: &Separation) -> bool {
    let Separation { distance, normal, points } = separation;
    distance.is_finite() && normal.iter().chain(points.iter().flatten()).all(|number| number.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn the_normal_proves_the_distance(capsule in capsules(), shape in shapes(), other in vector()) {
        let found = capsule.separation_from(&shape);
        prop_assert!(is_finite(&found), "{:?}", found);
        prop_assert!((found.normal.norm() - 1.0).abs() < ROUNDING);
        // No direction parts them further, and this one does by as much as is said.
        let proved = gap(&capsule, &shape, &found.normal);
        prop_assert!((proved - found.distance).abs() < ROUNDING, "{proved} {:?}", found);
        if let Some(direction) = other.try_normalize(1e-3) {
            prop_assert!(gap(&capsule, &shape, &direction) < found.distance + ROUNDING);
        }
    }

    #[test]
    fn witnesses_lie_on_both_surfaces_and_a_shift_brings_them_together(capsule in capsules(), shape in shapes()) {
        let found = capsule.separation_from(&shape);
        let [on_capsule, on_shape] = found.points;
        prop_assert!((on_capsule - on_shape - found.normal * found.distance).norm() < ROUNDING);
        prop_assert!(capsule.distance_to(&on_capsule).abs() < 1e-11 || found.distance < 0.0);
        prop_assert!(capsule.distance_to(&on_capsule) < 1e-11);
        let probe = Capsule::sphere(on_shape, 0.0).unwrap();
        prop_assert!(probe.separation_from(&shape).distance < 1e-11, "{:?}", found);
        let parted = shifted(&capsule, -found.normal * found.distance).separation_from(&shape);
        prop_assert!(parted.distance.abs() < 1e-10, "{:?} {:?}", found, parted);
    }

    #[test]
    fn a_distance_changes_by_no_more_than_a_shift(capsule in capsules(), shape in shapes(), shift in vector()) {
        let (here, there) = (capsule.separation_from(&shape), shifted(&capsule, shift).separation_from(&shape));
        prop_assert!((there.distance - here.distance).abs() <= shift.norm() + ROUNDING);
    }

    #[test]
    fn two_capsules_see_each_other_alike(a in capsules(), b in capsules()) {
        let (there, back) = (a.separation(&b), b.separation(&a));
        prop_assert!((there.distance - back.distance).abs() < ROUNDING);
    }

    #[test]
    fn no_point_of_a_segment_is_nearer_to_a_box(capsule in capsules(), shape in shapes(), part in 0.0..=1.0_f64) {
        let point = capsule.from().lerp(&capsule.to(), part);
        let ball = Capsule::sphere(point, capsule.radius()).unwrap();
        let (whole, part) = (capsule.separation_from(&shape), ball.separation_from(&shape));
        prop_assert!(part.distance > whole.distance - ROUNDING);
    }

    #[test]
    fn any_finite_numbers_give_finite_distances(
        numbers in prop::array::uniform9(prop_oneof![Just(0.0), Just(-0.0), Just(1e-320), Just(1e-170), -1e6..1e6_f64, -1e-6..1e-6_f64]),
        sides in prop::array::uniform3(prop_oneof![Just(1e-300), 1e-9..1e6_f64]),
    ) {
        let [a, b, c] = [0, 3, 6].map(|i| Vector3::new(numbers[i], numbers[i + 1], numbers[i + 2]));
        let (one, two) = (Capsule::new(a, b, 0.0).unwrap(), Capsule::new(b, c, 1e-3).unwrap());
        let cuboid = Cuboid::new(IsometryMatrix3::from_parts(b.into(), Rotation3::new(a)), sides.into()).unwrap();
        for shape in [two.into(), cuboid.into()] {
            let found = one.separation_from(&shape);
            prop_assert!(is_finite(&found) && (found.normal.norm() - 1.0).abs() < 1e-9, "{:?}", found);
        }
    }
}

fn capsule(from: [f64; 3], to: [f64; 3], radius: f64) -> Capsule {
    Capsule::new(from.into(), to.into(), radius).unwrap()
}

fn cube() -> Shape {
    Cuboid::new(IsometryMatrix3::identity(), Vector3::repeat(2.0)).unwrap().into()
}

#[test]
fn parallel_capsules_touch_in_the_middle_of_what_faces_the_other() {
    let (a, b) = (capsule([0.0; 3], [2.0, 0.0, 0.0], 0.1), capsule([3.0, 0.5, 0.0], [1.0, 0.5, 0.0], 0.1));
    let found = a.separation(&b);
    assert!((found.distance - 0.3).abs() < 1e-15);
    assert!((found.points[0] - Vector3::new(1.5, 0.1, 0.0)).norm() < 1e-15, "{found:?}");
    let in_line = capsule([5.0, 0.0, 0.0], [9.0, 0.0, 0.0], 0.1).separation(&a);
    assert!((in_line.distance - 2.8).abs() < 1e-15);
}

#[test]
fn what_coincides_still_has_a_direction() {
    let ball = capsule([0.2; 3], [0.2; 3], 0.1);
    assert_eq!(ball.separation(&ball).distance, -0.2);
    let bar = capsule([0.0; 3], [1.0, 0.0, 0.0], 0.1);
    let across = capsule([0.5, -1.0, 0.0], [0.5, 1.0, 0.0], 0.2);
    let found = bar.separation(&across);
    assert!((found.distance + 0.3).abs() < 1e-15 && found.normal.z.abs() == 1.0, "{found:?}");
    assert!(bar.separation(&bar).normal.x.abs() < 1e-15);
}

#[test]
fn a_centre_inside_a_box_leaves_through_the_nearest_face() {
    let ball = capsule([0.0, 0.0, 0.7], [0.0, 0.0, 0.7], 0.25);
    let found = ball.separation_from(&cube());
    assert!((found.distance + 0.55).abs() < 1e-15 && found.normal == Vector3::z());
    let middle = capsule([0.0; 3], [0.0; 3], 0.25).separation_from(&cube());
    assert_eq!(middle.distance, -1.25);
}

#[test]
fn a_segment_through_a_corner_leaves_over_the_edge() {
    // It cuts the edge x = y = 1 at a depth of a tenth along the diagonal.
    let near = 1.0 - 0.1 / 2.0_f64.sqrt();
    let bar = capsule([near + 1.0, near - 1.0, 0.0], [near - 1.0, near + 1.0, 0.0], 0.0);
    let found = bar.separation_from(&cube());
    assert!((found.distance + 0.1).abs() < 1e-12, "{found:?}");
    assert!((found.normal - Vector3::new(1.0, 1.0, 0.0).normalize()).norm() < 1e-12);
}

#[test]
fn numbers_that_make_no_shape_are_refused_with_a_remedy() {
    let zero = Vector3::zeros();
    let said = |error: ShapeError| error.to_string();
    assert!(
        said(Capsule::sphere(zero, -0.1).unwrap_err()).contains("`radius` is -0.1: a radius is a length [m]")
    );
    assert!(
        said(Capsule::new(zero, Vector3::repeat(f64::NAN), 0.1).unwrap_err())
            .starts_with("`to`: NaN is not a finite")
    );
    assert!(said(Capsule::sphere(Vector3::repeat(1e9), 0.1).unwrap_err()).contains("beyond any arm"));
    assert!(said(HalfSpace::new(zero, zero).unwrap_err()).contains("it has no direction; give"));
    let plate = Cuboid::new(IsometryMatrix3::identity(), Vector3::new(1.0, 1.0, 0.0));
    assert!(said(plate.unwrap_err()).contains("give a plate its thickness"));
    assert!(HalfSpace::new(zero, Vector3::new(0.0, 0.0, 1e-300)).is_ok(), "any length will do");
    assert!(Capsule::new(zero, zero, 0.1).unwrap().is_sphere());
}
