//! Renders the light of a generated room that reaches the camera, and finds what each pixel shows.

use super::room::{Class, Room};
use super::viewpoint::{Shot, Surfaces};
use glam::{DVec2, Vec2, Vec3};
use luxfer::exec;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::render::{self, Aov, Film, Outputs, World, denoise};
use luxfer::scene::TextureRef;
use std::sync::Arc;

/// Paths per pixel of each of the two renderings from which the noise filter works, and width of their pixels in photo
/// pixels.
const PATHS: u32 = 3;
const REDUCED: usize = 2;
/// Weight of light from another surface than the pixel's own. It matters only for pixels whose surface the small
/// renderings do not show.
const STRANGE: f32 = 1e-3;
/// Minimum albedo by which light is divided, as in the noise filter.
const MIN_ALBEDO: f32 = 0.02;
/// Strength of the noise filter.
const SMOOTHING: f32 = 1.5;
/// Number of rays across and down a pixel that shows several surfaces or a lamp, and a pixel that shows a texture.
/// [convention]
const FINE: usize = 5;
const PATTERNED: usize = 2;

/// Lamp number of pixels that show no lamp.
pub const NO_LAMP: u16 = u16::MAX;

/// The light that reaches the camera's lens, in cd/m², and the class and lamp that each pixel shows most of.
pub struct Exposure {
    pub light: Image,
    pub classes: Vec<u8>,
    /// Number of the lamp in the ceiling, or [`NO_LAMP`].
    pub lamps: Vec<u16>,
}

impl Exposure {
    pub fn of(room: &Room, surfaces: &Surfaces, shot: &Shot, seed: u64) -> Self {
        let whole = shown(room, surfaces, shot);
        let scattered = Scattered::of(room, shot, seed);
        let light = Image::from_fn(shot.width, shot.height, |x, y| {
            let shown = &whole[y * shot.width + x];
            (scattered.at(x, y, shown) * shown.albedo + shown.emission).to_array()
        });
        let classes = whole.iter().map(|shown| shown.class).collect();
        Self { light: light.expect("a picture"), classes, lamps: whole.iter().map(|shown| shown.lamp).collect() }
    }
}

/// Light that surfaces reflect, divided by their albedo. Light that comes directly from lamps is left out: with few
/// paths, the edges of lamps would be ragged.
struct Scattered {
    light: Image,
    normal: Image,
    /// Index of the mesh plus 1.
    mesh: Image,
}

impl Scattered {
    fn of(room: &Room, shot: &Shot, seed: u64) -> Self {
        let monitor = Monitor::default();
        let world = World::build(Arc::new(room.scene.clone()), monitor.job()).expect("a world");
        let film = |half: u64| {
            let mut outputs = Outputs::default();
            outputs.add("scattered", "C.+L").expect("an expression");
            outputs.aovs = vec![Aov::Position, Aov::Normal, Aov::Albedo, Aov::Object];
            let params = render::Params {
                width: shot.width / REDUCED,
                height: shot.height / REDUCED,
                samples: PATHS,
                seed: 2 * seed + half,
                outputs,
                ..render::Params::default()
            };
            render::run(&world, &shot.camera, &params, monitor.job(), &mut |_| {}).expect("a picture")
        };
        let (one, other) = (film(0), film(1));
        let halves = [&one.layers[0].image, &other.layers[0].image];
        // The variances of the whole pictures also hold the light that comes directly from lamps, which has noise at
        // edges only.
        let variances = [&one.variance, &other.variance];
        let mean = |layer: usize| mean(&one, &other, layer);
        let (position, normal, albedo) = (mean(1), mean(2), mean(3));
        let input = denoise::Input { halves, variances, albedo: &albedo, normal: &normal, position: &position };
        let params = denoise::Params { strength: SMOOTHING };
        let mut light = denoise::run(&input, &params, monitor.job()).expect("a smooth picture").image;
        light.data.iter_mut().zip(&albedo.data).for_each(|(v, a)| *v /= a.max(MIN_ALBEDO));
        Self { light, normal, mesh: one.layers[4].image.clone() }
    }

    /// Reflected light at a pixel of the photo: the mean of the four small pixels around it, as far as these show the
    /// pixel's surface.
    fn at(&self, x: usize, y: usize, shown: &Shown) -> Vec3 {
        let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / REDUCED as f32 - 0.5;
        let corner = place.floor();
        let part = place - corner;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for k in 0..4 {
            let step = Vec2::new((k % 2) as f32, (k / 2) as f32);
            let at = (corner + step)
                .clamp(Vec2::ZERO, Vec2::new(self.light.width as f32 - 1.0, self.light.height as f32 - 1.0));
            let (u, v) = (at.x as usize, at.y as usize);
            let near = (1.0 - (part - step).abs()).max(Vec2::splat(0.05)).element_product();
            let is_own = self.mesh.pixel(u, v)[0] == (shown.mesh + 1) as f32
                && self.normal.rgb(u, v).dot(shown.normal).abs() > 0.9;
            let weight = near * if is_own { 1.0 } else { STRANGE };
            sum += self.light.rgb(u, v) * weight;
            weights += weight;
        }
        sum / weights
    }
}

