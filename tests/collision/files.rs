//! Files of capsules and SRDFs: what is wrong is said with its place.

use kinstep::collision::{CollisionError, CollisionModel};
use kinstep::robot::{Srdf, embedded};

/// Everything that is said of a file of capsules.
fn said(text: &str) -> Vec<String> {
    let robot = embedded::get("planar4").unwrap();
    match CollisionModel::from_toml(&robot, text) {
        Err(CollisionError::Text(found)) => found.iter().map(ToString::to_string).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_file_of_capsules_is_told_everything_at_once() {
    let found = said(
        "[[capsule]]\nlink = \"lnik1\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradius = -0.1\n\n\
         [[sphere]]\nlink = \"link2\"\ncentre = [0, 0]\nradius = 0.1\n\n\
         [[allowed]]\nlinks = [\"link1\", \"link1\"]\n",
    );
    let starts = [
        "2:8: error: the robot has no link `lnik1`; did you mean `link1`",
        "5:10: error: `radius` is -0.1: a radius is a length [m], zero or more",
        "7:1: error: a sphere needs `center`: it has `link`, `center` and `radius`",
        "9:1: error: a sphere has no key `centre`; did you mean `center`?",
        "13:9: error: `links` names `link1` twice",
    ];
    assert_eq!(found.len(), starts.len(), "{found:#?}");
    for (found, start) in found.iter().zip(starts) {
        assert!(found.starts_with(start), "{found}\n{start}");
    }
}

#[test]
fn what_is_no_file_of_capsules_is_refused() {
    assert!(said("")[0].contains("write [[capsule]] with link, from, to and radius"));
    assert!(said("[capsule]\nlink = \"link1\"\n")[0].contains("each begun by a line [[capsule]]"));
    assert!(said("[[capsules]]\n")[0].contains("did you mean `capsule`?"));
    assert!(
        said("[[sphere]]\nlink = \"link1\"\ncenter = [0, nan, 0]\nradius = 1\n")[0].contains("not a number")
    );
    assert!(said("[[allowed]]\nlinks = \"link1\"\n")[0].contains("the names of two links"));
    assert!(said("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n")[0].contains("the key `link` is missing"));
    let robot = embedded::get("planar4").unwrap();
    let lost = CollisionModel::from_file(&robot, "no/such.toml".as_ref()).unwrap_err().to_string();
    assert!(lost.starts_with("can not read no/such.toml: there is no such file"), "{lost}");
    let none = CollisionModel::embedded("baxter").unwrap_err().to_string();
    assert!(none.contains("has no capsules; give it some"), "{none}");
}

fn srdf(inside: &str) -> Result<Srdf, String> {
    let panda = embedded::get("panda").unwrap();
    let text = format!("<?xml version=\"1.0\"?>\n<robot name=\"panda\">\n{inside}\n</robot>\n");
    Srdf::from_text(&text, &panda).map_err(|error| error.to_string())
}

#[test]
fn pairs_of_an_srdf_are_left_out() {
    let read = srdf(
        r#"<group name="arm"><chain base_link="panda_link0" tip_link="panda_link8"/></group>
           <disable_default_collisions link="panda_hand"/>
           <enable_collisions link1="panda_link1" link2="panda_hand"/>
           <disable_collisions link1="panda_link5" link2="panda_link7" reason="Default"/>"#,
    )
    .unwrap();
    assert!(read.diagnostics.is_empty(), "{:?}", read.diagnostics);
    let panda = embedded::get("panda").unwrap();
    let bare = CollisionModel::new(&panda);
    assert!(bare.checks("panda_link5", "panda_link7") && bare.checks("panda_link2", "panda_hand"));
    let model = bare.with_srdf(&read.pairs).unwrap();
    assert!(!model.checks("panda_link7", "panda_link5") && !model.checks("panda_link2", "panda_hand"));
    assert!(model.checks("panda_link1", "panda_hand") && model.checks("panda_link1", "panda_link5"));
}

#[test]
fn what_is_wrong_in_an_srdf_is_said_with_its_place() {
    let pair = |attributes: &str| srdf(&format!("<disable_collisions {attributes}/>")).unwrap_err();
    let unknown = pair(r#"link1="panda_link1" link2="panda_lnik3""#);
    assert!(
        unknown.starts_with("line 3, column 41: the robot has no link `panda_lnik3`; did you mean"),
        "{unknown}"
    );
    assert!(pair(r#"link1="panda_link1""#).contains("`<disable_collisions>` has no `link2`"));
    let slip = pair(r#"link1="panda_link1" lnik2="panda_link3""#);
    assert!(slip.contains("did you mean `link2`?"), "{slip}");
    assert!(pair(r#"link1="panda_link1" link2="panda_link1""#).contains("names `panda_link1` twice"));
    let slip = srdf(r#"<disable_colisions link1="a" link2="b"/>"#).unwrap();
    assert!(
        slip.diagnostics[0].message.contains("did you mean `<disable_collisions>`")
            || slip.diagnostics[0].message.contains("`disable_collisions`")
    );
    let panda = embedded::get("panda").unwrap();
    let whole = |text: &str| Srdf::from_text(text, &panda).unwrap_err().to_string();
    assert!(whole("").contains("the file is empty"));
    assert!(whole(embedded::text("panda").unwrap()).contains("this is a URDF"));
    assert!(whole("<robot name=\"panda\"><disable_collisions").contains("the file ends inside"));
    assert!(whole("<!DOCTYPE a><robot/>").contains("DTD"));
    assert!(whole("<sdf/>").contains("an SRDF begins with"));
}
