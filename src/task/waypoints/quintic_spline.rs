use nalgebra::{Matrix2, Matrix2x3, Matrix2x5, Vector3};

/// How a spline begins and ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// The third and fourth derivatives vanish: of all curves through the points the one with the least `int |p'''|^2`.
    #[default]
    Natural,
    /// The first and second derivatives vanish.
    Clamped,
    /// The end goes over into the beginning, with all derivatives that are continuous elsewhere; the last point is the first.
    Periodic,
}

impl Ends {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Natural, Self::Clamped, Self::Periodic];

    /// The word for it in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Natural => "natural",
            Self::Clamped => "clamped",
            Self::Periodic => "periodic",
        }
    }
}

/// The interpolating spline of degree five: polynomials between the points, four continuous derivatives at them.
///
/// Its unknowns are the first and second derivatives `(v_i, a_i)` at the points. That the third and fourth are continuous is
/// what makes `int |p'''|^2` least: a symmetric positive definite system of 2x2 blocks beside the diagonal, which takes a
/// time proportional to the number of points. (C. de Boor, A Practical Guide to Splines, 1978, chapter XIII, has the theory.)
#[derive(Clone, Debug)]
pub struct QuinticSpline {
    knots: Vec<f64>,
    /// For each interval the coefficients of the powers of the distance from its beginning.
    pieces: Vec<[Vector3<f64>; 6]>,
}

/// The energy of one interval by the derivatives at its ends: the blocks, and the right-hand sides times its chord.
struct Interval {
    begin: Matrix2<f64>,
    across: Matrix2<f64>,
    end: Matrix2<f64>,
    right: [Matrix2x3<f64>; 2],
}

impl Interval {
    fn of(h: f64, chord: Vector3<f64>) -> Self {
        let [once, square, cube] = [1.0 / h, 1.0 / (h * h), 1.0 / (h * h * h)];
        let row = |factor: f64| (chord * factor).transpose();
        let (speed, bend) = (row(360.0 * cube * once), row(60.0 * cube));
        Self {
            begin: Matrix2::new(192.0 * cube, 36.0 * square, 36.0 * square, 9.0 * once),
            across: Matrix2::new(168.0 * cube, -24.0 * square, 24.0 * square, -3.0 * once),
            end: Matrix2::new(192.0 * cube, -36.0 * square, -36.0 * square, 9.0 * once),
            right: [Matrix2x3::from_rows(&[speed, bend]), Matrix2x3::from_rows(&[speed, -bend])],
        }
    }
}

impl QuinticSpline {
    /// Returns the spline through `points` at the parameters `knots`.
    ///
    /// # Panics
    /// Unless there are as many knots as points, at least three, and the knots increase.
    pub fn new(knots: &[f64], points: &[Vector3<f64>], ends: Ends) -> Self {
        assert!(
            knots.len() == points.len() && knots.len() >= 3,
            "a spline needs three points and as many knots"
        );
        assert!(knots.windows(2).all(|pair| pair[0] < pair[1]), "the knots of a spline increase");
        let derivatives = derivatives(knots, points, ends);
        let piece = |i: usize| {
            let pair = [i, i + 1]
                .map(|k| (points[k], derivatives[k].row(0).transpose(), derivatives[k].row(1).transpose()));
            hermite(knots[i + 1] - knots[i], pair)
        };
        Self { knots: knots.to_vec(), pieces: (0..knots.len() - 1).map(piece).collect() }
    }

    /// The point at the parameter `s` and its derivative by it; outside of the knots the last polynomials go on.
    pub fn at(&self, s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let i = interval(&self.knots, s);
        let x = s - self.knots[i];
        let [c0, c1, c2, c3, c4, c5] = &self.pieces[i];
        let value = c0 + (c1 + (c2 + (c3 + (c4 + c5 * x) * x) * x) * x) * x;
        let rate = c1 + (c2 * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * x)) * x) * x) * x;
        (value, rate)
    }

    /// The derivative of that order at the parameter `s`.
    ///
    /// ```
    /// use kinstep::nalgebra::Vector3;
    /// use kinstep::task::{Ends, QuinticSpline};
    /// let knots = [0.0, 1.0, 3.0];
    /// let squares = knots.map(|s| Vector3::new(s * s, 0.0, 0.0));
    /// let spline = QuinticSpline::new(&knots, &squares, Ends::Natural);
    /// assert!((spline.derivative(2.0, 2).x - 2.0).abs() < 1e-12);
    /// ```
    pub fn derivative(&self, s: f64, order: usize) -> Vector3<f64> {
        let i = interval(&self.knots, s);
        let x = s - self.knots[i];
        let falling = |k: usize| (k + 1 - order..=k).map(|factor| factor as f64).product::<f64>();
        (order..6).rev().fold(Vector3::zeros(), |sum, k| sum * x + self.pieces[i][k] * falling(k))
    }
}

