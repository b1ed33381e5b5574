//! A figure as values: axes and marks.

use std::fmt::Write;

use super::axis::{Axis, Scale};

/// The outline of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A filled disk.
    Disk,
    /// An open circle.
    Circle,
    /// A diagonal cross.
    Cross,
    /// A filled diamond.
    Diamond,
    /// An open square.
    Square,
}

/// Something drawn inside the axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line through points, interrupted where one is not finite.
    Line {
        /// What the legend and the CSV file call it; lines of one name share a legend entry.
        name: String,
        /// The points.
        points: Vec<(f64, f64)>,
        /// What the points are taken at, one value each, or nothing.
        parameter: Vec<f64>,
        /// Which colour and dash.
        style: usize,
    },
    /// Points by themselves.
    Points {
        /// What the legend and the CSV file call them.
        name: String,
        /// The points.
        points: Vec<(f64, f64)>,
        /// Their outline.
        shape: Shape,
        /// Which colour.
        style: usize,
    },
    /// A filled area as horizontal strips.
    Region {
        /// What the legend and the CSV file call it.
        name: String,
        /// Strips: left, right, lower, upper.
        strips: Vec<[f64; 4]>,
        /// Which colour.
        style: usize,
    },
    /// A line of any strength, without an entry in the legend.
    Stroke {
        /// What the CSV file calls it; without a name it is not in the file.
        name: String,
        /// The points.
        points: Vec<(f64, f64)>,
        /// Which colour.
        style: usize,
        /// How wide \[px\].
        width: f64,
        /// How much of what is below it hides: 1 for everything.
        opacity: f64,
        /// Whether it is broken into dashes.
        is_dashed: bool,
    },
    /// Cells of a map, one wide and high, in shades.
    Cells {
        /// What the CSV file calls them.
        name: String,
        /// The cells.
        cells: Vec<Cell>,
    },
    /// A thin grey line that helps the eye; not in the CSV file.
    Guide {
        /// The points.
        points: Vec<(f64, f64)>,
    },
    /// A text beside a point.
    Label {
        /// The text.
        text: String,
        /// The point.
        at: (f64, f64),
    },
}

/// A cell of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Its middle.
    pub at: (f64, f64),
    /// What it stands for: the last column of the CSV file.
    pub value: f64,
    /// From light, 0, to dark, 1; without one it is grey.
    pub shade: Option<f64>,
    /// What stands in it.
    pub text: String,
}

impl Mark {
    pub(super) fn legend(&self) -> Option<(&str, usize)> {
        match self {
            Self::Line { name, style, .. }
            | Self::Points { name, style, .. }
            | Self::Region { name, style, .. } => Some((name, *style)),
            Self::Stroke { .. } | Self::Cells { .. } | Self::Guide { .. } | Self::Label { .. } => None,
        }
    }
}

/// Axes and what is drawn inside them.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The stem of its files.
    pub name: String,
    /// What is seen.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Whether both axes have one scale: circles are round.
    pub is_isometric: bool,
    /// What has to be known to read it, in a sentence or two below it; empty for nothing.
    pub caption: String,
    /// How wide and high the whole drawing is to be \[px\]; without it the drawing takes the room that it needs.
    pub size: Option<(f64, f64)>,
    /// What a point of a line is taken at: the last column of the CSV file.
    pub parameter: Option<String>,
    /// From back to front.
    pub marks: Vec<Mark>,
}

