//! COLLADA: scenes of geometries. Triangles, lists of polygons and polygons are read, with their diffuse colours; bones,
//! textures and curves are not. Lengths are scaled to metres; the up axis is left alone, as RViz leaves it.

use std::collections::HashMap;

use nalgebra::{Matrix4, Point3, Rotation3, Translation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use super::Colour;
use super::mesh::{MOST_TRIANGLES, Mesh, MeshPart, Triangle, fan};

/// Deepest nesting of nodes that is followed.
const MOST_DEPTH: usize = 64;
/// Most nodes that are placed: one may name others over and over.
const MOST_NODES: usize = 10_000;
/// Most elements that are read.
const MOST_ELEMENTS: u32 = 1_000_000;

pub(super) fn read(text: &str) -> Result<Mesh, String> {
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: MOST_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| error.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("its root is <{}>, not <COLLADA>", root.tag_name().name()));
    }
    let mut scene = Scene { by_id: ids(&document), mesh: Mesh::default(), triangles: 0, nodes: 0 };
    let metres = Matrix4::new_scaling(metres(root));
    let visual = root.descendants().find(|node| node.has_tag_name_of("visual_scene"));
    match visual {
        Some(visual) => scene.nodes(visual, &metres, 0),
        None => children(root, "library_geometries")
            .flat_map(|library| children(library, "geometry"))
            .for_each(|geometry| scene.geometry(geometry, &metres, &HashMap::new())),
    }
    Ok(scene.mesh)
}

/// Names without their namespace: writers differ in which one they declare.
trait LocalName {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl LocalName for Node<'_, '_> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.has_tag_name_of(name))
}

fn ids<'a, 'i>(document: &'a Document<'i>) -> HashMap<&'a str, Node<'a, 'i>> {
    document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect()
}

/// How long the file's unit is \[m\].
fn metres(root: Node<'_, '_>) -> f32 {
    let unit = children(root, "asset").flat_map(|asset| children(asset, "unit")).next();
    let length = unit.and_then(|unit| unit.attribute("meter")?.trim().parse().ok()).unwrap_or(1.0_f32);
    if length.is_finite() && length > 0.0 { length } else { 1.0 }
}

fn numbers<T: std::str::FromStr>(node: Node<'_, '_>) -> Vec<T> {
    let texts = node.children().filter_map(|child| if child.is_text() { child.text() } else { None });
    texts.flat_map(str::split_whitespace).filter_map(|number| number.parse().ok()).collect()
}

/// What each material of an instance is called in its geometry, and the material's id.
type Bound<'a> = HashMap<&'a str, &'a str>;

struct Scene<'a, 'i> {
    by_id: HashMap<&'a str, Node<'a, 'i>>,
    mesh: Mesh,
    triangles: usize,
    nodes: usize,
}

impl<'a, 'i> Scene<'a, 'i> {
    fn named(&self, reference: Option<&str>) -> Option<Node<'a, 'i>> {
        self.by_id.get(reference?.strip_prefix('#')?).copied()
    }

    fn nodes(&mut self, parent: Node<'a, 'i>, above: &Matrix4<f32>, depth: usize) {
        if depth > MOST_DEPTH {
            return;
        }
        for node in children(parent, "node") {
            self.node(node, above, depth);
        }
    }

    fn node(&mut self, node: Node<'a, 'i>, above: &Matrix4<f32>, depth: usize) {
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return;
        }
        let placed = node.children().filter_map(transform).fold(*above, |pose, next| pose * next);
        for instance in children(node, "instance_geometry") {
            if let Some(geometry) = self.named(instance.attribute("url")) {
                let bound = instance.descendants().filter(|n| n.has_tag_name_of("instance_material"));
                let bound = bound.filter_map(|n| Some((n.attribute("symbol")?, n.attribute("target")?)));
                self.geometry(geometry, &placed, &bound.collect());
            }
        }
        for instance in children(node, "instance_node") {
            if let Some(other) = self.named(instance.attribute("url")).filter(|_| depth < MOST_DEPTH) {
                self.node(other, &placed, depth + 1);
            }
        }
        self.nodes(node, &placed, depth + 1);
    }

    fn geometry(&mut self, geometry: Node<'a, 'i>, placed: &Matrix4<f32>, bound: &Bound<'a>) {
        for mesh in children(geometry, "mesh") {
            for faces in mesh.children() {
                let Some(triangles) = self.faces(faces) else { continue };
                let room = MOST_TRIANGLES.saturating_sub(self.triangles);
                let moved = triangles.into_iter().take(room).map(|triangle| {
                    triangle.map(|corner| placed.transform_point(&Point3::from(corner)).coords.into())
                });
                let part = MeshPart { colour: self.colour(faces, bound), triangles: moved.collect() };
                self.triangles += part.triangles.len();
                self.mesh.parts.push(part);
            }
        }
    }

    /// The triangles of `<triangles>`, `<polylist>` or `<polygons>`; `None` of anything else.
    fn faces(&self, faces: Node<'a, 'i>) -> Option<Vec<Triangle>> {
        let kind = faces.tag_name().name();
        if !matches!(kind, "triangles" | "polylist" | "polygons") {
            return None;
        }
        let offset = |input: Node<'_, '_>| {
            input.attribute("offset").and_then(|offset| offset.parse::<usize>().ok()).unwrap_or(0)
        };
        let stride = children(faces, "input").map(offset).max()?.checked_add(1).filter(|&s| s < 64)?;
        let vertex = children(faces, "input").find(|input| input.attribute("semantic") == Some("VERTEX"))?;
        let corners = self.positions(vertex)?;
        let first = offset(vertex);
        let mut triangles = Vec::new();
        for list in children(faces, "p") {
            let places: Vec<usize> = numbers(list);
            let places = places.chunks_exact(stride).map(|corner| corner[first]);
            // A face that names a corner that is not there is left out by leaving the whole list out.
            let corners: Vec<[f32; 3]> =
                places.map(|place| corners.get(place).copied()).collect::<Option<_>>()?;
            match kind {
                "triangles" => triangles.extend(corners.as_chunks::<3>().0),
                "polygons" => triangles.extend(fan(&corners)),
                _ => {
                    let mut rest = corners.as_slice();
                    for count in children(faces, "vcount").flat_map(numbers::<usize>) {
                        let (face, others) = rest.split_at_checked(count)?;
                        triangles.extend(fan(face));
                        rest = others;
                    }
                }
            }
        }
        Some(triangles)
    }

    /// The corners that an input of vertices refers to.
    fn positions(&self, input: Node<'a, 'i>) -> Option<Vec<[f32; 3]>> {
        let vertices = self.named(input.attribute("source"))?;
        let position = children(vertices, "input").find(|i| i.attribute("semantic") == Some("POSITION"))?;
        let array = children(self.named(position.attribute("source"))?, "float_array").next()?;
        Some(numbers::<f32>(array).as_chunks::<3>().0.to_vec())
    }

    fn colour(&self, faces: Node<'a, 'i>, bound: &Bound<'a>) -> Option<Colour> {
        let symbol = faces.attribute("material")?;
        let material = match bound.get(symbol) {
            Some(target) => self.named(Some(target))?,
            None => self.by_id.get(symbol).copied()?,
        };
        let effect = self.named(children(material, "instance_effect").next()?.attribute("url"))?;
        let diffuse = effect.descendants().find(|node| node.has_tag_name_of("diffuse"))?;
        let rgba: Vec<f64> = numbers(children(diffuse, "color").next()?);
        let rgba: [f64; 4] = rgba.get(..4)?.try_into().ok()?;
        // Opacity has two opposite meanings in files: everything is opaque.
        let [r, g, b, _] = rgba.map(|part| part.clamp(0.0, 1.0));
        Some([r, g, b, 1.0])
    }
}

