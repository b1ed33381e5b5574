//! An initial value problem: equations, initial values and, where it is known, the solution.

use super::compiled::{Compiled, Duals, EquationField};
use super::parse::{Meaning, Node, Switch, parse};
use crate::math::{Dual, Elementary, Function};
use num_traits::Zero;
use std::collections::HashSet;
use thiserror::Error;

/// The most unknowns of a problem.
const MOST_UNKNOWNS: usize = 1000;

/// The parts of a problem as people write them, each a list of `name = expression`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EquationText {
    /// Names with a value.
    pub parameters: Vec<(String, f64)>,
    /// Short names for parts of equations, in an order in which each uses earlier ones only.
    pub definitions: Vec<String>,
    /// The derivative of every unknown: `x' = expression`.
    pub equations: Vec<String>,
    /// The value of every unknown at t = 0: `x = expression`.
    pub initial: Vec<String>,
    /// The solution as a function of t, or nothing: `x = expression`.
    pub exact: Vec<String>,
    /// What may happen, where an expression crosses zero: `name: expression`.
    pub events: Vec<String>,
}

/// What is wrong with a line of a problem.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub struct EquationError {
    /// Which list: `parameters`, `where`, `equations`, `initial`, `exact` or `events`.
    pub list: &'static str,
    /// Which line of it, from 0; nothing where the list as a whole is meant.
    pub line: Option<usize>,
    /// Where in the line the token at fault begins, in characters from 1.
    pub column: Option<usize>,
    /// The sentence.
    pub message: String,
}

/// A system `x' = f(t, x)` from t = 0 that was written as text.
///
/// ```
/// use kinstep::integrate::{EquationText, Equations};
/// let lines = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect::<Vec<_>>();
/// let swing = Equations::parse(&EquationText {
///     equations: lines(&["x' = x*cos(t)"]),
///     initial: lines(&["x = 1"]),
///     exact: lines(&["x = exp(sin(t))"]),
///     ..EquationText::default()
/// })?;
/// assert_eq!(swing.unknowns(), ["x"]);
/// assert_eq!(swing.initial::<f64>(), [1.0]);
/// assert_eq!(swing.exact(0.5), Some(vec![0.5_f64.sin().exp()]));
/// # Ok::<(), kinstep::integrate::EquationError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Equations {
    unknowns: Vec<String>,
    definitions: Vec<Node>,
    derivatives: Vec<Node>,
    initial: Vec<Node>,
    exact: Option<Vec<Node>>,
    switches: Vec<Switch>,
    events: Vec<(String, Node)>,
}

impl Equations {
    /// Reads a problem.
    ///
    /// # Errors
    /// [`EquationError`]: a line that does not read, a name that means nothing or two things, an unknown without
    /// its initial value or its equation.
    pub fn parse(text: &EquationText) -> Result<Self, EquationError> {
        let mut names = Names::new(text)?;
        let equations = lines("equations", &text.equations, true)?;
        if equations.is_empty() || equations.len() > MOST_UNKNOWNS {
            let message = format!("a problem has 1 to {MOST_UNKNOWNS} equations such as \"x' = -x\"");
            return Err(EquationError { list: "equations", line: None, column: None, message });
        }
        for (line, (name, _)) in equations.iter().enumerate() {
            names.add("equations", line, name)?;
        }
        let unknowns: Vec<String> = equations.iter().map(|(name, _)| (*name).to_owned()).collect();
        let (mut definitions, mut switches) = (Vec::new(), Vec::new());
        for (line, (name, expression)) in lines("where", &text.definitions, false)?.into_iter().enumerate() {
            let (node, switch) = names.read("where", line, expression, names.variables.len())?;
            definitions.push(node);
            switches.extend(switch);
            names.add("where", line, name)?;
        }
        let all = names.variables.len();
        let mut derivatives = Vec::new();
        for (line, (_, expression)) in equations.iter().enumerate() {
            let (node, switch) = names.read("equations", line, *expression, all)?;
            derivatives.push(node);
            switches.extend(switch);
        }
        let initial = names.for_unknowns("initial", &text.initial, &unknowns, 0)?;
        let exact = if text.exact.is_empty() {
            None
        } else {
            Some(names.for_unknowns("exact", &text.exact, &unknowns, 1)?)
        };
        let events = names.events(&text.events)?;
        Ok(Self { unknowns, definitions, derivatives, initial, exact, switches, events })
    }

