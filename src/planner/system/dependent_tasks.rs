//! Tasks of which one asks for what follows from others.

use super::arm_runtime::ArmRuntime;
use super::resolved::System;
use crate::math::RowRotations;
use nalgebra::DMatrix;

/// A singular value below this fraction of the largest one is none: what depends leaves only rounding.
const NOTHING: f64 = 1e-9;
/// How far joints are moved away from their start [rad or m] to tell dependent tasks from a singular configuration.
const AWAY: [f64; 3] = [0.0, 0.31, -0.23];

/// Why the rows of a system have no regular configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::planner) enum Dependence {
    /// No joint moves these rows of a task.
    Still { task: usize, rows: Vec<usize> },
    /// A task asks for what others ask for already.
    Tasks { task: usize, others: Vec<usize> },
}

impl System {
    /// The first of its tasks that can not be met beside those before it, whatever the joint positions, and which of them it is
    /// in conflict with; `None` where its tasks have regular configurations. The joints are back at their start after it.
    pub(in crate::planner) fn dependence(&mut self, arms: &mut [ArmRuntime]) -> Option<Dependence> {
        let start = self.positions_mut().to_vec();
        let samples: Vec<Vec<DMatrix<f64>>> = AWAY
            .iter()
            .map(|away| {
                // No two joints move by the same.
                let moved = start.iter().zip(1..).map(|(q, joint)| q + away * f64::from(joint).sin());
                self.positions_mut().copy_from_slice(&moved.collect::<Vec<f64>>());
                self.look(arms, 0.0);
                self.jacobians().cloned().collect()
            })
            .collect();
        self.positions_mut().copy_from_slice(&start);
        self.look(arms, 0.0);
        let is_regular = |tasks: &[usize]| samples.iter().any(|jacobians| has_full_rank(jacobians, tasks));
        let mut independent: Vec<usize> = Vec::new();
        for task in 0..samples[0].len() {
            let with = |others: &[usize]| is_regular(&[others, &[task]].concat());
            if with(&independent) {
                independent.push(task);
                continue;
            }
            let rows: Vec<usize> =
                (0..samples[0][task].nrows()).filter(|&row| is_still(&samples, task, row)).collect();
            if !rows.is_empty() {
                return Some(Dependence::Still { task, rows });
            }
            let mut others = independent;
            for place in (0..others.len()).rev() {
                let other = others.remove(place);
                if with(&others) {
                    others.insert(place, other);
                }
            }
            return Some(Dependence::Tasks { task, others });
        }
        None
    }
}

fn has_full_rank(jacobians: &[DMatrix<f64>], tasks: &[usize]) -> bool {
    let columns = jacobians[0].ncols();
    let rows: Vec<(usize, usize)> =
        tasks.iter().flat_map(|&task| (0..jacobians[task].nrows()).map(move |row| (task, row))).collect();
    let mut rotations = RowRotations::with_capacity(rows.len(), columns);
    rotations.compute(columns, |row, column| jacobians[rows[row].0][(rows[row].1, column)]);
    let largest = rotations.values().iter().copied().fold(0.0, f64::max);
    rows.len() <= columns && rotations.smallest() > NOTHING * largest
}

/// Whether no joint moves a row.
fn is_still(samples: &[Vec<DMatrix<f64>>], task: usize, row: usize) -> bool {
    samples.iter().all(|jacobians| jacobians[task].row(row).amax() < NOTHING)
}
