//! Rows of the formula table and rows of one's own: what they are refused for, and what holds for every one.

mod bad_input;
mod figures;
mod identities;
mod lab;
mod root_condition;
