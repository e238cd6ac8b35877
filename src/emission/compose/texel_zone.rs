//! Restricts a texture to the places where lamps are possible. A texture is a rectangle, but the surface that it covers
//! often is not, and ducts or sprinklers may take the place of lamps.

use crate::emission::lamps::luminaire::Luminaire;
use crate::emission::lamps::{crumbs, luminaires};
use crate::emission::output::Emission;
use crate::error::{Error, Result};
use crate::image::{Image, dilate, try_vec};
use crate::job::Job;
use glam::{DVec2, UVec2};

/// Whether light may be shown at a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelZone {
    /// Light is allowed.
    Open,
    /// The surface does not cover the texel: light there is removed.
    Hidden,
    /// No lamp may be here: a lamp that covers the texel is removed as a whole.
    KeepOut,
}

impl TexelZone {
    /// Finds the zone of each texel of a texture of `size` texels. `covered` tells for each texel whether the surface
    /// covers it, and `in_zone` whether a point, in texels, lies in a zone without lamps. `margin` is the minimum
    /// distance, in texels, of lamps from these zones, from the edge of the surface and from the border of the texture.
    /// With `None`, lamps may cross the edge and the border.
    pub fn mark(
        size: UVec2,
        covered: &[bool],
        in_zone: impl Fn(DVec2) -> bool,
        margin: Option<f64>,
        job: Job,
    ) -> Result<Vec<Self>> {
        // Mark the texels where no lamp may be: texels in zones and, if lamps must keep a margin, texels off the
        // surface. Then dilate the marked texels by the margin.
        let (width, height) = (size.x as usize, size.y as usize);
        let mut blocked = Image::new(width, height, 1)?;
        for (i, out) in blocked.data.iter_mut().enumerate() {
            let texel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            *out = f32::from(in_zone(texel) || (margin.is_some() && !covered[i]));
        }
        let radius = margin.unwrap_or(0.0).min(65_536.0);
        let blocked = dilate(&blocked, radius as f32, job)?;
        let is_at_edge = |x: usize, y: usize| {
            let edge = (x.min(y).min(width - 1 - x).min(height - 1 - y)) as f64;
            margin.is_some() && edge < radius.max(1.0)
        };

        let mut zones = try_vec(width * height, Self::Open)?;
        for (i, out) in zones.iter_mut().enumerate() {
            *out = match () {
                _ if blocked.data[i] > 0.5 || is_at_edge(i % width, i / width) => Self::KeepOut,
                _ if !covered[i] => Self::Hidden,
                _ => Self::Open,
            };
        }
        Ok(zones)
    }
}

impl Emission {
    /// Removes light where `zones`, which has one entry per texel, does not allow it. The statistics of the emission
    /// still describe the pattern before the removal.
    ///
    /// Errors: `Degenerate` if no lamp is left.
    pub fn restrict(&mut self, zones: &[TexelZone], job: Job) -> Result<()> {
        // Mark the lamps that are to be removed as a whole. This must come before hidden light is removed, which may
        // split a lamp into pieces.
        let found = luminaires::components(&self.mask)?;
        let mut is_out = vec![false; found.list.len()];
        for (&label, _) in found.labels.iter().zip(zones).filter(|(l, g)| **l != 0 && **g == TexelZone::KeepOut) {
            is_out[label as usize - 1] = true;
        }
        let goes = |lamp: usize, i: usize| is_out[lamp] || zones[i] == TexelZone::Hidden;
        let lit = found.labels.iter().enumerate().filter(|(_, label)| **label != 0);
        if !lit.map(|(i, &label)| (label as usize - 1, i)).any(|(lamp, i)| goes(lamp, i)) {
            return Ok(());
        }
        job.check()?;
        crumbs::take_out(&mut self.texture, &mut self.mask, &found, goes);
        let left = luminaires::components(&self.mask)?;
        if left.list.is_empty() {
            return Err(Error::degenerate(format!(
                "none of the {} lamps has a place on the surface: reduce the margin, or remove zones",
                found.list.len()
            )));
        }
        // Lamps that lost no light keep their outline and size; the other lamps are measured again from the mask.
        let mask = &self.mask;
        let mut lamps = luminaires::find(&self.texture, &left, &|i| mask.data[i], job)?;
        for (label, (lamp, component)) in (1..).zip(lamps.iter_mut().zip(&left.list)) {
            let row = component.min[1] * mask.width;
            let first = (row + component.min[0]..=row + component.max[0]).find(|&i| left.labels[i] == label);
            let before = first.map_or(0, |i| found.labels[i] as usize - 1);
            let was = self.luminaires.get(before).filter(|_| found.list[before] == *component);
            if let Some(was) = was {
                let Luminaire { colour, flux_share, .. } = *lamp;
                *lamp = Luminaire { colour, flux_share, ..was.clone() };
            }
        }
        luminaires::number_kinds(&mut lamps, &self.texture);
        self.luminaires = lamps;
        Ok(())
    }
}
