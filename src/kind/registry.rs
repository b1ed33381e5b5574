use super::{Kind, Parameter};

/// Kinds by their names, in the order of their rows: the built-in ones, then those that were added.
#[derive(Clone, Debug)]
pub struct Registry<Make>(Vec<Kind<Make>>);

impl<Make: Copy> Registry<Make> {
    /// The kinds of a list.
    pub fn of(kinds: &[Kind<Make>]) -> Self {
        Self(kinds.to_vec())
    }

    /// Adds a kind, in place of one of that name.
    pub fn add(&mut self, kind: Kind<Make>) {
        match self.0.iter_mut().find(|own| own.name == kind.name) {
            Some(own) => *own = kind,
            None => self.0.push(kind),
        }
    }

    /// The kind of that name.
    pub fn get(&self, name: &str) -> Option<&Kind<Make>> {
        self.0.iter().find(|kind| kind.name == name)
    }

    /// All kinds.
    pub fn iter(&self) -> impl Iterator<Item = &Kind<Make>> {
        self.0.iter()
    }

    /// The names of all kinds.
    pub fn names(&self) -> Vec<&'static str> {
        self.iter().map(|kind| kind.name).collect()
    }

    /// The parameters of all kinds, those of one name once.
    pub fn parameters(&self) -> Vec<&'static Parameter> {
        let mut all: Vec<&'static Parameter> = Vec::new();
        for parameter in self.iter().flat_map(|kind| kind.parameters) {
            if all.iter().all(|known| known.name != parameter.name) {
                all.push(parameter);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::super::Form;
    use super::*;

    const SIZE: Parameter = Parameter::required("size", Form::Number, "m", "How large it is.");

    #[test]
    fn a_kind_of_a_known_name_takes_the_place_of_the_one_before() {
        let mut kinds = Registry::of(&[Kind::new("a", "The first.", &[SIZE], 1)]);
        kinds.add(Kind::new("b", "The second.", &[SIZE], 2));
        kinds.add(Kind::new("a", "Another.", &[], 3));
        assert_eq!(kinds.names(), ["a", "b"]);
        assert_eq!(kinds.get("a").map(|kind| kind.make), Some(3));
        assert!(kinds.get("c").is_none());
        assert_eq!(kinds.parameters(), [&SIZE]);
    }
}
