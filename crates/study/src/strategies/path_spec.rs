//! Random paths as scenarios write them.

use kinstep::task::TaskKind;
use kinstep_files::scenario::{PathSpec, Real, TimeLawSpec, TurnSpec};
use kinstep_strategies::{PathCase, Shape, TimeLawCase};

/// Returns a random path as a scenario writes it, for an arm whose task Jacobian has that smallest singular value at the start.
pub fn path_spec(
    case: &PathCase,
    smallest_singular_value: f64,
    task: TaskKind,
    law: TimeLawCase,
) -> PathSpec {
    let (name, parameters) = case.shape.parameters(case.scale(smallest_singular_value));
    let mut spec = PathSpec { parameters, ..PathSpec::new(name) };
    if let Shape::Arc(_) = case.shape {
        spec.sweep = Some(case.shape.sweep().into());
    }
    if !matches!(case.shape, Shape::Fourier(_) | Shape::Line(_)) {
        spec.rotation = Some(f64::from(case.rotation).to_radians().into());
    }
    spec.time_law = Some(TimeLawSpec::new(time_law_name(law)));
    let lean = case.lean_angle(smallest_singular_value);
    spec.turn = (task == TaskKind::Pose && lean > 0.0).then(|| TurnSpec {
        axis: PathCase::LEAN_AXIS.map(Real::from),
        angle: lean.into(),
        back: true,
    });
    spec
}

fn time_law_name(law: TimeLawCase) -> &'static str {
    match law {
        TimeLawCase::Sin2 => "sin2",
        TimeLawCase::Sin2Sin2 => "sin2sin2",
        TimeLawCase::Quintic => "quintic",
        TimeLawCase::Linear => "linear",
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
            let (one, other) = (spec.motion(&start, 1.0).unwrap().at(u), Motion::from_pose(case.path(0.5), Linear, 1.0, &start).at(u));
            prop_assert!((one.position - other.position).norm() < 1e-12);
            prop_assert!((one.rotation.matrix() - other.rotation.matrix()).norm() < 1e-12);
        }
    }
}
