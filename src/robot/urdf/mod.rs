//! Reading URDF: a strict pass with places over the XML, then urdf-rs for the values of the sound joints.
//!
//! urdf-rs alone takes most defects in silence (a missing `<limit>` reads as 0 to 0, unreadable tokens vanish,
//! loops and second parents pass). So the text is first looked over as markup ([`outline`]), parsed without DTD,
//! and read element by element with every finding kept; what is sound is handed to urdf-rs ([`values`]), and the
//! joints are joined to a tree ([`graph`]).

mod caps;
mod document;
mod element;
mod encoding;
mod error;
mod graph;
mod joint;
mod limit;
mod link;
mod mimic;
mod number;
mod options;
mod outline;
mod raw_joint;
mod read;
mod reader;
mod srdf;
mod values;
mod version;
mod visual;

pub use caps::{MAX_BYTES, MAX_DEPTH, MAX_JOINTS};
pub use error::UrdfError;
pub use options::UrdfOptions;
pub use srdf::{DisabledPair, Srdf};
