use super::ifd::Order;
use super::ifd::tests::{Entry, structure, writers};
use super::{decode, decode_inks, has_inks, probe};
use crate::error::ErrorKind;
use crate::image::colour::srgb_to_linear;
use crate::image::io::Encoding;
use crate::image::orientation::Orientation;
use half::f16;

/// A test picture and the settings with which it is stored as a TIFF.
#[derive(Clone)]
struct Picture {
    order: Order,
    size: [usize; 2],
    samples: usize,
    /// Bits per sample, and the sample format: 1 for integers, 3 for floating point.
    depth: (u16, u16),
    photometric: u16,
    compression: u16,
    predictor: u16,
    is_planar: bool,
    /// Rows per strip, unless `tile` gives the size of a tile.
    strip: usize,
    tile: Option<[usize; 2]>,
    more: Vec<Entry>,
}

/// Returns the value of a sample, in [0, 1].
fn value(x: usize, y: usize, s: usize) -> f64 {
    ((x * 37 + y * 11 + s * 71) % 101) as f64 / 100.0
}

impl Picture {
    fn new(samples: usize, bits: u16, format: u16, photometric: u16) -> Self {
        Self {
            order: Order::Little,
            size: [7, 5],
            samples,
            depth: (bits, format),
            photometric,
            compression: 1,
            predictor: 1,
            is_planar: false,
            strip: 2,
            tile: None,
            more: vec![],
        }
    }

    /// Returns the bytes of a sample as the file stores them.
    fn stored(&self, value: f64) -> Vec<u8> {
        let (_, u16, u32) = writers(self.order);
        match self.depth {
            (8, 1) => vec![(value * 255.0).round() as u8],
            (16, 1) => u16((value * 65_535.0).round() as u16),
            (32, 1) => u32((value * f64::from(u32::MAX)).round() as u32),
            (16, 3) => u16(f16::from_f64(value).to_bits()),
            (32, 3) => u32((value as f32).to_bits()),
            (64, 3) if self.order == Order::Little => value.to_le_bytes().to_vec(),
            (64, 3) => value.to_be_bytes().to_vec(),
            (bits, _) => vec![(value * f64::from((1 << bits) - 1)).round() as u8],
        }
    }

    /// Returns the value that is read back after rounding to the file's number format.
    fn kept(&self, value: f64) -> f32 {
        let steps = match self.depth {
            (_, 3) => return if self.depth.0 == 16 { f16::from_f64(value).to_f32() } else { value as f32 },
            (32, _) => f64::from(u32::MAX),
            (bits, _) => f64::from((1u32 << bits) - 1),
        };
        ((value * steps).round() / steps) as f32
    }

    /// Returns a chunk before compression, as rows of bytes. Samples outside the picture are 0.
    fn rows(&self, [x0, y0]: [usize; 2], [width, height]: [usize; 2], samples: std::ops::Range<usize>) -> Vec<Vec<u8>> {
        let row = |y: usize| {
            let mut out: Vec<Vec<u8>> = vec![];
            for x in x0..x0 + width {
                let inside = x < self.size[0] && y < self.size[1];
                out.extend(samples.clone().map(|s| self.stored(if inside { value(x, y, s) } else { 0.0 })));
            }
            if self.depth.0 >= 8 {
                return self.predict(&out, samples.len());
            }
            // Pack several samples into each byte, the first in the highest bits.
            let bits = usize::from(self.depth.0);
            let per = 8 / bits;
            out.chunks(per).map(|c| (0..c.len()).fold(0, |b, k| b | c[k][0] << (8 - bits * (k + 1)))).collect()
        };
        (y0..y0 + height).map(row).collect()
    }

    fn predict(&self, row: &[Vec<u8>], samples: usize) -> Vec<u8> {
        let size = row[0].len();
        match self.predictor {
            1 => row.concat(),
            2 => {
                let number = |b: &[u8]| {
                    let sum = |sum: u64, b: &u8| sum << 8 | u64::from(*b);
                    if self.order == Order::Big { b.iter().fold(0, sum) } else { b.iter().rev().fold(0, sum) }
                };
                let difference = |i: usize| {
                    let left = if i < samples { 0 } else { number(&row[i - samples]) };
                    let bytes = number(&row[i]).wrapping_sub(left).to_le_bytes();
                    let mut bytes = bytes[..size].to_vec();
                    if self.order == Order::Big {
                        bytes.reverse();
                    }
                    bytes
                };
                (0..row.len()).flat_map(difference).collect()
            }
            _ => {
                let highest = |k: usize| if self.order == Order::Big { k } else { size - 1 - k };
                let planes: Vec<u8> = (0..size).flat_map(|k| row.iter().map(move |v| v[highest(k)])).collect();
                let left = |i: usize| if i < samples { 0 } else { planes[i - samples] };
                (0..planes.len()).map(|i| planes[i].wrapping_sub(left(i))).collect()
            }
        }
    }

