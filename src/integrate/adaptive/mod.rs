//! Steps and orders that follow the solution: the families of Adams and of backward differentiation in their
//! variable-coefficient forms.
//!
//! Both keep *modified divided differences* of the past, of derivatives or of states, on the times that the steps had.
//! A row of any order and any steps is read off them, and so are its error and those of the rows of the orders beside it.

mod adams;
mod backward_differentiation;
mod differences;
mod family;
mod initial_step;
mod order_choice;
mod piece;
mod solve_status;
mod state_window;
mod statistics;
mod variable_order;

pub use family::Family;
pub(super) use piece::Piece;
pub use solve_status::SolveStatus;
pub(super) use state_window::StateWindow;
pub use statistics::Statistics;
pub use variable_order::VariableOrder;
