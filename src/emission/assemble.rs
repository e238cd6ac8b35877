//! Assembles the result of emission: renders the texture of a composition, lists its lamps, and compares its statistics
//! with the statistics of the exemplars.

use super::agreement::sampling;
use super::agreement::statistics::{Pattern, Statistics};
use super::compose::composition::Composition;
use super::compose::layer::Layer;
use super::compose::render;
use super::compose::weights::Style;
use super::exemplar::Exemplar;
use super::exemplar::components::{Component, Components};
use super::lamps::luminaires;
use super::lattice::law::Law;
use super::output::Emission;
use super::params::{Input, Params};
use super::quilt::patch_map::PatchMap;
use crate::error::Result;
use crate::image::Image;
use crate::job::Job;
use glam::Vec3;

/// Renders the whole texture of a composition, lists its lamps, and computes its statistics and their errors.
pub fn assemble(
    mut composition: Composition,
    input: &Input,
    styles: &[Style],
    params: &Params,
    job: Job,
) -> Result<Emission> {
    let (texture, mut coverage, components) = composition.all(input, styles, job.part(0.85, 0.95))?;
    let luminaires = luminaires::find(&texture, &components, &|i| coverage.data[i], job.part(0.95, 1.0))?;
    render::threshold(&mut coverage);
    let mask = coverage;

    let inputs = std::iter::once(input).chain(styles.iter().map(|style| &style.input));
    let parts = composition.layers.iter().zip(inputs).enumerate().map(|(k, (layer, input))| {
        (layer.statistics(input.unwarped).scaled(1.0 / layer.scale), composition.weights.mean(k))
    });
    let expected = Statistics::mixed(parts);
    let exemplar_lamps = composition.exemplar_lamps();
    let Layer { exemplar, law, regularity, choice, metadata, patch_map, .. } = composition.layers.swap_remove(0);
    let periods = if styles.is_empty() { law.periods() } else { [None; 2] };
    let statistics = [expected, statistics_of(&texture, &components, periods.map(|p| p.map(|p| p / params.scale)))];
    let error = statistics[1].difference(&statistics[0]);
    let sampling_error = match law {
        Law::Lattice(_) | Law::Row(_) | Law::Free if styles.is_empty() => {
            let images = (&texture, &mask);
            sampling::error(&exemplar, images, &statistics[1], periods, params.scale, job.part(1.0, 1.0))?
                .unwrap_or(0.0)
        }
        _ => 0.0,
    };
    let shown = shown_metadata(&patch_map, &exemplar, &metadata)?;
    job.report(1.0);
    Ok(Emission {
        texture,
        mask,
        exemplar_metadata: metadata,
        metadata: shown,
        luminaires,
        law,
        regularity,
        choice,
        statistics,
        error,
        first_error: None,
        sampling_error,
        exemplar_lamps,
    })
}

/// Computes the statistics of a texture, with lengths in texels. A lamp counts as whole if it does not touch the
/// border. `periods` are the periods along x and y in texels ([`Pattern::periods`]).
pub fn statistics_of(texture: &Image, components: &Components, periods: [Option<f64>; 2]) -> Statistics {
    let (width, height) = (texture.width, texture.height);
    let inside = |c: &Component| c.min.iter().all(|&low| low > 0) && c.max[0] + 1 < width && c.max[1] + 1 < height;
    let whole: Vec<bool> = components.list.iter().map(inside).collect();
    let colour = |i: usize| Some(Vec3::from_slice(&texture.data[3 * i..]));
    Statistics::of(&Pattern { width, height, components, whole: &whole, periods, colour })
}

/// Builds the metadata image of the texture (confidence, x and y distance to the nearest light) at working size. Each
/// pixel gets the metadata of the exemplar's pixel that `patch_map` shows there. Pixels without a patch get confidence
/// 0 and the largest distance, 1.
fn shown_metadata(patch_map: &PatchMap, exemplar: &Exemplar, metadata: &Image) -> Result<Image> {
    let mut out = Image::new(patch_map.width, patch_map.height, 3)?;
    for (y, row) in out.data.chunks_exact_mut(3 * patch_map.width).enumerate() {
        for (x, (label, pixel)) in patch_map.labels(y).zip(row.chunks_exact_mut(3)).enumerate() {
            match patch_map.source(x, y, label, &exemplar.working) {
                Some(source) => pixel.copy_from_slice(&metadata.data[3 * source..3 * source + 3]),
                None => pixel.copy_from_slice(&[0.0, 1.0, 1.0]),
            }
        }
    }
    Ok(out)
}
