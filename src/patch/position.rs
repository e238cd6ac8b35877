//! Packs the position of a patch into one integer.

/// Marks a patch without a match.
pub const NONE: u32 = u32::MAX;

/// Packs a position into one integer.
#[inline]
pub fn pack(x: usize, y: usize) -> u32 {
    (y as u32) << 16 | x as u32
}

#[inline]
pub fn unpack(position: u32) -> (usize, usize) {
    ((position & 0xffff) as usize, (position >> 16) as usize)
}
