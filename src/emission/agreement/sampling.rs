//! Estimates the sampling error of an exemplar's statistics. This error arises because the exemplar shows only a part
//! of its ceiling, with few lamps.
//!
//! The texture stands in for the whole ceiling (parametric bootstrap; Efron 1979). Parts of the texture, of the size
//! and shape of the region that the photo shows, stand in for the exemplar and are measured like it. The difference
//! between a part and the whole texture is an error that no synthesis could avoid.

use super::statistics::{Pattern, Statistics};
use crate::emission::exemplar::{Exemplar, components, roles};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_collect};
use crate::job::Job;
use glam::DVec2;

/// Number of parts of the texture whose statistics are compared with the statistics of the whole texture.
const PARTS: usize = 6;

/// Returns the sampling error of the exemplar's statistics, as a relative difference. The statistics of [`PARTS`] parts
/// of the texture, each as large as the exemplar, are compared with the statistics `whole` of the whole texture by
/// [`Statistics::difference`]. The result is the root mean square of these differences. `None` if the texture is
/// smaller than the exemplar, or if the texture exceeds the exemplar along both axes by less than half of the
/// exemplar's shorter side: the parts would then hardly differ.
///
/// `scale` is the number of unwarped pixels per texel. `periods` are the periods along x and y in unwarped pixels.
pub fn error(
    exemplar: &Exemplar,
    (texture, mask): (&Image, &Image),
    whole: &Statistics,
    periods: [Option<f64>; 2],
    scale: f64,
    job: Job,
) -> Result<Option<f64>> {
    let side = |pixels: usize| (pixels as f64 / scale).floor() as usize;
    let (width, height) = (side(exemplar.width), side(exemplar.height));
    let is_part = (1..=mask.width).contains(&width) && (1..=mask.height).contains(&height);
    let margin = DVec2::new(mask.width as f64 - width as f64, mask.height as f64 - height as f64);
    if !is_part || margin.max_element() < width.min(height) as f64 / 2.0 {
        return Ok(None);
    }
    let pixel = |side: usize, at: usize| (((at as f64 + 0.5) * scale) as usize).min(side - 1);
    let columns: Vec<usize> = (0..width).map(|x| pixel(exemplar.width, x)).collect();
    let shown = try_collect((0..height).flat_map(|y| {
        let start = pixel(exemplar.height, y) * exemplar.width;
        columns.iter().map(move |x| exemplar.shown[start + x])
    }))?;
    let periods = periods.map(|p| p.map(|p| p / scale));
    let parts = exec::map(PARTS, job, |k| -> Result<f64> {
        // Spread the parts evenly over the texture by the R2 low-discrepancy sequence (Roberts 2018).
        let step = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053);
        let corner = (margin * (step * (k as f64 + 0.5)).fract()).round();
        let at = |i: usize| (corner.y as usize + i / width) * mask.width + corner.x as usize + i % width;
        let components = components::find(width, height, |i| shown[i] && mask.data[at(i)] > 0.5)?;
        let roles = roles::classify(&components, &shown, width, height);
        let pieces: Vec<bool> = roles.iter().map(|role| role.is_piece()).collect();
        let colour = |i: usize| shown[i].then(|| glam::Vec3::from_slice(&texture.data[3 * at(i)..]));
        let pattern = Pattern { width, height, components: &components, whole: &pieces, periods, colour };
        Ok(Statistics::of(&pattern).difference(whole))
    })?;
    let squares = parts.into_iter().map(|part| part.map(|off| off * off)).sum::<Result<f64>>()?;
    Ok(Some((squares / PARTS as f64).sqrt()))
}
