//! (room: formula)
