//! Decompresses one chunk (strip or tile) of a TIFF's pixels, and undoes its predictor.

use super::ifd::Order;
use super::pixel_tags::{Compression, Depth, PixelTags, Predictor};
use crate::error::{Error, Result};
use half::f16;
use miniz_oxide::inflate::decompress_slice_iter_to_slice;
use weezl::{BitOrder, LzwStatus};

/// Decompresses the stored bytes until `out` is full; returns an error if they end too early.
pub fn unpack(stored: &[u8], compression: Compression, out: &mut [u8]) -> Result<()> {
    let needed = out.len();
    let written = match compression {
        Compression::None => {
            let len = needed.min(stored.len());
            out[..len].copy_from_slice(&stored[..len]);
            len
        }
        Compression::PackBits => packbits(stored, out),
        Compression::Lzw => lzw(stored, out),
        // With the status `HasMoreOutput`, the file stores more bytes than needed and the chunk is complete.
        Compression::Deflate => match decompress_slice_iter_to_slice(out, std::iter::once(stored), true, true) {
            Ok(written) => written,
            Err(miniz_oxide::inflate::TINFLStatus::HasMoreOutput) => needed,
            Err(_) => 0,
        },
    };
    if written == needed {
        return Ok(());
    }
    Err(Error::format(format!("the TIFF's pixels are damaged ({compression:?}): {needed} bytes were expected")))
}

/// Decompresses PackBits, which consists of runs of literal bytes and runs of equal bytes (TIFF 6.0, section 9).
/// Returns the number of bytes written.
fn packbits(mut stored: &[u8], out: &mut [u8]) -> usize {
    let mut at = 0;
    while let Some((&head, rest)) = stored.split_first().filter(|_| at < out.len()) {
        let (run, is_literal) = match head as i8 {
            -128 => (0, true),
            n @ 0.. => (n as usize + 1, true),
            n => (usize::from(n.unsigned_abs()) + 1, false),
        };
        let run = run.min(out.len() - at);
        let taken = if is_literal { run } else { 1 };
        let Some((source, rest)) = rest.split_at_checked(taken) else { break };
        let target = &mut out[at..at + run];
        if is_literal {
            target.copy_from_slice(source)
        } else {
            target.fill(source[0])
        }
        at += run;
        stored = rest;
    }
    at
}

/// Decompresses LZW; returns the number of bytes written.
fn lzw(stored: &[u8], out: &mut [u8]) -> usize {
    let mut decoder = weezl::decode::Decoder::with_tiff_size_switch(BitOrder::Msb, 8);
    let (mut from, mut to) = (0, 0);
    while to < out.len() {
        let step = decoder.decode_bytes(&stored[from..], &mut out[to..]);
        from += step.consumed_in;
        to += step.consumed_out;
        let is_stuck = step.consumed_in == 0 && step.consumed_out == 0;
        if is_stuck || !matches!(step.status, Ok(LzwStatus::Ok)) {
            break;
        }
    }
    to
}

/// Undoes the predictor of a row in place, with scratch memory `spare` of the same length. Returns the byte order that
/// the samples then have.
pub fn undo_predictor(row: &mut [u8], spare: &mut [u8], tags: &PixelTags, order: Order) -> Order {
    let samples = tags.samples;
    match (tags.predictor, tags.depth.bits() / 8) {
        (Predictor::None, _) => order,
        // Horizontal: each sample is stored as its difference from the same channel of the pixel to the left.
        (Predictor::Horizontal, 1) => {
            for i in samples..row.len() {
                row[i] = row[i].wrapping_add(row[i - samples]);
            }
            order
        }
        (Predictor::Horizontal, size) => {
            // Add numbers of any size byte by byte, from the lowest byte up.
            let byte = |k: usize| if order == Order::Little { k } else { size - 1 - k };
            for start in (samples * size..row.len()).step_by(size) {
                let mut carry = 0;
                for k in 0..size {
                    let at = start + byte(k);
                    let sum = u16::from(row[at]) + u16::from(row[at - samples * size]) + carry;
                    row[at] = sum as u8;
                    carry = sum >> 8;
                }
            }
            order
        }
        // Floating point: the row stores the highest bytes of all samples first, then the next lower bytes, and so on.
        // Each byte is stored as the difference from the byte before it in the same channel.
        (Predictor::Float, size) => {
            for i in samples..row.len() {
                row[i] = row[i].wrapping_add(row[i - samples]);
            }
            spare.copy_from_slice(row);
            let count = row.len() / size;
            for (i, sample) in row.chunks_exact_mut(size).enumerate() {
                for (k, byte) in sample.iter_mut().enumerate() {
                    *byte = spare[k * count + i];
                }
            }
            Order::Big
        }
    }
}

/// Returns a sample of a row by its index. Integers are scaled to `[0, 1]`.
pub fn sample(row: &[u8], index: usize, depth: Depth, order: Order) -> f32 {
    match depth {
        Depth::Bits(bits) => {
            let (bits, mask) = (usize::from(bits), (1u8 << bits) - 1);
            let at = index * bits;
            f32::from(row[at / 8] >> (8 - bits - at % 8) & mask) / f32::from(mask)
        }
        Depth::U8 => f32::from(row[index]) / 255.0,
        Depth::U16 => f32::from(order.u16(bytes(row, index))) / 65_535.0,
        Depth::U32 => (f64::from(order.u32(bytes(row, index))) / f64::from(u32::MAX)) as f32,
        Depth::F16 => f16::from_bits(order.u16(bytes(row, index))).to_f32(),
        Depth::F32 => f32::from_bits(order.u32(bytes(row, index))),
        Depth::F64 => f64::from_bits(order.u64(bytes(row, index))) as f32,
    }
}

fn bytes<const N: usize>(row: &[u8], index: usize) -> [u8; N] {
    std::array::from_fn(|k| row[index * N + k])
}
