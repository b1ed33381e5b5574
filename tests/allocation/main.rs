//! What may not allocate, under an allocator that counts.

mod planner;
mod robot;