/// The interval of increasing knots in which `s` lies, the first or last for what lies outside.
pub(in crate::task) fn interval(knots: &[f64], s: f64) -> usize {
    knots.partition_point(|&knot| knot <= s).clamp(1, knots.len() - 1) - 1
}

/// The coefficients of the polynomial over an interval of length `h` with that value and those two derivatives at its ends.
fn hermite(
    h: f64,
    [(p, v, a), (q, w, b)]: [(Vector3<f64>, Vector3<f64>, Vector3<f64>); 2],
) -> [Vector3<f64>; 6] {
    let gap = q - p - (v + a * (0.5 * h)) * h;
    let speed = (w - v - a * h) * h;
    let bend = (b - a) * (h * h);
    let cube = h * h * h;
    [
        p,
        v,
        a * 0.5,
        (gap * 10.0 - speed * 4.0 + bend * 0.5) / cube,
        (speed * 7.0 - gap * 15.0 - bend) / (cube * h),
        (gap * 6.0 - speed * 3.0 + bend * 0.5) / (cube * h * h),
    ]
}

/// The first and second derivatives at the knots, as rows.
fn derivatives(knots: &[f64], points: &[Vector3<f64>], ends: Ends) -> Vec<Matrix2x3<f64>> {
    let last = knots.len() - 1;
    let intervals: Vec<Interval> =
        (0..last).map(|i| Interval::of(knots[i + 1] - knots[i], points[i + 1] - points[i])).collect();
    let mut system: Vec<Row> = (0..=last).map(|i| Row::at(&intervals, i)).collect();
    match ends {
        Ends::Natural => solve(system).iter().map(|row| row.fixed_columns::<3>(0).into_owned()).collect(),
        Ends::Clamped => {
            let inner = if last < 2 { Vec::new() } else { solve(system.drain(1..last).collect()) };
            let inner = inner.iter().map(|row| row.fixed_columns::<3>(0).into_owned());
            let rest = std::iter::once(Matrix2x3::zeros());
            rest.clone().chain(inner).chain(rest).collect()
        }
        Ends::Periodic => {
            let (first, end) = (&intervals[0], &intervals[last - 1]);
            let mut inner: Vec<Row> = system.drain(1..last).collect();
            // The inner knots by those of the seam: two more right-hand sides.
            let open = inner.len() - 1;
            add_columns(&mut inner[0], &-first.across.transpose());
            add_columns(&mut inner[open], &-end.across);
            let inner = solve(inner);
            let (known, by_seam) =
                (|i: usize| inner[i].fixed_columns::<3>(0), |i: usize| inner[i].fixed_columns::<2>(3));
            let (across, back) = (&first.across, end.across.transpose());
            let matrix = first.begin + end.end + across * by_seam(0) + back * by_seam(open);
            let right = first.right[0] + end.right[1] - across * known(0) - back * known(open);
            let seam = inverse(&matrix) * right;
            let inner = (0..=open).map(|i| known(i) + by_seam(i) * seam);
            std::iter::once(seam).chain(inner).chain(std::iter::once(seam)).collect()
        }
    }
}

/// The equations of one knot: its own block, the block towards the next knot, and the right-hand sides.
struct Row {
    own: Matrix2<f64>,
    next: Matrix2<f64>,
    right: Matrix2x5<f64>,
}

impl Row {
    fn at(intervals: &[Interval], i: usize) -> Self {
        let (before, after) = (i.checked_sub(1).map(|i| &intervals[i]), intervals.get(i));
        let own = before.map_or(Matrix2::zeros(), |b| b.end) + after.map_or(Matrix2::zeros(), |a| a.begin);
        let right = before.map_or(Matrix2x3::zeros(), |b| b.right[1])
            + after.map_or(Matrix2x3::zeros(), |a| a.right[0]);
        let next = after.map_or(Matrix2::zeros(), |a| a.across);
        let mut columns = Matrix2x5::zeros();
        columns.fixed_columns_mut::<3>(0).copy_from(&right);
        Self { own, next, right: columns }
    }
}

fn add_columns(row: &mut Row, columns: &Matrix2<f64>) {
    let mut place = row.right.fixed_columns_mut::<2>(3);
    place += columns;
}

/// Solves a symmetric positive definite system of 2x2 blocks, block by block.
fn solve(mut rows: Vec<Row>) -> Vec<Matrix2x5<f64>> {
    for i in 1..rows.len() {
        let (done, rest) = rows.split_at_mut(i);
        let (before, row) = (&done[i - 1], &mut rest[0]);
        let factor = before.next.transpose() * inverse(&before.own);
        row.own -= factor * before.next;
        row.right -= factor * before.right;
    }
    let mut solution = vec![Matrix2x5::zeros(); rows.len()];
    for (i, row) in rows.iter().enumerate().rev() {
        let known = solution.get(i + 1).map_or(Matrix2x5::zeros(), |next| row.next * next);
        solution[i] = inverse(&row.own) * (row.right - known);
    }
    solution
}

fn inverse(m: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(m[(1, 1)], -m[(0, 1)], -m[(1, 0)], m[(0, 0)]) / m.determinant()
}
