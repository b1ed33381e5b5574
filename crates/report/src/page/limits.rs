//! How much of their limits the joints used.

use std::fmt::Write;

use super::PlanPage;
use super::markup::{escaped, plain};
use kinstep::planner::Peak;
use kinstep::robot::{ChainJoint, Limits};
use kinstep_files::trajectory::ArmTrajectory;

/// What counts as close: this share of the velocity limit, or of the range beyond its middle.
const CLOSE: f64 = 0.9;

/// What one joint did, beside what it may.
#[derive(Clone, Copy, Debug)]
pub(super) struct Use {
    limits: Limits,
    lowest: f64,
    highest: f64,
    fastest: f64,
    /// The largest acceleration and jerk between samples.
    hardest: [Peak; 2],
}

/// How a share of a limit is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Closeness {
    Far,
    Close,
    Crossed,
}

impl Closeness {
    fn of(share: f64) -> Self {
        match () {
            () if share > 1.0 + 1e-12 => Self::Crossed,
            () if share > CLOSE => Self::Close,
            () => Self::Far,
        }
    }

    fn mark(self) -> &'static str {
        match self {
            Self::Far => "",
            Self::Close => " <span class=\"mark close\">\u{25b2} close</span>",
            Self::Crossed => " <span class=\"mark crossed\">\u{2716} crossed</span>",
        }
    }

    fn class(self) -> &'static str {
        match self {
            Self::Far => "far",
            Self::Close => "close",
            Self::Crossed => "crossed",
        }
    }
}

impl Use {
    /// Looks at joint `index` of an arm whose samples are `sigma` apart.
    fn of(arm: &ArmTrajectory, index: usize, limits: Limits, sigma: f64) -> Self {
        // No step is zero: an arm without joints has no samples of them either.
        let joints = arm.joints.len().max(1);
        let every =
            |values: &[f64]| -> Vec<f64> { values.iter().skip(index).step_by(joints).copied().collect() };
        let (positions, velocities) = (every(&arm.positions), every(&arm.velocities));
        let means = positions.windows(2).map(|pair| (pair[1] - pair[0]) / sigma);
        let fastest = velocities.iter().copied().chain(means).map(f64::abs).fold(0.0, f64::max);
        let lowest = positions.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let samples = || (positions.iter().copied(), velocities.iter().copied());
        let ((q, v), (more_q, more_v)) = (samples(), samples());
        let hardest = [Peak::of_acceleration(q, v, sigma), Peak::of_jerk(more_q, more_v, sigma)];
        Self { limits, lowest, highest, fastest, hardest }
    }

    /// How far the joint went from the middle of its range, in halves of it; `None` without a range.
    fn range_share(&self) -> Option<f64> {
        let half = (self.limits.upper - self.limits.lower) / 2.0;
        let middle = f64::midpoint(self.limits.lower, self.limits.upper);
        let share = (self.highest - middle).max(middle - self.lowest) / half;
        (half.is_finite() && half > 0.0 && share.is_finite()).then_some(share)
    }

    fn velocity_share(&self) -> Option<f64> {
        let share = self.fastest / self.limits.velocity;
        (self.limits.velocity.is_finite() && share.is_finite()).then_some(share)
    }

    /// The shares of the acceleration and jerk limits that are known.
    fn hard_shares(&self) -> [Option<f64>; 2] {
        let [acceleration, jerk] = self.hardest;
        let pairs = [(acceleration, self.limits.acceleration), (jerk, self.limits.jerk)];
        pairs.map(|(peak, limit)| {
            Some(peak.certain / limit).filter(|share| limit.is_finite() && share.is_finite())
        })
    }

    fn shares(&self) -> impl Iterator<Item = f64> {
        let [acceleration, jerk] = self.hard_shares();
        [self.range_share(), self.velocity_share(), acceleration, jerk].into_iter().flatten()
    }

    fn row(&self, joint: &ChainJoint, shows_hardest: bool) -> String {
        let unit = if joint.kind.is_rotation() { "rad" } else { "m" };
        let mut cells = vec![self.range_cell(unit), self.velocity_cell(unit)];
        if shows_hardest {
            cells.extend(self.hard_cells(unit));
        }
        format!(
            "<tr><th scope=\"row\">{}</th>{}</tr>",
            escaped(&joint.name),
            cells.iter().fold(String::new(), |all, cell| all + "<td>" + cell + "</td>")
        )
    }

    fn hard_cells(&self, unit: &str) -> [String; 2] {
        let shares = self.hard_shares();
        let limits = [self.limits.acceleration, self.limits.jerk];
        std::array::from_fn(|k| {
            let peak = self.hardest[k].value.abs();
            share_cell(shares[k], &format!("{} {unit}/s{}", plain(peak), ["\u{b2}", "\u{b3}"][k]), limits[k])
        })
    }

    fn range_cell(&self, unit: &str) -> String {
        let Limits { lower, upper, .. } = self.limits;
        let went = if self.lowest <= self.highest {
            format!("{} \u{2026} {} {unit}", plain(self.lowest), plain(self.highest))
        } else {
            "nothing recorded".to_owned()
        };
        let Some(share) = self.range_share() else {
            return format!("{went}<small>no limits known</small>");
        };
        let closeness = Closeness::of(share);
        let place = |position: f64| 100.0 * (position - lower) / (upper - lower);
        format!(
            "{}{went}{}<small>of {} \u{2026} {}</small>",
            bar(place(self.lowest), place(self.highest), closeness),
            closeness.mark(),
            plain(lower),
            plain(upper)
        )
    }

    fn velocity_cell(&self, unit: &str) -> String {
        let went = format!("{} {unit}/s", plain(self.fastest));
        share_cell(self.velocity_share(), &went, self.limits.velocity)
    }
}

