//! Kinds by name: what files may call for, what each takes, and how one is made of it.
//!
//! A [`Kind`] stands beside the code of what it makes; the registries ([`curves`](crate::task::CURVES),
//! [time laws](crate::task::TIME_LAWS), [tasks](crate::task::TASKS), [laws](crate::law::LAWS),
//! [criteria](crate::law::CRITERIA)) list them, and whatever reads, checks, lists or tests kinds walks those.

mod by_joint;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod kind;
mod parameter;
mod parameters;
mod real;
mod registry;
mod value;

pub use by_joint::ByJoint;
pub use kind::{DrawParameters, Kind};
pub use parameter::{Form, Parameter, WrongForm};
pub use parameters::Parameters;
pub use real::Real;
pub use registry::Registry;
pub use value::Value;
