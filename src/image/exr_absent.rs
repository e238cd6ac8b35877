//! Stands in for the modules `openexr` and `numbers` in builds without the Cargo feature `exr`. OpenEXR files are still
//! recognised, so that the error names the feature.

use super::Image;
use super::file_colour::Space;
use crate::error::{Error, Result};

fn left_out() -> Error {
    Error::left_out("OpenEXR files were", "exr")
}

pub mod openexr {
    use super::{Image, Result, Space, left_out};

    pub const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

    pub struct Layer<'a> {
        pub name: &'a str,
        pub image: &'a Image,
        pub channels: &'a [&'a str],
    }

    pub fn probe(_: &[u8]) -> Result<(usize, usize, usize)> {
        Err(left_out())
    }

    pub fn working_bytes(_: &[u8]) -> Result<usize> {
        Err(left_out())
    }

    pub fn decode(_: &[u8]) -> Result<(Image, Space)> {
        Err(left_out())
    }

    pub fn encode(_: &[Layer], _: &[(String, String)]) -> Result<Vec<u8>> {
        Err(left_out())
    }
}

pub mod numbers {
    use super::{Image, Result, left_out};
    use std::path::Path;

    #[derive(Clone, Debug, PartialEq)]
    pub struct FileHeader {
        pub whole: [usize; 2],
        pub corner: [usize; 2],
        pub size: [usize; 2],
        pub numbers: usize,
        pub attributes: Vec<(String, String)>,
    }

    impl FileHeader {
        pub fn attribute(&self, _: &str) -> Option<&str> {
            None
        }
    }

    pub fn read_header(_: &Path) -> Result<FileHeader> {
        Err(left_out())
    }

    pub fn decode(_: &[u8], _: &FileHeader, _: impl FnMut([usize; 2], &[f64])) -> Result<()> {
        Err(left_out())
    }

    pub fn encode(_: &FileHeader, _: &Image, _: impl Fn([usize; 2], usize) -> f64) -> Result<Vec<u8>> {
        Err(left_out())
    }
}