    fn pack(&self, bytes: &[u8]) -> Vec<u8> {
        match self.compression {
            1 => bytes.to_vec(),
            5 => weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(bytes).unwrap(),
            8 => miniz_oxide::deflate::compress_to_vec_zlib(bytes, 6),
            // PackBits: write equal pairs as runs. Write other bytes literally, followed by the code 128, which does
            // nothing.
            _ => bytes
                .chunks(2)
                .flat_map(|c| {
                    if c.len() == 2 && c[0] == c[1] {
                        vec![255, c[0]]
                    } else {
                        [&[c.len() as u8 - 1], c, &[128]].concat()
                    }
                })
                .collect(),
        }
    }

    fn file(&self) -> Vec<u8> {
        let (_, u16, u32) = writers(self.order);
        let size = self.tile.unwrap_or([self.size[0], self.strip]);
        let all = 0..self.samples;
        let planes = if self.is_planar { all.map(|s| s..s + 1).collect() } else { vec![all] };
        let mut chunks = vec![];
        for samples in planes {
            for y in (0..self.size[1]).step_by(size[1]) {
                for x in (0..self.size[0]).step_by(size[0]) {
                    let height = if self.tile.is_some() { size[1] } else { size[1].min(self.size[1] - y) };
                    chunks.push(self.pack(&self.rows([x, y], [size[0], height], samples.clone()).concat()));
                }
            }
        }
        let shorts = |v: u16| (0..self.samples).flat_map(|_| u16(v)).collect::<Vec<u8>>();
        let longs = |v: &[usize]| v.iter().flat_map(|v| u32(*v as u32)).collect::<Vec<u8>>();
        let sizes: Vec<usize> = chunks.iter().map(Vec::len).collect();
        let entries = |offsets: &[usize]| {
            let mut entries = vec![
                (256, 3, u16(self.size[0] as u16)),
                (257, 4, u32(self.size[1] as u32)),
                (258, 3, shorts(self.depth.0)),
                (259, 3, u16(self.compression)),
                (262, 3, u16(self.photometric)),
                (277, 3, u16(self.samples as u16)),
                (284, 3, u16(if self.is_planar { 2 } else { 1 })),
                (317, 3, u16(self.predictor)),
                (339, 3, shorts(self.depth.1)),
            ];
            match self.tile {
                Some([width, height]) => entries.extend([
                    (322, 4, u32(width as u32)),
                    (323, 4, u32(height as u32)),
                    (324, 4, longs(offsets)),
                    (325, 4, longs(&sizes)),
                ]),
                None => entries.extend([
                    (273, 4, longs(offsets)),
                    (278, 4, u32(self.strip as u32)),
                    (279, 4, longs(&sizes)),
                ]),
            }
            entries.extend(self.more.clone());
            entries
        };
        let head = structure(self.order, &entries(&sizes)).len();
        let offsets: Vec<usize> = sizes.iter().scan(head, |at, s| Some(std::mem::replace(at, *at + s))).collect();
        [structure(self.order, &entries(&offsets)), chunks.concat()].concat()
    }

    /// Checks that reading returns the samples that `expected` computes for each pixel and channel.
    fn check(&self, channels: usize, expected: impl Fn(&Self, usize, usize, usize) -> f32) {
        let file = self.file();
        assert_eq!(probe(&file).unwrap(), (self.size[0], self.size[1], channels));
        let image = decode(&file, Encoding::Linear, Orientation::UPRIGHT).unwrap();
        assert_eq!((image.width, image.height, image.channels), (self.size[0], self.size[1], channels));
        for y in 0..self.size[1] {
            for x in 0..self.size[0] {
                for (c, v) in image.pixel(x, y).iter().enumerate() {
                    let wanted = expected(self, x, y, c);
                    assert!((v - wanted).abs() < 1e-6, "({x}, {y}) {c}: {v} instead of {wanted}");
                }
            }
        }
    }
}

