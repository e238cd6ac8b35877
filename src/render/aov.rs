//! What the camera sees of surfaces rather than of light: distance, position, orientation, colour and name of the first
//! surface along each sample of a pixel.
//!
//! Clear panes and mirrors are surfaces like others. Colours and coverage are means over all samples, so that they add up
//! like light; distances, positions and normals are means over the samples that met a surface. An index cannot be averaged:
//! it is that of the surface most samples met, if any met more than half of them, else of one of those met (the majority
//! vote of Boyer and Moore 1981, which takes one pass and one counter).

use super::ballot;
use super::path::PrimaryHit;
use super::world::World;
use glam::{DVec3, Vec3};

/// An image of the surfaces seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Distance along the viewing direction (z), in metres; infinite where nothing is.
    Depth,
    /// Distance along the ray, in metres; infinite where nothing is.
    Distance,
    /// In the world, in metres.
    Position,
    /// Unit shading normal in the world, on the side of the viewer; 0 where nothing is.
    Normal,
    /// The same of the triangle itself.
    GeometricNormal,
    /// Colour at normal incidence: what is reflected by either layer or let through.
    Albedo,
    /// Index of the mesh plus 1; 0 where nothing is.
    Object,
    /// Index of the material plus 1; 0 where nothing is.
    Material,
    /// Share of the pixel that is covered by a surface, in `[0, 1]`.
    Alpha,
    /// Luminance of the image in cd/m²: `0.2126 R + 0.7152 G + 0.0722 B`.
    Luminance,
}

impl Aov {
    pub const ALL: [Self; 10] = [
        Self::Depth,
        Self::Distance,
        Self::Position,
        Self::Normal,
        Self::GeometricNormal,
        Self::Albedo,
        Self::Object,
        Self::Material,
        Self::Alpha,
        Self::Luminance,
    ];

    /// The name of its layer in a file, as Blender and Nuke have it where they have one.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "Depth",
            Self::Distance => "Distance",
            Self::Position => "Position",
            Self::Normal => "Normal",
            Self::GeometricNormal => "GeometricNormal",
            Self::Albedo => "Albedo",
            Self::Object => "IndexOB",
            Self::Material => "IndexMA",
            Self::Alpha => "Alpha",
            Self::Luminance => "Luminance",
        }
    }

    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth | Self::Distance => &["Z"],
            Self::Position | Self::Normal | Self::GeometricNormal => &["X", "Y", "Z"],
            Self::Albedo => &["R", "G", "B"],
            Self::Object | Self::Material => &["X"],
            Self::Alpha => &["A"],
            Self::Luminance => &["Y"],
        }
    }

    /// How many numbers of a pixel are kept for it, apart from the count of samples that met a surface.
    pub fn kept(self) -> usize {
        match self {
            Self::Depth | Self::Distance => 1,
            Self::Position | Self::Normal | Self::GeometricNormal | Self::Albedo => 3,
            Self::Object | Self::Material => 2,
            Self::Alpha | Self::Luminance => 0,
        }
    }

    /// How many numbers of a pixel are summed for it where nothing may be lost ([`Surfaces::add_to`]).
    pub fn summed(self) -> usize {
        match self {
            Self::Object | Self::Material => ballot::NUMBERS,
            _ => self.kept(),
        }
    }

    /// Such sums as the numbers that are kept.
    pub fn keep_sums(self, sums: &[f64], kept: &mut [f32]) {
        match self {
            Self::Object | Self::Material => kept.copy_from_slice(&ballot::winner(sums).map(|v| v as f32)),
            _ => kept.iter_mut().zip(sums).for_each(|(k, &s)| *k = s as f32),
        }
    }

    /// Adds the sums over some paths to those over others.
    pub fn join_sums(self, sums: &mut [f64], others: &[f64]) {
        match self {
            Self::Object | Self::Material => ballot::join(sums, others),
            _ => sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other),
        }
    }

    /// The value of a pixel (positions relative to the world's centre) from the numbers kept, the samples that met a surface, and all samples.
    pub fn value(self, kept: &[f32], hits: f64, samples: f64, out: &mut [f32]) {
        let vector = || DVec3::from_array(std::array::from_fn(|i| f64::from(kept[i])));
        match self {
            Self::Depth | Self::Distance => {
                out[0] = if hits > 0.0 { (f64::from(kept[0]) / hits) as f32 } else { f32::INFINITY }
            }
            Self::Position => vector().map(|v| v / hits.max(1.0)).as_vec3().write_to_slice(out),
            Self::Normal | Self::GeometricNormal => vector().normalize_or_zero().as_vec3().write_to_slice(out),
            Self::Albedo => (vector() / samples).as_vec3().write_to_slice(out),
            Self::Object | Self::Material => out[0] = if hits > 0.0 { kept[0] } else { 0.0 },
            Self::Alpha => out[0] = (hits / samples) as f32,
            // Made from the image itself.
            Self::Luminance => (),
        }
    }
}