    /// The unknowns, in the order of the entries of a state.
    pub fn unknowns(&self) -> &[String] {
        &self.unknowns
    }

    /// Whether the solution is known.
    pub fn has_exact(&self) -> bool {
        self.exact.is_some()
    }

    /// The parts of the right-hand side that are not smooth where they switch, as they were written: `abs(x)`, `sign(x)`, `min(x, y)`,
    /// comparisons. [`EquationField::switches`] has the quantities that change their signs there.
    pub fn switches(&self) -> impl ExactSizeIterator<Item = &str> {
        self.switches.iter().map(|switch| switch.text.as_str())
    }

    /// The names of the events, in their order; [`EquationField::event`] has the values whose zeros they are.
    pub fn events(&self) -> impl ExactSizeIterator<Item = &str> {
        self.events.iter().map(|(name, _)| name.as_str())
    }

    /// The right-hand side.
    pub fn field<T: Elementary>(&self) -> EquationField<T> {
        let dimension = self.unknowns.len();
        EquationField {
            dimension,
            definitions: self.definitions.iter().map(Compiled::of).collect(),
            derivatives: self.derivatives.iter().map(Compiled::of).collect(),
            switches: self.switches.iter().map(|switch| Compiled::of(&switch.quantity)).collect(),
            events: self.events.iter().map(|(_, node)| Compiled::of(node)).collect(),
            duals: Duals {
                definitions: self.definitions.iter().map(Compiled::of).collect(),
                derivatives: self.derivatives.iter().map(Compiled::of).collect(),
                values: vec![Dual::zero(); 1 + dimension + self.definitions.len()],
                stack: Vec::new(),
            },
            values: vec![T::zero(); 1 + dimension + self.definitions.len()],
            stack: Vec::new(),
        }
    }

    /// The initial state.
    pub fn initial<T: Elementary>(&self) -> Vec<T> {
        values(&self.initial, T::zero())
    }

    /// The solution at `t`, where it is known.
    pub fn exact<T: Elementary>(&self, t: T) -> Option<Vec<T>> {
        self.exact.as_ref().map(|exact| values(exact, t))
    }

    /// The solution as a function, where it is known.
    pub fn solution<T: Elementary>(&self) -> Option<impl FnMut(T) -> Vec<T> + use<T>> {
        let compiled: Vec<Compiled<T>> = self.exact.as_ref()?.iter().map(Compiled::of).collect();
        let mut stack = Vec::new();
        Some(move |t| compiled.iter().map(|entry| entry.value(&[t], &mut stack)).collect())
    }
}

fn values<T: Elementary>(nodes: &[Node], t: T) -> Vec<T> {
    let mut stack = Vec::new();
    nodes.iter().map(|node| Compiled::of(node).value(&[t], &mut stack)).collect()
}

/// An expression and where it begins in its line, in characters from 0.
#[derive(Clone, Copy)]
struct Expression<'t> {
    text: &'t str,
    start: usize,
}

/// Splits `name = expression` (or `name' = expression`) lines.
fn lines<'t>(
    list: &'static str,
    lines: &'t [String],
    primed: bool,
) -> Result<Vec<(&'t str, Expression<'t>)>, EquationError> {
    let split = |(line, text): (usize, &'t String)| {
        let form = if primed { "x' = expression" } else { "x = expression" };
        let refuse = || EquationError {
            list,
            line: Some(line),
            column: Some(1),
            message: format!("\"{text}\" is not of the form `{form}`"),
        };
        let (before, expression) = text.split_once('=').ok_or_else(refuse)?;
        let name = before.trim();
        let name = if primed { name.strip_suffix('\'').map(str::trim_end) } else { Some(name) };
        let is_name = |name: &&str| {
            let mut characters = name.chars();
            characters.next().is_some_and(|c| c.is_alphabetic() || c == '_')
                && characters.all(|c| c.is_alphanumeric() || c == '_')
        };
        let expression = Expression { text: expression, start: before.chars().count() + 1 };
        Ok((name.filter(is_name).ok_or_else(refuse)?, expression))
    };
    lines.iter().enumerate().map(split).collect()
}

