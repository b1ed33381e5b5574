//! Exact polynomials and their root tests, and the numbers they are made of; rotations and small solves of static size.

mod algebraic;
mod bivariate;
mod complex_roots;
mod double_double;
mod elementary;
mod expression;
mod factor_degrees;
mod function;
mod gram;
mod hyperbolic;
mod interpolation;
mod inverse_trigonometric;
mod lanes;
mod lattice;
mod modular;
mod number_text;
mod polynomial;
mod power;
mod quadratic_program;
pub mod random;
mod rational;
mod rational_roots;
mod real;
mod real_roots;
mod root_condition;
mod rotation;
mod routh;
mod scalar;
mod sin_cos;
mod singular;
mod square_free;
mod wide;

pub use algebraic::{AlgebraicNumber, Surd};
pub use complex_roots::{complex_roots, root_moduli};
pub use double_double::DoubleDouble;
pub use expression::{ExpressionError, evaluate};
pub use factor_degrees::possible_factor_degrees;
pub use gram::GramCholesky;
pub use number_text::number_text;
pub use polynomial::Polynomial;
pub use quadratic_program::{Constraint, LeastDistance, LeastDistanceSolver, NoSolution, Solved};
pub use rational::{
    MAX_DIGITS, ParseRationalError, Rational, parse_rational, rational_from_f64, rational_to_f64,
};
pub use rational_roots::rational_roots;
pub use real_roots::{RealRoot, positive_roots, real_roots_between};
pub use root_condition::{RootCondition, root_condition};
pub use rotation::{rotation_vector, rotation_vector_rate};
pub use routh::{is_schur, is_schur_within};
pub use scalar::{Elementary, Scalar};
pub use singular::{RowRotations, SingularValues};

pub(crate) use algebraic::latex_fraction;
pub(crate) use bivariate::{Bivariate, resultant, resultant_cost};
pub(crate) use complex_roots::{Complex, polish, starting_points};
pub(crate) use function::Function;
pub(crate) use gram::LaneFactor;
pub(crate) use interpolation::interpolate;
pub(crate) use lanes::{Kernel, Lane, LaneArray, Lanes, level, with_instructions};
pub(crate) use random::{mix, normal};
pub(crate) use rational::{common_denominator, shortened};
pub(crate) use real::Real;
pub(crate) use rotation::{relative_rotation, small_rotation_vector};
pub(crate) use routh::{half_plane_image, last_hurwitz_determinant};
pub(crate) use sin_cos::{sines_and_cosines, sines_and_cosines_of};
pub(crate) use wide::Wide;
