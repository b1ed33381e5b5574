//! Where the file is that a URDF names.

use std::path::{Path, PathBuf};

/// Returns the file that a mesh's `reference` means in a URDF of `folder`, if there is one.
///
/// A path counts from the folder. `package://NAME/REST` is looked for in the folder and in every folder above: as
/// `NAME/REST` there, and as `REST` in one that is called `NAME` itself. `file://` names a path. Nothing is fetched from
/// elsewhere.
pub fn find_mesh(reference: &str, folder: &Path) -> Option<PathBuf> {
    let is_file = |path: &PathBuf| path.is_file();
    let package = ["package://", "model://"].into_iter().find_map(|scheme| reference.strip_prefix(scheme));
    if let Some(rest) = package {
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        return folder.ancestors().flat_map(|above| in_package(above, rest)).find(is_file);
    }
    if let Some(path) = reference.strip_prefix("file://") {
        return Some(folder.join(path)).filter(is_file);
    }
    (!reference.contains("://")).then(|| folder.join(reference)).filter(is_file)
}

fn in_package(above: &Path, rest: &str) -> Vec<PathBuf> {
    let inside = rest.split_once('/').filter(|(name, _)| above.file_name().is_some_and(|own| own == *name));
    let mut places = vec![above.join(rest)];
    places.extend(inside.map(|(_, inside)| above.join(inside)));
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn packages_are_found_beside_the_file_and_above() {
        let root = tempfile::tempdir().unwrap();
        let urdf = root.path().join("share/arm_description/urdf");
        let meshes = root.path().join("share/arm_description/meshes");
        fs::create_dir_all(&urdf).unwrap();
        fs::create_dir_all(&meshes).unwrap();
        fs::write(meshes.join("a.stl"), "").unwrap();
        let names = |reference: &str| find_mesh(reference, &urdf).is_some();
        assert!(names("package://arm_description/meshes/a.stl"));
        assert!(names("../meshes/a.stl"));
        assert!(names(&format!("file://{}", meshes.join("a.stl").display())));
        assert!(!names("package://other/meshes/a.stl"));
        assert!(!names("https://example.org/a.stl"));
        assert!(!names("../meshes"));
    }
}
