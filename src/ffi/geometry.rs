//! Plane geometry
//!
//! Homographies map points between two views of a plane. They are 3 x 3 matrices of homogeneous coordinates, stored
//! row by row. Points are in pixels, x to the right, y down; the centre of the top-left pixel is (0.5, 0.5). These
//! calls are synchronous: they do their work before they return.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::pointer::{Out, bytes, bytes_mut};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::geometry::Homography;
use crate::image::MAX_SIDE;
use crate::rectify;
use glam::{DMat3, DVec2};

/// Computes the homography that maps four points to four other points. The array from holds x and y of the four points,
/// 8 doubles; the array to holds x and y of the points to which they are mapped, in the same order. homography receives
/// the nine entries of the matrix, row by row, scaled to unit Frobenius norm. Any thread.
/// LUXFER_DEGENERATE if three points of one array lie on one line or two coincide, or if a coordinate is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_homography_from_corners(
    context: *mut luxfer_context,
    from: *const f64,
    to: *const f64,
    homography: *mut f64,
) -> luxfer_status {
    enter(context, |_| {
        let out = bytes_mut(homography.cast(), 9 * size_of::<f64>(), "homography")?;
        let found = Homography::from_corners(corners(from, "from")?, corners(to, "to")?)?;
        for (place, value) in out.chunks_exact_mut(size_of::<f64>()).zip(found.0.transpose().to_cols_array()) {
            place.copy_from_slice(&value.to_ne_bytes());
        }
        Ok(())
    })
}

/// Warps an image by a homography into a new image of width x height pixels, each in [1, 65536]. to_source is the
/// homography from points of the new image to points of the source: nine matrix entries, row by row. Each pixel of the
/// new image takes the value of the source at the point to which its centre is mapped, or 0 if that point lies outside
/// the source. The source is interpolated where it is magnified, and averaged over the pixel's footprint where it is
/// minified. The call takes a few milliseconds per megapixel. The caller releases *warped. Any thread.
/// LUXFER_INVALID_ARGUMENT if an entry is not finite or a size is out of range; LUXFER_OUT_OF_MEMORY beyond the memory
/// budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_warp(
    source: *mut luxfer_image,
    to_source: *const f64,
    width: u32,
    height: u32,
    warped: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(source, |object| {
        let out = Out::new(warped, "warped")?;
        let map = Homography(DMat3::from_cols_array(&numbers(to_source, "to_source")?).transpose());
        let (width, height) = (width as usize, height as usize);
        check_range("width", width, 1, MAX_SIDE)?;
        check_range("height", height, 1, MAX_SIDE)?;
        let source = object.image();
        let image = Pixels::counted(object.context(), width, height, source.channels, || {
            let monitor = object.context().monitor();
            object.context().quick.run(|| rectify::warp(source, &map, width, height, monitor.job()))
        })?;
        out.set(handle::give(image));
        Ok(())
    })
}

fn corners(place: *const f64, name: &str) -> Result<[DVec2; 4]> {
    let values: [f64; 8] = numbers(place, name)?;
    let points = std::array::from_fn(|i| DVec2::new(values[2 * i], values[2 * i + 1]));
    if points.iter().all(|p: &DVec2| p.is_finite()) {
        Ok(points)
    } else {
        Err(Error::degenerate(format!("{name} is {values:?}; every coordinate must be finite")))
    }
}

/// Reads `N` doubles from the caller's memory, at any alignment.
pub(super) fn numbers<const N: usize>(place: *const f64, name: &str) -> Result<[f64; N]> {
    let list = list(place, N, name)?;
    Ok(std::array::from_fn(|i| list[i]))
}

/// Reads `count` doubles from the caller's memory, at any alignment.
pub(super) fn list(place: *const f64, count: usize, name: &str) -> Result<Vec<f64>> {
    let bytes = bytes(place.cast(), count.saturating_mul(size_of::<f64>()), name)?;
    let number = |raw: &[u8]| {
        let mut word = [0; size_of::<f64>()];
        word.copy_from_slice(raw);
        f64::from_ne_bytes(word)
    };
    Ok(bytes.chunks_exact(size_of::<f64>()).map(number).collect())
}
