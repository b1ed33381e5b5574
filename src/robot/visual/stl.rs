//! STL: triangles and nothing else, as bytes or as text.

use super::mesh::{MOST_TRIANGLES, Mesh, MeshPart, Triangle};

const HEADER: usize = 80;
const RECORD: usize = 50;

/// Reads either kind. A binary file may begin with `solid` too: its length tells.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let count = bytes.get(HEADER..HEADER + 4).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let records = bytes.get(HEADER + 4..).unwrap_or_default();
    let fits = count.is_some_and(|count| count as usize == records.len() / RECORD);
    let triangles = if fits || !bytes.trim_ascii_start().starts_with(b"solid") {
        records.chunks_exact(RECORD).take(MOST_TRIANGLES).map(triangle).collect()
    } else {
        text(&String::from_utf8_lossy(bytes))?
    };
    Ok(Mesh { parts: vec![MeshPart { colour: None, triangles }] })
}

/// A record: normal, three corners, two bytes that mean nothing.
fn triangle(record: &[u8]) -> Triangle {
    let number = |at: usize| f32::from_le_bytes(std::array::from_fn(|i| record[at + i]));
    std::array::from_fn(|corner| std::array::from_fn(|axis| number(12 + 12 * corner + 4 * axis)))
}

fn text(text: &str) -> Result<Vec<Triangle>, String> {
    let corners = text.lines().filter_map(|line| line.trim().strip_prefix("vertex"));
    let corners: Vec<[f32; 3]> = corners.take(3 * MOST_TRIANGLES).map(corner).collect::<Result<_, _>>()?;
    Ok(corners.as_chunks::<3>().0.to_vec())
}

fn corner(line: &str) -> Result<[f32; 3], String> {
    let numbers: Vec<f32> = line.split_whitespace().filter_map(|number| number.parse().ok()).collect();
    <[f32; 3]>::try_from(numbers).map_err(|_| format!("`vertex{line}` is not a corner"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: Triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]];

    fn binary() -> Vec<u8> {
        let mut bytes = b"solid by its name only".to_vec();
        bytes.resize(HEADER, b' ');
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend([0; 12]);
        bytes.extend(CORNERS.iter().flatten().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
        bytes
    }

    #[test]
    fn bytes_and_text_read_alike() {
        let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n vertex 1 0 0\nvertex 0 1 5e-1\nendloop\n\
                    endfacet\nendsolid a\n";
        for bytes in [binary(), text.as_bytes().to_vec()] {
            assert_eq!(read(&bytes).unwrap().parts[0].triangles, [CORNERS]);
        }
    }

    #[test]
    fn what_is_cut_off_gives_what_is_whole() {
        let whole = binary();
        for length in 0..whole.len() {
            let read = read(&whole[..length]);
            assert!(read.is_ok_and(|mesh| mesh.triangles() == 0), "{length}");
        }
    }
}
