//! A robot drawn: links from frame to frame, and its joints with their axes, by numbers that the legend explains.

use nalgebra::{IsometryMatrix3, Vector3};

use super::figure::{Figure, Mark, Shape};
use super::style::{FONT_SIZE, PLOT, text_width};
use super::view::{View, spread};
use kinstep::robot::{Joint, JointKind, Robot};

/// Half the length of a drawn axis, and how thick a robot may be that lies in a plane, in sizes of the robot.
const AXIS: f64 = 0.045;
const THIN: f64 = 0.02;
/// Most joints that are numbered: beyond, nobody could tell them apart.
const MOST_NUMBERED: usize = 60;

/// Colours and dashes of what turns, slides, or moves in several directions.
const TURNS: usize = 1;
const SLIDES: usize = 2;
const FREE: usize = 3;

/// Returns drawings of a robot with its joints at `positions` \[rad\] or \[m\] (one per joint, in the robot's order): from
/// above, from the front, from the side and slanting; of a robot that lies in one plane, that plane alone.
pub fn robot_figures(robot: &Robot, positions: &[f64]) -> Vec<Figure> {
    let scene = Scene::new(robot, positions);
    scene.views().iter().map(|view| scene.figure(view)).collect()
}

/// What is drawn, in space.
struct Scene<'r> {
    robot: &'r Robot,
    poses: Vec<IsometryMatrix3<f64>>,
    size: f64,
}

impl<'r> Scene<'r> {
    fn new(robot: &'r Robot, positions: &[f64]) -> Self {
        let poses = robot.link_poses(positions);
        let extent = |axis: usize| spread(poses.iter().map(|pose| pose.translation.vector[axis]));
        let size = (0..3).map(extent).fold(0.0, f64::max);
        let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        Self { robot, poses, size }
    }

    fn views(&self) -> Vec<View> {
        let [slanted, front, side, top] = View::all();
        let is_flat = |axis: usize| {
            spread(self.poses.iter().map(|pose| pose.translation.vector[axis])) < THIN * self.size
                && self.moving_axes().all(|(joint, direction)| self.stays_flat(joint, direction[axis].abs()))
        };
        match [2, 1, 0].into_iter().find(|&axis| is_flat(axis)) {
            Some(2) => vec![top],
            Some(1) => vec![side],
            Some(_) => vec![front],
            None => vec![slanted, front, side, top],
        }
    }

    /// Whether a joint moves within a plane to which its axis has this component: turns about it, slides along it.
    fn stays_flat(&self, joint: usize, normal: f64) -> bool {
        if self.robot.joints()[joint].kind.is_rotation() { normal > 0.99 } else { normal < 0.01 }
    }

    /// The joints that turn or slide, with the directions of their axes in the root.
    fn moving_axes(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        let joints = self.robot.joints().iter().enumerate().filter(|(_, joint)| joint.kind.is_movable());
        joints.map(|(index, joint)| (index, self.poses[joint.child].rotation * joint.axis))
    }

    fn place(&self, link: usize) -> Vector3<f64> {
        self.poses[link].translation.vector
    }

    fn figure(&self, view: &View) -> Figure {
        let mut marks = vec![self.links(view)];
        marks.extend(self.axes(view, "axis of a turn", TURNS, true));
        marks.extend(self.axes(view, "axis of a slide", SLIDES, false));
        marks.extend(self.ends(view));
        marks.extend(self.joints(view));
        let places: Vec<(f64, f64)> = marks.iter().flat_map(points_of).collect();
        let x = self.range(&places.iter().map(|place| place.0).collect::<Vec<_>>());
        let y = self.range(&places.iter().map(|place| place.1).collect::<Vec<_>>());
        marks.extend(self.numbers(view, (PLOT / (x.1 - x.0)).min(PLOT * 0.85 / (y.1 - y.0))));
        let [x, y] = view.axes(x, y);
        Figure {
            name: view.name.to_owned(),
            title: format!("{}, {}", self.robot.name(), view.title),
            x,
            y,
            is_isometric: true,
            caption: String::new(),
            size: None,
            parameter: None,
            marks,
        }
    }

