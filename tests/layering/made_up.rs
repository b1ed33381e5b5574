//! What the rules find in small sources that are made up to break them.

use std::collections::BTreeSet;

use super::module::{Import, Module};
use super::rules;
use super::sources::Sources;
use super::table::{self, Room};

const ROOT: (&str, &str) = ("Cargo.toml", "[package]\nname = \"kinstep\"\n[[bench]]\nname = \"steps\"\n");

/// Sources of these files beside the root's manifest, and the table with these lines.
fn made_up(files: &[(&str, &str)], rows: &[&str]) -> (Sources, Vec<Room>) {
    let design =
        format!("# Design\n| `no` | room | `yet` |\n## Rooms\n\n{}\n## Why\n| `x` |", rows.join("\n"));
    let table = table::rooms(&design);
    let names: BTreeSet<String> = table.iter().map(|room| room.name.clone()).collect();
    let files: Vec<(String, String)> =
        [ROOT].iter().chain(files).map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    (Sources::new(&files, &names), table)
}

fn broken(files: &[(&str, &str)], rows: &[&str]) -> Vec<String> {
    let (sources, table) = made_up(files, rows);
    rules::against_table(&sources, &table)
}

fn circles(files: &[(&str, &str)]) -> Vec<String> {
    rules::circles_of_files(&made_up(files, &[]).0, "robot")
}

const NOTHING: [&str; 0] = [];

const LOW: (&str, &str) = ("src/low/mod.rs", "pub struct Low;\npub fn f(g: usize) {}");
const ROW_OF_LOW: &str = "| `low` | what is low, with a `word` between | nothing here |";

#[test]
fn comments_strings_and_restrictions_are_no_imports() {
    let module = Module::read(
        r##"
        //! use crate::a::A;
        /* use crate::b::B; /* use crate::c::C; */ use crate::d::D; */
        /// See [`crate::e::E`].
        const TEXT: &str = "use crate::f::F; \" crate::g::G";
        const RAW: &[u8] = br#"crate::h::H " crate::i::I"#;
        pub(in crate::j) fn quote<'a>(c: char, name: &'a str) -> bool { c == '"' || c == '\'' }
        #[error("crate::k::K {}", names::quote(.name))]
        pub(crate) use crate::l::{self, L, deep::{M as N, *}};
        fn size() -> usize { crate::o::O.len() + Vec::<usize>::new().len() }
        "##,
    );
    let import = |path: &str, name: &str| Import {
        path: path.split("::").map(str::to_owned).collect(),
        name: name.to_owned(),
        is_passed_on: true,
    };
    let expected = [
        import("crate::l", "l"),
        import("crate::l::L", "L"),
        import("crate::l::deep::M", "N"),
        import("crate::l::deep", "*"),
    ];
    assert_eq!(module.imports, expected);
    let paths: Vec<String> = module.paths.iter().map(|path| path.join("::")).collect();
    assert_eq!(paths, ["crate::o::O", "names::quote"]);
    assert_eq!(module.definitions, ["RAW", "TEXT", "quote", "size"].map(str::to_owned).into());
}

#[test]
fn a_table_that_is_right_is_silent() {
    let high = (
        "src/high.rs",
        "use crate::low::Low;\npub fn g() {}\n#[cfg(test)]\nmod tests { use crate::top::Top; }",
    );
    let top = ("src/top/mod.rs", "mod own;");
    let own = ("src/top/own.rs", "fn f() { crate::low::f(super::super::high::g()) }");
    let root = ("src/lib.rs", "pub mod low; pub mod high; pub mod top; pub use nalgebra;");
    let rows = [ROW_OF_LOW, "| `high` | what is high | `low` |", "| `top` | all | `low`, `high` |"];
    let broken = broken(&[LOW, high, top, own, root], &rows);
    assert_eq!(broken, NOTHING);
}

#[test]
fn an_import_that_the_table_lacks_is_told_with_its_names() {
    let high = ("src/high/mod.rs", "use crate::low::{Low, f};");
    let broken = broken(&[LOW, high], &[ROW_OF_LOW, "| `high` | what is high | nothing |"]);
    assert_eq!(broken, ["`high` imports `Low`, `f` from `low`, which the table does not say"]);
}

#[test]
fn a_superfluous_import_or_room_of_the_table_is_told() {
    let high = ("src/high/mod.rs", "//! Unlike [`crate::low::Low`].\npub struct High;");
    let rows = [ROW_OF_LOW, "| `high` | what is high | `low` |", "| `gone` | what was | |"];
    let expected = [
        "the table has a room `gone` that is not there",
        "`high` imports nothing from `low`, though the table says so",
    ];
    assert_eq!(broken(&[LOW, high], &rows), expected);
    assert_eq!(broken(&[LOW, high], &[ROW_OF_LOW]), ["the table has no room `high`"]);
}

#[test]
fn an_import_downwards_is_told_even_if_the_table_says_so() {
    let low = ("src/low/mod.rs", "fn f() { crate::high::g() }");
    let high = ("src/high/mod.rs", "pub fn g() {}");
    let rows = ["| `low` | what is low | `high` |", "| `high` | what is high | nothing |"];
    assert_eq!(
        broken(&[low, high], &rows),
        ["`low` imports from `high`, which does not stand above it in the table"]
    );
}

#[test]
fn a_path_to_nothing_is_told() {
    let high = ("src/high/mod.rs", "use crate::low::Lost;");
    let low = [("src/low/mod.rs", "mod own; pub use own::Low;"), ("src/low/own.rs", "pub struct Low;")];
    let rows = [ROW_OF_LOW, "| `high` | what is high | nothing |"];
    assert_eq!(
        broken(&[high, low[0], low[1]], &rows),
        ["src/high/mod.rs: nothing was found at `crate::low::Lost`"]
    );
}

