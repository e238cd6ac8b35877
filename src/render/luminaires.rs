//! Luminaires that shine from the faces of their luminous openings.
//!
//! A face has the same luminance at all of its points: in direction ω it is `L(ω) = I(ω) / A(ω)`, with the measured
//! intensity I and the projected area A of all faces. So the luminaire has exactly the measured intensity at a
//! distance, and the near field of a uniform surface. Faces reflect no light: the measured intensity contains all light
//! that leaves them in a dark room.

use super::bounds::{Bounds, CONE_MARGIN};
use super::facet;
use super::measured::Measured;
use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use crate::maths;
use crate::photometry::faces::{Emits, FacePatch, Faces};
use crate::photometry::opening::Opening;
use crate::scene::{MAX_LIGHT, Mesh, PunctualLight, Scene, c90};
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use std::sync::Arc;

/// Distance in metres by which flat faces are moved outwards, so that a face in the plane of a ceiling lies in front of
/// the ceiling. [convention]
const GAP: f64 = 2e-4;
/// Flat faces are moved outwards by [`GAP`], or by this multiple of d if that is larger. A ray starts at the distance d
/// off its surface, so that rounding does not make it hit this surface again. Here d is taken at the largest coordinate
/// of the scene, which counts as at most `facet::MAX_FREE_COORDINATE`. Rounding cannot close a gap of this size.
/// [rounding]
const GAP_OFFSETS: f64 = 8.0;
/// The luminance is intensity / projected area. In this quotient, the area counts as at least this share of the
/// opening's largest projected area along an axis of the luminaire. Otherwise a flat opening would have infinite
/// luminance along its plane, where its projected area is 0. [rounding]
const EDGE_ON: f64 = 1e-6;
/// Steps of a grid of directions in degrees: the first in C, the second in γ. The bounds on the intensities of patches
/// are computed from the luminances in these directions. [convention]
const STEP: [usize; 2] = [15, 5];
/// For light sampling, the bound on the intensity of a patch is at least this share of the largest such bound of the
/// luminaire. [convention]
const MIN_SHARE: f64 = 0.01;
/// Let L be the largest luminance of a flat patch, A its area and I its largest intensity, over all directions. If L A
/// is larger than this multiple of I, the patch is bounded by [`IntensityBound::Cone`] instead of
/// [`IntensityBound::Cosine`]. [convention]
const MAX_COSINE_EXCESS: f64 = 2.0;
/// A flat patch is also bounded by [`IntensityBound::Cone`] if it emits only within this angle in degrees to its
/// normal. [convention]
const NARROW: f64 = 60.0;

/// The faces of the luminaires of a scene.
#[derive(Default)]
pub struct Luminaires {
    /// For each light of the scene, a mesh of its faces in scene coordinates, without triangles for lights that shine
    /// from points. Empty if no light has faces.
    pub meshes: Vec<Mesh>,
    /// The luminaires with faces.
    pub sources: Vec<FaceLuminaire>,
}

/// A luminaire with faces.
pub struct FaceLuminaire {
    /// Index of the luminaire among the lights of the scene.
    pub light: usize,
    pub emission: FaceEmission,
    shape: Arc<LuminaireShape>,
    /// Position of the luminaire in world coordinates.
    position: DVec3,
    /// Unit directions in the scene: of C = 0°, of C = 90° and of the luminaire's axis (γ = 0°).
    frame: [DVec3; 3],
}

/// The data that all luminaires with the same luminous intensity distribution share.
struct LuminaireShape {
    faces: Faces,
    /// For each patch, the bound on its intensity; `None` for patches that do not emit.
    intensity_bounds: Vec<Option<IntensityBound>>,
    /// Luminous flux in lumens of a luminaire whose `colour` is (1, 1, 1).
    flux: f64,
}

/// An upper bound of the intensity of a patch in candela, as a function of direction, for a luminaire whose `colour` is
/// (1, 1, 1).
#[derive(Clone, Copy)]
enum IntensityBound {
    /// `Cosine(I₀)`: a triangle of area a, in a patch of area A, emits at most I₀ (a / A) cos θ at the angle θ to its
    /// normal.
    Cosine(f64),
    /// The intensity of a flat patch is at most `peak` up to `angle` (radians) from its normal, and 0 beyond.
    Cone { peak: f64, angle: f64 },
}

/// The luminance of the faces of a luminaire.
pub struct FaceEmission {
    measured: Measured,
    opening: Opening,
    min_area: f64,
    colour: Vec3,
}

impl FaceEmission {
    /// Returns the luminance per channel, in cd/m², towards a viewer in `direction`, limited to [`MAX_LIGHT`]. All
    /// faces that the viewer sees have the same luminance.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let local = self.measured.local(direction);
        let area = self.opening.projected_area(local).max(self.min_area);
        (self.colour * (self.measured.candela(local) / area) as f32).min(Vec3::splat(MAX_LIGHT))
    }

    pub fn colour(&self) -> Vec3 {
        self.colour
    }
}

