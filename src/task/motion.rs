use super::{Hold, Linear, Path, TimeLaw};
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3, Vector6};
use std::sync::Arc;

/// Where a tip shall be at an instant, and how it shall move there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Position in the world \[m\].
    pub position: Vector3<f64>,
    /// Orientation in the world.
    pub rotation: Rotation3<f64>,
    /// Twist (linear [m/s]; angular [rad/s]) in world axes.
    pub twist: Vector6<f64>,
}

impl Reference {
    /// Nothing but a value to be overwritten: at rest in the origin, turned by nothing.
    pub(crate) const REST: Self = Self {
        position: Vector3::new(0.0, 0.0, 0.0),
        rotation: Rotation3::from_matrix_unchecked(Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)),
        twist: Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };
}

/// What a tip shall do in the course of time: a path run through in a given time and laid to where an arm stands,
/// `p(t) = origin + path(u(t / T))`, `R(t) = turn(u(t / T)) R_0`, or references sampled beforehand.
pub struct Motion {
    course: Course,
}

enum Course {
    Curve(Curve),
    Samples { references: Arc<[Reference]>, sigma: f64 },
}

struct Curve {
    path: Box<dyn Path>,
    time_law: Box<dyn TimeLaw>,
    duration: f64,
    origin: Vector3<f64>,
    initial: Rotation3<f64>,
}

impl std::fmt::Debug for Motion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut motion = f.debug_struct("Motion");
        match &self.course {
            Course::Curve(curve) => motion.field("duration", &curve.duration).field("origin", &curve.origin),
            Course::Samples { references, sigma } => {
                motion.field("samples", &references.len()).field("sigma", sigma)
            }
        };
        motion.finish_non_exhaustive()
    }
}

impl Motion {
    /// Returns the motion along the path shifted so that it begins at the pose `start` \[m\], run through in `duration`
    /// \[s\].
    pub fn from_pose(
        path: impl Path + 'static,
        time_law: impl TimeLaw + 'static,
        duration: f64,
        start: &IsometryMatrix3<f64>,
    ) -> Self {
        let beginning = path.point(time_law.progress(0.0).0).position;
        Self::centered(path, time_law, duration, start.translation.vector - beginning, start.rotation)
    }

    /// Returns the motion along the path with its own origin at `center` \[m\], beginning with the orientation
    /// `initial`.
    pub fn centered(
        path: impl Path + 'static,
        time_law: impl TimeLaw + 'static,
        duration: f64,
        center: Vector3<f64>,
        initial: Rotation3<f64>,
    ) -> Self {
        let (path, time_law) = (Box::new(path), Box::new(time_law));
        Self { course: Course::Curve(Curve { path, time_law, duration, origin: center, initial }) }
    }

    /// References that were computed or recorded elsewhere, the first at `t = 0` and then every `sigma` \[s\]: sample `n`
    /// holds around `t = n sigma`, the last one, at rest, ever after. Plans can share them.
    ///
    /// Runge-Kutta starters look between the samples; give the first states yourself, or start by `paper` or `ramp`.
    ///
    /// # Panics
    /// When there are no references, or `sigma` is not positive.
    pub fn sampled(references: impl Into<Arc<[Reference]>>, sigma: f64) -> Self {
        let references = references.into();
        assert!(!references.is_empty(), "a sampled motion needs at least one reference");
        assert!(sigma > 0.0, "the sampling gap of a motion must be positive");
        Self { course: Course::Samples { references, sigma } }
    }

    /// Returns the reference at time `t` \[s\]; before the beginning and after the end the motion is at rest.
    pub fn at(&self, t: f64) -> Reference {
        match &self.course {
            Course::Curve(curve) => curve.at(t),
            Course::Samples { references, sigma } => {
                let recorded = place_of_sample(t, *sigma).and_then(|place| references.get(place));
                recorded.copied().unwrap_or_else(|| {
                    let end = if t < 0.0 { &references[0] } else { &references[references.len() - 1] };
                    Reference { twist: Vector6::zeros(), ..*end }
                })
            }
        }
    }

    /// How many derivatives of path and time law are continuous; `None` where all are, or where that is not known because the
    /// motion was sampled.
    pub fn smoothness(&self) -> Option<usize> {
        match &self.course {
            Course::Curve(curve) => {
                curve.path.smoothness().into_iter().chain(curve.time_law.smoothness()).min()
            }
            Course::Samples { .. } => None,
        }
    }

    /// The motion that stays at a pose.
    pub fn held(pose: &IsometryMatrix3<f64>) -> Self {
        Self::from_pose(Hold, Linear, 1.0, pose)
    }

    /// The progress along its path at time `t` \[s\] and its rate [1/s], if it has a path.
    pub(super) fn progress(&self, t: f64) -> Option<(f64, f64)> {
        match &self.course {
            Course::Curve(curve) => Some(curve.progress(t)),
            Course::Samples { .. } => None,
        }
    }