/// Sums over samples of what they met first.
#[derive(Clone, Copy, Default)]
pub struct Surfaces {
    pub hits: u32,
    depth: f64,
    distance: f64,
    position: DVec3,
    normal: DVec3,
    geometric: DVec3,
    albedo: DVec3,
    object: Vote,
    material: Vote,
}

impl Surfaces {
    /// `depth` is along the camera's viewing direction.
    pub fn add(&mut self, world: &World, seen: &PrimaryHit, depth: f32) {
        let material = world.scene().meshes[seen.mesh as usize].material;
        self.hits += 1;
        self.depth += f64::from(depth);
        self.distance += f64::from(seen.distance);
        self.position += seen.position.as_dvec3();
        self.normal += seen.normal.as_dvec3();
        self.geometric += seen.geometric_normal.as_dvec3();
        self.albedo += seen.colour.min(Vec3::ONE).as_dvec3();
        self.object.cast(seen.mesh + 1);
        self.material.cast(material as u32 + 1);
    }

    /// Adds the sums to those kept of a pixel.
    pub fn keep(&self, aov: Aov, kept: &mut [f32]) {
        match aov {
            Aov::Object => self.object.join(kept),
            Aov::Material => self.material.join(kept),
            _ => self.sum(aov).to_array().iter().zip(kept).for_each(|(v, k)| *k += *v as f32),
        }
    }

    /// Adds what a single path met to sums that keep all digits, and all votes but those of very many candidates.
    pub fn add_to(&self, aov: Aov, sums: &mut [f64]) {
        match aov {
            Aov::Object => ballot::cast(sums, self.object.candidate.into(), self.object.lead.into()),
            Aov::Material => ballot::cast(sums, self.material.candidate.into(), self.material.lead.into()),
            _ => self.sum(aov).to_array().iter().zip(sums).for_each(|(v, s)| *s += v),
        }
    }

    /// The sum of what is no index, in as many of its numbers as there are.
    fn sum(&self, aov: Aov) -> DVec3 {
        match aov {
            Aov::Depth => DVec3::splat(self.depth),
            Aov::Distance => DVec3::splat(self.distance),
            Aov::Position => self.position,
            Aov::Normal => self.normal,
            Aov::GeometricNormal => self.geometric,
            Aov::Albedo => self.albedo,
            Aov::Object | Aov::Material | Aov::Alpha | Aov::Luminance => DVec3::ZERO,
        }
    }
}

/// A candidate for the majority, and by how many votes it leads.
#[derive(Clone, Copy, Default)]
struct Vote {
    candidate: u32,
    lead: u32,
}

impl Vote {
    fn cast(&mut self, candidate: u32) {
        if self.lead == 0 {
            self.candidate = candidate;
        }
        self.lead = if self.candidate == candidate { self.lead + 1 } else { self.lead - 1 };
    }

    /// Joins the outcome of other votes, kept as two numbers; a majority of all still wins (Agarwal et al. 2013,
    /// "Mergeable summaries").
    fn join(self, kept: &mut [f32]) {
        let (candidate, lead) = (self.candidate as f32, self.lead as f32);
        if kept[0] == candidate {
            kept[1] += lead;
        } else if lead > kept[1] {
            kept.copy_from_slice(&[candidate, lead - kept[1]]);
        } else {
            kept[1] -= lead;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn a_majority_wins_however_the_votes_are_split() {
        let mut rng = Rng::new(31, &[]);
        for round in 0..200 {
            // 101 votes of which 51 are for candidate 7, in random order, joined at random places.
            let mut votes: Vec<u32> = (0..101).map(|i| if i < 51 { 7 } else { 1 + rng.below(5) as u32 }).collect();
            for i in (1..votes.len()).rev() {
                votes.swap(i, rng.below(i + 1));
            }
            let mut kept = [0.0; 2];
            let mut vote = Vote::default();
            for v in votes {
                vote.cast(v);
                if rng.below(7) == 0 {
                    vote.join(&mut kept);
                    vote = Vote::default();
                }
            }
            vote.join(&mut kept);
            assert_eq!(kept[0], 7.0, "round {round}");
        }
    }
}
