//! The words at the head of the page: what was planned, whether it worked, what to try next.

use std::fmt::Write;

use super::PlanPage;
use super::markup::{escaped, plain};
use crate::plan_text::{approach_of, came_near, disturbed_by, kept_together, mean_squares};
use crate::short;
use kinstep::planner::{ArmPlan, Plan, PlanStatus};

/// What was planned, in one line.
pub(super) fn lead(page: &PlanPage<'_>) -> String {
    let (plan, stage) = (page.plan, page.recording.stage);
    let arms = plan.arms.iter().enumerate().map(|(index, arm)| {
        let machine = stage.arms.get(index).and_then(|arm| stage.machines.get(arm.machine));
        let robot =
            machine.map_or_else(String::new, |machine| format!(" ({})", escaped(machine.robot.name())));
        let colour = index % super::replay::COLOURS;
        format!("<span class=\"arm c{colour}\">{}</span>{robot}", escaped(&arm.name))
    });
    let arms: Vec<String> = arms.collect();
    let synchrony = if arms.len() == 1 { "" } else { " in synchrony" };
    let mut html = format!(
        "<p class=\"lead\">{} {}{synchrony}: {}.</p><dl class=\"facts\">{}</dl>",
        arms.len(),
        if arms.len() == 1 { "arm" } else { "arms" },
        arms.join(", "),
        facts(plan),
    );
    for shared in &plan.shared {
        let (arms, joints) = (shared.arms.join(" and "), shared.joints.join(", "));
        // Writing to a String can not fail.
        let _ = write!(html, "<p>{} share {}: solved as one system.</p>", escaped(&arms), escaped(&joints));
    }
    for task in &plan.tasks {
        let _ = write!(html, "<p>{}.</p>", escaped(&kept_together(task)));
    }
    for sentence in approach_of(plan) {
        let _ = write!(html, "<p>{}.</p>", escaped(&sentence));
    }
    if let Some(noise) = &plan.noise {
        let (noise, errors) = (disturbed_by(noise), mean_squares(plan));
        let _ = write!(
            html,
            "<p>The loop suffered {}. Root mean square of the error in the second half: {}.</p>",
            escaped(&noise),
            escaped(&errors)
        );
    }
    html
}

fn facts(plan: &Plan) -> String {
    let facts = [
        ("formula", escaped(&plan.formula)),
        ("sampling gap \u{3c3}", format!("{} s", plan.sigma)),
        ("feedback step h", short(plan.h)),
        ("start", escaped(plan.start)),
        ("steps", format!("{}", plan.steps)),
        ("duration", format!("{} s", plain(plan.time(plan.steps)))),
    ];
    facts.iter().fold(String::new(), |all, (name, value)| {
        all + &format!("<div><dt>{name}</dt><dd>{value}</dd></div>")
    })
}

/// How a run ended: class, icon, words.
fn outcome(plan: &Plan) -> (&'static str, &'static str, &'static str) {
    match plan.status {
        PlanStatus::Completed if !plan.keeps_distances() => {
            ("fair", "\u{25b2}", "Completed, but bodies came nearer to each other than they may.")
        }
        PlanStatus::Completed if plan.is_within_limits() => {
            ("good", "\u{2714}", "Completed, within all limits that are known.")
        }
        PlanStatus::Completed => ("fair", "\u{25b2}", "Completed, but joints crossed their limits."),
        PlanStatus::Diverged => ("bad", "\u{2716}", "Stopped: the task error left every bound."),
        PlanStatus::Singular => {
            ("bad", "\u{2716}", "Stopped: an arm lost a direction that its task needs (singular).")
        }
        PlanStatus::Unreachable => ("bad", "\u{2716}", "Stopped: the path leaves what an arm can reach."),
        PlanStatus::Limit => ("bad", "\u{2716}", "Stopped at a limit."),
        PlanStatus::NonFinite => {
            ("bad", "\u{2716}", "Stopped: a joint position is no longer a finite number.")
        }
    }
}

/// Whether it worked, and why not.
pub(super) fn verdict(plan: &Plan) -> String {
    let (class, icon, words) = outcome(plan);
    let reason =
        plan.reason.iter().fold(String::new(), |all, reason| all + &format!("<p>{}</p>", escaped(reason)));
    let done = match plan.samples() {
        samples if samples == plan.steps + 1 => String::new(),
        0 => format!("<p>No sample was recorded of the {} planned steps.</p>", plan.steps),
        samples => format!(
            "<p>{} of {} steps were made; the record ends at {} s.</p>",
            samples - 1,
            plan.steps,
            plain(plan.time(samples - 1))
        ),
    };
    let worst = plan
        .arms
        .iter()
        .filter(|_| plan.samples() > 0)
        .fold(String::new(), |all, arm| all + &format!("<li>{}</li>", worst_of(plan, arm)));
    format!(
        "<div class=\"verdict {class}\"><p class=\"status\"><span class=\"icon\" aria-hidden=\"true\">{icon}</span> \
         <strong>{words}</strong></p>{reason}{done}<ul>{worst}</ul></div>"
    )
}

