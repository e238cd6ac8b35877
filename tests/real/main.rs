//! Tests of the stages on real photos, scenes and artworks.
//!
//! The data are not part of the project; they are read from `LUXFER_TEST_DATA` (default `../shared/data`). Without data
//! the tests are skipped; in CI they fail.

mod emission;
mod read;
mod rectify;
mod scene;
#[cfg(feature = "stylize")]
mod stylize;
#[path = "../truth/mod.rs"]
mod truth;
