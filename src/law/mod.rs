//! (room: law)
