//! What a table that names a kind says, by the registry of its kinds.

use super::check::{believable, refuse, require};
use super::error::{ErrorKind, ScenarioError, not_one_of, suggestion};
use super::key_path::KeyPath;
use kinstep::kind::{Form, Kind, Parameter, Parameters, Registry, Value};

/// A refusal, and whether it is of a key rather than of what stands there.
pub(super) struct Misread {
    pub(super) error: ScenarioError,
    pub(super) is_of_key: bool,
}

/// A table of a scenario that names a kind: where it stands, and which keys it has beside the parameters of kinds.
pub(super) struct KindTable<'a, Make> {
    pub(super) at: &'a KeyPath,
    pub(super) kinds: &'a Registry<Make>,
    pub(super) kind: &'a str,
    /// The keys that the reader knows before those of the kinds, and after them.
    pub(super) keys: [&'a [&'a str]; 2],
}

impl<'a, Make: Copy> KindTable<'a, Make> {
    /// The kind that the table names.
    pub(super) fn named(&self) -> Result<&'a Kind<Make>, ScenarioError> {
        named(self.kinds, &self.at.key("kind"), self.kind)
    }

    /// Reads what was written by the forms of the parameters, and puts it into their order.
    pub(super) fn read(&self, parameters: &mut Parameters) -> Result<(), Misread> {
        let of_value = |error| Misread { error, is_of_key: false };
        let kind = self.named().map_err(of_value)?;
        let written: Vec<(String, Value)> =
            parameters.iter().map(|(name, value)| (name.to_owned(), value.clone())).collect();
        for (name, value) in written {
            let parameter = self.parameter(kind, &name)?;
            let read = parameter.form.read(&value).map_err(|wrong| {
                let at = self.at.key(&name);
                let at = wrong.index.map_or(at.clone(), |index| at.index(index));
                of_value(refuse(&at, wrong.problem))
            })?;
            parameters.set(&name, read);
        }
        parameters.sort_like(kind.parameters);
        Ok(())
    }

    /// The parameter of that name: of the kind itself, or of another that is told apart later.
    fn parameter(&self, kind: &Kind<Make>, name: &str) -> Result<&'static Parameter, Misread> {
        let all = self.kinds.parameters();
        let known = kind.parameter(name).or_else(|| all.iter().copied().find(|own| own.name == name));
        known.ok_or_else(|| {
            let own = all.iter().map(|parameter| parameter.name);
            let keys = self.keys[0].iter().copied().chain(own).chain(self.keys[1].iter().copied());
            let problem = format!("there is no such key; {}", suggestion(name, keys));
            Misread { error: refuse(&self.at.key(name), problem), is_of_key: true }
        })
    }

    /// Checks the parameters of a kind, which takes other keys before and after them too, as far as they are `given`.
    pub(super) fn check(
        &self,
        parameters: &Parameters,
        (before, after, given): (&[&str], &[&str], &[&str]),
        is_planar: bool,
    ) -> Result<(), ScenarioError> {
        let kind = self.named()?;
        let own = kind.parameters.iter().map(|parameter| parameter.name);
        let known: Vec<&str> = before.iter().copied().chain(own).chain(after.iter().copied()).collect();
        for name in parameters.iter().map(|(name, _)| name).chain(given.iter().copied()) {
            require(known.contains(&name), &self.at.key(name), || {
                let has = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                format!("a {} has no such parameter; it has {has}", kind.name)
            })?;
        }
        for needed in kind.parameters.iter().filter(|parameter| parameter.is_required) {
            require(parameters.get(needed.name).is_some(), &self.at.key(needed.name), || {
                format!("a {} needs this", kind.name)
            })?;
        }
        for (name, value) in parameters.iter() {
            believable_numbers(&self.at.key(name), value)?;
        }
        for (name, value) in parameters.iter() {
            let objection = kind.parameter(name).and_then(|parameter| parameter.objection(value));
            objection.map_or(Ok(()), |problem| Err(refuse(&self.at.key(name), problem)))?;
        }
        let objection = kind.objection.and_then(|objection| objection(parameters));
        objection.map_or(Ok(()), |problem| Err(refuse(self.at, problem)))?;
        for parameter in kind.parameters.iter().filter(|parameter| parameter.form == Form::Point) {
            let point = parameters.get(parameter.name).and_then(Value::list);
            let at = self.at.key(parameter.name);
            point.map_or(Ok(()), |point| check_length(&at, point.len(), is_planar))?;
        }
        Ok(())
    }
}

/// The kind of a name that stands at `at`.
pub(super) fn named<'a, Make: Copy>(
    kinds: &'a Registry<Make>,
    at: &KeyPath,
    name: &str,
) -> Result<&'a Kind<Make>, ScenarioError> {
    kinds.get(name).ok_or_else(|| {
        let problem = format!("\"{name}\" is {}", not_one_of(name, &kinds.names()));
        ScenarioError::at(ErrorKind::Scenario, at, problem)
    })
}

fn believable_numbers(at: &KeyPath, value: &Value) -> Result<(), ScenarioError> {
    let Value::List(values) = value else { return believable_number(at, value) };
    for (index, value) in values.iter().enumerate() {
        let at = at.index(index);
        let numbers = value.list().unwrap_or(std::slice::from_ref(value));
        numbers.iter().try_for_each(|number| believable_number(&at, number))?;
    }
    Ok(())
}

fn believable_number(at: &KeyPath, value: &Value) -> Result<(), ScenarioError> {
    match value {
        Value::Number(number) => believable(at, number),
        _ => Ok(()),
    }
}

/// Points have x, y and z; in the plane the z may be left out.
pub(super) fn check_length(at: &KeyPath, length: usize, is_planar: bool) -> Result<(), ScenarioError> {
    require(length == 3 || (is_planar && length == 2), at, || {
        format!("expected {} numbers, got {length}", if is_planar { "2 or 3" } else { "3" })
    })
}
