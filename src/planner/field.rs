use super::bundle::{Bundle, Sample, Together, are_alike};
use super::runtime::ArmRuntime;
use super::shared::{self, SharedArms};
use super::{Arm, ArmState};
use crate::integrate::{Field, Parts};
use crate::math::level;
use fearless_simd::Level;

/// What a component of the state is: an arm and a joint of it.
pub(super) type Owner = (usize, usize);

/// Vectors of four fit wherever a group begins.
const ALIGNMENT: usize = 4;

/// The right-hand side of all arms together: `f = J^+ phi'` (and the null-space part), `g = -k J^+ e`, group by group.
///
/// A group of arms side by side has its part of the state joint by joint, all arms of each joint one after the other, so that
/// the state, its history and both parts of its derivative are vectors as they lie.
pub(super) struct SynchronousField {
    pub(super) arms: Vec<ArmRuntime>,
    pub(super) gain: f64,
    groups: Vec<Group>,
    pub(super) shared: Vec<SharedArms>,
    /// What the components of the state are; some only fill up a group.
    owners: Vec<Option<Owner>>,
    /// The groups and lanes of the arms that have one.
    lanes: Vec<Option<(usize, usize)>>,
    /// Whether all arms were clearly on their paths and far from singularities when they were evaluated last.
    is_on_course: bool,
    level: Level,
}

/// Arms that share no joints and are evaluated together.
struct Group {
    /// Where its part of the state begins.
    from: usize,
    arms: Members,
}

enum Members {
    /// A single arm whose law or chain is of no common kind.
    Alone(usize),
    SideBySide(Box<dyn Together>),
}

impl SynchronousField {
    /// The right-hand side of the arms of one plan, with gap `sigma`.
    pub(super) fn new(arms: Vec<Arm>, gain: f64, sigma: f64) -> Self {
        let (mut field, apart) = Self::of_shared(arms, gain, sigma);
        field.add_groups(apart);
        field
    }

    /// The same with every arm evaluated by itself.
    pub(super) fn one_by_one(arms: Vec<Arm>, gain: f64, sigma: f64) -> Self {
        let (mut field, apart) = Self::of_shared(arms, gain, sigma);
        for arm in apart {
            field.add_members(&[arm], Members::Alone(arm));
        }
        field
    }

    /// The right-hand side of the arms that share joints, and which others there are.
    fn of_shared(arms: Vec<Arm>, gain: f64, sigma: f64) -> (Self, Vec<usize>) {
        let sets = shared::sets(&arms);
        let arms = arms.into_iter().map(|arm| ArmRuntime::new(arm, sigma)).collect();
        let mut field = Self::without_groups(arms, gain);
        for set in &sets {
            field.add_shared(set);
        }
        let apart = (0..field.arms.len()).filter(|&arm| !field.arms[arm].is_shared).collect();
        (field, apart)
    }

    /// The right-hand side of arms of which those of the indices `moving` move; none of them share joints.
    pub(super) fn of_moving(arms: Vec<ArmRuntime>, moving: Vec<usize>, gain: f64) -> Self {
        let mut field = Self::without_groups(arms, gain);
        field.add_groups(moving);
        field
    }

    fn without_groups(arms: Vec<ArmRuntime>, gain: f64) -> Self {
        Self {
            gain,
            groups: Vec::new(),
            shared: Vec::new(),
            owners: Vec::new(),
            lanes: vec![None; arms.len()],
            is_on_course: false,
            level: level(),
            arms,
        }
    }

    fn add_shared(&mut self, arms: &[usize]) {
        let shared = SharedArms::new(&self.arms, arms, self.owners.len());
        self.owners.extend(shared.owners().iter().map(|owners| owners.first().copied()));
        for &arm in arms {
            self.arms[arm].is_shared = true;
            self.arms[arm].bounds.has_too_few_joints |= shared.has_too_few_joints();
        }
        self.shared.push(shared);
    }

    /// Puts arms that fit together into groups, in the order of their first members.
    fn add_groups(&mut self, mut rest: Vec<usize>) {
        while let Some(&first) = rest.first() {
            let mut members = vec![first];
            for &member in &rest[1..] {
                members.push(member);
                let arms: Vec<_> = members.iter().map(|&member| &self.arms[member].arm).collect();
                if !are_alike(&arms) {
                    members.pop();
                }
            }
            rest.retain(|member| !members.contains(member));
            self.add_group(&members);
        }
    }

    fn add_group(&mut self, members: &[usize]) {
        let together: Option<Box<dyn Together>> = if members.len() <= 2 {
            Bundle::<[f64; 2]>::new(&self.arms, members).map(|bundle| Box::new(bundle) as _)
        } else {
            Bundle::<[f64; 4]>::new(&self.arms, members).map(|bundle| Box::new(bundle) as _)
        };
        self.add_members(members, together.map_or(Members::Alone(members[0]), Members::SideBySide));
    }

