//! Plans scenarios and draws them: pictures of the README and of docs.
//!
//! `cargo run --example plan_pictures -- docs/pictures` (without a folder the pictures are only listed).

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;

use kinstep::formula::FormulaTable;
use kinstep_files::scenario::ScenarioText;
use kinstep_files::trajectory::{About, Recording, Trajectory};
use kinstep_report::figure::{Figure, PlanFigures};

/// The scenarios, and which of their pictures are shown.
const SHOWN: [(&str, &str, &[&str]); 3] = [
    ("planar_dual", include_str!("planar_dual.toml"), &["motion", "errors"]),
    ("dual_panda", include_str!("dual_panda.toml"), &["motion-slanted", "velocities-left"]),
    ("waypoints", include_str!("waypoints.toml"), &["motion-slanted"]),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1);
    for (name, text, shown) in SHOWN {
        for figure in pictures(text)?.iter().filter(|figure| shown.contains(&figure.name.as_str())) {
            let svg = figure.to_svg();
            println!("{name}-{}.svg: {} bytes, {}", figure.name, svg.len(), figure.title);
            if let Some(folder) = &folder {
                std::fs::write(Path::new(folder).join(format!("{name}-{}.svg", figure.name)), svg)?;
            }
        }
    }
    Ok(())
}

fn pictures(text: &str) -> Result<Vec<Figure>, Box<dyn Error>> {
    let folder = Some(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples")));
    let scenario = ScenarioText::parse(text)?.scenario()?;
    let stage = scenario.stage(folder)?;
    let plan = scenario.planner(FormulaTable::builtin(), folder)?.run();
    let trajectory = Trajectory::of(&plan, Some(About::of(&plan, text, &stage)));
    let recording = Recording { trajectory: &trajectory, stage: &stage };
    Ok(PlanFigures::new(recording, Some(&plan)).draw())
}
