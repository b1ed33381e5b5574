//! The kinds that a scenario can name.

use super::key_path::{KeyPath, Step};
use kinstep::collision::{MakeObstacle, OBSTACLES, ObstacleKind};
use kinstep::kind::Registry;
use kinstep::law::{CRITERIA, CriterionKind, LAWS, LawKind, MakeCriterion, MakeLaw};
use kinstep::task::{
    AddedTaskKind, CURVES, CurveKind, MakeCurve, MakeTask, MakeTimeLaw, TASKS, TIME_LAWS, TimeLawKind,
};

/// The curves, time laws, laws, null-space criteria, tasks and obstacles that a scenario can name: the built-in ones, and those that a
/// program adds.
///
/// ```
/// use kinstep::formula::FormulaTable;
/// use kinstep::kind::{Form, Kind, Parameter};
/// use kinstep::task::{Circle, CurveKind, MakeCurve};
/// use kinstep_files::scenario::{Kinds, ScenarioText};
///
/// const HOOP: CurveKind = Kind::new(
///     "hoop",
///     "2 size (cos a, sin a).",
///     &[Parameter::required("size", Form::Positive { noun: "size" }, "m", "Half the radius.")],
///     MakeCurve::Planar(|given| Box::new(Circle { radius: 2.0 * given.number("size").unwrap_or(0.0) })),
/// );
///
/// let kinds = Kinds::builtin().with_curve(HOOP);
/// let text = ScenarioText::parse(
///     r#"
///     sigma = 0.01
///     duration = 1.0
///     [[arm]]
///     name = "left"
///     robot = "planar4"
///     base = "base"
///     tip = "tip"
///     task = "position-xy"
///     q0 = [0.3, 0.3, 0.3, 0.3]
///     path = { kind = "hoop", size = 0.05 }
///     "#,
/// )?;
/// let planner = text.scenario_with(&kinds)?.planner_with(&kinds, FormulaTable::builtin(), None)?;
/// assert!(planner.run().is_completed());
/// # Ok::<(), kinstep_files::scenario::ScenarioError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Kinds {
    /// Curves.
    pub curves: Registry<MakeCurve>,
    /// Time laws.
    pub time_laws: Registry<MakeTimeLaw>,
    /// Laws.
    pub laws: Registry<MakeLaw>,
    /// Null-space criteria.
    pub criteria: Registry<MakeCriterion>,
    /// Tasks beside those of the arms.
    pub tasks: Registry<MakeTask>,
    /// Obstacles.
    pub obstacles: Registry<MakeObstacle>,
}

impl Default for Kinds {
    fn default() -> Self {
        Self::builtin()
    }
}

impl Kinds {
    /// The built-in kinds.
    pub fn builtin() -> Self {
        Self {
            curves: Registry::of(CURVES),
            time_laws: Registry::of(TIME_LAWS),
            laws: Registry::of(LAWS),
            criteria: Registry::of(CRITERIA),
            tasks: Registry::of(TASKS),
            obstacles: Registry::of(OBSTACLES),
        }
    }

    /// The same with one more curve, in place of one of that name.
    #[must_use]
    pub fn with_curve(mut self, kind: CurveKind) -> Self {
        self.curves.add(kind);
        self
    }

    /// The same with one more time law, in place of one of that name.
    #[must_use]
    pub fn with_time_law(mut self, kind: TimeLawKind) -> Self {
        self.time_laws.add(kind);
        self
    }

    /// The same with one more law, in place of one of that name.
    #[must_use]
    pub fn with_law(mut self, kind: LawKind) -> Self {
        self.laws.add(kind);
        self
    }

    /// The same with one more null-space criterion, in place of one of that name.
    #[must_use]
    pub fn with_criterion(mut self, kind: CriterionKind) -> Self {
        self.criteria.add(kind);
        self
    }

    /// The same with one more task over the tips of arms, in place of one of that name.
    #[must_use]
    pub fn with_task(mut self, kind: AddedTaskKind) -> Self {
        self.tasks.add(kind);
        self
    }

    /// The same with one more kind of obstacle, in place of one of that name.
    #[must_use]
    pub fn with_obstacle(mut self, kind: ObstacleKind) -> Self {
        self.obstacles.add(kind);
        self
    }

    /// The names of which one is to stand at a place of a scenario, if it is the place of a kind.
    pub(super) fn names_at(&self, path: &KeyPath) -> Option<Vec<&'static str>> {
        let keys: Vec<&str> = path.steps().iter().filter_map(Step::as_key).collect();
        match keys.as_slice() {
            ["arm", .., "path", "kind"] | ["relation", .., "path" | "relative", "kind"] => {
                Some(self.curves.names())
            }
            ["arm", .., "path", "time_law"]
            | ["arm", .., "path", "time_law", "kind"]
            | ["relation", .., "path" | "relative", "time_law"]
            | ["relation", .., "path" | "relative", "time_law", "kind"] => Some(self.time_laws.names()),
            ["law", "kind"] => Some(self.laws.names()),
            ["law", "criterion", "kind"] => Some(self.criteria.names()),
            ["relation", .., "kind"] => Some(self.tasks.names()),
            ["obstacle", .., "kind"] => Some(self.obstacles.names()),
            _ => None,
        }
    }
}
