//! Finds a point near which most of a scene lies. Most positions relative to this point are small, so that `f32` stores
//! them precisely.

use glam::DVec3;

/// Share of the points that differ from the median by at most the half-extent of [`detail`]. The remaining points are
/// ignored, because they may be outliers, such as a few objects left behind at the origin of a national grid.
/// [convention]
const NEAR_SHARE: f64 = 0.75;

/// Returns the median of the points on each axis, and a half-extent: [`NEAR_SHARE`] of the points differ from the
/// median by at most this length along every axis. `None` without points. Outliers hardly move the median, however far
/// away they are.
pub fn detail(points: &[DVec3]) -> Option<(DVec3, f64)> {
    if points.is_empty() {
        return None;
    }
    let at = |values: &mut [f64], share: f64| {
        values.sort_unstable_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share) as usize]
    };
    let median =
        DVec3::from_array(std::array::from_fn(|axis| at(&mut points.iter().map(|p| p[axis]).collect::<Vec<_>>(), 0.5)));
    let half_extent = at(&mut points.iter().map(|p| (*p - median).abs().max_element()).collect::<Vec<_>>(), NEAR_SHARE);
    Some((median, half_extent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_detail_of_a_scene_is_where_most_of_it_is() {
        let building = (0..60).map(|i| DVec3::new(1e6 + f64::from(i), f64::from(i % 3), -2e6));
        let points: Vec<DVec3> = building.chain([DVec3::ZERO, DVec3::splat(3.0)]).collect();
        let (median, half_extent) = detail(&points).unwrap();
        assert!((median - DVec3::new(1e6 + 29.0, 1.0, -2e6)).abs().max_element() <= 1.0, "{median}");
        assert!(half_extent <= 30.0, "{half_extent}");
        assert_eq!(detail(&[]), None);
    }
}
