//! Computes the verdict on a run from its masks and its texture; benches/photos.rs states the criteria.

use super::masks::Mask;
use super::outcome::Outcome;
use super::shapes::{Lamps, Shape, median};
use super::truth::{Lamp, Photo, Truth};
use glam::DVec2;
use luxfer::geometry::Homography;
use luxfer::rectify::Unwarped;

/// Distance in photo pixels from a lamp within which masked pixels still count as the lamp's. [convention]
const NEAR: u32 = 6;
/// Points along each side of the grid at which an unwarping is compared with the true one.
const GRID: usize = 12;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Right,
    Usable,
    Wrong,
    /// The true lamps of the photo are not known.
    Unjudged,
}

impl Verdict {
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Usable => "usable",
            Self::Wrong => "wrong",
            Self::Unjudged => "-",
        }
    }
}

/// Requirements of a verdict: minimum shares, and maximum factors between the texture's lamps and the true lamps.
struct Limits {
    precision: f64,
    found: f64,
    area: f64,
    aspect: f64,
    spacing: f64,
    lit: f64,
    /// Maximum share of the lamps that are of another kind than in truth.
    kinds: f64,
}

/// Limits for a texture that anyone recognises as the photo's. [convention]
const RIGHT: Limits =
    Limits { precision: 0.8, found: 0.9, area: 1.25, aspect: 1.25, spacing: 1.1, lit: 1.35, kinds: 0.25 };
/// Limits for a texture that needs a correction or two. [convention]
const USABLE: Limits =
    Limits { precision: 0.5, found: 0.7, area: 2.0, aspect: 1.6, spacing: 1.3, lit: 2.0, kinds: 0.5 };

/// Logarithms of the ratios between statistics of the texture's lamps and of the true lamps; `None` if a statistic is
/// not known for both.
#[derive(Clone, Copy, Debug, Default)]
pub struct Agreement {
    /// Median area of the lamps; for lines, their median width.
    pub area: Option<f64>,
    /// Median aspect ratio of the lamps; `None` for lines.
    pub aspect: Option<f64>,
    /// Median distance from a lamp to the nearest lamp; for lines, the median distance between neighbouring lines.
    pub spacing: Option<f64>,
    /// Lit share of the plane.
    pub lit: Option<f64>,
    /// The larger deviation of the two steps of the lattice, each compared with the true step.
    pub lattice: Option<f64>,
    /// Share of the lamps that are of another kind than in truth; `None` if all true lamps are of one kind.
    pub kinds: Option<f64>,
}

impl Agreement {
    pub fn between(texture: &Lamps, truth: &Lamps) -> Self {
        let ratio = |a: Option<f64>, b: Option<f64>| Some((a? / b?).ln());
        // If the texture lacks a statistic that the truth has, the deviation is infinite.
        let demanded = |a: Option<f64>, b: Option<f64>| b.map(|b| a.map_or(f64::INFINITY, |a| (a / b).ln()));
        let lines = truth.are_lines();
        // A photo of a single row does not show the distance to the next row, so compare distances along the row only.
        let row = truth.row();
        let spacing = |lamps: &Lamps| match row {
            _ if lines => lamps.spacing_across(),
            Some(angle) => lamps.spacing_along(angle),
            None => lamps.spacing(),
        };
        let lit = texture.lit.zip(truth.lit).map(|([lit, _], [low, high])| (lit / lit.clamp(low, high)).ln());
        let steps = texture.steps().zip(truth.steps());
        let kinds = truth.by_kind();
        if !kinds.is_empty() {
            return Self { spacing: demanded(spacing(texture), spacing(truth)), lit, ..Self::by_kind(texture, &kinds) };
        }
        Self {
            kinds: None,
            area: if lines { demanded(texture.width(), truth.width()) } else { demanded(texture.area(), truth.area()) },
            aspect: if lines { None } else { ratio(texture.aspect(), truth.aspect()) },
            spacing: if truth.whole.len() < 3 {
                ratio(spacing(texture), spacing(truth))
            } else {
                demanded(spacing(texture), spacing(truth))
            },
            lit,
            lattice: steps.map(|(a, b)| (a[0] / b[0]).ln().abs().max((a[1] / b[1]).ln().abs())),
        }
    }