fn sample(p: &Picture, x: usize, y: usize, s: usize) -> f32 {
    p.kept(value(x, y, s))
}

#[test]
fn every_depth_compression_predictor_and_layout_gives_its_samples_back() {
    for order in [Order::Little, Order::Big] {
        for depth in [(8, 1), (16, 1), (32, 1), (16, 3), (32, 3), (64, 3)] {
            for compression in [1, 5, 8, 32_773] {
                for predictor in if depth.1 == 3 { 1..=3 } else { 1..=2 } {
                    for (tile, strip, is_planar) in
                        [(None, 2, false), (None, 9, true), (Some([16, 16]), 0, false), (Some([3, 4]), 0, true)]
                    {
                        let plain = Picture::new(3, depth.0, depth.1, 2);
                        Picture { order, compression, predictor, is_planar, strip, tile, ..plain }.check(3, sample);
                    }
                }
            }
        }
    }
}

#[test]
fn grey_bits_palettes_and_cmyk_are_converted() {
    for bits in [1, 2, 4, 8, 16] {
        Picture::new(1, bits, 1, 1).check(1, sample);
        Picture::new(1, bits, 1, 0).check(1, |p, x, y, s| 1.0 - sample(p, x, y, s));
    }
    for bits in [1, 2, 4, 8] {
        let size = 1usize << bits;
        // In this palette, higher codes are redder and less blue.
        let map = |c: usize, i: usize| [i, 7, size - 1 - i][c] * 65_535 / (size - 1);
        let values = (0..3).flat_map(|c| (0..size).flat_map(move |i| (map(c, i) as u16).to_le_bytes())).collect();
        let picture = Picture { more: vec![(320, 3, values)], ..Picture::new(1, bits, 1, 3) };
        if size > 7 {
            picture.check(3, |p, x, y, c| {
                map(c, (sample(p, x, y, 0) * (size - 1) as f32).round() as usize) as f32 / 65_535.0
            });
        }
    }
    let inks = Picture::new(4, 8, 1, 5);
    inks.check(3, |p, x, y, c| (1.0 - sample(p, x, y, c)) * (1.0 - sample(p, x, y, 3)));
    // Without conversion to RGB, the amounts of the inks themselves are read.
    let file = inks.file();
    let amounts = decode_inks(&file, Orientation::UPRIGHT).unwrap();
    assert!(has_inks(&file) && !has_inks(&Picture::new(4, 8, 1, 2).file()));
    for (x, c) in [(0, 0), (1, 1), (2, 2), (2, 3)] {
        assert!((amounts.pixel(x, 1)[c] - sample(&inks, x, 1, c)).abs() < 1e-6);
    }
}

#[test]
fn alpha_is_kept_and_undone_where_colours_were_multiplied_by_it() {
    let extra = |kind: u16| vec![(338, 3, kind.to_le_bytes().to_vec())];
    for is_planar in [false, true] {
        let with =
            |samples, photometric, more| Picture { is_planar, more, ..Picture::new(samples, 16, 1, photometric) };
        with(4, 2, extra(2)).check(4, sample);
        with(4, 2, vec![]).check(4, sample);
        with(4, 2, extra(0)).check(3, sample);
        with(2, 1, extra(2)).check(4, |p, x, y, c| sample(p, x, y, c / 3));
        with(2, 1, extra(0)).check(1, sample);
        with(4, 2, extra(1)).check(4, |p, x, y, c| {
            let alpha = sample(p, x, y, 3);
            if c == 3 || alpha == 0.0 { sample(p, x, y, c) } else { (sample(p, x, y, c) / alpha).min(1.0) }
        });
    }
}

#[test]
fn integers_are_decoded_as_srgb_and_floating_point_is_linear() {
    for (bits, format) in [(8, 1), (16, 1), (32, 3)] {
        let picture = Picture { more: vec![(338, 3, vec![2, 0])], ..Picture::new(4, bits, format, 2) };
        let image = decode(&picture.file(), Encoding::Srgb, Orientation::UPRIGHT).unwrap();
        for (c, v) in image.pixel(3, 2).iter().enumerate() {
            let encoded = sample(&picture, 3, 2, c);
            let wanted = if format == 3 || c == 3 { encoded } else { srgb_to_linear(encoded) };
            assert!((v - wanted).abs() < 1e-6);
        }
    }
    // In orientation 6, the last stored row becomes the first column.
    let picture = Picture::new(3, 8, 1, 2);
    let image = decode(&picture.file(), Encoding::Linear, Orientation::new(6).unwrap()).unwrap();
    assert_eq!((image.width, image.height), (5, 7));
    assert_eq!(image.pixel(0, 2)[1], sample(&picture, 2, 4, 1));
}

