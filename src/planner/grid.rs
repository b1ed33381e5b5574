use super::{Arm, PlannerError};

/// Samples may take this much memory \[bytes\] before a plan is refused.
pub const MAX_SAMPLE_BYTES: f64 = 4e9;

/// How much memory \[bytes\] the samples of a plan take: positions and velocities of all joints, and the task error of each arm.
pub fn sample_bytes(steps: f64, joints: usize, arms: usize) -> f64 {
    steps * 8.0 * (2 * joints + 6 * arms) as f64
}

/// The gap and the number of steps: `sigma` as asked where it divides the duration, else `T / N` just below it.
pub(super) fn grid(
    sigma: f64,
    duration: f64,
    arms: &[Arm],
    warnings: &mut Vec<String>,
) -> Result<(f64, usize), PlannerError> {
    if !(duration > 0.0 && duration.is_finite()) {
        return Err(PlannerError::Duration { value: duration });
    }
    if !(sigma > 0.0 && sigma <= duration) {
        return Err(PlannerError::Sigma { value: sigma, duration });
    }
    let exact = duration / sigma;
    let whole = exact.round();
    let divides = (exact - whole).abs() <= 1e-9 * whole;
    let steps = if divides { whole } else { exact.ceil() };
    check_memory(sigma, steps, arms)?;
    if divides {
        return Ok((sigma, steps as usize));
    }
    let adjusted = duration / steps;
    warnings.push(format!(
        "sigma = {sigma} s does not divide the duration {duration} s; it was adjusted to {duration}/{steps} = {adjusted} s"
    ));
    Ok((adjusted, steps as usize))
}

fn check_memory(sigma: f64, steps: f64, arms: &[Arm]) -> Result<(), PlannerError> {
    let joints: usize = arms.iter().map(|arm| arm.q0.len()).sum();
    let bytes = sample_bytes(steps, joints, arms.len());
    if bytes <= MAX_SAMPLE_BYTES {
        return Ok(());
    }
    // A pose step of a 7-joint arm takes well under a microsecond on current machines.
    let seconds = steps * 1e-6 * arms.len() as f64;
    Err(PlannerError::TooManySteps { sigma, steps, gibibytes: bytes / f64::from(1 << 30), seconds })
}
