//! A line with the fewest points that look the same.

use crate::decimate;

/// What is nearer than this to a line does not show [px].
const UNSEEN: f64 = 0.15;

/// Returns the points of a line that it needs [px]: where it runs from left to right, at most the highest and the lowest
/// of every column of pixels, and of those no point that lies on the line through its neighbours.
pub(super) fn outline(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let runs_right = points.windows(2).all(|pair| pair[0].0 <= pair[1].0);
    let (first, last) = (points.first().map_or(0.0, |p| p.0), points.last().map_or(0.0, |p| p.0));
    let columns = (last - first).max(1.0) as usize;
    if runs_right { straightened(&decimate(points, 2 * columns + 2)) } else { straightened(points) }
}

/// Douglas and Peucker's choice of points: whatever is left out is within [`UNSEEN`] of the line.
fn straightened(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut keep = vec![false; points.len()];
    let ends = [0, points.len().saturating_sub(1)];
    keep.iter_mut().enumerate().for_each(|(k, keep)| *keep = ends.contains(&k));
    let mut open = vec![(ends[0], ends[1])];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|k| (k, distance(points[k], points[from], points[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = farthest.filter(|(_, distance)| *distance > UNSEEN) {
            keep[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

/// The distance of a point from a line between two others.
fn distance((x, y): (f64, f64), (ax, ay): (f64, f64), (bx, by): (f64, f64)) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let square = dx * dx + dy * dy;
    let along = if square > 0.0 { (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    (x - ax - along * dx).hypot(y - ay - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn nothing_that_shows_is_lost(points in prop::collection::vec((0.0..500.0_f64, 0.0..300.0_f64), 1..200)) {
            let kept = straightened(&points);
            prop_assert_eq!(kept.first(), points.first());
            prop_assert_eq!(kept.last(), points.last());
            let mut segment = 0;
            for point in &points {
                // Kept points come in order: what lies between two of them is near the line that joins them.
                if kept.get(segment + 1) == Some(point) {
                    segment += 1;
                }
                let (a, b) = (kept[segment.min(kept.len() - 1)], kept[(segment + 1).min(kept.len() - 1)]);
                prop_assert!(distance(*point, a, b) <= UNSEEN);
            }
        }
    }

    #[test]
    fn a_straight_line_has_two_points() {
        let points: Vec<_> = (0..1000).map(|k| (f64::from(k), 0.5 * f64::from(k))).collect();
        assert_eq!(outline(&points), [points[0], points[999]]);
        assert_eq!(outline(&[]), []);
        assert_eq!(outline(&[(1.0, 2.0)]), [(1.0, 2.0)]);
    }
}
