//! Converts amounts of cyan, magenta, yellow and black to linear Rec.709, by the tables of an ICC profile (ICC.1:2022,
//! 10.10 and 10.11, `lut16Type` and `lut8Type`): a curve for each ink, a grid of colours, and a curve for each
//! coordinate of CIELAB or CIE XYZ.
//!
//! The crate `moxcms` would resample these tables on its own grid, with errors of up to 12 codes of 255. It is
//! therefore used only to read the tables, and this module interpolates them. As in LCMS, the interpolation is
//! tetrahedral in magenta, yellow and black (Kasson, Nin, Plouffe and Hafner 1995), and linear in cyan.
//!
//! Not modelled: profiles whose tables are `lutAToBType`. They count as unusable.

use super::chromaticities::of_colorants;
use crate::error::Result;
use crate::image::{Image, try_collect};
use glam::{DMat3, Mat3, Vec3};
use moxcms::{ColorProfile, DataColorSpace, LutDataType, LutStore, LutType, LutWarehouse, RenderingIntent};

const INKS: usize = 4;

/// CIE XYZ of the white in the profile connection space (ICC.1:2022, 7.2.16). [convention: ICC]
const D50: Vec3 = Vec3::new(0.9642, 1.0, 0.8249);

/// The tables that convert a picture of four inks.
#[derive(Clone)]
pub struct Inks {
    /// Curves of the four inks, of equal length, one after another.
    curves: Vec<f32>,
    /// Number of grid points along each axis of `colours`; the index of black runs fastest.
    size: usize,
    colours: Vec<Vec3>,
    /// Curves of the three output coordinates, of equal length, one after another.
    output: Vec<f32>,
    /// The CIELAB or CIE XYZ values for encoded coordinates of 0 and of 1.
    range: [Vec3; 2],
    is_lab: bool,
    to_rec709: Mat3,
}

impl Inks {
    /// Reads the tables of a profile for a rendering intent; `None` if the profile has no usable tables for this
    /// intent.
    pub fn new(profile: &ColorProfile, intent: RenderingIntent) -> Result<Option<Self>> {
        let tables = match intent {
            RenderingIntent::RelativeColorimetric => &profile.lut_a_to_b_colorimetric,
            RenderingIntent::Saturation => &profile.lut_a_to_b_saturation,
            _ => &profile.lut_a_to_b_perceptual,
        };
        match (tables, of_colorants(DMat3::IDENTITY)) {
            (Some(LutWarehouse::Lut(tables)), Some(to_rec709)) => {
                Self::of_tables(tables, profile.pcs == DataColorSpace::Lab, to_rec709.as_mat3())
            }
            _ => Ok(None),
        }
    }

    fn of_tables(tables: &LutDataType, is_lab: bool, to_rec709: Mat3) -> Result<Option<Self>> {
        let size = usize::from(tables.num_clut_grid_points);
        let (curves, output) = (numbers(&tables.input_table)?, numbers(&tables.output_table)?);
        let stored = numbers(&tables.clut_table)?;
        let colours = try_collect(stored.as_chunks().0.iter().map(|&colour| Vec3::from_array(colour)))?;
        let is_whole = usize::from(tables.num_input_channels) == INKS
            && tables.num_output_channels == 3
            && (2..=255).contains(&size)
            && colours.len() == size.pow(INKS as u32)
            && curves.len() >= 2 * INKS
            && output.len() >= 2 * 3
            && curves.len() % INKS == 0
            && output.len() % 3 == 0;
        // CIELAB with 8 bits: the highest code is L = 100 and a = b = 127. CIELAB with 16 bits: L = 100 is the code
        // 0xff00, and a = b = 0 is 0x8000. CIE XYZ: X = Y = Z = 1 is the 16-bit code 0x8000 (ICC.1:2022, 6.3.4 and
        // 10.10).
        let low = Vec3::new(0.0, -128.0, -128.0);
        let range = match tables.lut_type {
            _ if !is_lab => [Vec3::ZERO, Vec3::splat(65_535.0 / 32_768.0)],
            LutType::Lut8 => [low, Vec3::new(100.0, 127.0, 127.0)],
            _ => [low, low + Vec3::new(100.0 * 65_535.0 / 65_280.0, 65_535.0 / 256.0, 65_535.0 / 256.0)],
        };
        Ok(is_whole.then_some(Self { curves, size, colours, output, range, is_lab, to_rec709 }))
    }

    /// Converts a picture of four inks to linear Rec.709.
    pub fn apply(&self, inks: &Image) -> Result<Image> {
        let mut image = Image::new(inks.width, inks.height, 3)?;
        for (pixel, amounts) in image.data.as_chunks_mut::<3>().0.iter_mut().zip(inks.data.as_chunks::<INKS>().0) {
            *pixel = self.colour(*amounts).max(Vec3::ZERO).to_array();
        }
        Ok(image)
    }

