//! (room: integrate)