    /// Compares each lamp of the texture with the true kind of lamp whose area is nearest.
    fn by_kind(texture: &Lamps, kinds: &[[f64; 3]]) -> Self {
        let nearest = |shape: &Shape| {
            let off = |kind: &[f64; 3]| (shape.area / kind[0]).ln().abs();
            (0..kinds.len()).min_by(|a, b| off(&kinds[*a]).total_cmp(&off(&kinds[*b]))).unwrap_or(0)
        };
        let assigned: Vec<(&Shape, usize)> = texture.whole.iter().map(|shape| (shape, nearest(shape))).collect();
        if assigned.is_empty() {
            return Self { area: Some(f64::INFINITY), ..Self::default() };
        }
        let share = |kind: usize| assigned.iter().filter(|(_, k)| *k == kind).count() as f64 / assigned.len() as f64;
        let off = kinds.iter().enumerate().map(|(kind, [.., truth])| (share(kind) - truth).abs()).sum::<f64>() / 2.0;
        Self {
            area: median(assigned.iter().map(|(shape, kind)| (shape.area / kinds[*kind][0]).ln())),
            aspect: median(assigned.iter().map(|(shape, kind)| (shape.aspect() / kinds[*kind][1]).ln())),
            kinds: Some(off),
            ..Self::default()
        }
    }

    fn is_within(&self, limits: &Limits) -> bool {
        let within = |value: Option<f64>, factor: f64| value.is_none_or(|v| v.abs() <= factor.ln());
        within(self.area, limits.area)
            && within(self.aspect, limits.aspect)
            && within(self.spacing, limits.spacing)
            && within(self.lit, limits.lit)
            && self.kinds.is_none_or(|off| off <= limits.kinds)
    }
}

/// Everything that is computed about one run.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// Share of the mask of lights that lies on a true lamp or near one; `None` if no true lamp is known.
    pub precision: Option<f64>,
    /// Share of the true lamps of which half the pixels lie in the mask of lights.
    pub found: Option<f64>,
    pub lights_iou: Option<f64>,
    pub plane_iou: Option<f64>,
    /// Deviation of the unwarped plane from the true plane, up to a similarity, relative to its extent.
    pub unwarp: Option<f64>,
    pub agreement: Option<Agreement>,
    pub verdict: Verdict,
}

impl Judgement {
    pub fn of(photo: &Photo, outcome: &Outcome) -> Self {
        let truth = &photo.truth;
        let results = outcome.results();
        let lights = results.lights.as_ref().map(|lights| Mask::of(&lights.mask));
        let plane = results.plane.as_ref().map(|plane| Mask::of(&plane.mask));
        let has_lamps = !truth.lamps.is_empty();
        let agreement = truth.layout.as_ref().map(|truth| match outcome.lamps() {
            Some(texture) => Agreement::between(&texture.joined(truth.bar), truth),
            None => Agreement { area: Some(f64::INFINITY), ..Agreement::default() },
        });
        let mut judgement = Self {
            precision: has_lamps.then(|| lights.as_ref().map_or(0.0, |lights| precision(lights, truth))),
            found: has_lamps.then(|| lights.as_ref().map_or(0.0, |lights| found(lights, truth))),
            lights_iou: lights.filter(|_| truth.plane.is_some()).map(|lights| lights.iou(&truth.lights)),
            plane_iou: plane.as_ref().and_then(|plane| plane_iou(plane, truth)),
            unwarp: results.unwarped.as_ref().zip(truth.to_photo).and_then(|(unwarped, map)| deviation(unwarped, &map)),
            agreement,
            verdict: Verdict::Unjudged,
        };
        let declined = (truth.is_trap && !outcome.warnings().is_empty()) || (truth.may_decline && outcome.declines());
        judgement.verdict = if declined { Verdict::Right } else { judgement.weigh(outcome) };
        judgement
    }

    fn weigh(&self, outcome: &Outcome) -> Verdict {
        let (Some(precision), Some(found)) = (self.precision, self.found) else { return Verdict::Unjudged };
        let meets = |limits: &Limits| {
            precision > limits.precision
                && found >= limits.found
                && self.agreement.is_none_or(|agreement| agreement.is_within(limits))
        };
        match () {
            _ if outcome.failure.is_some() => Verdict::Wrong,
            _ if meets(&RIGHT) => Verdict::Right,
            _ if meets(&USABLE) => Verdict::Usable,
            _ => Verdict::Wrong,
        }
    }
}