fn worst_of(plan: &Plan, arm: &ArmPlan) -> String {
    let turned = if arm.max_orientation_error > 0.0 {
        format!(" and {} rad", plain(arm.max_orientation_error))
    } else {
        String::new()
    };
    let at = worst_sample(arm)
        .map_or_else(String::new, |sample| format!(", {}", moment(plan.time(sample), "the largest error")));
    format!("{}: at most {} m{turned} from its path{at}", escaped(&arm.name), plain(arm.max_position_error))
}

/// The sample at which the task error was largest.
pub(super) fn worst_sample(arm: &ArmPlan) -> Option<usize> {
    let norms =
        arm.errors.iter().map(nalgebra::Vector6::norm).enumerate().filter(|(_, norm)| norm.is_finite());
    norms.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(sample, _)| sample)
}

/// A time that the replay goes to when it is pressed.
fn moment(time: f64, what: &str) -> String {
    format!(
        "<button type=\"button\" class=\"moment\" data-time=\"{time}\" title=\"Show {what} in the replay\">at {} \
         s</button>",
        plain(time)
    )
}

/// What the user should know.
pub(super) fn warnings(plan: &Plan) -> String {
    plan.warnings.iter().fold(String::new(), |all, warning| {
        all + &format!(
            "<p class=\"warning\"><span aria-hidden=\"true\">\u{25b2}</span> {}</p>",
            escaped(warning)
        )
    })
}

/// What to try next, as commands with their reasons.
pub(super) fn next(page: &PlanPage<'_>) -> String {
    let items = page.suggestions.iter().fold(String::new(), |all, suggestion| {
        let (arguments, reason) = (escaped(&suggestion.arguments), escaped(&suggestion.reason));
        all + &format!("<li><code>{} {arguments}</code> {reason}</li>", escaped(page.command))
    });
    if items.is_empty() {
        String::new()
    } else {
        format!("<h2>What to try next</h2><ul class=\"next\">{items}</ul>")
    }
}

/// The table of numbers.
pub(super) fn numbers(plan: &Plan) -> String {
    let heading = [
        "arm",
        "joints",
        "largest error",
        "in the second half",
        "position [m]",
        "orientation [rad]",
        "smallest singular value",
        "damped samples",
        "limits",
    ];
    let heading =
        heading.iter().fold(String::new(), |all, name| all + &format!("<th scope=\"col\">{name}</th>"));
    let rows = plan.arms.iter().map(|arm| number_row(plan, arm)).collect::<String>();
    format!(
        "<table class=\"numbers\"><thead><tr>{heading}</tr></thead><tbody>{rows}</tbody></table>{}{}",
        crossed(plan),
        nearest(plan)
    )
}

fn number_row(plan: &Plan, arm: &ArmPlan) -> String {
    let errors = [arm.max_error, arm.max_error_steady, arm.max_position_error, arm.max_orientation_error];
    let (value, at) = arm.smallest_singular_value;
    let singular = if value.is_finite() && plan.samples() > 0 {
        let most =
            arm.worst_singular_value.map_or_else(String::new, |most| format!(", at most {}", plain(most)));
        let shown = format!("at least {}{most}", plain(value));
        format!("{shown} {}", moment(at, "the worst conditioned posture"))
    } else {
        "\u{2013}".to_owned()
    };
    let limits = match arm.violations.len() {
        0 => "kept".to_owned(),
        count => format!("<span class=\"mark crossed\">\u{2716} {count} crossed</span>"),
    };
    let cells = [arm.joints.len().to_string()].into_iter().chain(errors.map(plain));
    let cells = cells.chain([singular, arm.damped_samples.to_string(), limits]);
    format!(
        "<tr><th scope=\"row\">{}</th>{}</tr>",
        escaped(&arm.name),
        cells.fold(String::new(), |all, cell| all + &format!("<td>{cell}</td>"))
    )
}

/// How near bodies came to each other.
fn nearest(plan: &Plan) -> String {
    let Some(closest) = &plan.distance else { return String::new() };
    let mark = if closest.is_kept() { "" } else { "<span class=\"mark crossed\">\u{2716}</span> " };
    let when = moment(closest.t, "where bodies are nearest");
    format!("<p>{mark}{}, {when}</p>", escaped(&came_near(closest)))
}

/// The limits that were crossed, each where it was worst.
fn crossed(plan: &Plan) -> String {
    let mut items = String::new();
    for arm in &plan.arms {
        for violation in &arm.violations {
            // Writing to a String can not fail.
            let _ = write!(
                items,
                "<li>{}, {}: {} {} where {} is allowed, {}</li>",
                escaped(&arm.name),
                escaped(&violation.joint),
                violation.kind.name(),
                plain(violation.value),
                plain(violation.limit),
                moment(violation.t, "this crossing")
            );
        }
    }
    if items.is_empty() {
        String::new()
    } else {
        format!("<h3>Limits crossed, where each was worst</h3><ul>{items}</ul>")
    }
}
