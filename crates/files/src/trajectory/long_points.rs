//! The points of a joint trajectory in a long file of YAML.

use super::long_file::LongFile;
use super::points::{POINTS, Points};
use super::quick_yaml;

/// The longest text behind the points \[bytes\].
const LONGEST_TAIL: usize = 1 << 16;

/// Returns what stands around the first list of points of a file, and the points; nothing where something is not certain.
pub(super) fn read(file: &mut LongFile<'_>) -> Option<(String, Box<Points>)> {
    let (head, start) = file.head()?;
    let begin = points_begin(&head)?;
    let rest = &head[begin..];
    let dash = format!("\n{}- ", &rest[..rest.find("- ").filter(|&at| rest[..at].trim().is_empty())?]);
    // The first point decides what all of them have.
    let first = begin + rest.find(&dash)? + 1;
    let (mut points, behind) = quick_yaml::points(&head[begin..first], &Points::new(begin))?;
    behind.is_empty().then_some(())?;
    points.reserve(file.length() / (first - begin) + 1);
    let others = points.following();
    let mut text = head[..begin].to_owned();
    let head_length = text.len();
    let cut = |block: &[u8]| {
        let at = block.windows(dash.len()).rposition(|window| window == dash.as_bytes());
        at.map(|at| at + 1)
    };
    let parse = |block: &str| {
        let (points, behind) = quick_yaml::points(block, &others)?;
        (behind.len() <= LONGEST_TAIL).then(|| (points, behind.to_owned()))
    };
    file.blocks(start + first, cut)?.each(parse, |(read, behind)| {
        // Nothing but the end comes behind points that something stands behind.
        (text.len() == head_length).then_some(())?;
        text.push_str(&behind);
        points.append(&read).then_some(())
    })?;
    Some((text, points))
}

/// Where the line begins that follows the key of the points.
fn points_begin(head: &str) -> Option<usize> {
    let mut at = 0;
    for line in head.split_inclusive('\n') {
        at += line.len();
        if line.trim().trim_start_matches("- ").strip_suffix(':') == Some(POINTS) {
            return Some(at);
        }
    }
    None
}
