//! Comparisons with other renderers.

mod adjoint;
mod mitsuba;
mod statistics;
