//! Arbitrary output variables (AOVs): attributes of the first surface along each camera ray, such as distance,
//! position, normal, albedo and mesh index, accumulated per pixel.
//!
//! Clear panes and mirrors count as surfaces. The albedo and the coverage of a pixel are means over all its samples;
//! samples of the background count as 0. Distances, positions and normals are means over the samples that hit a
//! surface; a mean normal is scaled to unit length. An index cannot be averaged: a pixel gets the index that more than
//! half of its hits have. Without such a majority it gets the index of any one of its hits (one-pass majority vote with
//! one counter, Boyer and Moore 1981).

use super::ballot;
use super::path::PrimaryHit;
use super::world::World;
use glam::{DVec3, Vec3};

/// A surface attribute that a film can record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Distance of the surface along the viewing direction (camera z), in metres; infinite for the background.
    Depth,
    /// Distance of the surface along the camera ray, in metres; infinite for the background.
    Distance,
    /// Position of the surface in scene coordinates, in metres; 0 for the background.
    Position,
    /// Unit shading normal in world space, facing the viewer; 0 for the background.
    Normal,
    /// Unit geometric normal of the triangle, facing the viewer; 0 for the background.
    GeometricNormal,
    /// Reflectance plus transmittance at normal incidence, limited to 1 per channel; 0 for the background.
    Albedo,
    /// Index of the mesh plus 1; 0 for the background. The luminous faces of light number `i` have the value
    /// `m + i + 1` if the scene has `m` meshes.
    Object,
    /// Index of the material plus 1; 0 for the background. The luminous faces of luminaires have the value `n + 1` if
    /// the scene has `n` materials.
    Material,
    /// Share of the pixel's samples that hit a surface, in `[0, 1]`.
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

    /// Returns the name of the attribute's layer in image files. If Blender or Nuke has a name for the attribute, the
    /// layer has the same name.
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

    /// Returns the number of f32 values per pixel in which a film sums up this attribute. The number of hits is stored
    /// separately.
    pub fn total_count(self) -> usize {
        match self {
            Self::Depth | Self::Distance => 1,
            Self::Position | Self::Normal | Self::GeometricNormal | Self::Albedo => 3,
            Self::Object | Self::Material => 2,
            Self::Alpha | Self::Luminance => 0,
        }
    }

    /// Returns the number of f64 values per pixel in which a render in parts (`super::parts`) sums up this attribute by
    /// [`SurfaceSums::add_to`].
    pub fn sum_count(self) -> usize {
        match self {
            Self::Object | Self::Material => ballot::NUMBERS,
            _ => self.total_count(),
        }
    }

    /// Converts the f64 sums that a render in parts keeps for a pixel to the f32 totals that a film stores.
    pub fn set_totals(self, sums: &[f64], totals: &mut [f32]) {
        match self {
            Self::Object | Self::Material => totals.copy_from_slice(&ballot::winner(sums).map(|v| v as f32)),
            _ => totals.iter_mut().zip(sums).for_each(|(k, &s)| *k = s as f32),
        }
    }

    /// Adds `others`, the f64 sums over other paths of the same pixel, to `sums`.
    pub fn join_sums(self, sums: &mut [f64], others: &[f64]) {
        match self {
            Self::Object | Self::Material => ballot::join(sums, others),
            _ => sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other),
        }
    }

    /// Writes the value of a pixel to `out`, computed from the pixel's totals, number of hits and number of samples.
    /// Positions are written in world coordinates (relative to `facet::centre`); the caller converts them to scene
    /// coordinates.
    pub fn value(self, totals: &[f32], hits: f64, samples: f64, out: &mut [f32]) {
        let vector = || DVec3::from_array(std::array::from_fn(|i| f64::from(totals[i])));
        match self {
            Self::Depth | Self::Distance => {
                out[0] = if hits > 0.0 { (f64::from(totals[0]) / hits) as f32 } else { f32::INFINITY }
            }
            Self::Position => vector().map(|v| v / hits.max(1.0)).as_vec3().write_to_slice(out),
            Self::Normal | Self::GeometricNormal => vector().normalize_or_zero().as_vec3().write_to_slice(out),
            Self::Albedo => (vector() / samples).as_vec3().write_to_slice(out),
            Self::Object | Self::Material => out[0] = if hits > 0.0 { totals[0] } else { 0.0 },
            Self::Alpha => out[0] = (hits / samples) as f32,
            // Nothing to write: the film computes the luminance from the main image.
            Self::Luminance => (),
        }
    }
}

/// Sums of all attributes over the primary hits of one pixel.
#[derive(Clone, Copy, Default)]
pub struct SurfaceSums {
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

impl SurfaceSums {
    /// Adds a primary hit. `depth` is the distance from the camera to the hit along the camera's forward direction, in
    /// metres; `seen.distance` is the distance along the ray.
    pub fn add(&mut self, world: &World, seen: &PrimaryHit, depth: f32) {
        let material = world.mesh(seen.mesh).material;
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

    /// Adds the sum of a surface attribute over the recorded hits to the f32 totals that the film keeps for the pixel.
    /// For an index, merges the recorded votes with the votes in the totals instead.
    pub fn add_to_totals(&self, aov: Aov, totals: &mut [f32]) {
        match aov {
            Aov::Object => self.object.join(totals),
            Aov::Material => self.material.join(totals),
            _ => self.sum(aov).to_array().iter().zip(totals).for_each(|(v, k)| *k += *v as f32),
        }
    }

    /// Adds the sum of a surface attribute over the recorded hits to the f64 sums that a render in parts keeps for the
    /// pixel. Call this function after each path: the votes for an index are then counted exactly, as long as the pixel
    /// shows at most `ballot::CANDIDATES` different indices.
    pub fn add_to(&self, aov: Aov, sums: &mut [f64]) {
        match aov {
            Aov::Object => ballot::cast(sums, self.object.candidate.into(), self.object.lead.into()),
            Aov::Material => ballot::cast(sums, self.material.candidate.into(), self.material.lead.into()),
            _ => self.sum(aov).to_array().iter().zip(sums).for_each(|(v, s)| *s += v),
        }
    }

    /// Returns the sum of an attribute that is not an index. The sum of a scalar attribute is in the first component.
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

/// State of a Boyer–Moore majority vote: the leading candidate, and its lead. The lead is the number of the
/// candidate's votes that no vote for another candidate has cancelled.
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

    /// Merges this vote into `totals`, which holds the candidate and the lead of earlier votes. A candidate with a
    /// majority of all votes still wins after merging (Agarwal et al. 2013, "Mergeable summaries").
    fn join(self, totals: &mut [f32]) {
        let (candidate, lead) = (self.candidate as f32, self.lead as f32);
        if totals[0] == candidate {
            totals[1] += lead;
        } else if lead > totals[1] {
            totals.copy_from_slice(&[candidate, lead - totals[1]]);
        } else {
            totals[1] -= lead;
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
            // Cast 101 votes in random order, 51 of them for candidate 7, and merge the partial votes at random times.
            let mut votes: Vec<u32> = (0..101).map(|i| if i < 51 { 7 } else { 1 + rng.below(5) as u32 }).collect();
            for i in (1..votes.len()).rev() {
                votes.swap(i, rng.below(i + 1));
            }
            let mut totals = [0.0; 2];
            let mut vote = Vote::default();
            for v in votes {
                vote.cast(v);
                if rng.below(7) == 0 {
                    vote.join(&mut totals);
                    vote = Vote::default();
                }
            }
            vote.join(&mut totals);
            assert_eq!(totals[0], 7.0, "round {round}");
        }
    }
}
