//! Lists the lamps of a composition without rendering the whole texture.
//!
//! Every lamp of a texture is a shifted lamp of an exemplar, so the list stores each outline once, and a position for
//! each lamp. The outlines are measured in the unwarped image, so their accuracy does not depend on the size of the
//! texels.
//!
//! Some lights are copied patch by patch and not as a whole: lights that run through their exemplar and, without
//! [`crate::emission::Params::whole_lamps`], all lights. Only their outlines are measured in the texture.

use super::composition::{Composition, exemplars};
use super::layer::Layer;
use super::weights::Style;
use super::{patch_lights, source};
use crate::emission::lamps::instance::Instance;
use crate::emission::lamps::luminaire::Luminaire;
use crate::emission::lamps::{kinds, luminaires};
use crate::emission::params::Input;
use crate::error::Result;
use crate::geometry::polygon;
use crate::image::colour::luminance;
use crate::job::Job;
use crate::maths;
use glam::{DVec2, Vec2Swizzles};

/// A lamp is listed if at least this area of it, in texels, lies within the texture. [rounding]
const MIN_SHOWN: f64 = 1e-6;

/// The lamps that a composition shows.
pub struct LampList {
    /// For each exemplar, the shapes of all its components, in unwarped pixels.
    shapes: Vec<Vec<Luminaire>>,
    /// Each lamp in the texture, with the index of its exemplar.
    shown: Vec<(u32, Instance)>,
    /// Lights that are copied patch by patch, measured in the texture.
    others: Vec<Luminaire>,
    /// Sum of luminance times area over all listed lights.
    flux: f64,
}

impl LampList {
    /// Lists the lamps of a composition. `input` and `styles` must be the exemplars for which the composition was
    /// planned. Errors: as for [`Composition::tile`].
    pub fn new(composition: &Composition, input: &Input, styles: &[Style], job: Job) -> Result<Self> {
        composition.check_exemplars(input, styles)?;
        let mut list = Self { shapes: Vec::new(), shown: Vec::new(), others: Vec::new(), flux: 0.0 };
        for (layer, (input, _)) in composition.layers.iter().zip(exemplars(input, 1.0, styles)) {
            let colours = source::mean_colours(layer, input, job)?;
            let Layer { exemplar, .. } = layer;
            let coverage = |pixel: usize| exemplar.coverage(input.light, pixel);
            let mut shapes = luminaires::find(&input.unwarped.to_rgb()?, &exemplar.components, &coverage, job)?;
            for (shape, (design, fitted)) in
                shapes.iter_mut().enumerate().filter_map(|(k, s)| Some((s, layer.designs.of(k)?)))
            {
                design.describe(fitted.centre, shape);
            }
            shapes.iter_mut().zip(colours).for_each(|(shape, colour)| shape.colour = colour);
            list.shapes.push(shapes);
        }
        for (k, layer) in composition.layers.iter().enumerate() {
            job.check()?;
            // If the texture is a plain copy of a part of the exemplar, all components are moved by one shift.
            let copied = layer.patch_map.shifts.first().filter(|_| layer.is_plain_copy());
            let copies = copied.map(|shift| {
                let instance = |component| Instance { component, shift: shift.exact };
                (0..layer.exemplar.components.list.len()).map(instance).collect::<Vec<_>>()
            });
            for &instance in copies.as_ref().unwrap_or(&layer.instances) {
                let lamp = list.placed(composition, k, instance);
                if lamp.area > MIN_SHOWN {
                    list.shown.push((k as u32, instance));
                    list.flux += flux(&lamp);
                }
            }
        }
        list.others = patch_lights::find(composition, input, styles, job)?;
        list.number_kinds(composition);
        list.flux += list.others.iter().map(flux).sum::<f64>();
        Ok(list)
    }