impl Luminaires {
    /// Builds the faces of all luminaires. `centre` is the origin of world coordinates, and `material` the index of the
    /// material of the faces.
    pub fn new(scene: &Scene, centre: DVec3, material: usize) -> Result<Self> {
        let mut this = Self::default();
        let (mut shapes, mut known_gap): (Vec<Option<Arc<LuminaireShape>>>, _) = (Vec::new(), None);
        for (light, kind) in scene.lights.iter().enumerate() {
            let PunctualLight::Luminaire { position, axis, c0, colour, distribution, .. } = *kind else { continue };
            let Some(opening) = kind.opening(&scene.distributions) else { continue };
            let measured = Measured::new(axis, c0, scene.distributions[distribution].clone());
            let min_area = opening.largest_area() * EDGE_ON;
            let emission = FaceEmission { measured, opening, min_area, colour };
            let position = position.as_dvec3() - centre;
            let gap = *known_gap.get_or_insert_with(|| gap(scene, centre));
            shapes.resize(scene.distributions.len(), None);
            let shape = match &shapes[distribution] {
                Some(shape) => shape.clone(),
                None => Arc::new(LuminaireShape::new(scene, distribution, &opening, gap)),
            };
            shapes[distribution] = Some(shape.clone());
            let frame = [c0, c90(axis, c0), axis].map(|v| v.as_dvec3());
            this.sources.push(FaceLuminaire { light, emission, shape, position, frame });
        }
        if !this.sources.is_empty() {
            this.meshes = try_with_capacity(scene.lights.len())?;
            this.meshes.resize(scene.lights.len(), Mesh::default());
            for source in &this.sources {
                this.meshes[source.light] = source.mesh(centre, material)?;
            }
        }
        Ok(this)
    }
}

/// Returns the distance in metres by which flat faces are moved outwards (see [`GAP_OFFSETS`]).
fn gap(scene: &Scene, centre: DVec3) -> f64 {
    let points = scene.meshes.iter().flat_map(|mesh| &mesh.positions);
    let largest = points.map(|p| (p.as_dvec3() - centre).abs().max_element()).fold(0.0, f64::max);
    GAP.max(largest.min(f64::from(facet::MAX_FREE_COORDINATE)) * GAP_OFFSETS * f64::from(facet::OFFSET))
}

impl FaceLuminaire {
    fn in_world(&self, local: DVec3) -> DVec3 {
        self.position + self.frame[0] * local.x + self.frame[1] * local.y + self.frame[2] * local.z
    }

    /// Returns the luminous flux in lumens, averaged over the channels.
    pub fn flux(&self) -> f64 {
        self.shape.flux * f64::from(self.emission.colour.element_sum() / 3.0)
    }

    /// Returns the corners of the triangles in world coordinates. The axes of a luminaire are left-handed, so two
    /// corners of each triangle are swapped: the triangles then wind anticlockwise as seen from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let Faces { points, triangles, .. } = &self.shape.faces;
        triangles.iter().map(|&[a, b, c]| [a, c, b].map(|i| self.in_world(points[i as usize]).as_vec3()))
    }

    /// Returns the mesh of the faces in scene coordinates.
    fn mesh(&self, centre: DVec3, material: usize) -> Result<Mesh> {
        let Faces { points, triangles, .. } = &self.shape.faces;
        Ok(Mesh {
            name: format!("light{}", self.light),
            material,
            positions: try_collect(points.iter().map(|p| (self.in_world(*p) + centre).as_vec3()))?,
            triangles: try_collect(triangles.iter().map(|&[a, b, c]| [a, c, b]))?,
            ..Mesh::default()
        })
    }

    /// Returns the range of triangles of each patch that emits, and the patch's bounds for light sampling. A dark
    /// luminaire has no such patches. `strength` is the colour of the luminaire, averaged over the channels.
    pub fn patches(&self, strength: f32) -> impl Iterator<Item = (Range<usize>, Bounds)> {
        let patches = self.shape.faces.patches.iter().zip(&self.shape.intensity_bounds);
        patches.filter_map(move |(patch, intensity_bound)| {
            let bounds = self.bounds(patch, (*intensity_bound)?, strength);
            (bounds.intensity > 0.0).then_some((patch.triangles.clone(), bounds))
        })
    }

    fn bounds(&self, patch: &FacePatch, intensity_bound: IntensityBound, strength: f32) -> Bounds {
        let Faces { points, triangles, .. } = &self.shape.faces;
        let area: f64 = patch.triangles.clone().map(|t| self.shape.faces.area_vector(t).length()).sum();
        let of_triangle = |t: usize| {
            let normal = self.shape.faces.area_vector(t);
            let corners = triangles[t].map(|i| self.in_world(points[i as usize]).as_vec3());
            let direction = (self.in_world(normal) - self.position).normalize_or_zero().as_vec3();
            let peak = match intensity_bound {
                IntensityBound::Cosine(peak) | IntensityBound::Cone { peak, .. } => peak,
            };
            Bounds::of_surface(corners, direction, false, (peak * normal.length() / area) as f32 * strength)
        };
        let parts: Vec<Bounds> = patch.triangles.clone().map(of_triangle).collect();
        let whole = Bounds::union(&parts);
        match intensity_bound {
            IntensityBound::Cosine(_) => whole,
            // In `Bounds`, the intensity has its full value up to the angle `cone_angle` - 90° to the axis, hence 90°
            // are added.
            IntensityBound::Cone { angle, .. } => Bounds { cone_angle: (angle + FRAC_PI_2) as f32, ..whole },
        }
    }
}

