//! Receives the samples of an OpenEXR layer from the crate `exr`: returns an error if memory is short, and checks the
//! position of each line. (The crate's own receiver aborts the process if memory is short, and trusts what a tile says
//! about its resolution.)

use crate::image::try_vec;
use exr::block::chunk::TileCoordinates;
use exr::block::lines::LineRef;
use exr::error::{Error, IoError, Result, UnitResult};
use exr::image::read::any_channels::{ReadSamples, SamplesReader};
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::Header;
use exr::prelude::{FlatSamples, Vec2, f16};
use std::io::ErrorKind;

/// Reads only the largest resolution of a layer.
pub(super) struct Largest;

/// The samples of one channel that have been read so far.
pub(super) struct Samples {
    width: usize,
    samples: FlatSamples,
}

impl ReadSamples for Largest {
    type Reader = Samples;

    fn create_sample_reader(&self, header: &Header, channel: &ChannelDescription) -> Result<Samples> {
        let (width, height) = (header.layer_size.0, header.layer_size.1);
        let samples = match channel.sample_type {
            SampleType::F16 => zeros(width * height, f16::ZERO).map(FlatSamples::F16),
            SampleType::F32 => zeros(width * height, 0.0).map(FlatSamples::F32),
            SampleType::U32 => zeros(width * height, 0).map(FlatSamples::U32),
        };
        Ok(Samples { width, samples: samples? })
    }
}

fn zeros<T: Clone>(len: usize, zero: T) -> Result<Vec<T>> {
    try_vec(len, zero).map_err(|_| IoError::from(ErrorKind::OutOfMemory).into())
}

impl SamplesReader for Samples {
    type Samples = FlatSamples;

    fn filter_block(&self, tile: TileCoordinates) -> bool {
        tile.level_index == Vec2(0, 0)
    }

    fn read_line(&mut self, line: LineRef<'_>) -> UnitResult {
        let at = line.location;
        // The head of a tile may contradict the offset table, by which the tile was selected.
        let misplaced = || Error::Invalid("a block that is not where the table of blocks has it".into());
        if at.level != Vec2(0, 0) || at.position.0 + at.sample_count > self.width {
            return Err(misplaced());
        }
        let start = at.position.1 * self.width + at.position.0;
        let places = start..start + at.sample_count;
        match &mut self.samples {
            FlatSamples::F16(all) => line.read_samples_into_slice(all.get_mut(places).ok_or_else(misplaced)?),
            FlatSamples::F32(all) => line.read_samples_into_slice(all.get_mut(places).ok_or_else(misplaced)?),
            FlatSamples::U32(all) => line.read_samples_into_slice(all.get_mut(places).ok_or_else(misplaced)?),
        }
    }

    fn into_samples(self) -> FlatSamples {
        self.samples
    }
}
