//! Tests of whole lighting transfers, and of the stages that find the camera, on rooms whose truth is known.

mod demo;
mod lamps_alike;
mod planes;
mod same_room;
mod shifted_lens;