/// The names that expressions may use.
struct Names {
    parameters: Vec<(String, f64)>,
    variables: Vec<String>,
}

impl Names {
    fn new(text: &EquationText) -> Result<Self, EquationError> {
        let mut names = Self { parameters: Vec::new(), variables: vec!["t".to_owned()] };
        for (name, value) in &text.parameters {
            names.check("parameters", None, name)?;
            names.parameters.push((name.clone(), *value));
        }
        Ok(names)
    }

    fn check(&self, list: &'static str, line: Option<usize>, name: &str) -> Result<(), EquationError> {
        let reserved = name == "pi" || Function::named(name).is_some();
        let taken =
            self.variables.iter().chain(self.parameters.iter().map(|(name, _)| name)).any(|n| n == name);
        if reserved || taken {
            let message = format!("\"{name}\" already means something else; choose another name");
            return Err(EquationError { list, line, column: line.map(|_| 1), message });
        }
        Ok(())
    }

    fn add(&mut self, list: &'static str, line: usize, name: &str) -> Result<(), EquationError> {
        self.check(list, Some(line), name)?;
        self.variables.push(name.to_owned());
        Ok(())
    }

    /// Reads an expression that may use the first `visible` variables.
    fn read(
        &self,
        list: &'static str,
        line: usize,
        expression: Expression<'_>,
        visible: usize,
    ) -> Result<(Node, Vec<Switch>), EquationError> {
        let meaning = |name: &str| {
            if let Some(slot) = self.variables[..visible].iter().position(|known| known == name) {
                return Ok(Meaning::Slot(slot));
            }
            if let Some((_, value)) = self.parameters.iter().find(|(known, _)| known == name) {
                return Ok(Meaning::Constant(*value));
            }
            let known: Vec<&str> = self.variables[..visible]
                .iter()
                .chain(self.parameters.iter().map(|(name, _)| name))
                .map(String::as_str)
                .chain(Function::NAMES.map(|(name, _)| name))
                .chain(["pi"])
                .collect();
            Err(format!("\"{name}\" means nothing here; known are {}", known.join(", ")))
        };
        parse(expression.text, &meaning).map_err(|error| {
            let column = expression.start + error.column + 1;
            EquationError { list, line: Some(line), column: Some(column), message: error.message }
        })
    }

    /// Reads events, `name: expression`.
    fn events(&self, text: &[String]) -> Result<Vec<(String, Node)>, EquationError> {
        let list = "events";
        let mut events: Vec<(String, Node)> = Vec::new();
        for (line, text) in text.iter().enumerate() {
            let refuse = |message: String| EquationError { list, line: Some(line), column: Some(1), message };
            let form = || refuse(format!("\"{text}\" is not of the form `name: expression`"));
            let (before, expression) = text.split_once(':').ok_or_else(form)?;
            let name = Some(before.trim()).filter(|name| !name.is_empty()).ok_or_else(form)?;
            if events.iter().any(|(known, _)| known == name) {
                return Err(refuse(format!("there are two events \"{name}\"; call one of them otherwise")));
            }
            let expression = Expression { text: expression, start: before.chars().count() + 1 };
            let (node, _) = self.read(list, line, expression, self.variables.len())?;
            events.push((name.to_owned(), node));
        }
        Ok(events)
    }

