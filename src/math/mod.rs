//! (room: math)
