//! (room: task)
