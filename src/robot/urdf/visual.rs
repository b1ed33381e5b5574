//! `<visual>` and `<collision>`: the shapes of links. Nothing here is ever an error: what can not be read is left out, with a note.

use std::collections::HashMap;

use nalgebra::{IsometryMatrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node};

use super::number::{finite, vector};
use super::{MAX_BYTES, element, outline};
use crate::robot::names::quote;
use crate::robot::visual::{Colour, Shape, Visual, Visuals};

/// Most shapes that are read.
const MOST: usize = 20_000;

impl Visuals {
    /// Returns the looks that a URDF text gives its links; what can not be read is left out, with a note.
    ///
    /// ```
    /// use kinstep::robot::{Shape, Visuals};
    /// let looks = Visuals::from_urdf(
    ///     r#"<robot name="ball"> <link name="ball">
    ///          <visual> <geometry> <sphere radius="0.1"/> </geometry> </visual>
    ///          <visual> <geometry> <sphere radius="-1"/> </geometry> </visual>
    ///        </link> </robot>"#,
    /// );
    /// assert_eq!(looks.visuals[0].shape, Shape::Sphere { radius: 0.1 });
    /// assert_eq!(looks.notes, ["link `ball`: a shape whose `radius` is -1"]);
    /// ```
    pub fn from_urdf(text: &str) -> Self {
        read(text, "visual")
    }

    /// Returns the shapes that a URDF text gives its links for collision checks (`<collision>`), without colours; what can not
    /// be read is left out, with a note.
    ///
    /// ```
    /// use kinstep::robot::{Shape, Visuals};
    /// let shapes = Visuals::collision_from_urdf(
    ///     r#"<robot name="ball"> <link name="ball">
    ///          <collision> <geometry> <sphere radius="0.1"/> </geometry> </collision>
    ///        </link> </robot>"#,
    /// );
    /// assert_eq!(shapes.visuals[0].shape, Shape::Sphere { radius: 0.1 });
    /// ```
    pub fn collision_from_urdf(text: &str) -> Self {
        read(text, "collision")
    }
}

/// Reads the shapes of all links that stand in elements of that name.
fn read(text: &str, what: &str) -> Visuals {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut looks = Visuals::default();
    if text.len() > MAX_BYTES {
        looks.notes.push("the text is too long to look for shapes in".to_owned());
        return looks;
    }
    let outline = outline::outline(text);
    if outline.stop.is_some() {
        looks.notes.push("the text is not URDF: no shapes were looked for".to_owned());
        return looks;
    }
    match Document::parse(&outline.mended(text)) {
        Ok(document) => read_links(document.root_element(), what, &mut looks),
        Err(error) => looks.notes.push(format!("the text is not well-formed: {error}")),
    }
    looks
}

fn read_links(root: Node<'_, '_>, what: &str, looks: &mut Visuals) {
    let palette = palette(root);
    for link in element::children_named(root, "link") {
        let Some(name) = link.attribute("name") else { continue };
        for visual in element::children_named(link, what) {
            if looks.visuals.len() == MOST {
                looks.notes.push(format!("there are more than {MOST} shapes; the others are left out"));
                return;
            }
            match read_visual(name, visual, &palette) {
                Ok(visual) => looks.visuals.push(visual),
                Err(reason) => looks.notes.push(format!("link {}: {reason}", quote(name))),
            }
        }
    }
}

/// The colours that stand at the top of the file, by name.
fn palette<'a>(root: Node<'a, '_>) -> HashMap<&'a str, Colour> {
    let named = |material: Node<'a, '_>| Some((material.attribute("name")?, colour_of(material)?));
    element::children_named(root, "material").filter_map(named).collect()
}

fn colour_of(material: Node<'_, '_>) -> Option<Colour> {
    let colour = element::children_named(material, "color").next()?;
    let rgba: [f64; 4] = vector(colour.attribute("rgba")?).ok()?;
    Some(rgba.map(|part| part.clamp(0.0, 1.0)))
}

fn read_visual(link: &str, visual: Node<'_, '_>, palette: &HashMap<&str, Colour>) -> Result<Visual, String> {
    let geometry =
        element::children_named(visual, "geometry").next().ok_or("a shape without `<geometry>`")?;
    let shape = element::children(geometry).next().ok_or("an empty `<geometry>`")?;
    let material = element::children_named(visual, "material").next();
    let named = |material: Node<'_, '_>| palette.get(material.attribute("name")?).copied();
    Ok(Visual {
        link: link.to_owned(),
        origin: origin(element::children_named(visual, "origin").next())?,
        shape: read_shape(shape)?,
        colour: material.and_then(|material| colour_of(material).or_else(|| named(material))),
    })
}

fn origin(origin: Option<Node<'_, '_>>) -> Result<IsometryMatrix3<f64>, String> {
    let Some(origin) = origin else { return Ok(IsometryMatrix3::identity()) };
    let three = |name: &str| origin.attribute(name).map_or(Ok([0.0; 3]), vector::<3>);
    let rotation = if let Some(text) = origin.attribute("quat_xyzw") {
        let [x, y, z, w] = vector::<4>(text)?;
        let length = Quaternion::new(w, x, y, z);
        let unit = UnitQuaternion::try_new(length, 1e-9).ok_or("a quaternion of length zero")?;
        unit.to_rotation_matrix()
    } else {
        let [roll, pitch, yaw] = three("rpy")?;
        Rotation3::from_euler_angles(roll, pitch, yaw)
    };
    Ok(IsometryMatrix3::from_parts(Translation3::from(Vector3::from(three("xyz")?)), rotation))
}

fn read_shape(shape: Node<'_, '_>) -> Result<Shape, String> {
    let given = |name: &str| shape.attribute(name).ok_or_else(|| format!("a shape without `{name}`"));
    let size = |name: &str| positive(finite(given(name)?)?, name);
    match shape.tag_name().name() {
        "box" => {
            let sides: [f64; 3] = vector(given("size")?)?;
            for side in sides {
                positive(side, "size")?;
            }
            Ok(Shape::Box { sides })
        }
        "cylinder" => Ok(Shape::Cylinder { radius: size("radius")?, length: size("length")? }),
        "capsule" => Ok(Shape::Capsule { radius: size("radius")?, length: size("length")? }),
        "sphere" => Ok(Shape::Sphere { radius: size("radius")? }),
        "mesh" => Ok(Shape::Mesh {
            reference: given("filename")?.trim().to_owned(),
            scale: shape.attribute("scale").map_or(Ok([1.0; 3]), vector)?,
        }),
        other => Err(format!("the unknown shape {}", quote(other))),
    }
}

fn positive(value: f64, name: &str) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("a shape whose `{name}` is {value}")) }
}
