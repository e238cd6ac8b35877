//! Generated photographs: makes from a seed a photo with its strokes and its exact truth. Photos are kept under
//! `target/photolab`.

use super::camera::Look;
use super::dice::Dice;
use super::exposure::{Exposure, NO_LAMP};
use super::hurried::{self, Scenery};
use super::masks::Mask;
use super::room::{Class, Room};
use super::shapes::{Lamps, Shape};
use super::truth::{Lamp, Photo, Truth};
use super::viewpoint::{Shot, Surfaces};
use crate::harness::{Clock, time};
use glam::{DMat3, DVec2, Vec3};
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::image::io::{self, Encoding};
use luxfer::segment::strokes;
use std::path::PathBuf;
use std::sync::Arc;

/// Version of the generator: photos that another version has made are made again.
const VERSION: u32 = 3;
/// First seeds of three ranges: photos that may be tuned on, photos that figures are computed from, and photos from
/// which a classifier may learn.
pub const TUNING: u64 = 1_000_000;
pub const EVALUATION: u64 = 2_000_000;
pub const LEARNING: u64 = 3_000_000;
/// Minimum number of pixels of a lamp that a run is expected to find.
const MIN_PIXELS: usize = 12;
/// Maximum share of a lamp's pixels that may be hidden or cut off if the lamp counts as seen whole. [convention]
const MAX_HIDDEN: f64 = 0.1;
/// Minimum sine of the angle between a pixel's ray and the ceiling, for pixels that count for the lit share.
const MIN_SLOPE: f32 = 0.15;

/// A generated photo with its truth, before a run on it is judged.
pub struct Made {
    pub photo: Photo,
    /// Bytes of the photo's JPEG file.
    pub file: Vec<u8>,
    pub room: Room,
    pub shot: Shot,
    /// Class and lamp number of each pixel.
    pub classes: Vec<u8>,
    pub lamps: Vec<u16>,
    /// Processor seconds for four steps: the room and its view, the light, the camera, and the strokes. Light and
    /// camera take 0 if the photo was kept from an earlier run.
    pub seconds: [f64; 4],
    /// Text of the ten strokes for the judgement of masks from few strokes.
    pub ten: String,
    /// Text of the strokes of a whole run.
    pub strokes: String,
}

/// Returns the generated photo of a seed; makes it if no earlier run has stored it.
pub fn made(seed: u64) -> Made {
    let mut seconds = [0.0; 4];
    let (room_seconds, (room, surfaces, shot, own)) = time(Clock::Process, || room_of(seed));
    seconds[0] = room_seconds;
    let look = Look::new(&mut Dice::new(own, 8));
    let (bytes, seen) = kept(seed).unwrap_or_else(|| {
        let (light_seconds, straight) = time(Clock::Process, || Exposure::of(&room, &surfaces, &shot, seed));
        let (lens_seconds, (bent, bytes)) = time(Clock::Process, || {
            let bent = look.bend(&straight);
            let bytes = look.photograph(&bent, seed);
            (bent, bytes)
        });
        (seconds[1], seconds[2]) = (light_seconds, lens_seconds);
        keep(seed, &bytes, &bent, [shot.width, shot.height]);
        (bytes, (bent.classes, bent.lamps))
    });
    let (classes, lamps) = seen;
    let image = io::decode(&bytes, Encoding::Srgb).and_then(|i| i.to_rgb()).expect("a photo");
    let scenery = Scenery { width: shot.width, height: shot.height, classes: &classes, lamps: &lamps };
    let (stroke_seconds, (text, ten)) = time(Clock::Process, || {
        let mut dice = Dice::new(own, 9);
        let counts = hurried::counts(&mut dice);
        let text = hurried::draw(&scenery, counts, &mut dice);
        (text, hurried::draw(&scenery, hurried::TEN, &mut Dice::new(own, 10)))
    });
    seconds[3] = stroke_seconds;
    let truth = truth(&room, &shot, &look, &scenery);
    let strokes = strokes::parse(&text, shot.width, shot.height).expect("strokes");
    let name = format!("{seed}_{}", room.ceiling.pattern);
    let photo = Photo { name, image: Arc::new(image), strokes, truth };
    Made { photo, file: bytes, room, shot, classes, lamps, ten, strokes: text, seconds }
}

/// Tries rooms of a seed until the camera sees lamps in one. Returns the room, its surfaces, the view and the seed of
/// that room.
fn room_of(seed: u64) -> (Room, Surfaces, Shot, u64) {
    (0u64..)
        .find_map(|attempt| {
            let own = seed ^ attempt << 40;
            let room = Room::new(own, seed);
            let surfaces = Surfaces::of(&room);
            let shot = Shot::choose(&room, &surfaces, &mut Dice::new(own, 7))?;
            Some((room, surfaces, shot, own))
        })
        .expect("a room with a view")
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("target/photolab/v{VERSION}"))
}

