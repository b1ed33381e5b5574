//! What the robots of the page look like: shapes and meshes, small enough to be sent by mail.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nalgebra::IsometryMatrix3;
use serde::Serialize;

use super::markup::base64;
use kinstep::robot::{Colour, Mesh, MeshPart, Shape, Triangle, Visual, Visuals, find_mesh};
use kinstep_files::trajectory::Machine;

/// Most triangles of all meshes of a page together: about a megabyte.
const MOST_TRIANGLES: usize = 80_000;
/// Fewest triangles of one mesh: with less, nobody would know it again.
const FEWEST_TRIANGLES: usize = 150;
/// Most notes that are shown.
const MOST_NOTES: usize = 8;

/// A shape of a link, as the replay draws it.
#[derive(Serialize)]
pub(super) struct Look {
    link: usize,
    pose: [f64; 12],
    shape: &'static str,
    /// Box: sides; cylinder and capsule: radius, length; sphere: radius; mesh: scale.
    size: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<Colour>,
}

/// What is known of the looks of a machine.
pub(super) struct Looks {
    /// The shapes.
    pub(super) shown: Vec<Look>,
    /// Whether these are all.
    pub(super) is_whole: bool,
}

/// Triangles of one colour: corners as whole numbers of a box, and which three make a triangle.
#[derive(Serialize)]
pub(super) struct Surface {
    low: [f32; 3],
    step: f32,
    /// Three 16-bit numbers per corner.
    corners: String,
    /// Three 32-bit places per triangle.
    triangles: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<Colour>,
}

/// The meshes of all machines, each file once.
#[derive(Default)]
pub(super) struct Library {
    files: HashMap<PathBuf, Option<usize>>,
    /// Every mesh is its surfaces.
    pub(super) meshes: Vec<Vec<Surface>>,
    /// What could not be shown, and why.
    pub(super) notes: Vec<String>,
    most: usize,
}

impl Library {
    /// A library of meshes for these machines.
    pub(super) fn of(machines: &[Machine]) -> (Self, Vec<Looks>) {
        let looks: Vec<Visuals> = machines
            .iter()
            .map(|machine| machine.urdf.as_deref().map(Visuals::from_urdf).unwrap_or_default())
            .collect();
        let mut names: Vec<&str> =
            looks.iter().flat_map(|looks| &looks.visuals).filter_map(reference).collect();
        names.sort_unstable();
        names.dedup();
        let most = (MOST_TRIANGLES / names.len().max(1)).max(FEWEST_TRIANGLES);
        let mut library = Self { most, ..Self::default() };
        let shown =
            machines.iter().zip(looks).map(|(machine, looks)| library.looks(machine, looks)).collect();
        (library, shown)
    }

    fn looks(&mut self, machine: &Machine, looks: Visuals) -> Looks {
        let notes = looks.notes.len();
        looks.notes.into_iter().for_each(|note| self.note(note));
        let count = looks.visuals.len();
        let shown: Vec<Look> =
            looks.visuals.into_iter().filter_map(|visual| self.look(machine, visual)).collect();
        Looks { is_whole: notes == 0 && shown.len() == count, shown }
    }

    fn look(&mut self, machine: &Machine, visual: Visual) -> Option<Look> {
        let link = machine.robot.links().iter().position(|link| link.name == visual.link)?;
        let (shape, size, mesh) = match visual.shape {
            Shape::Box { sides } => ("box", sides.to_vec(), None),
            Shape::Cylinder { radius, length } => ("cylinder", vec![radius, length], None),
            Shape::Capsule { radius, length } => ("capsule", vec![radius, length], None),
            Shape::Sphere { radius } => ("sphere", vec![radius], None),
            Shape::Mesh { reference, scale } => {
                ("mesh", scale.to_vec(), Some(self.mesh(&reference, machine.folder.as_deref())?))
            }
        };
        Some(Look { link, pose: rows(&visual.origin), shape, size, mesh, colour: visual.colour })
    }

    /// The place of a mesh in the library; `None`, and a note, where it can not be had.
    fn mesh(&mut self, reference: &str, folder: Option<&Path>) -> Option<usize> {
        let key = folder.unwrap_or(Path::new("")).join(reference);
        if let Some(known) = self.files.get(&key) {
            return *known;
        }
        let found = folder.and_then(|folder| find_mesh(reference, folder));
        let read = found.ok_or_else(|| format!("{reference} was not found"));
        let read = read.and_then(|path| Mesh::read(&path).map_err(|error| error.to_string()));
        let place = match read {
            Ok(mesh) => {
                self.meshes.push(mesh.reduced(self.most).parts.iter().map(Surface::of).collect());
                Some(self.meshes.len() - 1)
            }
            Err(reason) => {
                self.note(reason);
                None
            }
        };
        self.files.insert(key, place);
        place
    }

    fn note(&mut self, note: String) {
        match self.notes.len() {
            count if count < MOST_NOTES => self.notes.push(note),
            MOST_NOTES => self.notes.push("and more".to_owned()),
            _ => {}
        }
    }
}

fn reference(visual: &Visual) -> Option<&str> {
    match &visual.shape {
        Shape::Mesh { reference, .. } => Some(reference),
        _ => None,
    }
}

/// The three rows of a pose: nine numbers of its rotation and three of its place, in turn.
pub(super) fn rows(pose: &IsometryMatrix3<f64>) -> [f64; 12] {
    let matrix = pose.to_homogeneous();
    std::array::from_fn(|i| matrix[(i / 4, i % 4)])
}

impl Surface {
    fn of(part: &MeshPart) -> Self {
        let (low, step) = lattice(&part.triangles);
        let mut places: HashMap<[u16; 3], u32> = HashMap::new();
        let (mut corners, mut triangles) = (Vec::new(), Vec::new());
        for corner in part.triangles.iter().flatten() {
            let cell: [u16; 3] =
                std::array::from_fn(|axis| ((corner[axis] - low[axis]) / step).round() as u16);
            let next = places.len() as u32;
            let place = *places.entry(cell).or_insert_with(|| {
                corners.extend(cell.iter().flat_map(|number| number.to_le_bytes()));
                next
            });
            triangles.extend(place.to_le_bytes());
        }
        Self { low, step, corners: base64(&corners), triangles: base64(&triangles), colour: part.colour }
    }
}

/// The lowest corner of the triangles, and a step with which 65535 of them reach across.
fn lattice(triangles: &[Triangle]) -> ([f32; 3], f32) {
    let corners = || triangles.iter().flatten();
    let bound = |first: f32, pick: fn(f32, f32) -> f32| -> [f32; 3] {
        std::array::from_fn(|axis| corners().map(|corner| corner[axis]).fold(first, pick))
    };
    let (low, high) = (bound(f32::INFINITY, f32::min), bound(f32::NEG_INFINITY, f32::max));
    let side = (0..3).map(|axis| high[axis] - low[axis]).fold(f32::MIN_POSITIVE, f32::max);
    (low, side / f32::from(u16::MAX))
}