#[test]
fn members_are_a_room_or_hold_several() {
    let files = [
        LOW,
        ("src/lib.rs", "pub mod low;"),
        ("crates/files/Cargo.toml", "[package]\nname = \"kinstep-files\"\n"),
        ("crates/files/src/lib.rs", "pub mod read;\npub mod write;"),
        ("crates/files/src/read/mod.rs", "pub struct Reader(kinstep::low::Low);"),
        ("crates/files/src/write.rs", "use crate::read;\npub enum Writer { Csv }"),
        ("crates/pages/Cargo.toml", "[package]\nname = \"kinstep-pages\"\n[lib]\nname = \"kinstep_pages\""),
        (
            "crates/pages/src/lib.rs",
            "mod deep;\nuse kinstep_files::write::Writer;\npub fn page() { Writer::Csv }",
        ),
        ("crates/pages/src/deep/mod.rs", "use crate::page;\nuse kinstep::low;"),
        ("crates/pages/src/main.rs", "use kinstep_files::read::Reader;"),
    ];
    let rows = [
        ROW_OF_LOW,
        "| `read` | reading | `low` |",
        "| `write` | writing | `read` |",
        "| `pages` | the whole member | `low` |",
    ];
    assert_eq!(
        broken(&files, &rows),
        ["`pages` imports `Writer` from `write`, which the table does not say"]
    );
}

#[test]
fn rooms_in_a_circle_are_told() {
    let low = ("src/low/mod.rs", "use crate::high::High; pub struct Low;");
    let high = ("src/high/mod.rs", "use crate::low::Low; pub struct High;");
    let circles = rules::circles_of_rooms(&made_up(&[low, high], &[]).0);
    assert_eq!(circles, ["a circle of 2:\n  high names `Low` of low\n  low names `High` of high"]);
}

#[test]
fn files_in_a_circle_are_told_with_what_makes_it() {
    let files = [
        ("src/robot/mod.rs", "mod model; mod path; mod tree;\npub use model::Robot;\npub use path::Path;"),
        ("src/robot/model.rs", "use super::tree::Rows;\npub struct Robot;"),
        ("src/robot/path.rs", "use super::{Robot, tree};\npub struct Path;"),
        ("src/robot/tree.rs", "use crate::robot::Path;\npub struct Rows;"),
    ];
    let expected = "a circle of 3:\
        \n  src/robot/model.rs names `Rows` of src/robot/tree.rs\
        \n  src/robot/tree.rs names `Path` of src/robot/path.rs\
        \n  src/robot/path.rs names `Robot` of src/robot/model.rs";
    assert_eq!(circles(&files)[0], expected);
}

#[test]
fn a_circle_is_seen_through_the_index_of_a_folder() {
    let files = [
        ("src/robot/mod.rs", "mod model; mod urdf;\npub use model::Robot;"),
        ("src/robot/model.rs", "use super::urdf;\npub struct Robot;\nfn f() { urdf::read() }"),
        ("src/robot/urdf/mod.rs", "mod read;\npub(super) use read::read;"),
        ("src/robot/urdf/read.rs", "use crate::robot::Robot;\npub(in crate::robot) fn read() -> Robot {}"),
    ];
    let expected = "a circle of 2:\
        \n  src/robot/model.rs names `read` of src/robot/urdf/read.rs\
        \n  src/robot/urdf/read.rs names `Robot` of src/robot/model.rs";
    assert_eq!(circles(&files), [expected]);
}

#[test]
fn an_index_is_in_no_circle_unless_it_has_code_of_its_own() {
    let child = ("src/robot/child.rs", "use super::Law;\npub struct Child;");
    let index = |code| [("src/robot/mod.rs", code), child];
    assert_eq!(circles(&index("mod child;\npub use child::Child;\npub trait Law {}")), NOTHING);
    let expected = "a circle of 2:\
        \n  src/robot/child.rs names `Law` of src/robot/mod.rs\
        \n  src/robot/mod.rs names `Child` of src/robot/child.rs";
    assert_eq!(
        circles(&index("mod child;\npub use child::Child;\npub trait Law { fn f(&self) -> Child; }")),
        [expected]
    );
}

#[test]
fn tests_are_in_no_circle() {
    let files = [
        ("src/robot/mod.rs", "mod a; mod b;\n#[cfg(test)]\nmod tests;"),
        ("src/robot/a.rs", "use super::b::B;\npub struct A;"),
        ("src/robot/b.rs", "pub struct B;\n#[cfg(test)]\nmod tests { use super::super::a::A; fn f() {} }"),
        ("src/robot/tests.rs", "use super::a::A;\npub struct T;"),
    ];
    assert_eq!(circles(&files), NOTHING);
    let live = ("src/robot/b.rs", "pub struct B;\nuse super::a::A;");
    assert_eq!(circles(&[files[0], files[1], live]).len(), 1);
}

#[test]
fn what_can_not_be_followed_is_told() {
    let files = [
        ("src/robot/mod.rs", "mod a; mod deep;"),
        ("src/robot/a.rs", "use super::deep::*;\npub struct A;\npub mod inside { pub struct A; }"),
        ("src/robot/deep/mod.rs", "mod b;\npub use b::B;"),
        ("src/robot/deep/b.rs", "pub struct B;"),
    ];
    let expected = [
        "src/robot/a.rs: the module `inside` has no file of its own",
        "src/robot/a.rs: `super::deep::*` does not say which files it names",
    ];
    assert_eq!(circles(&files), expected);
}
