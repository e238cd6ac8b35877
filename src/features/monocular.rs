//! Estimates depth from a single photo with a network that the caller supplies, in the form in which MiDaS and DPT are
//! published as ONNX files (Ranftl et al. 2020, "Towards Robust Monocular Depth Estimation"; 2021, "Vision Transformers
//! for Dense Prediction").
//!
//! Input of the network, as in the published scripts: sRGB values in `[0, 1]`, resized to the network's input by cubic
//! convolution (slope -0.75, no low-pass filter), minus a mean, divided by a standard deviation. If the file leaves the
//! input size open, the aspect ratio is kept: the longer side becomes 384 pixels, the shorter side a multiple of 32.
//!
//! Output of the network: the map is resized to the photo by cubic convolution. Its values v are normalised to
//! `m = (v - min v) / (max v - min v)` and taken as inverse depth, `1/z = 1/far + m (1/near - 1/far)`. The nearest
//! pixel then lies on the near plane of [`Params`] and the farthest on the far plane; `1 - m` is the screen depth of
//! Eq. 1 (see `frustum`).
//!
//! Not modelled: the unknown offset of the network's inverse depth (the farthest pixel is put on the far plane
//! instead); networks that estimate depth in metres.

use super::clean;
use super::{DepthKind, DepthMap, DepthSource, Features, Input, Params};
use crate::error::{Error, ErrorKind, Result};
use crate::exec;
use crate::image::{Image, colour::linear_to_srgb};
use crate::job::Job;
use crate::network::{Network, Tensor, resize_cubic};
use std::sync::Arc;

/// The input normalisation with which the network was trained. The file does not record it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normalisation {
    /// Chosen by the input size, as for the published networks: [`Self::ImageNet`] for inputs of 256 x 256 (MiDaS
    /// small), else [`Self::Half`] (DPT).
    BySize,
    /// Subtract the mean of ImageNet's colours and divide by their standard deviation: MiDaS 2.1, large and small.
    ImageNet,
    /// Map `[0, 1]` to `[-1, 1]`: DPT.
    Half,
    /// Keep `[0, 1]` unchanged.
    None,
}

/// A network that estimates the relative inverse depth of a photo.
pub struct DepthNetwork {
    pub network: Network,
    pub normalisation: Normalisation,
}

/// Input size of networks that accept any size: length of the longer side (`OPEN_SIDE`), and a number of which both
/// sides are multiples (`MULTIPLE`).
const OPEN_SIDE: usize = 384;
const MULTIPLE: usize = 32;
/// Maximum number of rows and of columns of a network's input; networks with larger inputs are refused.
const MAX_INPUT_SIDE: usize = 4096;
/// Confidence in depth estimated by a network; measured depth has confidence 1. [convention]
const CONFIDENCE: f32 = 0.5;

impl DepthNetwork {
    /// Reads an ONNX file and checks that its input is a single image.
    pub fn parse(bytes: &[u8], normalisation: Normalisation) -> Result<Self> {
        let network = Self { network: Network::parse(bytes)?, normalisation };
        network.input_size(1, 1)?;
        Ok(network)
    }

    /// Returns the rows and columns of the network's input for a photo. Returns an error unless the input is a single
    /// RGB image with sides of at most `MAX_INPUT_SIDE`.
    fn input_size(&self, width: usize, height: usize) -> Result<[usize; 2]> {
        let shape = self.network.input_shape();
        let is = |size: Option<usize>, wanted: usize| size.is_none_or(|n| n == wanted);
        let &[batch, channels, rows, columns] = shape else { return Err(not_an_image(shape)) };
        let is_small = |size: Option<usize>| size.is_none_or(|n| n <= MAX_INPUT_SIDE);
        if !(is(batch, 1) && is(channels, 3) && is_small(rows) && is_small(columns)) {
            return Err(not_an_image(shape));
        }
        let longer = width.max(height) as f64;
        let open = |side: usize| {
            let scaled = OPEN_SIDE as f64 * side as f64 / longer / MULTIPLE as f64;
            (scaled.round() as usize * MULTIPLE).max(MULTIPLE)
        };
        Ok([rows.unwrap_or(open(height)), columns.unwrap_or(open(width))])
    }

    fn mean_and_deviation(&self, size: [usize; 2]) -> [[f32; 3]; 2] {
        match self.normalisation {
            Normalisation::BySize if size == [256, 256] => IMAGENET,
            Normalisation::ImageNet => IMAGENET,
            Normalisation::BySize | Normalisation::Half => [[0.5; 3]; 2],
            Normalisation::None => [[0.0; 3], [1.0; 3]],
        }
    }

