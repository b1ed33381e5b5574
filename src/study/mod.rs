//! (room: study)
