//! Lamps that the photo shows small, replaced by like ones that it shows large.

use super::design::Designs;
use super::instance::Instance;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::roles::Role;
use crate::rng::Rng;
use std::collections::BTreeMap;

/// By how much, relatively, lamps of a kind may differ in area, in both sides and in their ratio.
const LIKE: f64 = 0.25;

/// By how much more, in pixels of the photo: blur and glow make a lamp so much longer that the photo shows small.
/// Beyond the last of these no lamps are alike.
const BLUR: f64 = 2.0;

const MIN_LIKE: f64 = 0.5;

/// A lamp is shown sharply if it covers this share of the photo pixels that the largest of its kind does.
const SHARP: f64 = 0.4;

/// Puts in the place of a lamp that the photo shows small one like it that it shows large. Which of several is drawn,
/// so that they keep their variety.
pub fn show_sharpest(exemplar: &Exemplar, instances: &mut [Instance], seed: u64) {
    let lamps = &exemplar.components.list;
    let sharp = |k: usize| -> Vec<usize> {
        let like = (LIKE + BLUR / exemplar.photo_area[k].max(1.0).sqrt()).min(MIN_LIKE);
        let is_like = |j: &usize| {
            let close = |a: usize, b: usize| (a as f64 - b as f64).abs() <= like * a.max(b) as f64;
            let (a, b) = (&lamps[k], &lamps[*j]);
            let ([w, h], [u, v]) = (a.size(), b.size());
            // As large and of the same proportions; and with nothing cut off.
            let is_alike = close(a.area, b.area) && close(w, u) && close(h, v) && close(w * v, u * h);
            exemplar.roles[*j] == Role::Whole && is_alike
        };
        let like: Vec<usize> = (0..lamps.len()).filter(is_like).collect();
        let most = like.iter().map(|&j| exemplar.photo_area[j]).fold(0.0, f64::max);
        like.into_iter().filter(|&j| exemplar.photo_area[j] >= SHARP * most).collect()
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

/// The same of lamps that have a design: of a kind those are shown that the photo shows sharply, each at the middle of
/// the lamp it stands for.
pub fn show_designed(exemplar: &Exemplar, designs: &Designs, instances: &mut [Instance], seed: u64) {
    let area = |k: usize| exemplar.photo_area[k];
    let clear = |kind: usize| {
        let of_kind = move |k: &usize| designs.of(*k).is_some_and(|(_, fitted)| fitted.kind == kind);
        (0..exemplar.roles.len()).filter(of_kind).filter(|&k| exemplar.roles[k] == Role::Whole)
    };
    let sharp: Vec<Vec<usize>> = (0..designs.kinds.len())
        .map(|kind| {
            let most = clear(kind).map(area).fold(0.0, f64::max);
            clear(kind).filter(|&k| area(k) >= SHARP * most).collect()
        })
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
