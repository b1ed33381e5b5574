//! Meshes from files, by their extension.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::{Mesh, MeshError, collada, obj, stl};

/// Longest file that is read, in bytes.
const MOST_BYTES: u64 = 128 << 20;

impl Mesh {
    /// Returns the mesh in a file: STL (binary or text), OBJ or COLLADA, known by its extension.
    ///
    /// # Errors
    /// [`MeshError`]: the file can not be read, is longer than 128 MiB, or holds no mesh.
    pub fn read(path: &Path) -> Result<Self, MeshError> {
        let refuse = |reason| MeshError::Content { path: path.to_owned(), reason };
        let bytes = bytes_of(path).map_err(|source| MeshError::File { path: path.to_owned(), source })?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(refuse(format!("it is longer than the {MOST_BYTES} bytes that are read")));
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        Self::from_bytes(&bytes, &extension).map_err(refuse)
    }

    /// Returns the mesh that bytes hold, in the format of that extension, in lower case.
    ///
    /// # Errors
    /// A sentence that says why there is none.
    pub fn from_bytes(bytes: &[u8], extension: &str) -> Result<Self, String> {
        let mut mesh = match extension {
            "stl" => stl::read(bytes)?,
            "obj" => obj::read(&String::from_utf8_lossy(bytes))?,
            "dae" => collada::read(&String::from_utf8_lossy(bytes))?,
            other => {
                return Err(format!("\"{other}\" is not among the formats that are read: stl, obj, dae"));
            }
        };
        for part in &mut mesh.parts {
            part.triangles.retain(|triangle| triangle.iter().flatten().all(|number| number.is_finite()));
        }
        mesh.parts.retain(|part| !part.triangles.is_empty());
        if mesh.parts.is_empty() { Err("it holds no triangle".to_owned()) } else { Ok(mesh) }
    }
}

fn bytes_of(path: &Path) -> io::Result<Vec<u8>> {
    if !path.metadata()?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_unknown_format_is_refused_with_the_known_ones() {
        let reason = Mesh::from_bytes(b"solid", "step").unwrap_err();
        assert!(reason.contains("stl, obj, dae"), "{reason}");
        assert!(Mesh::from_bytes(b"", "obj").unwrap_err().contains("no triangle"));
    }

    proptest! {
        #[test]
        fn no_bytes_make_a_reader_panic(
            bytes in proptest::collection::vec(any::<u8>(), 0..300), words in "(v|f|vertex| |-?[0-9]{1,3}|/|\n){0,60}",
        ) {
            for extension in ["stl", "obj", "dae"] {
                for bytes in [bytes.as_slice(), words.as_bytes()] {
                    if let Ok(mesh) = Mesh::from_bytes(bytes, extension) {
                        prop_assert!(mesh.triangles() > 0);
                        let _ = mesh.reduced(3);
                    }
                }
            }
        }
    }
}
