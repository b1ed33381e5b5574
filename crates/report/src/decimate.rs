//! Fewer points that look the same: the extremes stay.

/// Returns at most `most` of the points, in their order: the first, the last, and of every stretch of as many points as
/// the others the lowest and the highest, so that every peak is still there.
///
/// A stretch without any number keeps one point, so that a longer gap stays a gap; single points that are not numbers
/// are left out. `most` counts as four if it is less, since fewer points hold no extremes.
///
/// ```
/// let wave: Vec<_> = (0..10_000).map(|k| (f64::from(k), (f64::from(k) / 500.0).sin())).collect();
/// let few = kinstep_report::decimate(&wave, 100);
/// assert!(few.len() <= 100);
/// let highest = |points: &[(f64, f64)]| points.iter().map(|point| point.1).fold(f64::MIN, f64::max);
/// assert_eq!(highest(&few), highest(&wave));
/// ```
pub fn decimate(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let most = most.max(4);
    if points.len() <= most {
        return points.to_vec();
    }
    let inner = &points[1..points.len() - 1];
    let stretches = (most - 2) / 2;
    let mut kept = vec![points[0]];
    for stretch in 0..stretches {
        let (from, to) = (stretch * inner.len() / stretches, (stretch + 1) * inner.len() / stretches);
        kept.extend(extremes(&inner[from..to]));
    }
    kept.push(points[points.len() - 1]);
    kept
}

/// The lowest and the highest point in their order, once where they are the same.
fn extremes(stretch: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
    let numbers =
        || stretch.iter().enumerate().filter(|(_, point)| point.0.is_finite() && point.1.is_finite());
    let lowest = numbers().min_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(place, _)| place);
    let highest = numbers().max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(place, _)| place);
    // A stretch without numbers is a gap.
    let places = [
        lowest.min(highest).or(stretch.len().checked_sub(1)),
        lowest.max(highest).filter(|_| lowest != highest),
    ];
    places.into_iter().flatten().map(|place| stretch[place])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn extreme(points: &[(f64, f64)], sign: f64) -> f64 {
        points.iter().map(|point| sign * point.1).filter(|y| y.is_finite()).fold(f64::MIN, f64::max)
    }

    proptest! {
        #[test]
        fn extremes_and_ends_stay_and_the_points_keep_their_order(
            values in prop::collection::vec(prop_oneof![20 => -1e6..1e6_f64, 1 => Just(f64::NAN)], 0..3000),
            most in 0..200_usize,
        ) {
            let points: Vec<_> = values.iter().enumerate().map(|(k, y)| (k as f64, *y)).collect();
            let few = decimate(&points, most);
            prop_assert!(few.len() <= most.max(4));
            let bits = |point: Option<&(f64, f64)>| point.map(|(x, y)| (x.to_bits(), y.to_bits()));
            prop_assert_eq!(bits(few.first()), bits(points.first()));
            prop_assert_eq!(bits(few.last()), bits(points.last()));
            prop_assert!(few.windows(2).all(|pair| pair[0].0 < pair[1].0));
            for sign in [1.0, -1.0] {
                prop_assert_eq!(extreme(&few, sign), extreme(&points, sign));
            }
        }
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let value = |k: i32| if (400..600).contains(&k) { f64::NAN } else { f64::from(k) };
        let points: Vec<_> = (0..1000).map(|k| (f64::from(k), value(k))).collect();
        let few = decimate(&points, 50);
        assert!(few.len() <= 50 && few.iter().any(|point| point.1.is_nan()));
    }
}
