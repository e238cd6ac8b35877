//! Discs that look long in the unwarped photo, because of bloom or because they protrude from the plane.

use super::bloom::{BloomFit, MIN_BLOOM_LAMPS, common_side};
use super::member::{MAX_ALIGNED_ANGLE, Member, principal};
use crate::emission::exemplar::measured_lamp::MAX_SITE_DIFFERENCE;
use crate::maths;
use glam::DVec2;

/// Limits for discs that blur has elongated. [judged on 20 photos]
/// - `MAX_SMEARED`: lamps with a larger mean area, in photo pixels, do not count as small in [`disc`].
/// - `MIN_SMEAR`: the long axis must exceed the short axis by this factor, both for the lamp and for a photo pixel in
///   the unwarped photo.
/// - `MIN_COS_ALONG`: minimum cosine of the angle between the long axes of the lamp and of the photo pixel.
const MAX_SMEARED: f64 = 160.0;
const MIN_SMEAR: f64 = 1.25;
const MIN_COS_ALONG: f64 = 0.9;
/// Let α be the angle of a lamp's long axis. Lamps count as elongated in one common direction if the mean of their unit
/// vectors at the angles 2α is longer than this. The mean has length 1 if all axes are parallel. Lamps that are
/// elongated along their own blur, but not in a common direction, are discs, whatever their size. [judged on 20 photos]
const MIN_COMMON_DIRECTION: f64 = 0.93;

/// Round lamps whose length is at most this many times their width are discs, whatever elongates them. Lamps are rarely
/// slightly oval. [convention]
const MAX_NEARLY_ROUND: f64 = 1.25;

/// Whether blur may have elongated a lamp: both the lamp and a photo pixel are elongated in the unwarped photo
/// ([`MIN_SMEAR`]), and the cosine of the angle between their long axes exceeds `min_cos`.
fn is_smeared(lamp: &Member, min_cos: f64) -> bool {
    let [[short, x], [long, y]] = principal(lamp.moments);
    let [[minor, u], [major, v]] = principal(lamp.inverse_map * lamp.inverse_map.transpose());
    let along = DVec2::new(x, y).dot(DVec2::new(u, v)).abs();
    long > MIN_SMEAR * short && major > MIN_SMEAR * minor && along > min_cos
}

/// Takes the lamps that protrude from the plane out of `kinds`, and returns them in groups of similar width.
///
/// Unwarping projects a body that hangs below the plane, and its glare, away from one point: the foot of the
/// perpendicular from the camera to the plane. It also stretches photo pixels away from this point. So the long axis of
/// a protruding lamp is parallel to the long axis of a photo pixel there. The lower the lamp hangs, the longer it
/// looks.
///
/// - A kind protrudes if blur may have elongated each of its lamps ([`is_smeared`]), with an angle of at most
///   [`MAX_ALIGNED_ANGLE`] between the two long axes.
/// - If the lamps of all these kinds are parallel to each other, none counts as protruding. This excludes a single
///   lamp, and lamps in one line with the camera, such as a continuous row of tubes.
/// - A further kind protrudes if each of its lamps meets two conditions. The lamp is about as wide as a lamp of the
///   kinds above. Blur may have elongated the lamp, where the cosine of the angle between the two long axes only needs
///   to exceed [`MIN_COS_ALONG`].
pub fn take_protruding(kinds: &mut Vec<Vec<Member>>) -> Vec<Vec<Member>> {
    let points_away = |kind: &Vec<Member>, min_cos: f64| kind.iter().all(|lamp| is_smeared(lamp, min_cos));
    let certain: Vec<&Member> =
        kinds.iter().filter(|kind| points_away(kind, maths::cos(MAX_ALIGNED_ANGLE))).flatten().collect();
    let turns: DVec2 = certain.iter().map(|lamp| double_angle(lamp)).sum();
    // Let the angles of the lamps deviate from their mean with the standard deviation σ = `MAX_ALIGNED_ANGLE`. Then the
    // mean of the unit vectors at twice the angles has the length exp(-(2σ)² / 2). Lamps with a longer mean vector are
    // parallel.
    let parallel = maths::exp(-2.0 * maths::powi(MAX_ALIGNED_ANGLE, 2));
    if certain.is_empty() || turns.length() > parallel * certain.len() as f64 {
        return Vec::new();
    }
    let widths: Vec<f64> = certain.iter().map(|lamp| width(lamp).0).collect();
    let is_as_wide = |lamp: &Member| widths.iter().any(|w| are_alike(*w, width(lamp).0));
    let protrudes = |kind: &Vec<Member>| points_away(kind, MIN_COS_ALONG) && kind.iter().all(is_as_wide);
    let (protruding, others): (Vec<_>, Vec<_>) = std::mem::take(kinds).into_iter().partition(protrudes);
    *kinds = others;

    let mut protruding: Vec<Member> = protruding.into_iter().flatten().collect();
    protruding.sort_by(|a, b| width(b).0.total_cmp(&width(a).0));
    let mut groups: Vec<Vec<Member>> = Vec::new();
    for lamp in protruding {
        match groups.last_mut().filter(|group| are_alike(width(&group[0]).0, width(&lamp).0)) {
            Some(group) => group.push(lamp),
            None => groups.push(vec![lamp]),
        }
    }
    groups
}

