//! Distances of random pairs as another library computes them.

use kinstep::collision::{Capsule, Cuboid, HalfSpace, Shape};
use kinstep::nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3};
use serde_json::Value;

/// To what the other library iterates [m].
const ITERATED: f64 = 1e-6;

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().unwrap())
}

fn capsule(value: &Value) -> Capsule {
    Capsule::new(vector(&value["from"]), vector(&value["to"]), value["radius"].as_f64().unwrap()).unwrap()
}

fn other(pair: &Value) -> Shape {
    match pair["other"].as_str().unwrap() {
        "capsule" => capsule(&pair["second"]).into(),
        "box" => {
            let value = &pair["box"];
            let rows = [0, 1, 2].map(|i| vector(&value["rotation"][i]).transpose());
            let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
            let pose = IsometryMatrix3::from_parts(vector(&value["center"]).into(), rotation);
            Cuboid::new(pose, vector(&value["size"])).unwrap().into()
        }
        _ => {
            let value = &pair["half_space"];
            HalfSpace::new(vector(&value["point"]), vector(&value["normal"])).unwrap().into()
        }
    }
}

#[test]
fn distances_and_normals_are_those_of_coal() {
    let file: Value = serde_json::from_str(include_str!("../data/collision_coal.json")).unwrap();
    let pairs = file["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 120);
    for (number, pair) in pairs.iter().enumerate() {
        let found = capsule(&pair["capsule"]).separation_from(&other(pair));
        let expected = pair["distance"].as_f64().unwrap();
        assert!((found.distance - expected).abs() < ITERATED, "{number}: {found:?}, {expected}\n{pair}");
        let normal = (found.normal - vector(&pair["normal"])).norm();
        assert!(normal < 1e-3, "{number}: {found:?}, {normal:e}\n{pair}");
    }
}