    fn add_members(&mut self, members: &[usize], arms: Members) {
        let (from, width) = (self.owners.len().next_multiple_of(ALIGNMENT), arms.width());
        self.owners.resize(from, None);
        for joint in 0..self.arms[members[0]].positions.len() {
            self.owners.extend((0..width).map(|lane| Some((members[lane.min(members.len() - 1)], joint))));
        }
        self.owners.resize(self.owners.len().next_multiple_of(ALIGNMENT), None);
        if let Members::SideBySide(_) = arms {
            for (lane, &member) in members.iter().enumerate() {
                self.lanes[member] = Some((self.groups.len(), lane));
            }
        }
        self.groups.push(Group { from, arms });
    }

    /// What the components of the state are: the joints of arms, or nothing.
    pub(super) fn owners(&self) -> &[Option<Owner>] {
        &self.owners
    }

    /// The state in which every arm has the joint positions that `position` gives.
    pub(super) fn state(&self, position: impl Fn(Owner) -> f64) -> Vec<f64> {
        self.owners.iter().map(|owner| owner.map_or(0.0, &position)).collect()
    }

    /// Finds the task errors of all arms, which are evaluated one by one, at other joint positions than those that were
    /// evaluated.
    pub(super) fn look(&mut self, t: f64, x: &[f64]) {
        for Group { from, arms } in &self.groups {
            if let Members::Alone(arm) = *arms {
                let runtime = &mut self.arms[arm];
                let joints = runtime.positions.len();
                runtime.positions.copy_from_slice(&x[*from..][..joints]);
                runtime.look(t);
            }
        }
        for shared in &self.shared {
            shared.look(&mut self.arms, t, x);
        }
    }

    /// Whether all arms were clearly on their paths and far from singularities when they were evaluated last.
    pub(super) fn is_on_course(&self) -> bool {
        self.is_on_course
    }

    /// An arm at the sample that was watched or told last.
    pub(super) fn arm(&self, arm: usize) -> ArmState<'_> {
        let lane = self.lanes[arm].map(|(group, lane)| (&self.groups[group].arms, lane));
        match lane {
            Some((Members::SideBySide(together), lane)) => together.arm(lane),
            _ => ArmState::of(&self.arms[arm]),
        }
    }

    /// Takes down states, errors, limits and conditioning of a sample in which all arms are on course.
    pub(super) fn watch(&mut self, t: f64, sample: &Sample<'_>) {
        for group in &mut self.groups {
            if let Members::SideBySide(together) = &mut group.arms {
                together.watch(self.level, t, &mut self.arms, &sample.from(group.from));
            }
        }
    }

    /// Tells every arm what is known of it at a sample.
    pub(super) fn tell(&mut self, sample: &Sample<'_>) {
        for group in &mut self.groups {
            if let Members::SideBySide(together) = &mut group.arms {
                together.tell(self.level, &mut self.arms, &sample.from(group.from));
            }
        }
    }

    /// Tells the monitors where the arms were one sample ago.
    pub(super) fn remind(&mut self, sample: &Sample<'_>) {
        self.each_together(|together, arms, from| together.remind(arms, &sample.previous[from..]));
    }

    /// Gives the monitors what has been watched.
    pub(super) fn hand_over(&mut self) {
        self.each_together(|together, arms, _| together.hand_over(arms));
    }

    fn each_together(&mut self, act: impl Fn(&dyn Together, &mut [ArmRuntime], usize)) {
        for group in &self.groups {
            if let Members::SideBySide(together) = &group.arms {
                act(&**together, &mut self.arms, group.from);
            }
        }
    }
}

impl Members {
    /// How many lanes there are for each joint.
    fn width(&self) -> usize {
        match self {
            Self::Alone(_) => 1,
            Self::SideBySide(together) => together.width(),
        }
    }
}

impl<'a> Sample<'a> {
    /// The part of the state that begins there.
    fn from(&self, from: usize) -> Sample<'a> {
        Sample {
            positions: &self.positions[from..],
            previous: &self.previous[from..],
            velocities: &self.velocities[from..],
        }
    }
}

impl Field<f64> for SynchronousField {
    fn dimension(&self) -> usize {
        self.owners.len()
    }

    fn parts(&self) -> Parts {
        Parts::Feedback
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        let at = (t, self.gain);
        let mut is_on_course = self.shared.is_empty();
        for Group { from, arms } in &mut self.groups {
            let (x, f, g) = (&x[*from..], &mut f[*from..], &mut g[*from..]);
            match arms {
                Members::Alone(arm) => {
                    evaluate_alone(&mut self.arms[*arm], at, x, [f, g]);
                    is_on_course = false;
                }
                Members::SideBySide(together) => {
                    is_on_course &= together.evaluate(self.level, at, &mut self.arms, x, [f, g]);
                }
            }
        }
        self.is_on_course = is_on_course;
        for shared in &mut self.shared {
            shared.evaluate(&mut self.arms, at, x, [&mut *f, &mut *g]);
        }
    }
}

fn evaluate_alone(runtime: &mut ArmRuntime, (t, gain): (f64, f64), x: &[f64], [f, g]: [&mut [f64]; 2]) {
    let joints = runtime.positions.len();
    runtime.positions.copy_from_slice(&x[..joints]);
    runtime.evaluate(t, gain);
    f[..joints].copy_from_slice(&runtime.velocities);
    g[..joints].copy_from_slice(&runtime.feedback);
}
