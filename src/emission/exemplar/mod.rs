//! The exemplar: the usable part of the unwarped image, its lamps, and its reduced image for the synthesis.

pub mod area_sums;
pub mod bars;
pub mod components;
pub mod foreshortening;
pub mod fragments;
pub mod joins;
pub mod measured_lamp;
pub mod panes;
pub mod roles;
pub mod working;

use super::params::Input;
use crate::error::{Error, Result};
use crate::geometry::PhotoMap;
use crate::image::{Image, colour, try_collect, try_vec};
use crate::job::Job;
use components::{Component, Components};
use foreshortening::{LocalMap, MagnificationLimit};
use glam::DVec2;
use measured_lamp::MeasuredLamp;
use roles::Role;
use working::{Sources, Working};

/// A pixel counts as light if its confidence is at least this. [convention]
pub const LIT: f32 = 0.5;

/// A lamp must cover at least this number of photo pixels, roughly a disc three pixels across. If all lights are
/// smaller, the largest light sets the minimum. [judged on 5 photos]
const MIN_LAMP: f64 = 9.0;

/// The plane counts as a luminous ceiling if at least this share of it is lit. [bench photos:tune]
pub const MIN_LUMINOUS_SHARE: f64 = 0.3;

/// The usable part of the unwarped image with its lights.
pub struct Exemplar {
    pub width: usize,
    pub height: usize,
    /// Whether the photo shows each pixel: the pixel is finite, on the plane, and not magnified beyond the limit.
    pub shown: Vec<bool>,
    pub components: Components,
    /// The role of each component, in the order of `components.list`.
    pub roles: Vec<Role>,
    /// Number of photo pixels that show each component.
    pub photo_area: Vec<f64>,
    /// Share of each component that is dark: darker than half of the component's median luminance. Dark pixels show a
    /// thing in front of the lamp, or a bar.
    pub dark_share: Vec<f64>,
    /// Share of the pixels marked in `shown` that is lit.
    pub lit_share: f64,
    /// The map from unwarped pixels into the photo, if there is one.
    pub to_photo: Option<PhotoMap>,
    pub working: Working,
}

impl Exemplar {
    /// Analyses the input. If `max_magnification` is above 0, leaves out the parts that unwarping magnifies more than
    /// this many times as much as the least magnified pixel. Errors: no valid pixel, no light (`Degenerate`).
    pub fn new(input: &Input, working_side: f64, max_magnification: f64, job: Job) -> Result<Self> {
        let Input { unwarped: image, light, .. } = *input;
        let (width, height) = (image.width, image.height);
        let mut shown = shown_pixels(input)?;
        if let Some((_, to_photo)) = input.photo.filter(|_| max_magnification > 0.0) {
            let limit = MagnificationLimit::new(&to_photo, (&shown, width), max_magnification);
            limit.inspect(|limit| limit.restrict(&mut shown, width));
        }
        let (components, photo_area) = lights(input, &shown)?;
        let mut roles = roles::classify(&components, &shown, width, height);
        if let Some((_, to_photo)) = input.photo {
            fragments::demote(&components, &mut roles, &photo_area, to_photo);
        }

        let is_usable = |(&s, &l): (&bool, &u32)| s && (l == 0 || roles[l as usize - 1] != Role::Cut);
        let usable = try_collect(shown.iter().zip(&components.labels).map(is_usable))?;
        let sources = Sources { image, light, components: &components, usable: &usable, shown: &shown };
        let working = Working::new(&sources, working_side, job)?;

        let dark_share = dark_shares(&components, image)?;
        let lit = components.list.iter().map(|c| c.area).sum::<usize>();
        let lit_share = lit as f64 / shown.iter().filter(|&&s| s).count() as f64;
        Ok(Self {
            width,
            height,
            shown,
            components,
            roles,
            photo_area,
            dark_share,
            lit_share,
            to_photo: input.photo.map(|p| p.1),
            working,
        })
    }

