use crate::integrate::adaptive::Family;
use crate::integrate::method::Method;

/// What makes the steps of a solution.
#[derive(Clone, Debug)]
pub(super) enum Choice<T> {
    /// The family that the problem asks for.
    Automatic,
    /// One family.
    Family(Family),
    /// A method in equal steps of at most this length.
    Method(Method<T>, T),
}