/// What was used of a limit in either direction.
fn share_cell(share: Option<f64>, went: &str, limit: f64) -> String {
    let Some(share) = share else { return format!("{went}<small>no limit known</small>") };
    let closeness = Closeness::of(share);
    format!(
        "{}{went}{}<small>{:.0} % of {}</small>",
        bar(0.0, 100.0 * share, closeness),
        closeness.mark(),
        100.0 * share,
        plain(limit)
    )
}

/// A bar from one to the other, in hundredths of a track.
fn bar(from: f64, to: f64, closeness: Closeness) -> String {
    let (from, to) = (from.clamp(0.0, 100.0), to.clamp(0.0, 100.0));
    // A joint that stands still shows too.
    let width = (to - from).max(1.5);
    format!(
        "<svg class=\"bar {}\" viewBox=\"0 0 100 6\" preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect \
         class=\"track\" width=\"100\" height=\"6\"/><rect class=\"used\" x=\"{:.1}\" width=\"{width:.1}\" \
         height=\"6\"/></svg>",
        closeness.class(),
        from.min(100.0 - width)
    )
}

/// The tables of all arms.
pub(super) fn section(page: &PlanPage<'_>) -> String {
    let recording = page.recording;
    let mut html = format!("<p>{}</p>", sentence(counts(page)));
    for ((arm, staged), uses) in recording.trajectory.arms.iter().zip(&recording.stage.arms).zip(uses(page)) {
        // Most robots know nothing of accelerations.
        let shows_hardest = uses.iter().any(|joint| joint.hard_shares().iter().any(Option::is_some));
        let rows =
            staged.chain.joints().iter().zip(&uses).map(|(joint, used)| used.row(joint, shows_hardest));
        let more =
            if shows_hardest { "<th scope=\"col\">acceleration</th><th scope=\"col\">jerk</th>" } else { "" };
        // Writing to a String can not fail.
        let _ = write!(
            html,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Limits of {name}\"><table \
             class=\"limits\"><caption>{name}</caption><thead><tr><th scope=\"col\">joint</th><th \
             scope=\"col\">positions</th><th scope=\"col\">fastest</th>{more}</tr></thead><tbody>{rows}</tbody></table></div>",
            name = escaped(&arm.name),
            rows = rows.collect::<String>()
        );
    }
    html
}

/// What the joints of every arm did.
fn uses(page: &PlanPage<'_>) -> Vec<Vec<Use>> {
    let arms = page.recording.trajectory.arms.iter().zip(&page.recording.stage.arms);
    arms.map(|(arm, staged)| {
        let joints = staged.chain.joints().iter().enumerate();
        joints.map(|(index, joint)| Use::of(arm, index, joint.limits, page.plan.sigma)).collect()
    })
    .collect()
}

/// How many limits were crossed, and how many came close without it.
fn counts(page: &PlanPage<'_>) -> (usize, usize) {
    let joints = uses(page).into_iter().flatten();
    let shares = joints.flat_map(|joint| joint.shares().collect::<Vec<_>>());
    shares.map(Closeness::of).fold((0, 0), |(crossed, close), closeness| match closeness {
        Closeness::Crossed => (crossed + 1, close),
        Closeness::Close => (crossed, close + 1),
        Closeness::Far => (crossed, close),
    })
}

fn sentence(counts: (usize, usize)) -> String {
    let limits = |count: usize| if count == 1 { "1 limit".to_owned() } else { format!("{count} limits") };
    match counts {
        (0, 0) => "No joint came close to a limit that is known.".to_owned(),
        (0, close) => format!("No limit was crossed; joints came close to {}.", limits(close)),
        (crossed, 0) => format!("Joints crossed {}.", limits(crossed)),
        (crossed, close) => {
            format!("Joints crossed {} and came close to {}.", limits(crossed), limits(close))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn used(positions: &[f64], limits: Limits) -> Use {
        let arm = ArmTrajectory {
            name: "a".to_owned(),
            joints: vec!["j".to_owned()],
            positions: positions.to_vec(),
            velocities: Vec::new(),
            accelerations: Vec::new(),
            errors: Vec::new(),
        };
        Use::of(&arm, 0, limits, 0.5)
    }

    #[test]
    fn shares_count_from_the_middle_of_the_range_and_from_rest() {
        let joint =
            used(&[0.0, 1.0, -0.5], Limits { lower: -1.0, upper: 3.0, velocity: 6.0, ..Limits::UNLIMITED });
        assert_eq!((joint.range_share(), joint.velocity_share()), (Some(0.75), Some(0.5)));
        assert_eq!(joint.hard_shares(), [None, None]);
        let limits = Limits { acceleration: 20.0, ..Limits::UNLIMITED };
        let [Some(share), None] = used(&[0.0, 1.0, -0.5], limits).hard_shares() else { panic!() };
        assert!((share - 0.5).abs() < 1e-9, "{share}");
        let closeness = [0.75, 0.95, 1.0, 1.1].map(Closeness::of);
        assert_eq!(closeness, [Closeness::Far, Closeness::Close, Closeness::Close, Closeness::Crossed]);
    }

    #[test]
    fn joints_without_limits_or_samples_have_no_share() {
        let free = used(&[0.0, 1.0], Limits::UNLIMITED);
        assert_eq!((free.range_share(), free.velocity_share()), (None, None));
        let still = used(&[], Limits { lower: -1.0, upper: 3.0, velocity: 6.0, ..Limits::UNLIMITED });
        assert_eq!(still.range_share(), None);
        assert!(still.range_cell("rad").contains("nothing recorded"));
    }
}
