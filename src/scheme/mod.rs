//! (room: scheme)
