use super::{Real, Value};

/// What is read as a number.
const NUMBER: &str = "a number or an expression in pi such as \"9*pi/10\"";

/// One parameter of a kind, as files write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// The key.
    pub name: &'static str,
    /// What may stand there.
    pub form: Form,
    /// The unit of its numbers (`m`, `rad`, `1/s`); empty where there is none.
    pub unit: &'static str,
    /// Whether the kind can not do without it.
    pub is_required: bool,
    /// What it means, and what it is unless given, in one sentence.
    pub description: &'static str,
}

impl Parameter {
    /// A parameter that has to be given.
    pub const fn required(
        name: &'static str,
        form: Form,
        unit: &'static str,
        description: &'static str,
    ) -> Self {
        Self { name, form, unit, is_required: true, description }
    }

    /// A parameter that may be left out.
    pub const fn optional(
        name: &'static str,
        form: Form,
        unit: &'static str,
        description: &'static str,
    ) -> Self {
        Self { is_required: false, ..Self::required(name, form, unit, description) }
    }

    /// What speaks against a value of the right form, as the end of a sentence that begins with the key.
    pub fn objection(&self, value: &Value) -> Option<String> {
        let (Form::Positive { noun } | Form::ByJoint { noun }) = self.form else { return None };
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let refuse = |number: &Real| {
            (number.value() <= 0.0).then(|| format!("{number}{unit} is not a {noun}; it is positive"))
        };
        match value {
            Value::Number(number) => refuse(number),
            Value::Table(entries) => entries.iter().find_map(|(name, value)| match value {
                Value::Number(number) => refuse(number).map(|problem| format!("joint `{name}`: {problem}")),
                _ => None,
            }),
            _ => None,
        }
    }
}

/// What may stand at the key of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A number.
    Number,
    /// A number above zero, and what it would be called in a refusal: `-1 m is not a radius; it is positive`.
    Positive {
        /// Its name with "a" before it.
        noun: &'static str,
    },
    /// Any number of numbers.
    Numbers,
    /// Two numbers.
    Pair,
    /// A point or a displacement in world axes: three numbers, or two where the task lies in the plane of x and y.
    Point,
    /// Any number of vectors of three numbers.
    Vectors,
    /// Any number of quaternions x, y, z, w.
    Quaternions,
    /// A word.
    Text,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// True or false.
    Flag,
    /// A number above zero for all joints, or a table of such numbers by the names of joints; what it would be called in a
    /// refusal.
    ByJoint {
        /// Its name with "a" before it.
        noun: &'static str,
    },
}

/// A value that is not of the form that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrongForm {
    /// Its place in the list, if it stands in one.
    pub index: Option<usize>,
    /// What is wrong, as the end of a sentence that begins with the key.
    pub problem: String,
}

impl From<String> for WrongForm {
    fn from(problem: String) -> Self {
        Self { index: None, problem }
    }
}

impl Form {
    /// Returns what was written as a value of this form: text that stands for a number becomes that number.
    ///
    /// # Errors
    /// [`WrongForm`] where something else was written.
    pub fn read(self, written: &Value) -> Result<Value, WrongForm> {
        Ok(match self {
            Self::Number | Self::Positive { .. } => number(written)?,
            Self::Numbers | Self::Point => numbers(written)?,
            Self::Pair => of_length(2, numbers(written)?)?,
            Self::Vectors => Value::List(rows(3, written)?),
            Self::Quaternions => Value::List(rows(4, written)?),
            Self::Text => match written {
                Value::Text(_) => written.clone(),
                _ => return Err(written.instead_of("text").into()),
            },
            Self::OneOf(words) => one_of(words, written)?,
            Self::ByJoint { .. } => by_joint(written)?,
            Self::Flag => match written {
                Value::Flag(_) => written.clone(),
                _ => return Err(written.instead_of("true or false").into()),
            },
        })
    }
}

fn number(written: &Value) -> Result<Value, String> {
    match written {
        Value::Number(number) if !number.value().is_finite() => {
            Err(format!("{} is not a finite number", number.value()))
        }
        Value::Number(_) => Ok(written.clone()),
        Value::Text(text) => text.parse::<Real>().map(Value::Number).map_err(|e| e.to_string()),
        _ => Err(written.instead_of(NUMBER)),
    }
}

fn numbers(written: &Value) -> Result<Value, WrongForm> {
    let Value::List(values) = written else { return Err(written.instead_of("a list").into()) };
    let read = values
        .iter()
        .enumerate()
        .map(|(index, value)| number(value).map_err(|problem| WrongForm { index: Some(index), problem }));
    read.collect::<Result<_, _>>().map(Value::List)
}

