//! A small world of its own to try everything on: two rooms, generated, and a photo taken of one of them.

pub mod photo;
