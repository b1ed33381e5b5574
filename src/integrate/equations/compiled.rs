//! Expressions as lists of operations on a stack, and the field that they make.

use super::parse::{Comparison, Node};
use crate::integrate::field::Field;
use crate::math::{DoubleDouble, Dual, Elementary, Function};

#[derive(Clone, Copy, Debug)]
enum Operation<T> {
    Constant(T),
    Slot(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// To a power, counted in halves.
    Power(i32),
    RealPower,
    Compare(Comparison),
    /// With so many arguments.
    Call(Function, usize),
}

/// An expression ready to be evaluated.
#[derive(Clone, Debug)]
pub(super) struct Compiled<T> {
    operations: Vec<Operation<T>>,
}

impl<T: Elementary> Compiled<T> {
    pub(super) fn of(node: &Node) -> Self {
        let mut compiled = Self { operations: Vec::new() };
        compiled.add(node);
        compiled
    }

    fn add(&mut self, node: &Node) {
        let operation = match node {
            Node::Number(value) => Operation::Constant(T::from_rational(value)),
            Node::Parameter(value) => Operation::Constant(T::from_extended(DoubleDouble::from(*value))),
            Node::Pi => Operation::Constant(T::pi()),
            Node::Slot(slot) => Operation::Slot(*slot),
            Node::Negative(inside) => self.after(&[inside], Operation::Negate),
            Node::Sum(a, b) => self.after(&[a, b], Operation::Add),
            Node::Difference(a, b) => self.after(&[a, b], Operation::Subtract),
            Node::Product(a, b) => self.after(&[a, b], Operation::Multiply),
            Node::Quotient(a, b) => self.after(&[a, b], Operation::Divide),
            Node::Power(base, halves) => self.after(&[base], Operation::Power(*halves)),
            Node::RealPower(base, exponent) => self.after(&[base, exponent], Operation::RealPower),
            Node::Compared(comparison, a, b) => self.after(&[a, b], Operation::Compare(*comparison)),
            Node::Call(function, arguments) => {
                for argument in arguments {
                    self.add(argument);
                }
                Operation::Call(*function, arguments.len())
            }
        };
        self.operations.push(operation);
    }

    fn after(&mut self, arguments: &[&Node], operation: Operation<T>) -> Operation<T> {
        for argument in arguments {
            self.add(argument);
        }
        operation
    }

    /// The value where the variables have `values`; the stack keeps its memory between calls.
    pub(super) fn value(&self, values: &[T], stack: &mut Vec<T>) -> T {
        stack.clear();
        for operation in &self.operations {
            let result = match *operation {
                Operation::Constant(value) => value,
                Operation::Slot(slot) => values[slot],
                Operation::Negate => -pop(stack),
                Operation::Power(halves) => power(pop(stack), halves),
                Operation::Call(function, count) => {
                    let arguments = stack.len() - count;
                    let value = function.value(&stack[arguments..]);
                    stack.truncate(arguments);
                    value
                }
                two => {
                    let (b, a) = (pop(stack), pop(stack));
                    match two {
                        Operation::Add => a + b,
                        Operation::Subtract => a - b,
                        Operation::Multiply => a * b,
                        Operation::RealPower => a.power(b),
                        Operation::Compare(comparison) => compared(comparison, a, b),
                        _ => a / b,
                    }
                }
            };
            stack.push(result);
        }
        pop(stack)
    }
}

fn pop<T: Elementary>(stack: &mut Vec<T>) -> T {
    stack.pop().expect("an operation is compiled after its arguments")
}

fn power<T: Elementary>(base: T, halves: i32) -> T {
    let mut result = if halves % 2 == 0 { T::one() } else { base.sqrt() };
    let (mut square, mut rest) = (base, halves.unsigned_abs() / 2);
    while rest > 0 {
        if rest % 2 == 1 {
            result = result * square;
        }
        square = square * square;
        rest /= 2;
    }
    if halves < 0 { T::one() / result } else { result }
}

/// One where the comparison holds, zero where it does not; NaN where a side is NaN.
fn compared<T: Elementary>(comparison: Comparison, a: T, b: T) -> T {
    let Some(order) = a.partial_cmp(&b) else { return a + b };
    let holds = match comparison {
        Comparison::Less => order.is_lt(),
        Comparison::LessOrEqual => order.is_le(),
        Comparison::Greater => order.is_gt(),
        Comparison::GreaterOrEqual => order.is_ge(),
        Comparison::Equal => order.is_eq(),
        Comparison::Unequal => order.is_ne(),
    };
    if holds { T::one() } else { T::zero() }
}

/// The right-hand side of [`Equations`](super::Equations) in numbers of one kind, with the memory that it needs.
///
/// Variables stand in the order t, unknowns, definitions.
#[derive(Clone, Debug)]
pub struct EquationField<T> {
    pub(super) dimension: usize,
    pub(super) definitions: Vec<Compiled<T>>,
    pub(super) derivatives: Vec<Compiled<T>>,
    pub(super) switches: Vec<Compiled<T>>,
    pub(super) events: Vec<Compiled<T>>,
    pub(super) duals: Duals<T>,
    pub(super) values: Vec<T>,
    pub(super) stack: Vec<T>,
}

impl<T: Elementary> Field<T> for EquationField<T> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], _g: &mut [T]) {
        self.go_to(t, x);
        for (derivative, out) in self.derivatives.iter().zip(f) {
            *out = derivative.value(&self.values, &mut self.stack);
        }
    }

    /// Exact, by forward-mode automatic differentiation.
    fn jacobian(&mut self, t: T, x: &[T], jacobian: &mut [T]) -> bool {
        self.duals.write_jacobian(t, x, jacobian);
        true
    }
}

