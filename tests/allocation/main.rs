//! What may not allocate, under an allocator that counts.

mod integrate;
mod planner;
mod robot;