/// Share of a mask's area that lies on a true lamp or near one.
fn precision(lights: &Mask, truth: &Truth) -> f64 {
    let mut lights = lights.clone();
    let near = truth.lights.dilated(NEAR);
    if let Some(unlisted) = &truth.unlisted {
        let unlisted = unlisted.on.iter().zip(&near.on).map(|(unlisted, near)| *unlisted && !near);
        lights.on.iter_mut().zip(unlisted).for_each(|(on, unlisted)| *on &= !unlisted);
    }
    if !truth.centres.is_empty() {
        let is_listed = |i: &usize| {
            let at = DVec2::new((i % lights.width) as f64 + 0.5, (i / lights.width) as f64 + 0.5);
            truth.centres.iter().any(|centre| centre.distance(at) <= f64::from(NEAR))
        };
        let parts: Vec<Vec<usize>> = lights.parts().into_iter().filter(|part| part.iter().any(is_listed)).collect();
        parts.iter().flatten().filter(|i| !near.on[**i]).for_each(|&i| lights.on[i] = false);
    }
    lights.common(&near) as f64 / lights.count().max(1) as f64
}

/// Share of the true lamps of which half the pixels lie in the mask; if a lamp's pixels are not known, its centre must
/// lie in the mask.
fn found(lights: &Mask, truth: &Truth) -> f64 {
    let is_found = |lamp: &&Lamp| match lamp.pixels.len() {
        0 => lights.holds(lamp.centre),
        count => 2 * lamp.pixels.iter().filter(|&&i| lights.on[i as usize]).count() >= count,
    };
    truth.lamps.iter().filter(is_found).count() as f64 / truth.lamps.len() as f64
}

/// Intersection over union with the true plane, over the pixels that are clearly plane or clearly not.
fn plane_iou(plane: &Mask, truth: &Truth) -> Option<f64> {
    let mut plane = plane.clone();
    if let Some(either) = &truth.either {
        plane.on.iter_mut().zip(&either.on).for_each(|(on, either)| *on &= !either);
    }
    truth.plane.as_ref().map(|truth| plane.iou(truth))
}

/// Root mean square distance between unwarped points and the true points after the best similarity, on a grid over the
/// visible part of the plane. It is relative to the root mean square distance of the points from their mean. Mirrored
/// figures count as similar.
fn deviation(unwarped: &Unwarped, to_photo: &Homography) -> Option<f64> {
    let from_photo = to_photo.inverse();
    let (width, height) = (unwarped.valid.width, unwarped.valid.height);
    let grid =
        (0..GRID * GRID).map(|i| [(i % GRID * 2 + 1) * width / (2 * GRID), (i / GRID * 2 + 1) * height / (2 * GRID)]);
    let seen = grid.filter(|[x, y]| unwarped.valid.pixel(*x, *y)[0] > 0.5);
    let pairs: Vec<[DVec2; 2]> = seen
        .map(|[x, y]| DVec2::new(x as f64 + 0.5, y as f64 + 0.5))
        .map(|at| [at, from_photo.apply(unwarped.to_photo.apply(at))])
        .filter(|pair| pair[1].is_finite())
        .collect();
    if pairs.len() < 4 {
        return None;
    }
    let mean = |k: usize| pairs.iter().map(|pair| pair[k]).sum::<DVec2>() / pairs.len() as f64;
    let means = [mean(0), mean(1)];
    let extent: f64 = pairs.iter().map(|pair| pair[0].distance_squared(means[0])).sum();
    // Fit in complex numbers: a = c b + d, or a = c conj(b) + d for mirrored figures.
    let residual = |mirror: DVec2| {
        let pairs = pairs.iter().map(|pair| [pair[0] - means[0], (pair[1] - means[1]) * mirror]);
        let (mut product, mut square) = (DVec2::ZERO, 0.0);
        for [a, b] in pairs.clone() {
            product += DVec2::new(a.dot(b), b.perp_dot(a));
            square += b.length_squared();
        }
        let factor = product / square;
        pairs.map(|[a, b]| a.distance_squared(factor.rotate(b))).sum::<f64>()
    };
    let least = residual(DVec2::ONE).min(residual(DVec2::new(1.0, -1.0)));
    Some((least / extent).sqrt())
}
