//! (room: planner)
