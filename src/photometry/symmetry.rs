//! Symmetric distributions, of which a file states one half or one quarter of the C planes.

use crate::error::{Error, Result};

/// Expands the stored planes to the full circle, by the symmetry that their range of angles implies (LM-63). `angles`
/// are the angles C of the stored planes in degrees, and `candela` their intensities, plane by plane. Returns the
/// angles C and the intensities of all planes.
///
/// # Errors
/// `Format` if the angles do not ascend, or if their range implies no symmetry.
pub fn unfold(angles: &[f64], candela: &[f64], gammas: usize) -> Result<(Vec<f64>, Vec<f64>)> {
    // Turn an angle of -0 into 0, because `total_cmp` would distinguish the two.
    let angles: Vec<f64> = angles.iter().map(|c| c + 0.0).collect();
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    if angles.windows(2).any(|w| w[0] >= w[1]) {
        return Err(Error::format("the horizontal angles do not ascend"));
    }
    let plane = |i: usize| (angles[i], &candela[i * gammas..][..gammas]);
    let mut all: Vec<(f64, &[f64])> = (0..angles.len()).map(plane).collect();
    match (first, last) {
        (0.0, 0.0) => {}
        (0.0, 90.0) => {
            mirror(&mut all, 90.0);
            mirror(&mut all, 180.0);
        }
        (0.0, 180.0) => mirror(&mut all, 180.0),
        // From 90° to 270°: the distribution is symmetric about the plane through 90° and 270°.
        (90.0, 270.0) => mirror(&mut all, 90.0),
        (0.0, end) if end > 180.0 && end < 360.0 => {}
        (0.0, 360.0) => {
            all.pop();
        }
        _ => {
            return Err(Error::format(format!(
                "the horizontal angles go from {first} to {last}; they must go from 0 to 0, 90, 180, or an angle above \
                 180 up to 360, or from 90 to 270"
            )));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok((all.iter().map(|(c, _)| *c).collect(), all.iter().flat_map(|(_, values)| values.iter().copied()).collect()))
}

/// Adds the mirror images of the planes about the plane at the angle `about`. A mirror image is left out if `all`
/// already contains a plane at its angle: a plane at `about`, for example, is its own mirror image.
fn mirror(all: &mut Vec<(f64, &[f64])>, about: f64) {
    let mut there: Vec<f64> = all.iter().map(|(c, _)| *c).collect();
    there.sort_by(f64::total_cmp);
    let images: Vec<_> = all.iter().map(|&(c, values)| ((2.0 * about - c).rem_euclid(360.0), values)).collect();
    all.extend(images.into_iter().filter(|(c, _)| there.binary_search_by(|d| d.total_cmp(c)).is_err()));
}
