//! Replaces lamps that few photo pixels show by similar lamps that many photo pixels show, and that are therefore
//! sharper. Lamps that are partly hidden by something in front of them are replaced by similar lamps in full view.

use super::designs::Designs;
use super::instance::Instance;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::roles::Role;
use crate::rng::Rng;
use std::collections::BTreeMap;

/// Two lamps are similar if their areas, their widths, their heights and their aspect ratios each differ by at most a
/// relative tolerance. Let A be the number of photo pixels that show the lamp to be replaced. The tolerance is
/// `DIFFERENCE` + `BLUR_PIXELS` / √A, but at most `MAX_DIFFERENCE`. [bench emission:real]
const DIFFERENCE: f64 = 0.25;

/// `BLUR_PIXELS`, in photo pixels, allows for blur and bloom, which enlarge a small lamp by a larger share than a large
/// one. For `MAX_DIFFERENCE`, see [`DIFFERENCE`]. [bench emission:real]
const BLUR_PIXELS: f64 = 2.0;
const MAX_DIFFERENCE: f64 = 0.5;

/// A lamp counts as sharp if the number of photo pixels that show it is at least this share of the largest number among
/// similar lamps. [bench emission:perspective]
const MIN_SHARP_SHARE: f64 = 0.4;

/// A lamp is obstructed if its dark share ([`Exemplar::dark_share`]) exceeds the smallest dark share of its kind by
/// more than this value. Between 0.02 and 0.1, the value changes which lamps the textures show, but not where.
/// [bench photos:real]
const MAX_OBSTRUCTED: f64 = 0.05;

/// Replaces each lamp that is not sharp, or that the photo does not show completely, by a similar lamp that is sharp
/// and whole. The new lamp gets the centre of the lamp that it replaces. If there are several such lamps, one is chosen
/// at random for each instance, so that the texture shows all of them. If the exemplar has no such lamp, the lamp is
/// not replaced.
pub fn show_sharpest(exemplar: &Exemplar, instances: &mut [Instance], seed: u64) {
    let lamps = &exemplar.components.list;
    let sharp = |k: usize| -> Vec<usize> {
        let like = (DIFFERENCE + BLUR_PIXELS / exemplar.photo_area[k].max(1.0).sqrt()).min(MAX_DIFFERENCE);
        let is_like = |j: &usize| {
            let close = |a: usize, b: usize| (a as f64 - b as f64).abs() <= like * a.max(b) as f64;
            let (a, b) = (&lamps[k], &lamps[*j]);
            let ([w, h], [u, v]) = (a.size(), b.size());
            let is_alike = close(a.area, b.area) && close(w, u) && close(h, v) && close(w * v, u * h);
            exemplar.roles[*j] == Role::Whole && is_alike
        };
        let like: Vec<usize> = (0..lamps.len()).filter(is_like).collect();
        sharpest(exemplar, like)
    };
    let mut choices: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (n, instance) in instances.iter_mut().enumerate() {
        let k = instance.component;
        let choice = choices.entry(k).or_insert_with(|| sharp(k));
        if !choice.is_empty() && !choice.contains(&k) {
            let j = choice[Rng::new(seed, &[0x6c61, n as u64]).below(choice.len())];
            *instance = Instance { component: j, shift: instance.shift + lamps[k].centre - lamps[j].centre };
        }
    }
}

/// Returns the sharp lamps ([`MIN_SHARP_SHARE`]) among the given similar lamps.
fn sharpest(exemplar: &Exemplar, mut lamps: Vec<usize>) -> Vec<usize> {
    let max_area = lamps.iter().map(|&k| exemplar.photo_area[k]).fold(0.0, f64::max);
    lamps.retain(|&k| exemplar.photo_area[k] >= MIN_SHARP_SHARE * max_area);
    lamps
}

/// Returns the lamps that are not obstructed ([`MAX_OBSTRUCTED`]) among the given lamps of one kind.
fn unobstructed(exemplar: &Exemplar, mut lamps: Vec<usize>) -> Vec<usize> {
    let min_dark = lamps.iter().map(|&k| exemplar.dark_share[k]).fold(f64::INFINITY, f64::min);
    lamps.retain(|&k| exemplar.dark_share[k] <= min_dark + MAX_OBSTRUCTED);
    lamps
}

/// Like [`show_sharpest`], but for lamps with a design: replaces each lamp that is not sharp, obstructed, or not shown
/// completely by the photo. The new lamp is a sharp, whole and unobstructed lamp of the same kind, with the centre of
/// the lamp that it replaces. If the kind has no such lamp, the lamp is not replaced.
pub fn show_designed(exemplar: &Exemplar, designs: &Designs, instances: &mut [Instance], seed: u64) {
    let clear = |kind: usize| {
        let of_kind = move |k: &usize| designs.of(*k).is_some_and(|(_, fitted)| fitted.kind == kind);
        (0..exemplar.roles.len()).filter(of_kind).filter(|&k| exemplar.roles[k] == Role::Whole)
    };
    let sharp: Vec<Vec<usize>> = (0..designs.kinds.len())
        .map(|kind| sharpest(exemplar, unobstructed(exemplar, clear(kind).collect())))
        .collect();
    for (n, instance) in instances.iter_mut().enumerate() {
        let Some((_, own)) = designs.of(instance.component) else { continue };
        let choice = &sharp[own.kind];
        if !choice.is_empty() && !choice.contains(&instance.component) {
            let component = choice[Rng::new(seed, &[0x6465, n as u64]).below(choice.len())];
            if let Some((_, other)) = designs.of(component) {
                *instance = Instance { component, shift: instance.shift + own.centre - other.centre };
            }
        }
    }
}
