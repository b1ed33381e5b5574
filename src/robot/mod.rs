//! (room: robot)