    /// A range with room around it, and not much narrower than the robot is long.
    fn range(&self, values: &[f64]) -> (f64, f64) {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::MAX, f64::min), finite().fold(f64::MIN, f64::max));
        let room = (0.1 * self.size).max((0.5 * self.size - (high - low)) / 2.0);
        (low - room, high + room)
    }

    fn links(&self, view: &View) -> Mark {
        let gap = (f64::NAN, f64::NAN);
        let ends =
            |joint: &Joint| [view.at(&self.place(joint.parent)), view.at(&self.place(joint.child)), gap];
        let points = self.robot.joints().iter().flat_map(ends).collect();
        Mark::Line { name: "links".to_owned(), points, parameter: Vec::new(), style: 0 }
    }

    /// The axes of one kind as short lines; one that points at the eye has none.
    fn axes(&self, view: &View, name: &str, style: usize, turns: bool) -> Option<Mark> {
        let mut points = Vec::new();
        for (index, direction) in self.moving_axes() {
            let joint = &self.robot.joints()[index];
            let (origin, half) = (self.place(joint.child), direction * (AXIS * self.size));
            let along = view.at(&half);
            if joint.kind.is_rotation() == turns && along.0.hypot(along.1) > 0.1 * AXIS * self.size {
                points.extend([view.at(&(origin - half)), view.at(&(origin + half)), (f64::NAN, f64::NAN)]);
            }
        }
        (!points.is_empty()).then(|| Mark::Line {
            name: name.to_owned(),
            points,
            parameter: Vec::new(),
            style,
        })
    }

    /// The joints that are not fixed, with their numbers from 1.
    fn numbered(&self) -> impl Iterator<Item = (usize, &Joint)> {
        (1..).zip(self.robot.joints().iter().filter(|joint| joint.kind != JointKind::Fixed))
    }

    fn joints(&self, view: &View) -> Vec<Mark> {
        let named = self.has_numbers();
        let mark = |(number, joint): (usize, &Joint)| {
            let (shape, style) = match joint.kind {
                JointKind::Revolute | JointKind::Continuous => (Shape::Circle, TURNS),
                JointKind::Prismatic => (Shape::Square, SLIDES),
                _ => (Shape::Diamond, FREE),
            };
            let points = vec![view.at(&self.place(joint.child))];
            let name = if named { format!("{number}  {}", joint.name) } else { joint.kind.to_string() };
            Mark::Points { name, points, shape, style }
        };
        self.numbered().map(mark).collect()
    }

    fn ends(&self, view: &View) -> [Mark; 2] {
        let place = |link: &kinstep::robot::Link| {
            let index = self.robot.links().iter().position(|other| other.name == link.name);
            view.at(&self.place(index.unwrap_or_default()))
        };
        let points =
            |name: &str, points, shape, style| Mark::Points { name: name.to_owned(), points, shape, style };
        [
            points("root", self.robot.roots().map(place).collect(), Shape::Cross, 6),
            points("tip", self.robot.leaves().map(place).collect(), Shape::Disk, 6),
        ]
    }

    /// Whether the joints are few enough to be told apart by numbers.
    fn has_numbers(&self) -> bool {
        self.numbered().count() <= MOST_NUMBERED
    }

    /// The numbers of the joints, on a drawing of `scale` pixels a metre; those that would overlap stand together.
    fn numbers(&self, view: &View, scale: f64) -> Vec<Mark> {
        let place = |(number, joint): (usize, &Joint)| (view.at(&self.place(joint.child)), vec![number]);
        let mut labels: Vec<Numbers> = self.numbered().filter(|_| self.has_numbers()).map(place).collect();
        while let Some((first, second)) = overlapping(&labels, scale) {
            let (_, numbers) = labels.remove(second);
            labels[first].1.extend(numbers);
            labels[first].1.sort_unstable();
        }
        labels.into_iter().map(|(at, numbers)| Mark::Label { text: runs(&numbers), at }).collect()
    }
}

