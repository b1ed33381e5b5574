//! What to try where a file calls its joints by other names than the robot.

use super::csv_layout::listed;
use super::{ReadOptions, Trajectory};

impl ReadOptions {
    /// Returns what would make the names of a trajectory's joints those of the known joints, where they are not and something
    /// would: a [prefix](ReadOptions::prefix), or [columns that count joints](ReadOptions::map).
    pub fn hint(&self, trajectory: &Trajectory) -> Option<String> {
        let all: Vec<&str> = trajectory.arms.iter().flat_map(|arm| &arm.joints).map(String::as_str).collect();
        if self.joints.is_empty() || all.iter().all(|joint| self.joint(joint).is_some()) {
            return None;
        }
        let is_strange = all.iter().all(|joint| self.joint(joint).is_none());
        self.prefix_hint(&all).or_else(|| if is_strange { self.counted_hint(&all) } else { None })
    }

    /// What stands around the names of known joints, in as many names as there are.
    fn prefix_hint(&self, all: &[&str]) -> Option<String> {
        let mut around: Vec<[&str; 2]> = all.iter().filter_map(|joint| self.around(joint)).collect();
        around.sort_unstable();
        around.dedup();
        let counted = around.into_iter().map(|[before, after]| {
            let own = all.iter().filter_map(|joint| joint.strip_prefix(before)?.strip_suffix(after));
            (own.filter(|own| self.joint(own).is_some()).count(), [before, after])
        });
        let (count, [before, after]) = counted.max_by_key(|(count, _)| *count)?;
        // A slip of the pen in one name is no custom of a file.
        if count * 2 < all.len() {
            return None;
        }
        let of = if count == all.len() {
            format!("all {count} joints")
        } else {
            format!("{count} of {} joints", all.len())
        };
        Some(if after.is_empty() {
            format!(
                "{of} have the prefix `{before}`, which the robot's have not: --prefix {before} takes it off"
            )
        } else {
            format!(
                "{of} are called `{before}JOINT{after}`: --map '{before}*{after}' takes them for their positions"
            )
        })
    }

    /// What stands before and behind the longest name of a known joint within another name.
    fn around<'n>(&self, name: &'n str) -> Option<[&'n str; 2]> {
        let known = self.joints.iter().map(|joint| joint.name.as_str());
        let known = known.filter(|known| known.len() < name.len() && name.contains(known));
        let (before, after) = name.split_once(known.max_by_key(|known| known.len())?)?;
        Some([before, after])
    }

    /// Columns that count as many joints as the robot has.
    fn counted_hint(&self, all: &[&str]) -> Option<String> {
        let own = self.joints.iter().filter(|joint| !joint.follows).count();
        let stem = |name: &&str| name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        let mut stems: Vec<(String, usize)> = Vec::new();
        for name in all.iter().filter(|name| name.ends_with(|c: char| c.is_ascii_digit())) {
            let stem = stem(name);
            match stems.iter_mut().find(|(known, _)| *known == stem) {
                Some((_, count)) => *count += 1,
                None => stems.push((stem, 1)),
            }
        }
        stems.retain(|(_, count)| *count == own && own > 1);
        let measured = |(stem, _): &(String, usize)| !(stem.starts_with("actual_q") || stem.starts_with('q'));
        stems.sort_by_key(measured);
        let [(first, _), ..] = &stems[..] else { return None };
        let patterns: Vec<String> = stems.iter().map(|(stem, _)| format!("{stem}*")).collect();
        let patterns: Vec<&str> = patterns.iter().map(String::as_str).collect();
        let list = listed(&patterns)?;
        Some(format!(
            "the columns {list} count {own} joints, as many as the robot has: --map '{first}*' takes some for its positions in its \
             order, and leaves out the others"
        ))
    }
}