impl LuminaireShape {
    fn new(scene: &Scene, distribution: usize, opening: &Opening, gap: f64) -> Self {
        let luminaire = &scene.distributions[distribution];
        let (low, high) = (luminaire.min_gamma(), luminaire.max_gamma());
        let is_dark = luminaire.candela.iter().all(|v| *v == 0.0);
        let emits = Emits { forwards: !is_dark && low < 90.0, backwards: !is_dark && high > 90.0 };
        let faces = Faces::new(opening, emits, gap);
        // Compute the luminance in a grid of directions over the whole sphere.
        let measured = Measured::new(Vec3::Z, Vec3::X, luminaire.clone());
        let min_area = opening.largest_area() * EDGE_ON;
        let directions =
            (0..=180).step_by(STEP[1]).flat_map(|gamma| (0..360).step_by(STEP[0]).map(move |c| [c, gamma]));
        let samples: Vec<(DVec3, f64)> = directions
            .map(|angles| {
                let [c, gamma] = angles.map(|degrees| f64::from(degrees as u32).to_radians());
                let local =
                    DVec3::new(maths::sin(gamma) * maths::cos(c), maths::sin(gamma) * maths::sin(c), maths::cos(gamma));
                (local, measured.candela(local) / opening.projected_area(local).max(min_area))
            })
            .collect();
        let mut intensity_bounds: Vec<_> = faces
            .patches
            .iter()
            .map(|patch| patch.is_luminous.then(|| IntensityBound::new(&faces, patch, &samples, [low, high])))
            .collect();
        // A patch may seem dark only because the grid of directions misses its light. Raise the bound of such a patch,
        // so that light sampling selects the patch too.
        let brightest = intensity_bounds.iter().flatten().map(IntensityBound::peak).fold(0.0, f64::max);
        intensity_bounds.iter_mut().flatten().for_each(|bound| bound.raise(brightest * MIN_SHARE));
        Self { faces, intensity_bounds, flux: luminaire.flux() }
    }
}

impl IntensityBound {
    /// Bounds the intensity of a patch. `samples` are directions over the whole sphere, with the luminance of the faces
    /// in each. The luminaire emits only at angles γ between the two `limits` in degrees.
    fn new(faces: &Faces, patch: &FacePatch, samples: &[(DVec3, f64)], limits: [f64; 2]) -> Self {
        let normals: Vec<DVec3> = patch.triangles.clone().map(|t| faces.area_vector(t)).collect();
        let area: f64 = normals.iter().map(|n| n.length()).sum();
        let whole: DVec3 = normals.iter().sum();
        let is_flat = whole.length() > area * (1.0 - 1e-9);
        let (mut luminance, mut peak) = (0.0f64, 0.0f64);
        for (direction, sample) in samples {
            let seen: f64 = normals.iter().map(|n| n.dot(*direction).max(0.0)).sum();
            if seen > 0.0 {
                (luminance, peak) = (luminance.max(*sample), peak.max(sample * seen));
            }
        }
        let widest = match whole.normalize_or_zero().z {
            z if z > 1.0 - 1e-9 => limits[1].min(90.0),
            z if z < 1e-9 - 1.0 => (180.0 - limits[0]).min(90.0),
            _ => 90.0,
        };
        if is_flat && (luminance * area > MAX_COSINE_EXCESS * peak || widest < NARROW) {
            Self::Cone { peak, angle: widest.to_radians() + CONE_MARGIN }
        } else {
            Self::Cosine(luminance * area)
        }
    }

    fn peak(&self) -> f64 {
        match *self {
            Self::Cosine(peak) | Self::Cone { peak, .. } => peak,
        }
    }

    fn raise(&mut self, min_peak: f64) {
        match self {
            Self::Cosine(peak) | Self::Cone { peak, .. } => *peak = peak.max(min_peak),
        }
    }
}
