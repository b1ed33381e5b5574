use super::{Parameter, Parameters};

/// One kind of curve, time law, law, criterion or task: its name, what it takes, and how one is made of that.
///
/// It stands in the file of the type that it makes, and in the registry of the folder; everything that reads, checks, lists
/// or tests kinds walks the registries. Kinds of your own are made the same way:
///
/// ```
/// use kinstep::kind::{Form, Kind, Parameter};
/// use kinstep::task::{Circle, CurveKind, MakeCurve};
///
/// const HOOP: CurveKind = Kind::new(
///     "hoop",
///     "2 size (cos a, sin a).",
///     &[Parameter::required("size", Form::Positive { noun: "size" }, "m", "Half the radius.")],
///     MakeCurve::Planar(|given| Box::new(Circle { radius: 2.0 * given.number("size").unwrap_or(0.0) })),
/// );
/// assert!(HOOP.parameter("size").is_some_and(|size| size.is_required));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Kind<Make> {
    /// The name in files.
    pub name: &'static str,
    /// What it is, in one sentence.
    pub description: &'static str,
    /// What it takes.
    pub parameters: &'static [Parameter],
    /// Makes one of parameters that were checked: all that are required are there and of their forms.
    pub make: Make,
    /// Says what is wrong with parameters that are all right one by one.
    pub objection: Option<fn(&Parameters) -> Option<String>>,
    /// Draws parameters at random, for tests.
    pub draw: Option<DrawParameters>,
}

/// Returns parameters of about the given size \[m\], made of whole numbers from a range that are drawn one after the other.
pub type DrawParameters = fn(f64, &mut dyn FnMut(i32, i32) -> i32) -> Parameters;

impl<Make> Kind<Make> {
    /// A kind of that name and description that is made of these parameters.
    pub const fn new(
        name: &'static str,
        description: &'static str,
        parameters: &'static [Parameter],
        make: Make,
    ) -> Self {
        Self { name, description, parameters, make, objection: None, draw: None }
    }

    /// The same with an objection to parameters that do not go together.
    #[must_use]
    pub const fn with_objection(mut self, objection: fn(&Parameters) -> Option<String>) -> Self {
        self.objection = Some(objection);
        self
    }

    /// The same with a way to draw parameters at random.
    #[must_use]
    pub const fn with_draw(mut self, draw: DrawParameters) -> Self {
        self.draw = Some(draw);
        self
    }

    /// The parameter of that name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}
