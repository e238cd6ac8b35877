//! A small world of its own to try everything on: two rooms, generated.