/// What an element does to the frames below it; `None` where it is no transform.
fn transform(node: Node<'_, '_>) -> Option<Matrix4<f32>> {
    let of = || numbers::<f32>(node);
    match node.tag_name().name() {
        "matrix" => Some(Matrix4::from_row_slice(of().get(..16)?)),
        "translate" => Some(Translation3::from(Vector3::from_row_slice(of().get(..3)?)).to_homogeneous()),
        "scale" => Some(Matrix4::new_nonuniform_scaling(&Vector3::from_row_slice(of().get(..3)?))),
        "rotate" => {
            let [x, y, z, degrees] = <[f32; 4]>::try_from(of().get(..4)?).ok()?;
            let axis = Unit::try_new(Vector3::new(x, y, z), 1e-9)?;
            Some(Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset><unit meter="0.01"/></asset>
      <library_effects><effect id="e"><profile_COMMON><technique><phong><diffuse><color>1 0.5 0 0.3</color></diffuse>
      </phong></technique></profile_COMMON></effect></library_effects>
      <library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
      <library_geometries><geometry id="g"><mesh>
        <source id="s"><float_array count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array></source>
        <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
        <polylist count="1" material="paint"><input semantic="VERTEX" source="#v" offset="0"/>
          <input semantic="NORMAL" source="#n" offset="1"/><vcount>4</vcount><p>0 9 1 9 2 9 3 9</p></polylist>
      </mesh></geometry></library_geometries>
      <library_visual_scenes><visual_scene><node><translate>0 0 100</translate><node><rotate>0 0 1 90</rotate>
        <instance_geometry url="#g"><bind_material><technique_common>
        <instance_material symbol="paint" target="#m"/></technique_common></bind_material></instance_geometry>
      </node></node></visual_scene></library_visual_scenes></COLLADA>"##;

    #[test]
    fn scenes_place_and_colour_their_geometries() {
        let mesh = read(SQUARE).unwrap();
        let [part] = mesh.parts.as_slice() else { panic!("{mesh:?}") };
        assert_eq!(part.colour, Some([1.0, 0.5, 0.0, 1.0]));
        let expected = [[0.0, 0.0, 1.0], [0.0, 0.01, 1.0], [-0.01, 0.01, 1.0]];
        for (corner, expected) in part.triangles[0].iter().zip(expected) {
            assert!(corner.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{corner:?}");
        }
        assert_eq!(part.triangles.len(), 2);
    }

    #[test]
    fn faces_without_their_corners_are_left_out() {
        let broken = SQUARE.replace("3 9</p>", "7 9</p>");
        assert_eq!(read(&broken).unwrap().triangles(), 0);
        assert!(read("<robot/>").unwrap_err().contains("<robot>"));
        assert!(read("<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA>&b;</COLLADA>").is_err());
    }

    #[test]
    fn nodes_that_hold_themselves_come_to_an_end() {
        let text = r##"<COLLADA><library_visual_scenes><visual_scene><node id="a"><instance_node url="#a"/></node>
          </visual_scene></library_visual_scenes></COLLADA>"##;
        assert_eq!(read(text).unwrap().triangles(), 0);
        let often = text.replace("<instance_node url=\"#a\"/>", &"<instance_node url=\"#a\"/>".repeat(50));
        assert_eq!(read(&often).unwrap().triangles(), 0);
    }
}