    /// Groups lamps of equal shape into kinds, and stores in each lamp the number of its kind. A kind may hold lamps of
    /// several exemplars, and lights that are copied patch by patch.
    fn number_kinds(&mut self, composition: &Composition) {
        let mut counts: Vec<Vec<usize>> = self.shapes.iter().map(|shapes| vec![0; shapes.len()]).collect();
        for (k, instance) in &self.shown {
            let is_whole = composition.layers[*k as usize].exemplar.roles[instance.component].is_whole();
            counts[*k as usize][instance.component] += usize::from(is_whole);
        }
        // Convert all shapes to texels, so that they can be compared.
        let size = DVec2::new(composition.width as f64, composition.height as f64);
        let factors = composition.layers.iter().map(|layer| 1.0 / layer.scale);
        let shown = |(shapes, factor): (&Vec<Luminaire>, f64)| {
            shapes.iter().map(|shape| shape.moved(DVec2::ZERO, factor)).collect::<Vec<_>>()
        };
        let mut lamps: Vec<Luminaire> = self.shapes.iter().zip(factors).flat_map(shown).collect();
        lamps.extend(self.others.iter().cloned());
        let counts = counts.into_iter().flatten().chain(self.others.iter().map(|l| usize::from(l.is_within(size))));
        kinds::number(lamps.iter_mut().zip(counts));
        let listed = self.shapes.iter_mut().flatten().chain(&mut self.others);
        listed.zip(lamps).for_each(|(lamp, numbered)| lamp.kind = numbered.kind);
    }

    /// The number of listed lights.
    pub fn count(&self) -> usize {
        self.shown.len() + self.others.len()
    }

    /// Returns the light with the given index; `None` if there is no such light. If the border of the texture cuts the
    /// light, returns the part within the texture.
    pub fn get(&self, composition: &Composition, index: usize) -> Option<Luminaire> {
        let mut lamp = match self.shown.get(index) {
            Some(&(k, instance)) => self.placed(composition, k as usize, instance),
            None => self.others.get(index - self.shown.len())?.clone(),
        };
        lamp.flux_share = if self.flux > 0.0 { flux(&lamp) / self.flux } else { 0.0 };
        Some(lamp)
    }

    /// A lamp of exemplar `k` as the texture shows it: shifted, scaled, and clipped to the texture.
    fn placed(&self, composition: &Composition, k: usize, instance: Instance) -> Luminaire {
        let layer: &Layer = &composition.layers[k];
        let shape = &self.shapes[k][instance.component];
        let shift = layer.rounded(instance.shift);
        let size = DVec2::new(composition.width as f64, composition.height as f64);
        let whole = shape.moved(shift, 1.0 / layer.scale);
        // If the texture is a plain copy of a part of the exemplar, the exemplar's weight in the blend dims the lights.
        // Otherwise a lamp is shown at full brightness or not at all.
        let whole = match layer.is_plain_copy() {
            true => Luminaire { colour: whole.colour * composition.weights.at(k, whole.centre / size), ..whole },
            false => whole,
        };
        if whole.outline.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()) {
            return whole;
        }
        within(&whole, size)
    }
}

fn flux(lamp: &Luminaire) -> f64 {
    f64::from(luminance(lamp.colour)) * lamp.area
}

/// Clips a lamp to a texture of the given size in texels, and measures the remaining part.
fn within(lamp: &Luminaire, size: DVec2) -> Luminaire {
    let sides = [(DVec2::NEG_X, 0.0), (DVec2::NEG_Y, 0.0), (DVec2::X, size.x), (DVec2::Y, size.y)];
    let outline =
        sides.iter().fold(lamp.outline.clone(), |outline, &(normal, offset)| polygon::clip(&outline, normal, offset));
    let all = polygon::area(&lamp.outline).abs();
    let left = polygon::area(&outline).abs();
    let share = if all > 0.0 { (left / all).min(1.0) } else { 0.0 };
    if share <= 0.0 {
        return Luminaire { area: 0.0, outline: Vec::new(), kind: 0, ..*lamp };
    }
    let axis = maths::direction_at(lamp.orientation);
    let extent = |axis: DVec2| polygon::extent(&outline, axis);
    // If the remaining part is longer across the lamp's axis than along it, exchange the axes.
    let (size, quarter) = (DVec2::new(extent(axis), extent(axis.perp())), std::f64::consts::FRAC_PI_2);
    let (size, orientation) = match lamp.orientation {
        angle if size.x >= size.y => (size, angle),
        angle => (size.yx(), if angle > 0.0 { angle - quarter } else { angle + quarter }),
    };
    Luminaire { centre: centroid(&outline), size, orientation, area: lamp.area * share, outline, kind: 0, ..*lamp }
}

/// The centroid of the area that a polygon encloses.
fn centroid(corners: &[DVec2]) -> DVec2 {
    let origin = corners.first().copied().unwrap_or_default();
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (i, p) in corners.iter().enumerate() {
        let (p, q) = (*p - origin, corners[(i + 1) % corners.len()] - origin);
        let part = p.perp_dot(q);
        sum += (p + q) * part / 3.0;
        area += part;
    }
    origin + if area == 0.0 { DVec2::ZERO } else { sum / area }
}
