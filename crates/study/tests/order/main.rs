//! Orders that runs show, and orders that are claimed in vain.

mod mutants;
mod others;
mod problems;
mod property;
mod registry;
mod scenarios;
mod table;
