use super::problem::dot;

/// The normals of the active constraints as `N = Q_1 R`: `Q` orthogonal, `R` upper triangular, both kept by rotations as
/// constraints come and go (Goldfarb and Idnani 1983, with a Hessian that is the identity).
#[derive(Clone, Debug)]
pub(super) struct Factors {
    unknowns: usize,
    active: usize,
    /// Column after column.
    q: Vec<f64>,
    /// Column after column, of which the first entries count.
    r: Vec<f64>,
}

impl Factors {
    pub(super) fn with_capacity(unknowns: usize) -> Self {
        let mut new = Self {
            unknowns,
            active: 0,
            q: vec![0.0; unknowns * unknowns],
            r: vec![0.0; unknowns * unknowns],
        };
        new.clear();
        new
    }

    /// No constraint is active.
    pub(super) fn clear(&mut self) {
        self.active = 0;
        self.q.fill(0.0);
        self.q.iter_mut().step_by(self.unknowns + 1).for_each(|diagonal| *diagonal = 1.0);
    }

    /// How many constraints are active.
    pub(super) fn active(&self) -> usize {
        self.active
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.q[j * self.unknowns..(j + 1) * self.unknowns]
    }

    /// Writes `Q^T n`.
    pub(super) fn project(&self, normal: &[f64], out: &mut [f64]) {
        for (out, column) in out.iter_mut().zip(self.q.chunks_exact(self.unknowns)) {
            *out = dot(column, normal);
        }
    }

    /// Writes the part of a normal, given as `Q^T n`, that no active normal has: the direction of the step.
    pub(super) fn free_part(&self, projected: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for j in self.active..self.unknowns {
            for (out, entry) in out.iter_mut().zip(self.column(j)) {
                *out += projected[j] * entry;
            }
        }
    }

    /// Writes `R^-1 v` for the first entries of `v`.
    pub(super) fn solve(&self, v: &[f64], out: &mut [f64]) {
        let (n, count) = (self.unknowns, self.active);
        out[..count].copy_from_slice(&v[..count]);
        for j in (0..count).rev() {
            out[j] /= self.r[j * n + j];
            let known = out[j];
            for i in 0..j {
                out[i] -= self.r[j * n + i] * known;
            }
        }
    }

    /// Writes `R^-T v`.
    pub(super) fn solve_transposed(&self, v: &[f64], out: &mut [f64]) {
        let n = self.unknowns;
        for j in 0..self.active {
            let column = &self.r[j * n..j * n + j];
            out[j] = (v[j] - dot(column, &out[..j])) / self.r[j * n + j];
        }
    }

    /// Adds `Q_1 y` to `x`.
    pub(super) fn add_active_part(&self, y: &[f64], x: &mut [f64]) {
        for (j, y) in y.iter().enumerate().take(self.active) {
            for (x, entry) in x.iter_mut().zip(self.column(j)) {
                *x += y * entry;
            }
        }
    }

    /// Takes in a normal, given as `Q^T n`, which is overwritten.
    pub(super) fn add(&mut self, projected: &mut [f64]) {
        let (n, place) = (self.unknowns, self.active);
        for j in (place + 1..n).rev() {
            let Some((cosine, sine, length)) = rotation(projected[j - 1], projected[j]) else { continue };
            projected[j - 1] = length;
            projected[j] = 0.0;
            self.rotate_columns(j - 1, cosine, sine);
        }
        self.r[place * n..=place * n + place].copy_from_slice(&projected[..=place]);
        self.active += 1;
    }

    /// Leaves out the normal of that place.
    pub(super) fn remove(&mut self, place: usize) {
        let n = self.unknowns;
        for j in place + 1..self.active {
            let (before, after) = self.r.split_at_mut(j * n);
            before[(j - 1) * n..][..=j].copy_from_slice(&after[..=j]);
        }
        self.active -= 1;
        for j in place..self.active {
            let Some((cosine, sine, length)) = rotation(self.r[j * n + j], self.r[j * n + j + 1]) else {
                continue;
            };
            self.r[j * n + j] = length;
            self.r[j * n + j + 1] = 0.0;
            for column in j + 1..self.active {
                let entries = &mut self.r[column * n + j..];
                (entries[0], entries[1]) =
                    (cosine * entries[0] + sine * entries[1], cosine * entries[1] - sine * entries[0]);
            }
            self.rotate_columns(j, cosine, sine);
        }
    }

    /// Rotates a column of `Q` and the next.
    fn rotate_columns(&mut self, j: usize, cosine: f64, sine: f64) {
        let (head, tail) = self.q.split_at_mut((j + 1) * self.unknowns);
        let first = &mut head[j * self.unknowns..];
        for (a, b) in first.iter_mut().zip(&mut tail[..self.unknowns]) {
            (*a, *b) = (cosine * *a + sine * *b, cosine * *b - sine * *a);
        }
    }
}

/// The rotation that turns `(a, b)` into `(length, 0)`; none where `b` is zero already.
fn rotation(a: f64, b: f64) -> Option<(f64, f64, f64)> {
    if b == 0.0 {
        return None;
    }
    let length = a.hypot(b);
    Some((a / length, b / length, length))
}