type Seen = (Vec<u8>, Vec<u16>);

/// The kept photo of a seed with the classes and lamp numbers of its pixels; `None` if it has not been made.
fn kept(seed: u64) -> Option<(Vec<u8>, Seen)> {
    let photo = std::fs::read(folder().join(format!("{seed}.jpg"))).ok()?;
    let seen = image::open(folder().join(format!("{seed}.png"))).ok()?.to_rgb8();
    let lamp = |p: &image::Rgb<u8>| u16::from_le_bytes([p.0[1], p.0[2]]);
    Some((photo, (seen.pixels().map(|p| p.0[0]).collect(), seen.pixels().map(lamp).collect())))
}

fn keep(seed: u64, photo: &[u8], exposure: &Exposure, size: [usize; 2]) {
    let write = || -> Option<()> {
        std::fs::create_dir_all(folder()).ok()?;
        labels(&exposure.classes, &exposure.lamps, size).save(folder().join(format!("{seed}.png"))).ok()?;
        std::fs::write(folder().join(format!("{seed}.jpg")), photo).ok()
    };
    if write().is_none() {
        println!("# photo {seed} was not kept in {}", folder().display());
    }
}

/// Encodes labels as an image: the class in red, the lamp number in green and blue.
fn labels(classes: &[u8], lamps: &[u16], [width, _]: [usize; 2]) -> image::RgbImage {
    image::RgbImage::from_fn(width as u32, (classes.len() / width) as u32, |x, y| {
        let i = y as usize * width + x as usize;
        let [low, high] = lamps[i].to_le_bytes();
        image::Rgb([classes[i], low, high])
    })
}

impl Made {
    /// The labels of all pixels as an image: the class in red, the lamp number in green and blue.
    pub fn labels(&self) -> image::RgbImage {
        labels(&self.classes, &self.lamps, [self.shot.width, self.shot.height])
    }
}

fn truth(room: &Room, shot: &Shot, look: &Look, scenery: &Scenery) -> Truth {
    let (width, height) = (shot.width, shot.height);
    let mask = |is: &dyn Fn(usize) -> bool| Mask { width, height, on: (0..width * height).map(is).collect() };
    let lights = mask(&|i| scenery.lamps[i] != NO_LAMP);
    let plane = mask(&|i| matches!(scenery.classes[i], 1 | 2));
    // Objects that hang before the ceiling may count as plane or not.
    let either = mask(&|i| scenery.classes[i] == Class::Hanging as u8);

    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); room.ceiling.fittings.len()];
    (0..width * height)
        .filter(|&i| scenery.lamps[i] != NO_LAMP)
        .for_each(|i| pixels[scenery.lamps[i] as usize].push(i as u32));
    let middle = |pixels: &[u32]| {
        let at = |&i: &u32| DVec2::new((i as usize % width) as f64 + 0.5, (i as usize / width) as f64 + 0.5);
        pixels.iter().map(at).sum::<DVec2>() / pixels.len() as f64
    };
    let lamp = |pixels: &Vec<u32>| Lamp { centre: middle(pixels), polygons: Vec::new(), pixels: pixels.clone() };
    let lamps = pixels.iter().filter(|p| p.len() >= MIN_PIXELS).map(lamp).collect();

    let centre = DVec2::new(width as f64, height as f64) / 2.0;
    let scale = DMat3::from_translation(centre)
        * DMat3::from_scale(DVec2::splat(1.0 / look.magnification()))
        * DMat3::from_translation(-centre);
    let to_photo = Homography(scale * shot.to_photo().0);
    let layout = Some(layout(room, shot, &to_photo, &pixels, &lit(room, shot, scenery)));
    Truth {
        lights,
        unlisted: None,
        plane: Some(plane),
        either: Some(either),
        lamps,
        centres: Vec::new(),
        layout,
        distance: Some(shot.distance.into()),
        to_photo: Some(to_photo),
        is_trap: false,
        may_decline: false,
    }
}