/// Whether two widths may belong to lamps of one kind.
fn are_alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= MAX_SITE_DIFFERENCE * a.max(b)
}

/// The common diameter of discs, without bloom, in unwarped pixels. It is estimated from the widths of the lamps,
/// because bloom and protrusion act mainly on their lengths.
pub fn diameter(members: &[&Member]) -> Option<f64> {
    common_side(members.iter().map(|lamp| width(lamp)))
}

/// The short diameter of a lamp, and the length of a photo pixel across it, in unwarped pixels.
fn width(lamp: &Member) -> (f64, f64) {
    let [[short, x], [_, y]] = principal(lamp.moments);
    (4.0 * short, lamp.photo_pixel(DVec2::new(-y, x)))
}

/// The long diameter of a lamp, and the length of a photo pixel along it, in unwarped pixels.
fn length(lamp: &Member) -> (f64, f64) {
    let [[_, x], [long, y]] = principal(lamp.moments);
    (4.0 * long, lamp.photo_pixel(DVec2::new(x, y)))
}

/// The unit vector at twice the angle of a lamp's long axis, the same for both directions of the axis.
fn double_angle(lamp: &Member) -> DVec2 {
    let [[_, x], [_, y]] = principal(lamp.moments);
    maths::direction_at(2.0 * maths::atan2(y, x))
}

/// Decides whether lamps are discs. Returns their diameter without bloom, in unwarped pixels; `None` if they are not
/// discs. `aspect` is the aspect ratio of the ellipse that fits them, if an ellipse fits better than a rectangle.
///
/// In the unwarped photo, bloom elongates a disc along the direction in which unwarping magnifies more. At least
/// [`MIN_BLOOM_LAMPS`] round lamps are discs if bloom explains their long and short sides ([`BloomFit::shown`]).
/// Round lamps that are hardly longer than wide ([`MAX_NEARLY_ROUND`]) are discs too. Otherwise, lamps are discs if the
/// lamps that are elongated along their blur have at least half of the photo pixels of all lamps, and if one of these
/// conditions holds as well:
///
/// - They are round. Lamps are rarely oval, but a disc looks oval if it blooms, or if its cover protrudes from the
///   ceiling.
/// - They are small in the photo ([`MAX_SMEARED`]).
/// - They are not all elongated in one common direction.
///
/// The diameter of these lamps follows from their short sides if bloom does not explain the sides.
pub fn disc(members: &[&Member], aspect: Option<f64>) -> Option<f64> {
    let are_round = aspect.is_some();
    let are_nearly_discs = aspect.is_some_and(|aspect| aspect <= MAX_NEARLY_ROUND);
    let are_enough = members.len() >= MIN_BLOOM_LAMPS;
    let sides = |lamp: &&Member| [width(lamp), length(lamp)];
    let shown = are_enough.then(|| BloomFit::new(members.iter().flat_map(sides)).shown()).flatten();
    if are_round && shown.is_some() {
        return shown;
    }
    let total: f64 = members.iter().map(|m| m.weight).sum();
    let mean_area = members.iter().map(|m| m.weight * m.weight).sum::<f64>() / total;
    let smeared: f64 = members.iter().filter(|m| is_smeared(m, MIN_COS_ALONG)).map(|m| m.weight).sum();
    let common_turn = members.iter().map(|m| double_angle(m) * m.weight).sum::<DVec2>().length() / total;
    let are_unlike_ovals = are_round || mean_area <= MAX_SMEARED || common_turn <= MIN_COMMON_DIRECTION;
    if !are_nearly_discs && (smeared < 0.5 * total || !are_unlike_ovals) {
        return None;
    }
    shown.or_else(|| diameter(members))
}

#[cfg(test)]
mod tests {
    use super::super::design::{Design, Shape};
    use super::super::designs::fit;
    use super::super::member::{polygon_moments, rectangle_angle};
    use super::*;
    use glam::{DMat2, Vec2Swizzles};

    const DIAMETER: f64 = 20.0;
    const DISC_BLOOM: f64 = 4.0;

    /// A disc of [`DIAMETER`] that unwarping magnifies by `pixel` along y. Bloom of [`DISC_BLOOM`] photo pixels at each
    /// edge makes it an ellipse.
    fn bloomed_disc(component: usize, pixel: f64) -> Member {
        let size = DVec2::new(DIAMETER + 2.0 * DISC_BLOOM, DIAMETER + 2.0 * DISC_BLOOM * pixel);
        oval(component, (size, 0.0), 1000.0, DMat2::from_diagonal(DVec2::new(1.0, pixel)))
    }

