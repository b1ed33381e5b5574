//! Figures as files: SVG, and the numbers beside it as CSV.

use std::path::Path;

use super::failure::{Exit, Failure};
use super::folder::Folder;
use kinstep::formula::Analysis;
use kinstep_report::figure::{Figure, comparison, portrait, sheet};

/// Most steps of a row that is drawn: beyond, pictures are black.
const MOST_DRAWN: usize = 40;

/// Extensions of pictures that are not drawn: no one means a folder by such a name.
const OTHER_PICTURES: [&str; 12] =
    ["png", "pdf", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "eps", "ps", "html"];

/// Draws rows, each by itself; see [`draw`].
pub(super) fn plot(path: &Path, force: bool, rows: &[(&str, &Analysis)]) -> Result<Vec<String>, Failure> {
    refuse_long(rows)?;
    let figures: Vec<Figure> = rows.iter().flat_map(|(id, analysis)| portrait(id, analysis)).collect();
    draw(path, force, &title(rows), &figures)
}

/// Draws rows over one another; see [`draw`].
pub(super) fn plot_together(
    path: &Path,
    force: bool,
    rows: &[(&str, &Analysis)],
) -> Result<Vec<String>, Failure> {
    refuse_long(rows)?;
    draw(path, force, &title(rows), &comparison(rows))
}

fn refuse_long(rows: &[(&str, &Analysis)]) -> Result<(), Failure> {
    match rows.iter().find(|(_, analysis)| analysis.steps() > MOST_DRAWN) {
        None => Ok(()),
        Some((id, analysis)) => {
            let steps = analysis.steps();
            Err(Failure::usage(format!("{id} has {steps} steps; figures are drawn of up to {MOST_DRAWN}")))
        }
    }
}

fn title(rows: &[(&str, &Analysis)]) -> String {
    rows.iter().map(|(id, _)| *id).collect::<Vec<_>>().join(", ")
}

/// Writes figures into a folder, a file per figure, or, where the name ends in `.svg`, on one page of that title; returns
/// the names written.
pub(super) fn draw(
    path: &Path,
    force: bool,
    title: &str,
    figures: &[Figure],
) -> Result<Vec<String>, Failure> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        return page(path, force, title, figures);
    }
    if OTHER_PICTURES.iter().any(|other| extension == *other) && !path.is_dir() {
        let message = format!(
            "--plot {}: pictures are drawn as SVG; name a folder, or a file that ends in .svg",
            path.display()
        );
        return Err(Failure::usage(message));
    }
    folder(path, force, figures)
}

fn folder(path: &Path, force: bool, figures: &[Figure]) -> Result<Vec<String>, Failure> {
    let files: Vec<(String, String)> = figures
        .iter()
        .flat_map(|figure| {
            let name = |kind: &str| format!("{}.{kind}", figure.name);
            [(name("svg"), figure.to_svg()), (name("csv"), figure.to_csv())]
        })
        .collect();
    write_all("--plot", path, force, &files)
}

fn page(path: &Path, force: bool, title: &str, figures: &[Figure]) -> Result<Vec<String>, Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let beside = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    // One table of numbers for the page: the name of the figure goes before each line.
    let line = |name: &str, line: &str| format!("{name},{line}\n");
    let lines = |figure: &Figure| -> Vec<String> {
        figure.to_csv().lines().map(|text| line(&figure.name, text)).collect()
    };
    let numbers = figures.iter().flat_map(lines).collect::<Vec<_>>().concat();
    let csv = Path::new(&name).with_extension("csv").to_string_lossy().into_owned();
    write_all("--plot", beside, force, &[(name, sheet(title, figures, 2.min(figures.len()))), (csv, numbers)])
}

/// Writes files into the folder that an option names, and returns their paths.
pub(super) fn write_all(
    option: &str,
    path: &Path,
    force: bool,
    files: &[(String, String)],
) -> Result<Vec<String>, Failure> {
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let mut repeated = names.clone();
    repeated.sort_unstable();
    if let Some([name, ..]) = repeated.windows(2).find(|pair| pair[0] == pair[1]) {
        let message = format!("{name} would be written twice; name each formula once");
        return Err(Failure::new(Exit::Usage, message));
    }
    let folder = Folder::named_by(option, path, force, &names)?;
    for (name, content) in files {
        folder.write(name, |out| out.write_all(content.as_bytes()))?;
    }
    Ok(names.iter().map(|name| path.join(name).display().to_string()).collect())
}
