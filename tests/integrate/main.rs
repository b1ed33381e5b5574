//! The stepper with methods, steps and fields of one's own.

mod methods;
mod solver;