/// The lamps as the photo shows them, projected onto the ceiling: the lamps seen whole, or all lamps if fewer than
/// three are seen whole.
fn layout(room: &Room, shot: &Shot, to_photo: &Homography, pixels: &[Vec<u32>], lit: &[f64; 2]) -> Lamps {
    let distance = f64::from(shot.distance);
    let foot = Vec3::new(shot.camera.position.x, 0.0, shot.camera.position.z);
    let mut shapes: Vec<(Shape, usize, bool)> = Vec::new();
    for (fitting, pixels) in room.ceiling.fittings.iter().zip(pixels).filter(|(fitting, _)| fitting.is_lit) {
        // A lamp below the ceiling hides a larger part of the ceiling than its own area.
        let grown = distance / (distance - f64::from(fitting.drop));
        let foot = DVec2::new(foot.x.into(), foot.z.into());
        let on_ceiling = |p: glam::Vec2| (foot + ((fitting.centre + p).as_dvec2() - foot) * grown) / distance;
        let outline: Vec<DVec2> = fitting.form.outline(0.0).into_iter().map(on_ceiling).collect();
        let area = f64::from(fitting.form.area()) * (grown / distance).powi(2);
        let Some(shape) = Shape::of(&outline, Some(area)) else { continue };
        let seen = pixels.len() as f64
            > (1.0 - MAX_HIDDEN) * area_in_photo(&outline, to_photo, f64::from(fitting.form.filled()));
        shapes.push((shape, fitting.kind, seen && pixels.len() >= MIN_PIXELS));
    }
    let whole = shapes.iter().filter(|(_, _, seen)| *seen).count();
    let counts = |seen: bool| seen || whole < 3;
    let (some, rest): (Vec<_>, Vec<_>) = shapes.into_iter().partition(|(_, _, seen)| counts(*seen));
    Lamps {
        kinds: some.iter().map(|(_, kind, _)| *kind).collect(),
        whole: some.into_iter().map(|(shape, _, _)| shape).collect(),
        cut: Vec::new(),
        others: rest.into_iter().map(|(shape, _, _)| shape.centroid).collect(),
        lit: Some(*lit),
        bar: 0.0,
    }
}

/// Number of photo pixels that a lamp would cover if nothing hid it; infinite if a part of it lies behind the camera.
fn area_in_photo(outline: &[DVec2], to_photo: &Homography, filled: f64) -> f64 {
    let behind = |p: &DVec2| to_photo.apply_homogeneous(*p).z <= 0.0;
    if outline.iter().any(behind) {
        return f64::INFINITY;
    }
    let corners: Vec<DVec2> = outline.iter().map(|p| to_photo.apply(*p)).collect();
    luxfer::geometry::polygon::area(&corners).abs() * filled
}

/// Lower and upper bound of the lit share of the ceiling: over the whole ceiling, over a cell of its pattern, and over
/// the visible part.
fn lit(room: &Room, shot: &Shot, scenery: &Scenery) -> [f64; 2] {
    let lit = || room.ceiling.fittings.iter().filter(|fitting| fitting.is_lit);
    let area: f32 = lit().map(|fitting| fitting.form.area()).sum();
    let mut shares = vec![f64::from(area / (room.size.x * room.size.z))];
    if let Some((cell, count)) = room.ceiling.cell {
        let mean = area / room.ceiling.fittings.len() as f32;
        shares.push(f64::from(mean * count as f32 / cell));
    }
    let (mut lamps, mut all) = (0.0, 0.0);
    for i in (0..scenery.classes.len()).filter(|i| matches!(scenery.classes[*i], 1 | 2)) {
        let at = DVec2::new((i % shot.width) as f64 + 0.5, (i / shot.width) as f64 + 0.5);
        let ray = shot.direction(at);
        if ray.normalize().y > MIN_SLOPE {
            // Area of the ceiling that the pixel shows, up to a factor.
            let weight = f64::from(ray.y).powi(-3);
            all += weight;
            lamps += if scenery.lamps[i] != NO_LAMP { weight } else { 0.0 };
        }
    }
    if all > 0.0 {
        shares.push(lamps / all);
    }
    [
        shares.iter().copied().fold(f64::MAX, f64::min).max(1e-6),
        shares.into_iter().fold(0.0, f64::max).min(1.0).max(1e-6),
    ]
}

/// Shows classes as a picture for people: the plane grey, lamps yellow, other classes in other colours.
pub fn picture_of(classes: &[u8], width: usize, height: usize) -> Image {
    const COLOURS: [[f32; 3]; 8] = [
        [0.0; 3],
        [0.4, 0.4, 0.4],
        [1.0, 0.8, 0.0],
        [0.1, 0.2, 0.1],
        [0.2, 0.1, 0.05],
        [0.1, 0.4, 1.0],
        [0.05, 0.05, 0.2],
        [0.8, 0.05, 0.3],
    ];
    Image::from_fn(width, height, |x, y| COLOURS[classes[y * width + x].min(7) as usize]).expect("a picture")
}
