//! What a plan asks of every joint.

use super::{Table, short};
use kinstep::planner::{ArmPlan, Plan};
use kinstep::robot::ChainJoint;
use kinstep_files::trajectory::{Stage, StagedArm};

/// A joint that comes nearer to a limit than this share of its range, or uses more than the rest of its velocity, is close.
const CLOSE: f64 = 0.1;

/// What one joint does beside what it may do.
struct Demand<'a> {
    joint: &'a ChainJoint,
    /// Its least and greatest position [rad or m].
    extent: (f64, f64),
    /// Its greatest velocity in either direction [rad/s or m/s], from sample to sample or of the feedforward.
    peak: f64,
}

/// Returns a table of the joints of a plan, with their extreme positions, their peak velocities and the shares of the limits
/// that these are, and a line for every joint that comes close to a limit.
pub fn plan_details(plan: &Plan, stage: &Stage) -> String {
    let mut table =
        Table::new(["arm", "joint", "least", "greatest", "to a limit", "peak velocity", "limit", "share"]);
    let mut close = Vec::new();
    for arm in &plan.arms {
        let Some(staged) = stage.arm(&arm.name) else { continue };
        for demand in demands(arm, staged, plan.sigma) {
            table.row(demand.cells(&arm.name));
            close.extend(
                demand
                    .closeness()
                    .map(|how| format!("close to a limit: {} {} {how}\n", arm.name, demand.joint.name)),
            );
        }
    }
    format!("\n{table}{}{}", if close.is_empty() { "" } else { "\n" }, close.concat())
}

fn demands<'a>(arm: &'a ArmPlan, staged: &'a StagedArm, sigma: f64) -> impl Iterator<Item = Demand<'a>> {
    let count = arm.joints.len();
    staged.chain.joints().iter().take(count).enumerate().map(move |(k, joint)| {
        let positions = || arm.positions.iter().skip(k).step_by(count).copied();
        let means = positions().zip(positions().skip(1)).map(|(a, b)| (b - a) / sigma);
        let velocities = arm.velocities.iter().skip(k).step_by(count).copied().chain(means);
        let extent = positions().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| (a.min(q), b.max(q)));
        Demand { joint, extent, peak: velocities.fold(0.0, |most: f64, v| most.max(v.abs())) }
    })
}

impl Demand<'_> {
    /// How far the joint stays from its position limits; less than nothing beyond one.
    fn margin(&self) -> f64 {
        (self.extent.0 - self.joint.limits.lower).min(self.joint.limits.upper - self.extent.1)
    }

    fn share(&self) -> f64 {
        self.peak / self.joint.limits.velocity
    }

    fn cells(&self, arm: &str) -> Vec<String> {
        let known = |value: f64| if value.is_finite() { short(value) } else { "-".to_owned() };
        let limits = self.joint.limits;
        let share = format!("{:.0} %", 100.0 * self.share());
        let share = if limits.velocity.is_finite() { share } else { "-".to_owned() };
        let numbers = [self.extent.0, self.extent.1, self.margin(), self.peak, limits.velocity].map(known);
        [arm.to_owned(), self.joint.name.clone()].into_iter().chain(numbers).chain([share]).collect()
    }

    fn closeness(&self) -> Option<String> {
        let limits = self.joint.limits;
        if self.margin() < CLOSE * (limits.upper - limits.lower) && self.margin().is_finite() {
            return Some(format!("leaves {} of its range", short(self.margin())));
        }
        let is_fast = limits.velocity.is_finite() && self.share() > 1.0 - CLOSE;
        is_fast.then(|| format!("uses {:.0} % of its velocity", 100.0 * self.share()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep_files::scenario::ScenarioText;

    #[test]
    fn every_joint_has_its_line_and_the_peaks_are_the_plans() {
        let text = ScenarioText::parse(include_str!("../../../examples/dual_panda.toml")).unwrap();
        let mut scenario = text.scenario().unwrap();
        scenario.duration = 0.2.into();
        let stage = scenario.stage(None).unwrap();
        let table = kinstep::formula::FormulaTable::builtin();
        let plan = scenario.planner(table, None).unwrap().run();
        let details = plan_details(&plan, &stage);
        let rows = details.lines().filter(|line| line.contains("panda_joint") && !line.starts_with("close"));
        assert_eq!(rows.count(), 14, "{details}");
        let demand = demands(&plan.arms[0], &stage.arms[0], plan.sigma).nth(3).unwrap();
        let fastest = (0..plan.samples()).map(|n| plan.arms[0].velocity(n)[3].abs()).fold(0.0, f64::max);
        assert!(demand.peak >= fastest && demand.peak < 1.5 * fastest, "{} {fastest}", demand.peak);
        assert!((demand.margin() - (demand.extent.0 + 3.0718)).abs() < 1e-9, "{}", demand.margin());
    }
}