    fn colour(&self, amounts: [f32; INKS]) -> Vec3 {
        let count = self.curves.len() / INKS;
        let mut cell = [0; INKS];
        let mut part = [0.0; INKS];
        for (ink, &amount) in amounts.iter().enumerate() {
            let along = curve(&self.curves[ink * count..][..count], amount).clamp(0.0, 1.0) * (self.size - 1) as f32;
            cell[ink] = (along as usize).min(self.size - 2);
            part[ink] = along - cell[ink] as f32;
        }
        let (low, high) =
            (self.tetrahedron(cell, part), self.tetrahedron([cell[0] + 1, cell[1], cell[2], cell[3]], part));
        let count = self.output.len() / 3;
        let mut encoded = low.lerp(high, part[0]).to_array();
        for (axis, v) in encoded.iter_mut().enumerate() {
            *v = curve(&self.output[axis * count..][..count], *v);
        }
        let colour = self.range[0] + Vec3::from_array(encoded) * (self.range[1] - self.range[0]);
        self.to_rec709 * if self.is_lab { xyz(colour) } else { colour }
    }

    /// Interpolates in magenta, yellow and black at one grid point of cyan. Starts with the colour at the low corner of
    /// `cell`. Then steps to the next grid point along one axis after another, in descending order of the axes'
    /// fractions `part`. Each step adds the difference between the colours of its two grid points, multiplied by the
    /// fraction of its axis.
    fn tetrahedron(&self, cell: [usize; INKS], part: [f32; INKS]) -> Vec3 {
        let mut axes = [1, 2, 3];
        axes.sort_unstable_by(|&a, &b| part[b].total_cmp(&part[a]));
        let mut corner = cell;
        let mut last = self.point(corner);
        let mut sum = last;
        for axis in axes {
            corner[axis] += 1;
            let next = self.point(corner);
            sum += part[axis] * (next - last);
            last = next;
        }
        sum
    }

    fn point(&self, at: [usize; INKS]) -> Vec3 {
        self.colours[at.iter().fold(0, |index, i| index * self.size + i)]
    }
}

/// Returns the samples of a table, scaled to `[0, 1]`.
fn numbers(store: &LutStore) -> Result<Vec<f32>> {
    match store {
        LutStore::Store8(codes) => try_collect(codes.iter().map(|&code| f32::from(code) / 255.0)),
        LutStore::Store16(codes) => try_collect(codes.iter().map(|&code| f32::from(code) / 65_535.0)),
    }
}

/// Interpolates a curve sampled over `[0, 1]`. A position outside is clamped, and NaN counts as 0.
fn curve(samples: &[f32], at: f32) -> f32 {
    let within = if at > 0.0 { at.min(1.0) } else { 0.0 };
    let along = within * (samples.len() - 1) as f32;
    let first = (along as usize).min(samples.len() - 2);
    samples[first] + (along - first as f32) * (samples[first + 1] - samples[first])
}

/// Converts CIELAB to CIE XYZ, both under D50 (CIE 15:2018, 8.2.1).
fn xyz(lab: Vec3) -> Vec3 {
    let y = (lab.x + 16.0) / 116.0;
    let root = Vec3::new(y + lab.y / 500.0, y, y - lab.z / 200.0);
    // For small values, the curve of CIELAB is a straight line of slope 108 / 841 instead of a cube.
    // [convention: CIE 15:2018, 8.2.1]
    let linear = (root - 4.0 / 29.0) * (108.0 / 841.0);
    D50 * Vec3::select(root.cmpgt(Vec3::splat(6.0 / 29.0)), root * root * root, linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile whose lightness falls with the amounts of cyan and black. Paper without ink is white; full black ink
    /// is black.
    fn inks() -> Inks {
        let size: usize = 3;
        let mut colours = Vec::new();
        for index in 0..size.pow(4) {
            let amount = |axis: u32| (index / size.pow(3 - axis) % size) as f32 / (size - 1) as f32;
            let lightness = (1.0 - amount(3)) * (1.0 - 0.5 * amount(0));
            colours.push(Vec3::new(lightness, 128.0 / 255.0, 128.0 / 255.0));
        }
        let ramp = |count: usize| [0.0, 1.0].repeat(count);
        let range = [Vec3::new(0.0, -128.0, -128.0), Vec3::new(100.0, 127.0, 127.0)];
        let to_rec709 = of_colorants(DMat3::IDENTITY).unwrap().as_mat3();
        Inks { curves: ramp(4), size, colours, output: ramp(3), range, is_lab: true, to_rec709 }
    }

    #[test]
    fn paper_is_white_and_black_ink_black() {
        let inks = inks();
        assert!((inks.colour([0.0; 4]) - Vec3::ONE).abs().max_element() < 2e-3);
        assert!(inks.colour([0.0, 0.0, 0.0, 1.0]).abs().max_element() < 1e-5);
        // A lightness of L = 50 means Y = ((50 + 16) / 116)^3.
        for amounts in [[0.0, 0.7, 0.2, 0.5], [1.0, 0.1, 0.9, 0.0]] {
            assert!((inks.colour(amounts) - 0.1842).abs().max_element() < 1e-3, "{amounts:?}");
        }
        // Test amounts between the grid points, and amounts that are NaN or outside `[0, 1]`.
        assert!((inks.colour([0.25, 0.0, 0.0, 0.25]).y - ((65.625f32 + 16.0) / 116.0).powi(3)).abs() < 2e-3);
        assert_eq!(inks.colour([f32::NAN, 2.0, -1.0, 0.0]), inks.colour([0.0, 1.0, 0.0, 0.0]));
    }
}