    /// An ellipse with the given sides and angle, shown by `weight` photo pixels, where `inverse_map` converts steps in
    /// photo pixels to steps in unwarped pixels.
    fn oval(component: usize, (size, angle): (DVec2, f64), weight: f64, inverse_map: DMat2) -> Member {
        let centre = DVec2::new(100.0, 0.0);
        let outline =
            Design { shape: Shape::Ellipse, size, axis: DVec2::from_angle(angle), hole: DVec2::ZERO }.outline(centre);
        let (area, centre, moments) = polygon_moments(&outline).unwrap();
        Member {
            component,
            angle: rectangle_angle(&outline),
            outline,
            area,
            centre,
            moments,
            weight,
            blur: DVec2::new(inverse_map.row(0).length(), inverse_map.row(1).length()),
            inverse_map,
            is_clear: true,
            hole_share: 0.0,
        }
    }

    /// A lamp of the same outline in a photo that unwarping magnifies along x instead of y.
    fn with_blur_across(lamp: Member) -> Member {
        Member { blur: lamp.blur.yx(), inverse_map: DMat2::from_diagonal(lamp.blur.yx()), ..lamp }
    }

    #[test]
    fn discs_that_bloom_has_elongated_are_round_again() {
        let lamps: Vec<Member> =
            [1.2, 1.5, 1.9, 2.4].into_iter().enumerate().map(|(k, p)| bloomed_disc(k, p)).collect();
        let design = fit(&lamps).unwrap();
        assert_eq!(design.shape, Shape::Ellipse);
        assert!((design.size - DIAMETER).abs().max_element() < 0.5, "{}", design.size);
        // Ellipses that are elongated across the direction of their blur are not discs, unless they are nearly round.
        let turned = |pixels: [f64; 4]| {
            let lamps = pixels.into_iter().enumerate().map(|(k, p)| with_blur_across(bloomed_disc(k, p)));
            fit(&lamps.collect::<Vec<_>>()).unwrap().size
        };
        let [long, round] = [turned([2.2, 2.5, 2.9, 3.4]), turned([1.2, 1.3, 1.4, 1.5])];
        assert!(long.y > MAX_NEARLY_ROUND * long.x && round.x == round.y, "{long} {round}");
    }

    #[test]
    fn a_few_ovals_that_are_long_along_their_blur_are_discs() {
        // Two lamps are too few to show their bloom, so the diameter of the discs is the short side of the ovals.
        let lamps = || [2.5, 2.6].into_iter().enumerate().map(|(k, pixel)| bloomed_disc(k, pixel));
        let design = fit(&lamps().collect::<Vec<_>>()).unwrap();
        assert_eq!((design.shape, design.size.x), (Shape::Ellipse, design.size.y));
        assert!((design.size.x / (DIAMETER + 2.0 * DISC_BLOOM) - 1.0).abs() < 0.1, "{}", design.size);
        let design = fit(&lamps().map(with_blur_across).collect::<Vec<_>>()).unwrap();
        assert!(design.size.y > 1.3 * design.size.x, "{}", design.size);
    }

    /// An ellipse with the given sides and with its long axis at `angle`, where unwarping stretches photo pixels in the
    /// direction `away`. Both angles are in radians, from x towards y.
    fn long_lamp(component: usize, size: DVec2, angle: f64, away: f64) -> Member {
        let stretch = DMat2::from_angle(away) * DMat2::from_diagonal(DVec2::new(2.0, 1.0)) * DMat2::from_angle(-away);
        oval(component, (size, angle), 300.0, stretch)
    }

    #[test]
    fn lamps_that_point_away_from_the_camera_protrude_and_parallel_lamps_do_not() {
        let spot = |k: usize, length: f64, angle: f64| long_lamp(k, DVec2::new(length, 22.0), angle, angle + 0.03);
        let spots = || [(90.0, 1.2), (120.0, 1.5), (70.0, 1.9)].into_iter().enumerate();
        let mut kinds: Vec<Vec<Member>> = spots().map(|(k, (length, angle))| vec![spot(k, length, angle)]).collect();
        // Add a spot whose long axis is 15 degrees off the direction away from the camera. Also add a row of parallel
        // tubes, of which only the last points away from the camera.
        kinds.push(vec![long_lamp(3, DVec2::new(60.0, 20.0), 1.4, 1.66)]);
        kinds
            .push([0.4, 0.9, 1.55].into_iter().map(|away| long_lamp(4, DVec2::new(140.0, 30.0), 1.57, away)).collect());
        let protruding = take_protruding(&mut kinds);
        assert_eq!(protruding.iter().map(Vec::len).collect::<Vec<_>>(), [4]);
        assert_eq!(kinds.iter().map(Vec::len).collect::<Vec<_>>(), [3]);
        let found = diameter(&protruding[0].iter().collect::<Vec<_>>()).unwrap();
        assert!((found - 21.5).abs() < 1.0, "{found}");

        // Lamps in one line with the camera, and a single lamp, give no evidence that they protrude.
        for angles in [vec![1.5, 1.5, 1.5], vec![1.2]] {
            let mut kinds: Vec<Vec<Member>> = angles.into_iter().map(|angle| vec![spot(0, 90.0, angle)]).collect();
            assert!(take_protruding(&mut kinds).is_empty());
            assert!(!kinds.is_empty());
        }
    }
}