    /// Estimates the depth along z of every pixel of a photo (linear RGB, 1 = display white). Returns an image with one
    /// channel and values from `near` to `far`.
    pub fn estimate(&self, photo: &Image, near: f32, far: f32, job: Job) -> Result<Image> {
        let (width, height) = (photo.width, photo.height);
        let [rows, columns] = self.input_size(width, height)?;
        let [mean, deviation] = self.mean_and_deviation([rows, columns]);

        // Encode the photo as planes of sRGB values, resize, then normalise.
        let (photo, _) = clean::clean(photo, job.part(0.0, 0.02))?;
        let mut planes = Image::new(width, height, 3)?;
        exec::for_rows(&mut planes.data, width, job.part(0.02, 0.05), |k, row| {
            let (channel, y) = (k / height, k % height);
            for (x, out) in row.iter_mut().enumerate() {
                *out = linear_to_srgb(photo.rgb(x, y)[channel].clamp(0.0, 1.0));
            }
        })?;
        let mut input = resize_cubic(&planes.data, 3, [height, width], [rows, columns], job.part(0.05, 0.1))?;
        drop(planes);
        for (plane, (mean, deviation)) in input.chunks_exact_mut(rows * columns).zip(mean.iter().zip(deviation)) {
            plane.iter_mut().for_each(|v| *v = (*v - mean) / deviation);
        }
        let input = Tensor::floats(vec![1, 3, rows, columns], input);
        let output = self.network.run(input, job.part(0.1, 0.95))?;

        // Check that the output is a single map, and resize it to the photo's size.
        let Some((before, &[map_height, map_width])) = output.shape.split_last_chunk::<2>() else {
            return Err(not_a_map(&output.shape));
        };
        if before.iter().any(|&n| n != 1) || map_height == 0 || map_width == 0 {
            return Err(not_a_map(&output.shape));
        }
        let values = output.as_floats()?;
        let bad = values.iter().filter(|v| !v.is_finite()).count();
        if bad > 0 {
            return Err(Error::degenerate(format!(
                "the network's map has {bad} values that are NaN or infinite; is its normalisation the right one?"
            )));
        }
        let mut map = resize_cubic(values, 1, [map_height, map_width], [height, width], job.part(0.95, 1.0))?;
        let lowest = map.iter().copied().fold(f32::INFINITY, f32::min);
        let highest = map.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        // A map that is constant up to rounding becomes a wall on the near plane.
        let range = highest - lowest;
        let is_constant = range <= 1e-5 * (highest.abs() + lowest.abs());
        let normalised = |v: f32| if !is_constant { ((v - lowest) / range).clamp(0.0, 1.0) } else { 1.0 };
        map.iter_mut().for_each(|v| *v = 1.0 / (1.0 / far + normalised(*v) * (1.0 / near - 1.0 / far)));
        Ok(Image { width, height, channels: 1, data: map })
    }
}

/// Mean and standard deviation of ImageNet's colours in `[0, 1]`. [convention]
const IMAGENET: [[f32; 3]; 2] = [[0.485, 0.456, 0.406], [0.229, 0.224, 0.225]];

fn not_an_image(shape: &[Option<usize>]) -> Error {
    let sizes: Vec<String> = shape.iter().map(|n| n.map_or("?".into(), |n| n.to_string())).collect();
    let message =
        format!("the network's input has shape [{}]; one image, [1, 3, rows, columns], is needed", sizes.join(", "));
    Error::new(ErrorKind::Unsupported, message)
}

fn not_a_map(shape: &[usize]) -> Error {
    Error::new(ErrorKind::Unsupported, format!("the network's output has shape {shape:?}; one map of depth is needed"))
}

