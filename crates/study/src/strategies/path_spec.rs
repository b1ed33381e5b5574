//! Random paths as scenarios write them.

use kinstep::task::TaskKind;
use kinstep_files::scenario::{PathKind, PathSpec, Real, TimeLawKind, TurnSpec};
use kinstep_strategies::{PathCase, Shape, TimeLawCase};

/// Returns a random path as a scenario writes it, for an arm whose task Jacobian has that smallest singular value at the start.
pub fn path_spec(
    case: &PathCase,
    smallest_singular_value: f64,
    task: TaskKind,
    law: TimeLawCase,
) -> PathSpec {
    let scale = case.scale(smallest_singular_value);
    let mut spec = PathSpec::new(kind(&case.shape));
    match &case.shape {
        Shape::Fourier(modes) => {
            let vectors = |which: usize| {
                let vector = |(k, mode): (usize, &[[i8; 3]; 2])| {
                    <[f64; 3]>::from(Shape::coefficient(k, mode[which], scale)).map(Real::from)
                };
                modes.iter().enumerate().map(vector).collect()
            };
            (spec.cosines, spec.sines) = (Some(vectors(0)), Some(vectors(1)));
        }
        Shape::Lissajous(x, y) => {
            spec.amplitudes = Some([scale.into(), scale.into()]);
            spec.frequencies = Some([f64::from(*x).into(), f64::from(*y).into()]);
            spec.phase = Some(Shape::PHASE.into());
        }
        Shape::Rose(petals) => {
            (spec.radius, spec.petals) = (Some(scale.into()), Some(f64::from(*petals).into()));
        }
        Shape::Line(direction) => {
            let displacement = Shape::displacement(*direction, scale);
            spec.displacement = Some(displacement.iter().map(|&entry| entry.into()).collect());
        }
        Shape::Arc(degrees) => {
            (spec.radius, spec.sweep) = (Some(scale.into()), Some(f64::from(*degrees).to_radians().into()));
        }
        _ => spec.radius = Some(scale.into()),
    }
    if !matches!(case.shape, Shape::Fourier(_) | Shape::Line(_)) {
        spec.rotation = Some(f64::from(case.rotation).to_radians().into());
    }
    spec.time_law = Some(time_law_kind(law));
    let lean = case.lean_angle(smallest_singular_value);
    spec.turn = (task == TaskKind::Pose && lean > 0.0).then(|| TurnSpec {
        axis: PathCase::LEAN_AXIS.map(Real::from),
        angle: lean.into(),
        back: true,
    });
    spec
}

fn kind(shape: &Shape) -> PathKind {
    match shape {
        Shape::Fourier(_) => PathKind::Fourier,
        Shape::Circle | Shape::Arc(_) => PathKind::Circle,
        Shape::Line(_) => PathKind::Line,
        Shape::Tricuspid => PathKind::Tricuspid,
        Shape::Astroid => PathKind::Astroid,
        Shape::Lissajous(..) => PathKind::Lissajous,
        Shape::Rose(_) => PathKind::Rose,
    }
}

fn time_law_kind(law: TimeLawCase) -> TimeLawKind {
    match law {
        TimeLawCase::Sin2 => TimeLawKind::Sin2,
        TimeLawCase::Sin2Sin2 => TimeLawKind::Sin2sin2,
        TimeLawCase::Quintic => TimeLawKind::Quintic,
        TimeLawCase::Linear => TimeLawKind::Linear,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::nalgebra::IsometryMatrix3;
    use kinstep::task::{Linear, Motion};
    use kinstep_strategies::{open_paths, paths};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_scenario_goes_the_same_way(case in prop_oneof![paths(), open_paths()], u in 0.0..1.0_f64) {
            let start = IsometryMatrix3::identity();
            let spec = path_spec(&case, 0.5, TaskKind::Pose, TimeLawCase::Linear);
            let (one, other) = (spec.motion(&start, 1.0).at(u), Motion::from_pose(case.path(0.5), Linear, 1.0, &start).at(u));
            prop_assert!((one.position - other.position).norm() < 1e-12);
            prop_assert!((one.rotation.matrix() - other.rotation.matrix()).norm() < 1e-12);
        }
    }
}