/// Mean of one layer of two films.
fn mean(one: &Film, other: &Film, layer: usize) -> Image {
    let mut mean = one.layers[layer].image.clone();
    mean.data.iter_mut().zip(&other.layers[layer].image.data).for_each(|(a, b)| *a = (*a + b) / 2.0);
    mean
}

/// The contents of a photo pixel.
#[derive(Clone, Copy)]
struct Shown {
    /// Mean emission and mean albedo over the pixel.
    emission: Vec3,
    albedo: Vec3,
    class: u8,
    lamp: u16,
    /// Mesh and normal of the surface at the middle of the pixel.
    mesh: u32,
    normal: Vec3,
}

fn shown(room: &Room, surfaces: &Surfaces, shot: &Shot) -> Vec<Shown> {
    let (width, height) = (shot.width, shot.height);
    let job = Monitor::default();
    let centre = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
    let meshes: Vec<u32> =
        exec::map(width * height, job.job(), |i| mesh_at(surfaces, shot, centre(i))).expect("the meshes seen");
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let neighbours = [(x.saturating_sub(1), y), (x + 1, y), (x, y.saturating_sub(1)), (x, y + 1)];
        let differs = |&(x, y): &(usize, usize)| meshes[y.min(height - 1) * width + x.min(width - 1)] != meshes[i];
        let material = &room.scene.materials[room.scene.meshes[meshes[i] as usize].material];
        let fine = match () {
            _ if neighbours.iter().any(differs) || material.emission != Vec3::ZERO => FINE,
            _ if material.base_color_texture.is_some() => PATTERNED,
            _ => 1,
        };
        let at = |k: usize| {
            let step = DVec2::new((k % fine) as f64 + 0.5, (k / fine) as f64 + 0.5) / fine as f64;
            sample(room, surfaces, shot, DVec2::new(x as f64, y as f64) + step)
        };
        let samples: Vec<Shown> = (0..fine * fine).map(at).collect();
        let mean = |of: fn(&Shown) -> Vec3| samples.iter().map(of).sum::<Vec3>() / samples.len() as f32;
        let most = |of: &dyn Fn(&Shown) -> (u8, u16)| {
            let count = |value: (u8, u16)| samples.iter().filter(|s| of(s) == value).count();
            samples.iter().map(of).max_by_key(|value| (count(*value), *value)).expect("a sample")
        };
        // A pixel belongs to a lamp if lamps cover at least half of it.
        let lit = samples.iter().filter(|s| s.lamp != NO_LAMP).count() * 2 >= samples.len();
        let (class, lamp) = most(&|s| if (s.lamp != NO_LAMP) == lit { (s.class, s.lamp) } else { (0, 0) });
        let (class, lamp) = if class == 0 { (samples[0].class, samples[0].lamp) } else { (class, lamp) };
        let middle = samples[samples.len() / 2];
        Shown { emission: mean(|s| s.emission), albedo: mean(|s| s.albedo), class, lamp, ..middle }
    };
    exec::map(width * height, job.job(), pixel).expect("what is seen")
}

fn mesh_at(surfaces: &Surfaces, shot: &Shot, at: DVec2) -> u32 {
    surfaces.seen(shot.camera.position, shot.direction(at)).map_or(0, |seen| seen.mesh as u32)
}

fn sample(room: &Room, surfaces: &Surfaces, shot: &Shot, at: DVec2) -> Shown {
    let direction = shot.direction(at);
    let Some(seen) = surfaces.seen(shot.camera.position, direction) else {
        let (class, lamp) = (Class::Wall as u8, NO_LAMP);
        return Shown { emission: Vec3::ZERO, albedo: Vec3::ZERO, class, lamp, mesh: 0, normal: Vec3::Y };
    };
    let mesh = &room.scene.meshes[seen.mesh];
    let (class, number) = room.classes[seen.mesh];
    let material = &room.scene.materials[mesh.material];
    let [a, b, c] = mesh.corners(seen.triangle);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let faces = normal.dot(direction) < 0.0 || material.double_sided;
    // Texture coordinates are interpolated between the corners of the triangle.
    let coordinates = || {
        let [p, q, r] = mesh.triangles[seen.triangle].map(|i| mesh.uvs[0].get(i as usize).copied().unwrap_or_default());
        p + (q - p) * seen.barycentric.x + (r - p) * seen.barycentric.y
    };
    let pattern = |map: Option<TextureRef>| {
        let sample = |map: TextureRef| {
            let uv = map.transform * coordinates().extend(1.0);
            room.scene.textures[map.texture].sample(uv.truncate()).truncate()
        };
        map.map_or(Vec3::ONE, sample)
    };
    Shown {
        emission: if faces { material.emission * pattern(material.emission_texture) } else { Vec3::ZERO },
        albedo: (material.base_color * pattern(material.base_color_texture)).max(Vec3::splat(MIN_ALBEDO)),
        class: class as u8,
        lamp: if class == Class::Lamp { number as u16 } else { NO_LAMP },
        mesh: seen.mesh as u32,
        normal,
    }
}