/// Numbers that stand together, and where.
type Numbers = ((f64, f64), Vec<usize>);

/// Returns the first two labels that would be drawn over each other.
fn overlapping(labels: &[Numbers], scale: f64) -> Option<(usize, usize)> {
    let wide = |numbers: &[usize]| text_width(&runs(numbers), FONT_SIZE) + 4.0;
    let overlap = |(at, own): &Numbers, (other, numbers): &Numbers| {
        let (across, up) = ((other.0 - at.0) * scale, (other.1 - at.1) * scale);
        up.abs() < FONT_SIZE && -wide(numbers) < across && across < wide(own)
    };
    let pairs =
        (0..labels.len()).flat_map(|first| (first + 1..labels.len()).map(move |second| (first, second)));
    pairs.into_iter().find(|&(first, second)| overlap(&labels[first], &labels[second]))
}

/// Returns rising numbers with runs of them drawn together: `1, 3\u{2013}5`.
fn runs(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let run = |(first, last): (usize, usize)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first}\u{2013}{last}"),
    };
    runs.into_iter().map(run).collect::<Vec<_>>().join(", ")
}

pub(super) fn points_of(mark: &Mark) -> Vec<(f64, f64)> {
    match mark {
        Mark::Line { points, .. }
        | Mark::Points { points, .. }
        | Mark::Stroke { points, .. }
        | Mark::Guide { points } => points.clone(),
        Mark::Region { .. } | Mark::Cells { .. } | Mark::Label { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::robot::{DhTable, embedded};

    #[test]
    fn a_flat_robot_is_drawn_once_and_another_four_times() {
        let views = |name: &str| -> Vec<String> {
            let robot = embedded::get(name).unwrap();
            robot_figures(&robot, &[]).into_iter().map(|figure| figure.name).collect()
        };
        assert_eq!(views("planar4"), ["top"]);
        assert_eq!(views("panda"), ["slanted", "front", "side", "top"]);
    }

    #[test]
    fn joints_stand_where_the_kinematics_puts_them() {
        let robot = embedded::get("planar4").unwrap();
        let right = std::f64::consts::FRAC_PI_2;
        let figure = &robot_figures(&robot, &[right, -right])[0];
        let csv = figure.to_csv();
        for line in ["1  j1,0,0", "2  j2,0,1", "3  j3,1,1", "4  j4,2,1", "tip,3,1", "root,0,0"] {
            assert!(csv.lines().any(|found| found == line), "{line}:\n{csv}");
        }
        assert!(figure.to_svg().contains("4  j4"));
    }

    #[test]
    fn a_robot_of_very_many_joints_is_drawn_without_numbers() {
        let robot = Robot::from_dh(&DhTable::planar("snake", &[0.1; 500])).unwrap();
        let figure = &robot_figures(&robot, &[])[0];
        assert!(figure.marks.iter().all(|mark| !matches!(mark, Mark::Label { .. })));
        assert_eq!(figure.to_svg().matches("continuous").count(), 1, "one entry of the legend");
    }

    #[test]
    fn numbers_in_a_row_are_drawn_together() {
        assert_eq!(runs(&[1, 3, 4, 5, 7, 8]), "1, 3\u{2013}5, 7, 8");
    }

    #[test]
    fn every_embedded_robot_has_finite_drawings_of_its_own_proportions() {
        for name in embedded::names() {
            let robot = embedded::get(name).unwrap();
            for figure in robot_figures(&robot, &vec![0.4; robot.joints().len()]) {
                let svg = figure.to_svg();
                assert!(figure.is_isometric && !svg.contains("NaN") && !svg.contains("inf"), "{name}");
            }
        }
    }
}