#[test]
fn truncated_and_inconsistent_files_are_errors() {
    for compression in [1, 5, 8, 32_773] {
        let file = Picture { compression, ..Picture::new(3, 16, 1, 2) }.file();
        for cut in 0..file.len() {
            let error = decode(&file[..cut], Encoding::Srgb, Orientation::UPRIGHT);
            // The last bytes of a compressed strip may contain only the end mark, which is not needed.
            assert!(error.is_err() || cut + 6 > file.len() && compression != 1, "{compression} cut at {cut}");
        }
        // Change every byte: the result is an error, or a picture no larger than the file can hold.
        let plain = Picture { compression, size: [7, 5], ..Picture::new(3, 16, 1, 2) }.file();
        for at in 0..plain.len() {
            for value in [0, 1, 2, 5, 8, 32, 127, 255] {
                let mut bad = plain.clone();
                bad[at] = value;
                if let Ok(image) = decode(&bad, Encoding::Srgb, Orientation::UPRIGHT) {
                    assert!(image.width * image.height * 3 / 8 <= 1400 * plain.len(), "{at} = {value}");
                }
            }
        }
    }
    // Absurd sizes, counts and samples must not cause an allocation.
    for (tag, value) in [(256, 60_000), (257, 1 << 20), (257, 60_000), (277, 60_000), (322, 1 << 20), (323, 0)] {
        let tiled = Picture { tile: Some([16, 16]), compression: 8, ..Picture::new(3, 8, 1, 2) };
        let mut file = tiled.file();
        let at = (10..200).step_by(12).find(|&at| file[at..at + 2] == u16::to_le_bytes(tag)).unwrap();
        file[at + 2..at + 12].copy_from_slice(&[&[4, 0, 1, 0, 0, 0][..], &u32::to_le_bytes(value)].concat());
        let error = probe(&file).unwrap_err();
        let is_past_limits = error.message.contains("sides must lie in");
        let kind = if is_past_limits { ErrorKind::Unsupported } else { ErrorKind::Format };
        assert_eq!(error.kind, kind, "{tag}: {error}");
    }
}

#[test]
fn unsupported_features_are_named() {
    let plain = Picture::new(3, 8, 1, 2);
    let bytes = |v: u16| v.to_le_bytes().to_vec();
    for (picture, name) in [
        (Picture { photometric: 6, ..plain.clone() }, "YCbCr"),
        (Picture { photometric: 8, ..plain.clone() }, "CIELAB"),
        (Picture { photometric: 32_803, ..plain.clone() }, "a sensor's own"),
        (Picture { depth: (8, 2), ..plain.clone() }, "SampleFormat 2"),
        (Picture { more: vec![(254, 3, bytes(1))], ..plain.clone() }, "raw data"),
        (Picture { more: vec![(50_706, 1, vec![1, 4, 0, 0])], ..plain.clone() }, "raw data"),
        (Picture { more: vec![(266, 3, bytes(2))], ..plain.clone() }, "FillOrder 2"),
        (Picture { is_planar: true, samples: 4, photometric: 5, ..plain.clone() }, "CMYK in separate planes"),
    ] {
        let error = probe(&picture.file()).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains(name), "{error}");
    }
    // Change only the tag that names the compression: this test has no encoder for these compressions.
    let mut file = plain.file();
    assert_eq!(file[46..48], bytes(259));
    for (code, name) in [(7, "JPEG"), (4, "fax"), (50_000, "Zstandard")] {
        file[54..56].copy_from_slice(&bytes(code));
        let error = probe(&file).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains(name), "{error}");
    }
    for (picture, name) in [
        (Picture { photometric: 2, samples: 2, ..plain.clone() }, "2 samples"),
        (Picture { more: vec![(320, 3, vec![0; 96])], ..Picture::new(1, 8, 1, 3) }, "48 values"),
    ] {
        let error = probe(&picture.file()).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains(name), "{error}");
    }
}