/// Computes the features of a photo with depth from a network. Returns the features and the depth; ignores
/// `input.depth`.
pub fn run_with_network(input: &Input, network: &DepthNetwork, params: &Params, job: Job) -> Result<(Features, Image)> {
    params.check()?;
    let depth = network.estimate(input.photo, params.near, params.far, job.part(0.0, 0.9))?;
    let map = DepthMap { image: &depth, kind: DepthKind::AlongZ };
    let mut features = super::run(&Input { depth: Some(map), ..*input }, params, job.part(0.9, 1.0))?;
    features.depth_source = DepthSource::Network;
    Arc::make_mut(&mut features.depth_confidence).data.iter_mut().for_each(|c| *c *= CONFIDENCE);
    Ok((features, depth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::network::writer::{Setting, Writer};

    /// A network that outputs, for each pixel, (mean of the three input channels) - 3.
    fn file(rows: i64, columns: i64) -> Vec<u8> {
        let three = Tensor::floats(vec![], vec![3.0]);
        let axis = [Setting::Is("axes", &[1])];
        Writer::new(13, &[1, 3, rows, columns])
            .constant("three", &three)
            .node("ReduceMean", &["x"], "mean", &axis)
            .node("Sub", &["mean", "three"], "y", &[])
            .file()
    }

    fn estimate(file: &[u8], normalisation: Normalisation, photo: &Image) -> Result<Image> {
        DepthNetwork::parse(file, normalisation)?.estimate(photo, 1.0, 10.0, Monitor::default().job())
    }

    #[test]
    fn bright_is_near_and_dark_is_far_by_equation_1() {
        let ramp = |x: usize| crate::image::colour::srgb_to_linear(x as f32 / 63.0);
        let photo = Image::from_fn(64, 64, |x, _| [ramp(x); 3]).unwrap();
        for normalisation in [Normalisation::BySize, Normalisation::ImageNet, Normalisation::Half, Normalisation::None]
        {
            let depth = estimate(&file(64, 64), normalisation, &photo).unwrap();
            for (i, z) in depth.data.iter().enumerate() {
                let m = (i % 64) as f32 / 63.0;
                assert!((1.0 / z - (0.1 + 0.9 * m)).abs() < 1e-3, "{i} {z}");
            }
        }
    }

    #[test]
    fn sizes_are_those_of_the_file_or_keep_the_shape_of_the_photo() {
        let size = |rows, columns, photo: (usize, usize)| {
            DepthNetwork::parse(&file(rows, columns), Normalisation::BySize)
                .unwrap()
                .input_size(photo.0, photo.1)
                .unwrap()
        };
        assert_eq!(size(256, 320, (1000, 10)), [256, 320]);
        assert_eq!(size(0, 0, (1200, 800)), [256, 384]);
        assert_eq!(size(0, 0, (800, 1200)), [384, 256]);
        assert_eq!(size(0, 0, (65_536, 1)), [32, 384]);
        let by_size =
            |n| DepthNetwork::parse(&file(n, n), Normalisation::BySize).unwrap().mean_and_deviation([n as usize; 2]);
        assert_eq!((by_size(256), by_size(384)), (IMAGENET, [[0.5; 3]; 2]));
    }

    #[test]
    fn poor_photos_and_networks_of_other_kinds() {
        let nan = Image::from_fn(40, 30, |x, _| [if x < 20 { f32::NAN } else { 0.5 }; 3]).unwrap();
        for photo in [nan, Image::new(1, 1, 3).unwrap(), Image::new(1, 300, 1).unwrap()] {
            let depth = estimate(&file(32, 32), Normalisation::BySize, &photo).unwrap();
            assert!(depth.data.iter().all(|z| *z == 1.0), "what is constant is a wall on the near plane");
        }
        let photo = Image::new(8, 8, 3).unwrap();
        for shape in [vec![1, 1, 8, 8], vec![3, 8, 8], vec![2, 3, 8, 8], vec![1, 3, 8, 5000]] {
            let error =
                estimate(&Writer::new(13, &shape).node("Relu", &["x"], "y", &[]).file(), Normalisation::None, &photo);
            assert_eq!(error.unwrap_err().kind, ErrorKind::Unsupported);
        }
        let three = Writer::new(13, &[1, 3, 8, 8]).node("Relu", &["x"], "y", &[]).file();
        assert_eq!(estimate(&three, Normalisation::None, &photo).unwrap_err().kind, ErrorKind::Unsupported);
        let log = Writer::new(13, &[1, 3, 8, 8])
            .node("Log", &["x"], "log", &[])
            .node("ReduceMean", &["log"], "y", &[Setting::Is("axes", &[1])])
            .file();
        assert_eq!(estimate(&log, Normalisation::None, &photo).unwrap_err().kind, ErrorKind::Degenerate);
    }

    #[test]
    fn features_say_where_their_depth_is_from() {
        let photo = Image::from_fn(48, 32, |x, y| [x as f32 / 48.0, y as f32 / 32.0, 0.5]).unwrap();
        let network = DepthNetwork::parse(&file(32, 32), Normalisation::BySize).unwrap();
        let input = Input { photo: &photo, depth: None, room: None };
        let monitor = Monitor::default();
        let (features, depth) = run_with_network(&input, &network, &Params::default(), monitor.job()).unwrap();
        assert_eq!(features.depth_source, DepthSource::Network);
        assert!(features.depth_confidence.data.iter().all(|c| *c == CONFIDENCE));
        assert!(depth.data.iter().all(|z| (1.0..=10.0).contains(z)));
        monitor.cancel();
        assert!(run_with_network(&input, &network, &Params::default(), monitor.job()).is_err());
    }
}
