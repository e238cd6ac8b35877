//! The transfer: runs the stages in order; every intermediate can be read, replaced and re-run from.