fn one_of(words: &[&str], written: &Value) -> Result<Value, String> {
    let known = || words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
    match written {
        Value::Text(text) if words.contains(&text.as_str()) => Ok(written.clone()),
        Value::Text(text) => Err(format!("there is no \"{text}\" here; it is one of {}", known())),
        _ => Err(written.instead_of(&format!("one of {}", known()))),
    }
}

fn by_joint(written: &Value) -> Result<Value, String> {
    let Value::Table(entries) = written else {
        return number(written).map_err(|problem| match written {
            Value::List(_) => written.instead_of("a number, or a table of numbers by the names of joints"),
            _ => problem,
        });
    };
    let entry = |(name, value): &(String, Value)| {
        let value = number(value).map_err(|problem| format!("joint `{name}`: {problem}"))?;
        Ok((name.clone(), value))
    };
    entries.iter().map(entry).collect::<Result<_, String>>().map(Value::Table)
}

fn rows(length: usize, written: &Value) -> Result<Vec<Value>, WrongForm> {
    let Value::List(values) = written else { return Err(written.instead_of("a list").into()) };
    let row = |(index, value)| {
        let numbers = numbers(value).and_then(|numbers| of_length(length, numbers));
        numbers.map_err(|wrong| WrongForm { index: Some(index), ..wrong })
    };
    values.iter().enumerate().map(row).collect()
}

fn of_length(length: usize, numbers: Value) -> Result<Value, WrongForm> {
    let got = numbers.list().map_or(0, <[Value]>::len);
    if got == length { Ok(numbers) } else { Err(format!("expected {length} numbers, got {got}").into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(form: Form, written: impl Into<Value>) -> (Option<usize>, String) {
        let wrong = form.read(&written.into()).unwrap_err();
        (wrong.index, wrong.problem)
    }

    #[test]
    fn text_becomes_the_number_that_it_stands_for_and_reads_as_it_was_written() {
        let Value::Number(number) = Form::Number.read(&"pi/2".into()).unwrap() else { panic!("a number") };
        assert_eq!((number.value(), number.to_string()), (std::f64::consts::FRAC_PI_2, "pi/2".to_owned()));
        let pair = Form::Pair.read(&Value::List(vec!["1/4".into(), 2.0.into()])).unwrap();
        let numbers: Vec<_> = pair.list().unwrap().iter().filter_map(Value::number).collect();
        assert_eq!(numbers, [0.25, 2.0]);
    }

    #[test]
    fn what_is_of_another_form_is_refused_at_its_place() {
        let wrong = problem(Form::Number, true);
        assert_eq!(wrong, (None, format!("invalid type: boolean `true`, expected {NUMBER}")));
        assert_eq!(problem(Form::Number, f64::NAN).1, "NaN is not a finite number");
        assert_eq!(
            problem(Form::Number, "tau").1,
            "\"tau\", column 1: 'tau' is not known; known are pi and functions such as sin, atan2, sqrt, min"
        );
        assert_eq!(problem(Form::Pair, [1.0, 2.0, 3.0]), (None, "expected 2 numbers, got 3".to_owned()));
        assert_eq!(
            problem(Form::Vectors, vec![[1.0, 2.0]]),
            (Some(0), "expected 3 numbers, got 2".to_owned())
        );
        assert_eq!(problem(Form::Numbers, 3.0).1, "invalid type: floating point `3.0`, expected a list");
        assert_eq!(problem(Form::Numbers, [Value::from(1.0), true.into()]).0, Some(1));
        assert_eq!(problem(Form::Text, 1.0).1, "invalid type: floating point `1.0`, expected text");
        assert_eq!(problem(Form::Flag, "yes").1, "invalid type: string \"yes\", expected true or false");
        assert_eq!(problem(Form::Point, Value::Table(Vec::new())).1, "invalid type: table, expected a list");
    }

    #[test]
    fn what_has_to_be_positive_says_what_it_is_and_its_unit() {
        let radius = Parameter::required("radius", Form::Positive { noun: "radius" }, "m", "The radius.");
        assert_eq!(radius.objection(&(-0.1).into()).unwrap(), "-0.1 m is not a radius; it is positive");
        assert_eq!(radius.objection(&0.1.into()), None);
        let plain = Parameter::optional("phase", Form::Number, "rad", "The phase.");
        assert_eq!(plain.objection(&(-0.1).into()), None);
    }
}