impl Figure {
    /// Returns the numbers of every mark but guides and labels, a line each: mark, x, y and the parameter if there is one.
    ///
    /// A strip of a region is its two ends. Nine digits, which is more than a drawing shows.
    pub fn to_csv(&self) -> String {
        let mut text = format!("mark,{},{}", self.x.column, self.y.column);
        if let Some(parameter) = &self.parameter {
            let _ = write!(text, ",{parameter}");
        }
        text.push('\n');
        for mark in &self.marks {
            match mark {
                Mark::Line { name, points, parameter, .. } => {
                    for (i, point) in points.iter().enumerate() {
                        self.csv_line(&mut text, name, *point, parameter.get(i));
                    }
                }
                Mark::Stroke { name, .. } if name.is_empty() => {}
                Mark::Points { name, points, .. } | Mark::Stroke { name, points, .. } => {
                    for point in points {
                        self.csv_line(&mut text, name, *point, None);
                    }
                }
                Mark::Region { name, strips, .. } => {
                    for [left, right, lower, upper] in strips {
                        let middle = f64::midpoint(*lower, *upper);
                        self.csv_line(&mut text, name, (*left, middle), None);
                        self.csv_line(&mut text, name, (*right, middle), None);
                    }
                }
                Mark::Cells { name, cells } => {
                    for cell in cells {
                        self.csv_line(&mut text, name, cell.at, Some(&cell.value));
                    }
                }
                Mark::Guide { .. } | Mark::Label { .. } => {}
            }
        }
        text
    }

    fn csv_line(&self, text: &mut String, name: &str, (x, y): (f64, f64), parameter: Option<&f64>) {
        let _ = write!(text, "{},{},{}", quoted(name), on_axis(x, &self.x), on_axis(y, &self.y));
        if self.parameter.is_some() {
            let _ = write!(text, ",{}", parameter.map_or_else(String::new, |value| small(*value)));
        }
        text.push('\n');
    }
}

/// A text as a field of a CSV file.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A number as its axis shows it: on a logarithmic one small numbers are no noise, and on one of names they are names.
fn on_axis(value: f64, axis: &Axis) -> String {
    match axis.scale {
        Scale::Logarithmic => small(value),
        Scale::Named => {
            axis.names.get(value.round() as usize).map_or_else(|| number(value), |name| quoted(name))
        }
        Scale::Linear | Scale::Angle => number(value),
    }
}

/// A number that keeps its digits however small it is.
fn small(value: f64) -> String {
    let is_small = value != 0.0 && value.abs() < 1e-6;
    if is_small { format!("{value:.6e}") } else { number(value) }
}

/// Nine digits, without noise about zero.
fn number(value: f64) -> String {
    let text = format!("{value:.9}");
    let trimmed = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if trimmed == "-0" { "0".to_owned() } else { trimmed.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn specimen() -> Figure {
        Figure {
            name: "a".to_owned(),
            title: "a < b & c".to_owned(),
            x: Axis::new("h", "h", Scale::Linear, (0.0, 1.0)),
            y: Axis::new("r", "r", Scale::Logarithmic, (0.1, 10.0)),
            is_isometric: false,
            caption: "what < it is".to_owned(),
            size: None,
            parameter: Some("t".to_owned()),
            marks: vec![
                Mark::Line {
                    name: "x, y".to_owned(),
                    points: vec![(0.0, 1.0), (0.5, f64::NAN), (1.0, 2.0)],
                    parameter: vec![1.0, 2.0, 3.0],
                    style: 0,
                },
                Mark::Points {
                    name: "p".to_owned(),
                    points: vec![(0.25, -0.0)],
                    shape: Shape::Disk,
                    style: 1,
                },
                Mark::Guide { points: vec![(0.0, 1.0), (1.0, 1.0)] },
            ],
        }
    }

    #[test]
    fn numbers_stand_beside_the_figure() {
        let csv = specimen().to_csv();
        assert_eq!(csv, "mark,h,r,t\n\"x, y\",0,1,1\n\"x, y\",0.5,NaN,2\n\"x, y\",1,2,3\np,0.25,0,\n");
    }

    #[test]
    fn a_drawing_is_well_formed_and_escapes_its_text() {
        let svg = specimen().to_svg();
        let document = roxmltree::Document::parse(&svg).expect("well-formed");
        assert_eq!(document.root_element().tag_name().name(), "svg");
        assert!(document.descendants().any(|node| node.text() == Some("a < b & c")));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