    /// The tangent `d position / du` \[m\] of its path at progress `u`, if it has a path.
    pub(super) fn tangent(&self, u: f64) -> Option<Vector3<f64>> {
        match &self.course {
            Course::Curve(curve) => Some(curve.path.point(u).tangent),
            Course::Samples { .. } => None,
        }
    }

    /// The references that it was made of and their gap \[s\], if it was sampled beforehand.
    pub(crate) fn samples(&self) -> Option<(&Arc<[Reference]>, f64)> {
        match &self.course {
            Course::Curve(_) => None,
            Course::Samples { references, sigma } => Some((references, *sigma)),
        }
    }
}

/// Which sample holds at time `t`, the first being that of `t = 0`.
#[inline]
pub(crate) fn place_of_sample(t: f64, sigma: f64) -> Option<usize> {
    let place = t / sigma + 0.5;
    (place >= 0.0).then_some(place as usize)
}

impl Curve {
    /// The progress and its rate [1/s] at time `t` \[s\].
    fn progress(&self, t: f64) -> (f64, f64) {
        let tau = t / self.duration;
        let (u, rate) = self.time_law.progress(tau.clamp(0.0, 1.0));
        (u, if (0.0..=1.0).contains(&tau) { rate / self.duration } else { 0.0 })
    }

    fn at(&self, t: f64) -> Reference {
        let (u, rate) = self.progress(t);
        let point = self.path.point(u);
        let (turn, spin) = self.path.turn(u);
        let (linear, angular) = (point.tangent * rate, spin * rate);
        Reference {
            position: self.origin + point.position,
            rotation: turn * self.initial,
            twist: Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_vector;
    use crate::task::{Planar, Plane, Quintic, Tricuspid, Turning};
    use proptest::prelude::*;

    fn motion() -> Motion {
        let path = Planar::new(Tricuspid { radius: 0.3 }, Plane::Yz, 0.4, 0.2, 5.0);
        let path = Turning::new(path, Vector3::y_axis(), 1.3);
        let start = IsometryMatrix3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 0.3));
        Motion::from_pose(path, Quintic, 2.0, &start)
    }

    proptest! {
        #[test]
        fn the_twist_is_the_derivative_of_the_pose(t in 0.01..1.99_f64) {
            let (motion, step) = (motion(), 1e-5);
            let (before, now, after) = (motion.at(t - step), motion.at(t), motion.at(t + step));
            let linear = (after.position - before.position) / (2.0 * step);
            let angular = rotation_vector(&(after.rotation * before.rotation.inverse())) / (2.0 * step);
            prop_assert!((linear - now.twist.fixed_rows::<3>(0)).norm() < 1e-8);
            prop_assert!((angular - now.twist.fixed_rows::<3>(3)).norm() < 1e-8);
        }
    }

    #[test]
    fn planes_named_the_other_way_around_hold_the_mirror_image() {
        let point = |plane| Planar::new(Tricuspid { radius: 0.3 }, plane, 0.0, 0.2, 5.0).point(0.3).position;
        for (plane, mirrored) in [(Plane::Xy, Plane::Yx), (Plane::Yz, Plane::Zy), (Plane::Zx, Plane::Xz)] {
            let (there, here) = (point(plane), point(mirrored));
            let swapped = match plane {
                Plane::Xy => Vector3::new(there.y, there.x, there.z),
                Plane::Yz => Vector3::new(there.x, there.z, there.y),
                _ => Vector3::new(there.z, there.y, there.x),
            };
            assert_eq!(here, swapped, "{mirrored:?}");
            assert_ne!(here, there, "{mirrored:?}");
        }
    }

    #[test]
    fn samples_hold_around_their_times_and_rest_outside() {
        let motion = motion();
        let references: Vec<_> = (0..=20).map(|n| motion.at(0.1 * f64::from(n))).collect();
        let sampled = Motion::sampled(references, 0.1);
        for n in 0..=20 {
            assert_eq!(sampled.at(0.1 * f64::from(n)), motion.at(0.1 * f64::from(n)));
        }
        assert_eq!(sampled.at(0.52), motion.at(0.5));
        assert_eq!(sampled.at(7.0).position, motion.at(2.0).position);
        assert_eq!((sampled.at(7.0).twist, sampled.at(-1.0).twist), (Vector6::zeros(), Vector6::zeros()));
    }

    #[test]
    fn it_begins_at_the_pose_and_rests_after_the_end() {
        let motion = motion();
        assert!((motion.at(0.0).position - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-15);
        assert_eq!(motion.at(2.5).twist, Vector6::zeros());
        assert_eq!(motion.at(2.5).position, motion.at(2.0).position);
    }
}