/// The right-hand side in numbers that carry derivatives.
#[derive(Clone, Debug)]
pub(super) struct Duals<T> {
    pub(super) definitions: Vec<Compiled<Dual<T>>>,
    pub(super) derivatives: Vec<Compiled<Dual<T>>>,
    pub(super) values: Vec<Dual<T>>,
    pub(super) stack: Vec<Dual<T>>,
}

impl<T: Elementary> Duals<T> {
    fn write_jacobian(&mut self, t: T, x: &[T], jacobian: &mut [T]) {
        let dimension = x.len();
        let Self { definitions, derivatives, values, stack } = self;
        values[0] = Dual::constant(t);
        for j in 0..dimension {
            for (i, &x) in x.iter().enumerate() {
                values[1 + i] = if i == j { Dual::variable(x) } else { Dual::constant(x) };
            }
            for (k, definition) in definitions.iter().enumerate() {
                values[1 + dimension + k] = definition.value(values, stack);
            }
            for (i, derivative) in derivatives.iter().enumerate() {
                jacobian[i * dimension + j] = derivative.value(values, stack).derivative;
            }
        }
    }
}

impl<T: Elementary> EquationField<T> {
    /// Writes the quantities at `t` and `x` at whose changes of sign the right-hand side is not smooth, one for each of
    /// [`Equations::switches`](super::Equations::switches).
    ///
    /// # Panics
    /// If `x` or `quantities` has another length.
    pub fn switches(&mut self, t: T, x: &[T], quantities: &mut [T]) {
        assert_eq!(quantities.len(), self.switches.len(), "one number per switch");
        self.go_to(t, x);
        for (switch, out) in self.switches.iter().zip(quantities) {
            *out = switch.value(&self.values, &mut self.stack);
        }
    }

    /// The value at `t` and `x` of an event's expression, in the order of [`Equations::events`](super::Equations::events).
    ///
    /// # Panics
    /// If there is no such event, or `x` has another length.
    pub fn event(&mut self, event: usize, t: T, x: &[T]) -> T {
        self.go_to(t, x);
        self.events[event].value(&self.values, &mut self.stack)
    }

    /// Gives every variable and definition its value.
    fn go_to(&mut self, t: T, x: &[T]) {
        self.values[0] = t;
        self.values[1..=self.dimension].copy_from_slice(x);
        for (k, definition) in self.definitions.iter().enumerate() {
            self.values[1 + self.dimension + k] = definition.value(&self.values, &mut self.stack);
        }
    }
}
