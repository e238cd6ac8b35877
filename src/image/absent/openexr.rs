//! Stands in for `openexr` in builds without the Cargo feature `exr`. The files are still recognised, so that the error
//! names the feature.

use super::Image;
use super::file_colour::Space;
use crate::error::{Error, Result};

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

pub struct Layer<'a> {
    pub name: &'a str,
    pub image: &'a Image,
    pub channels: &'a [&'a str],
}

pub(super) fn left_out() -> Error {
    Error::left_out("OpenEXR files were", "exr")
}

pub(super) fn probe(_: &[u8]) -> Result<(usize, usize, usize)> {
    Err(left_out())
}

pub(super) fn working_bytes(_: &[u8]) -> Result<usize> {
    Err(left_out())
}

pub(super) fn decode(_: &[u8]) -> Result<(Image, Space)> {
    Err(left_out())
}

pub fn encode(_: &[Layer], _: &[(String, String)]) -> Result<Vec<u8>> {
    Err(left_out())
}
