//! OBJ: corners, and faces that number them. Materials are in other files and not read.

use super::mesh::{MOST_TRIANGLES, Mesh, MeshPart, Triangle, fan};

pub(super) fn read(text: &str) -> Result<Mesh, String> {
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut triangles: Vec<Triangle> = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => corners.push(corner(line)?),
            Some("f") => {
                let place = |word: &str| place(word, corners.len()).map(|place| corners[place]);
                let face: Option<Vec<_>> = words.map(place).collect();
                let face = face.ok_or_else(|| format!("`{line}` names a corner that is not there"))?;
                triangles.extend(fan(&face));
            }
            _ => {}
        }
        if triangles.len() > MOST_TRIANGLES {
            break;
        }
    }
    Ok(Mesh { parts: vec![MeshPart { colour: None, triangles }] })
}

fn corner(line: &str) -> Result<[f32; 3], String> {
    let numbers: Vec<f32> =
        line.split_whitespace().skip(1).filter_map(|number| number.parse().ok()).collect();
    let three = numbers.get(..3).and_then(|three| three.try_into().ok());
    three.ok_or_else(|| format!("`{line}` is not a corner"))
}

/// Where the corner is that `7`, `7/1/2` or `-1` names: counted from 1, or back from the last.
fn place(word: &str, count: usize) -> Option<usize> {
    let number = word.split('/').next()?;
    let place = match number.strip_prefix('-') {
        Some(back) => count.checked_sub(back.parse().ok()?)?,
        None => number.parse::<usize>().ok()?.checked_sub(1)?,
    };
    (place < count).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_split_and_corners_are_counted_from_either_end() {
        let text = "# a square\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -4 -3 -2\n";
        let mesh = read(text).unwrap();
        assert_eq!(mesh.triangles(), 3);
        assert_eq!(mesh.parts[0].triangles[0], mesh.parts[0].triangles[2]);
        assert!(read("v 0 0 0\nf 1 2 3\n").unwrap_err().contains("not there"));
        assert!(read("v 0 0\n").unwrap_err().contains("not a corner"));
    }
}
