//! Replaces lamps that the photo shows small by similar lamps that it shows large.

use super::design::Designs;
use super::instance::Instance;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::roles::Role;
use crate::rng::Rng;
use std::collections::BTreeMap;

/// By how much, relatively, lamps of a kind may differ in area, in both sides and in their ratio.
const LIKE: f64 = 0.25;

/// By how many photo pixels they may differ in addition: blur and glow lengthen a lamp that the photo shows small.
/// `MIN_LIKE` limits the sum of both, as a relative difference.
const BLUR: f64 = 2.0;

const MIN_LIKE: f64 = 0.5;

/// A lamp is shown sharply if it covers this share of the photo pixels that the largest of its kind does.
const SHARP: f64 = 0.4;

/// Replaces each lamp that the photo shows small by a similar lamp that the photo shows large. Among several such lamps
/// one is drawn at random, so that the texture keeps their variety.
pub fn show_sharpest(exemplar: &Exemplar, instances: &mut [Instance], seed: u64) {
    let lamps = &exemplar.components.list;
    let sharp = |k: usize| -> Vec<usize> {
        let like = (LIKE + BLUR / exemplar.photo_area[k].max(1.0).sqrt()).min(MIN_LIKE);
        let is_like = |j: &usize| {
            let close = |a: usize, b: usize| (a as f64 - b as f64).abs() <= like * a.max(b) as f64;
            let (a, b) = (&lamps[k], &lamps[*j]);
            let ([w, h], [u, v]) = (a.size(), b.size());
            // Alike in size and proportions, and with nothing cut off.
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

/// Like [`show_sharpest`], for lamps that have a design: each lamp that the photo does not show sharply is replaced by
/// one of its kind that it does, centred on the lamp it replaces.
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