    /// The share of an unwarped pixel that light covers, equal to the confidence in `light`. The share is 0 for a pixel
    /// that the photo does not show, for a lit pixel that belongs to no component (its light is too small to be a
    /// lamp), and for an index beyond the last pixel. Unlit pixels keep their confidence, which fades out beside lamps.
    pub fn coverage(&self, light: &Image, pixel: usize) -> f32 {
        let is_light = self.components.labels.get(pixel).is_some_and(|label| *label != 0);
        match self.shown.get(pixel) {
            Some(true) if is_light || light.data[pixel] < LIT => light.data[pixel].clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// The label of the component at a point within the exemplar; 0 where no component lies.
    pub fn label_at(&self, p: DVec2) -> u32 {
        self.components.labels[p.y as usize * self.width + p.x as usize]
    }

    /// Whether the plane is a luminous ceiling or a skylight: panes divided by bars, rather than lamps on a ceiling.
    pub fn is_luminous_ceiling(&self) -> bool {
        self.lit_share >= MIN_LUMINOUS_SHARE
    }

    /// Whether whole lamps ([`Role::is_whole`]) have less than half of the photo pixels that show light.
    pub fn is_mostly_cut(&self) -> bool {
        let of = |is_counted: fn(Role) -> bool| {
            let lights = self.roles.iter().zip(&self.photo_area).filter(|(role, _)| is_counted(**role));
            lights.map(|(_, area)| area).sum::<f64>()
        };
        of(Role::is_whole) < 0.5 * of(|_| true)
    }

    /// The bounding box of the lights: `[[first column, first row], [last column, last row]]`, inclusive.
    pub fn box_of_lights(&self) -> [[usize; 2]; 2] {
        let corners =
            |a: [usize; 2], b: [usize; 2], pick: fn(usize, usize) -> usize| [pick(a[0], b[0]), pick(a[1], b[1])];
        let lights = &self.components.list;
        let low = lights.iter().fold([usize::MAX; 2], |low, light| corners(low, light.min, usize::min));
        [low, lights.iter().fold([0; 2], |high, light| corners(high, light.max, usize::max))]
    }

    /// The whole lamps: lamps that the photo shows completely, and lamps that count as whole ([`Role::is_whole`]).
    pub fn lamps(&self) -> impl Iterator<Item = &Component> {
        self.components.list.iter().zip(&self.roles).filter(|(_, role)| role.is_whole()).map(|(c, _)| c)
    }

    /// The components for whose role `has_role` returns true, as evidence for a lattice, in descending order of their
    /// number of photo pixels.
    pub fn measured_lamps(&self, has_role: impl Fn(Role) -> bool) -> Vec<MeasuredLamp> {
        let lamps = self.components.list.iter().enumerate().filter(|(k, _)| has_role(self.roles[*k]));
        let mut all: Vec<MeasuredLamp> =
            lamps.map(|(k, lamp)| MeasuredLamp::new(k, lamp, self.photo_area[k], self.to_photo)).collect();
        all.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        all
    }

    /// The components that are copied as one piece, with their indices.
    pub fn pieces(&self) -> impl Iterator<Item = (usize, &Component)> {
        self.components.list.iter().enumerate().filter(|(k, _)| self.roles[*k].is_piece())
    }

    /// A measure of how much unwarping magnifies the photo at a point: it increases with the magnification. 0 without a
    /// photo.
    pub fn magnification(&self, at: DVec2) -> f64 {
        self.to_photo.map_or(0.0, |to_photo| foreshortening::denominator(&to_photo.homography, at))
    }

    /// The part of the exemplar that unwarping magnifies at most `max_magnification` times as much as the least
    /// magnified pixel. `None` if this part is the whole exemplar, or without a photo.
    pub fn magnification_limit(&self, max_magnification: f64) -> Option<MagnificationLimit> {
        MagnificationLimit::new(&self.to_photo?, (&self.shown, self.width), max_magnification)
    }
}

/// Whether each pixel is finite and on the plane. Errors: `Degenerate` if no pixel is.
fn shown_pixels(input: &Input) -> Result<Vec<bool>> {
    let Input { unwarped: image, light, valid, .. } = *input;
    let mut shown = try_vec(image.width * image.height, false)?;
    let pixels = image.data.chunks_exact(image.channels).zip(&light.data).zip(&valid.data);
    for (out, ((colour, light), &valid)) in shown.iter_mut().zip(pixels) {
        *out = valid >= 0.5 && light.is_finite() && colour.iter().all(|c| c.is_finite());
    }
    if shown.contains(&true) {
        return Ok(shown);
    }
    Err(Error::degenerate(
        "no pixel of the unwarped image is valid and finite: unwarp a part of the plane that the photo shows",
    ))
}

/// Finds the connected lights, and the number of photo pixels that show each. With a photo, leaves out lights that are
/// too small to be lamps ([`MIN_LAMP`]). Errors: `Degenerate` if there is no light.
fn lights(input: &Input, shown: &[bool]) -> Result<(Components, Vec<f64>)> {
    let Input { unwarped: image, light, photo, .. } = *input;
    let (width, height) = (image.width, image.height);
    let mut components = components::find(width, height, |i| shown[i] && light.data[i] >= LIT)?;
    let mut photo_area = photo_areas(&components, photo.map(|p| p.1));
    if photo.is_some() {
        // Drop lights that cover too few photo pixels to be lamps: remnants of other lights' edges, or noise.
        let min_area = photo_area.iter().copied().fold(0.0, f64::max).min(MIN_LAMP);
        components = components::find(width, height, |i| {
            components.labels[i].checked_sub(1).is_some_and(|k| photo_area[k as usize] >= min_area)
        })?;
        photo_area.retain(|&a| a >= min_area);
    }
    if components.list.is_empty() {
        return Err(Error::degenerate(
            "no light is marked: no valid pixel of `light` reaches 0.5; paint more of the lamps as light",
        ));
    }
    Ok((components, photo_area))
}

/// Area of each component in photo pixels, by the magnification at its centre; without a photo, its area in unwarped
/// pixels.
fn photo_areas(components: &Components, to_photo: Option<PhotoMap>) -> Vec<f64> {
    components.list.iter().map(|c| c.area as f64 * LocalMap::new(to_photo, c.centre).area()).collect()
}

/// The share of each component's pixels that are darker than half of the component's median luminance.
fn dark_shares(components: &Components, image: &Image) -> Result<Vec<f64>> {
    // Group the luminances of all lit pixels by component. `luminances` holds one range for each component. `ends`
    // first holds the start of each range, and then moves on with each added value until it is the end of the range.
    let mut ends = try_vec(components.list.len(), 0usize)?;
    let mut total = 0;
    for (end, component) in ends.iter_mut().zip(&components.list) {
        *end = total;
        total += component.area;
    }
    let mut luminances = try_vec(total, 0f32)?;
    for (i, &label) in components.labels.iter().enumerate().filter(|(_, label)| **label != 0) {
        let end = &mut ends[label as usize - 1];
        luminances[*end] = colour::luminance(image.rgb(i % image.width, i / image.width));
        *end += 1;
    }
    let share = |(component, &end): (&Component, &usize)| {
        let own = &mut luminances[end - component.area..end];
        let (_, median, _) = own.select_nth_unstable_by(component.area / 2, f32::total_cmp);
        let half = *median / 2.0;
        own.iter().filter(|luminance| **luminance < half).count() as f64 / component.area as f64
    };
    try_collect(components.list.iter().zip(&ends).map(share))
}