    /// Reads one expression for every unknown, in their order, whatever order the lines have.
    fn for_unknowns(
        &self,
        list: &'static str,
        text: &[String],
        unknowns: &[String],
        visible: usize,
    ) -> Result<Vec<Node>, EquationError> {
        let found = lines(list, text, false)?;
        let mut seen = HashSet::new();
        for (line, (name, _)) in found.iter().enumerate() {
            if !unknowns.iter().any(|unknown| unknown == name) || !seen.insert(*name) {
                let message = format!(
                    "\"{name}\" is not an unknown, or stands here twice; the unknowns are {}",
                    unknowns.join(", ")
                );
                return Err(EquationError { list, line: Some(line), column: Some(1), message });
            }
        }
        unknowns
            .iter()
            .map(|unknown| {
                let line =
                    found.iter().position(|(name, _)| name == unknown).ok_or_else(|| EquationError {
                        list,
                        line: None,
                        column: None,
                        message: format!("there is no line for the unknown \"{unknown}\""),
                    })?;
                self.read(list, line, found[line].1, visible).map(|(node, _)| node)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::field::Field;
    use crate::math::DoubleDouble;
    use proptest::prelude::*;

    fn lines(lines: &[&str]) -> Vec<String> {
        lines.iter().map(|&line| line.to_owned()).collect()
    }

    fn of(equation: &str) -> Result<Equations, EquationError> {
        Equations::parse(&EquationText {
            parameters: vec![("a".to_owned(), 0.5)],
            definitions: lines(&["s = x*x", "s2 = s + 1"]),
            equations: lines(&[equation]),
            initial: lines(&["x = sqrt(2)"]),
            ..EquationText::default()
        })
    }

    fn value(expression: &str, t: f64, x: f64) -> f64 {
        let mut f = [0.0];
        of(&format!("x' = {expression}")).unwrap().field().evaluate(t, &[x], &mut f, &mut []);
        f[0]
    }

    #[test]
    fn expressions_mean_what_they_mean_on_paper() {
        for (text, expected) in [
            ("1 - 2 - 3", -4.0),
            ("2*3^2", 18.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("12/3/2", 2.0),
            ("4^1.5", 8.0),
            ("4^(-3/2)", 0.125),
            ("1e-2 + .5", 0.51),
            ("a*x", 1.5),
            ("s2 + t", 12.0),
            ("-(x - t)", -1.0),
            ("ln(exp(x))", 3.0),
            ("sin(pi/2) + cos(0*x)", 2.0),
            ("abs(-x) + sign(-x)*sign(t)", 2.0),
            ("min(x, t) + 10*max(x, t, 5)", 52.0),
            ("tan(atan(x)) + atan2(0, -1)/pi", 4.0),
            ("asin(1) + acos(0)", std::f64::consts::PI),
            ("sinh(x)/cosh(x) - tanh(x)", 0.0),
            ("t^x + x^(1/3)*x^(2/3) + t^0.1*t^-0.1", 12.0),
            ("(x < t) + 10*(x >= t) + 100*(x == 3) + 1000*(x != 3)", 110.0),
            ("t + x > 4", 1.0),
        ] {
            assert!((value(text, 2.0, 3.0) - expected).abs() < 1e-14, "{text}: {}", value(text, 2.0, 3.0));
        }
    }

    #[test]
    fn numbers_are_exact_in_extended_precision() {
        let equations = of("x' = 0.1").unwrap();
        let mut f = [DoubleDouble::from(0.0)];
        equations.field().evaluate(f[0], &equations.initial::<DoubleDouble>(), &mut f, &mut []);
        assert!((f[0] * DoubleDouble::from(10.0) - DoubleDouble::from(1.0)).to_f64().abs() < 1e-31);
    }

    /// The digits are those of an arithmetic with 180 of them.
    #[test]
    fn every_function_has_thirty_digits_in_extended_precision() {
        for (text, digits) in [
            ("asin(0.7)", "0.77539749661075306374035335271498711356"),
            ("asin(-0.99)", "-1.4292568534704694004855323346647244271"),
            ("asin(0.001)", "0.0010000001666667416667113095541914906261"),
            ("acos(0.7)", "0.79539883018414355549096833892476432854"),
            ("acos(-0.99)", "3.0000531802653660197168540263044758692"),
            ("acos(0.999)", "0.044725087168733431249696232671551069904"),
            ("ln(1.0009765625)", "0.00097608597305545889596082490801718667261"),
            ("ln(0.3)", "-1.203972804325935992622746217761838503"),
            ("ln(7e5)", "13.458835614025541725195310016865000768"),
            ("exp(-0.001)", "0.9990004998333749916680553571676559747"),
            ("exp(1.3)", "3.6692966676192442204574899160114862514"),
            ("exp(40.5)", "388084696243620324.02317218757269945334"),
            ("sinh(0.001)", "0.0010000001666666750000001984127011684304"),
            ("sinh(0.9)", "1.0265167257081752759583361619784223538"),
            ("sinh(20)", "242582597.70489513795397660405149136536"),
            ("tanh(0.001)", "0.00099999966666679999994603176790122570467"),
            ("tanh(-0.9)", "-0.71629787019902442081144378305809486317"),
            ("tanh(9)", "0.99999996954004097447930211118358239753"),
            ("tan(0.3)", "0.30933624960962323303530367969829466726"),
            ("tan(1.4)", "5.797883715482889643707720243603699046"),
            ("tan(-2)", "2.1850398632615189916433061023136825434"),
            ("atan(0.001)", "0.00099999966666686666652380963492054401162"),
            ("atan(-3)", "-1.2490457723982544258299170772810901231"),
            ("atan(1e6)", "1.5707953267948966195646550249728847754"),
            ("sin(3.14159)", "0.0000026535897932353484174726298024211452225"),
            ("sin(0.25)", "0.24740395925452292959684870484938919589"),
            ("sin(100)", "-0.50636564110975879365655761045978543207"),
            ("cos(1.5707)", "0.000096326794747652228535096823231605124118"),
            ("cos(0.25)", "0.9689124217106447841445954494941891998"),
            ("cos(-100)", "0.86231887228768393410193851395084253551"),
            ("cosh(0.1)", "1.0050041680558035989879784429683416447"),
            ("cosh(3)", "10.067661995777765841953936035115889837"),
            ("cosh(-30)", "5343237290762.2310734952343721588156692"),
            ("sqrt(2)", "1.4142135623730950488016887242096980786"),
            ("sqrt(0.1)", "0.31622776601683793319988935444327185337"),
            ("sqrt(1e10)", "100000.0"),
            ("2^(0.1)", "1.0717734625362931642130063250233420229"),
            ("0.3^(-7.25)", "6178.3271824738655417700054334507638845"),
            ("1.5^(pi)", "3.5744317230367653203349838630341995935"),
            ("10^(1/3)", "2.1544346900318837217592935665193504953"),
            ("atan2(1, -2)", "2.6779450445889871222483871518182884822"),
            ("atan2(-0.001, -3)", "-3.1412593202688055833186105267898506261"),
        ] {
            let equations = of(&format!("x' = {text}")).unwrap();
            let mut f = [DoubleDouble::from(0.0)];
            equations.field().evaluate(f[0], &equations.initial::<DoubleDouble>(), &mut f, &mut []);
            let known = DoubleDouble::from_rational(&crate::math::parse_rational(digits).unwrap());
            let off = (f[0] - known).to_f64().abs() / known.to_f64().abs().max(1.0);
            assert!(off < 1e-30, "{text}: {off:e}");
        }
    }

    #[test]
    fn events_are_zeros_of_expressions_and_refused_like_equations() {
        let with = |events: &[&str]| {
            Equations::parse(&EquationText {
                equations: lines(&["x' = u", "u' = -1"]),
                definitions: lines(&["half = x/2"]),
                initial: lines(&["x = 0", "u = 1"]),
                events: lines(events),
                ..EquationText::default()
            })
        };
        let equations = with(&["ground: x", "low: half - t"]).unwrap();
        assert_eq!(equations.events().collect::<Vec<_>>(), ["ground", "low"]);
        assert_eq!(equations.field().event(1, 1.0, &[3.0, 0.0]), 0.5);
        for (event, column, reason) in [
            ("ground", 1, "not of the form `name: expression`"),
            (": x", 1, "not of the form"),
            ("ground: y", 9, "\"y\" means nothing here; known are t, x, u, half"),
            ("low: x", 1, "two events \"low\""),
        ] {
            let error = with(&["low: x", event]).unwrap_err();
            assert!(error.message.contains(reason), "{error}");
            assert_eq!((error.list, error.line, error.column), ("events", Some(1), Some(column)));
        }
    }

    #[test]
    fn the_jacobian_is_exact() {
        let equations = Equations::parse(&EquationText {
            definitions: lines(&["r = x*y"]),
            equations: lines(&["x' = r^1.5 + t", "y' = sin(x)*exp(-y) + max(x, y)"]),
            initial: lines(&["x = 1", "y = 1"]),
            ..EquationText::default()
        });
        let (x, y) = (0.7_f64, 0.4_f64);
        let mut jacobian = [0.0; 4];
        assert!(equations.unwrap().field().jacobian(0.3, &[x, y], &mut jacobian));
        let root = 1.5 * (x * y).sqrt();
        let exact = [root * y, root * x, x.cos() * (-y).exp() + 1.0, -x.sin() * (-y).exp()];
        assert!(jacobian.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-14), "{jacobian:?}");
    }

    #[test]
    fn what_may_switch_is_known_with_its_quantity() {
        let equations = of("x' = abs(x - 1) + min(t, 2*x)*(s2 <= 5) + sin(x)").unwrap();
        assert_eq!(equations.switches().collect::<Vec<_>>(), ["abs(x - 1)", "min(t, 2*x)", "s2 <= 5"]);
        let mut quantities = [0.0; 3];
        equations.field().switches(1.0, &[3.0], &mut quantities);
        assert_eq!(quantities, [2.0, -5.0, 5.0]);
        assert_eq!(of("x' = sqrt(x)").unwrap().switches().len(), 0);
    }

    #[test]
    fn what_does_not_read_is_refused_with_a_reason() {
        for (text, column, reason) in [
            ("x' = y", 6, "\"y\" means nothing here; known are t, x, s, s2, a, sin"),
            ("x' = 2 +", 9, "ends where"),
            ("x' = (2", 6, "not closed"),
            ("x' = (2, 3)", 8, "`,` stands where the parenthesis should be closed"),
            ("x' = 2 3", 8, "`3` can not stand here"),
            ("x' = 2^(1/0)", 10, "divides by zero"),
            ("x' = t + sin x", 10, "needs its argument"),
            ("x' = 1.2.3", 6, "second decimal point"),
            ("x = 2", 1, "not of the form `x' = expression`"),
            ("t' = 2", 1, "already means something else"),
            ("abs' = 2", 1, "already means something else"),
            ("a' = 2", 1, "already means something else"),
            ("x' = x!", 7, "`!` can not stand"),
            ("x' = x = 2", 8, "compared with =="),
            ("x' = 1 < x < 2", 12, "two comparisons in a row"),
            ("x' = t*min(x)", 8, "min takes two arguments or more, separated by commas; 1 given"),
            ("x' = atan2(x, t, 1)", 6, "atan2 takes two arguments, atan2(y, x); 3 given"),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.message.contains(reason), "{text}: {error}");
            assert_eq!(error.column, Some(column), "{text}");
            assert_eq!(error.list, "equations");
        }
        assert!(of(&format!("x' = {}x{}", "(".repeat(99), ")".repeat(99))).is_err());
        assert!(of(&format!("x' = {}x", "-".repeat(3000))).is_err());
        let two = EquationText { equations: lines(&["x' = 1"]), ..EquationText::default() };
        assert!(Equations::parse(&two).unwrap_err().message.contains("no line for the unknown \"x\""));
        assert!(Equations::parse(&EquationText::default()).is_err());
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "[xta0-9.+*/^()' =<>,sincoemabx-]{0,30}") {
            let _ = of(&text);
            let _ = of(&format!("x' = {text}"));
        }
    }
}
