//! Viewpoints of generated photos: where the camera stands in a room, and where it sees points.

use super::dice::Dice;
use super::room::{Class, Room};
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};
use luxfer::accel::{Accel, Ray};
use luxfer::geometry::Homography;
use luxfer::job::Monitor;
use luxfer::scene::Camera;

/// Diagonal in mm of the 36 × 24 mm picture format for which focal lengths are given. [convention]
const DIAGONAL: f32 = 43.27;
/// Number of viewpoints that are tried before a room is given up.
const TRIES: usize = 160;
/// Numbers of rays across and down the picture that test a view.
const RAYS: [usize; 2] = [40, 30];
/// Minimum share of the picture that shows the ceiling, and minimum number of pixels across a lamp that counts as
/// seen.
const MIN_CEILING: f32 = 0.08;
const MIN_WIDTH: f64 = 4.0;

/// The surfaces of a room for ray tracing: for each triangle its mesh, and for each mesh its first triangle.
pub struct Surfaces {
    accel: Accel,
    meshes: Vec<u32>,
    firsts: Vec<u32>,
}

/// The hit of a ray: a mesh, a triangle of the mesh, and the position in the triangle.
pub struct Seen {
    pub mesh: usize,
    pub triangle: usize,
    pub barycentric: Vec2,
}

impl Surfaces {
    pub fn of(room: &Room) -> Self {
        let (mut triangles, mut meshes, mut firsts) = (Vec::new(), Vec::new(), Vec::new());
        for (number, mesh) in room.scene.meshes.iter().enumerate() {
            firsts.push(triangles.len() as u32);
            triangles.extend((0..mesh.triangles.len()).map(|t| mesh.corners(t)));
            meshes.resize(triangles.len(), number as u32);
        }
        Self { accel: Accel::build(&triangles, Monitor::default().job()).expect("a room"), meshes, firsts }
    }

    pub fn seen(&self, from: Vec3, direction: Vec3) -> Option<Seen> {
        let hit = self.accel.closest(&Ray::new(from, direction), |_| true)?;
        let mesh = self.meshes[hit.triangle as usize] as usize;
        let triangle = (hit.triangle - self.firsts[mesh]) as usize;
        Some(Seen { mesh, triangle, barycentric: Vec2::new(hit.u, hit.v) })
    }
}

/// A camera in a room, and the size of its picture in pixels.
#[derive(Clone, Debug)]
pub struct Shot {
    pub camera: Camera,
    pub width: usize,
    pub height: usize,
    /// Vertical distance in metres from the camera to the ceiling.
    pub distance: f32,
    /// Focal length in mm, for a picture of 36 × 24 mm.
    pub focal: f32,
}

impl Shot {
    /// Draws random views until one meets the requirements; `None` if none of the attempts does.
    pub fn choose(room: &Room, surfaces: &Surfaces, dice: &mut Dice) -> Option<Self> {
        let (width, height) = size(dice);
        // Most photos must show at least three lamps.
        let wanted = if dice.chance(0.05) { 1 } else { 3 };
        let aim = [dice.between(-10.0, 60.0), dice.between(-10.0, 60.0), dice.between(0.0, 45.0)];
        (0..TRIES)
            .map(|_| Self::random(room, dice, [width, height], aim))
            .find(|shot| shot.will_do(room, surfaces, wanted))
    }

    fn random(room: &Room, dice: &mut Dice, [width, height]: [usize; 2], aim: [f32; 3]) -> Self {
        let size = room.size;
        let eye = if dice.chance(0.15) { dice.between(0.4, 1.1) } else { dice.between(1.2, 1.75) }.min(size.y - 0.7);
        let inset = |dice: &mut Dice, length: f32| dice.between(0.05, 0.95) * (length - 0.6) + 0.3;
        let position = Vec3::new(inset(dice, size.x), eye, inset(dice, size.z));
        let (pitch, yaw) =
            ((dice.pick(&aim) + 4.0 * dice.normal()).clamp(-10.0, 60.0), dice.between(0.0, std::f32::consts::TAU));
        let (pitch, roll) = (pitch.to_radians(), (1.5 * dice.normal()).to_radians());
        let focal = if dice.chance(0.12) { dice.log_between(50.0, 120.0) } else { dice.log_between(24.0, 42.0) };
        let forward = Vec3::new(yaw.sin() * pitch.cos(), pitch.sin(), -yaw.cos() * pitch.cos());
        let upright = Camera::look_at(position, position + forward, 1.0);
        let right = upright.forward.cross(upright.up);
        let up = upright.up * roll.cos() + right * roll.sin();
        let (w, h) = (width as f32, height as f32);
        let fov_y = 2.0 * (h / 2.0 / (focal / DIAGONAL * w.hypot(h))).atan();
        let camera = Camera { up, fov_y, ..upright };
        Self { camera, width, height, distance: size.y - eye, focal }
    }

    fn will_do(&self, room: &Room, surfaces: &Surfaces, wanted: usize) -> bool {
        let rays = RAYS[0] * RAYS[1];
        let place = |i: usize| [(i % RAYS[0]) as f32 + 0.5, (i / RAYS[0]) as f32 + 0.5];
        let class = |i: usize| {
            let [x, y] = place(i);
            let direction = self.direction(DVec2::new(
                (x * self.width as f32 / RAYS[0] as f32).into(),
                (y * self.height as f32 / RAYS[1] as f32).into(),
            ));
            surfaces.seen(self.camera.position, direction).map(|seen| room.classes[seen.mesh].0)
        };
        let classes: Vec<Option<Class>> = (0..rays).map(class).collect();
        let share = |of: &[Class]| classes.iter().flatten().filter(|c| of.contains(c)).count() as f32 / rays as f32;
        if share(&[Class::Ceiling, Class::Lamp]) < MIN_CEILING || share(&[Class::Thing]) > 0.6 {
            return false;
        }
        self.lamps_seen(room, surfaces) >= wanted
    }

    /// Number of lamps that lie wholly inside the picture, are large enough, and are not hidden at a test point.
    fn lamps_seen(&self, room: &Room, surfaces: &Surfaces) -> usize {
        let lamps = room.classes.iter().enumerate().filter(|(_, (class, _))| *class == Class::Lamp);
        let is_seen = |&(mesh, (_, number)): &(usize, &(Class, usize))| {
            let fitting = &room.ceiling.fittings[*number];
            let place = |p: Vec2| Vec3::new(p.x, room.size.y - fitting.drop, p.y);
            let outline = fitting.form.outline(0.0);
            let corners: Option<Vec<DVec2>> =
                outline.iter().map(|p| self.project(place(fitting.centre + *p))).collect();
            let Some(corners) = corners else { return false };
            let size = DVec2::new(self.width as f64, self.height as f64);
            // Lines of light may leave the picture, other lamps may not.
            let count = corners.iter().filter(|p| inside_picture(**p, size)).count();
            let is_line = room.ceiling.pattern == "slots";
            let inside = if is_line { 2 * count >= corners.len() } else { count == corners.len() };
            let (low, high) = corners.iter().fold((DVec2::MAX, DVec2::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
            // Test a point of the lamp itself: the centre of a ring, for example, is ceiling.
            let edge = if is_line && !inside_picture(corners[0], size) {
                outline[2] + outline[3]
            } else {
                outline[0] + outline[1]
            };
            let point = place(fitting.centre + edge * 0.46);
            let direction = (point - self.camera.position).normalize();
            let is_met = |seen: Seen| seen.mesh == mesh;
            inside
                && (high - low).min_element() >= MIN_WIDTH
                && surfaces.seen(self.camera.position, direction).is_some_and(is_met)
        };
        lamps.filter(is_seen).count()
    }

    /// Focal length in pixels.
    pub fn focal_pixels(&self) -> f64 {
        self.height as f64 / 2.0 / f64::from(self.camera.fov_y / 2.0).tan()
    }

    /// Direction of the ray through a point of the picture, given in pixels.
    pub fn direction(&self, pixel: DVec2) -> Vec3 {
        let (w, h) = (self.width as f64, self.height as f64);
        self.camera.direction((pixel.x / w) as f32, (pixel.y / h) as f32, (w / h) as f32)
    }

    /// Position in pixels at which the camera sees a point; `None` for points behind the camera.
    pub fn project(&self, point: Vec3) -> Option<DVec2> {
        let camera = &self.camera;
        let v = (point - camera.position).as_dvec3();
        let (forward, up) = (camera.forward.as_dvec3(), camera.up.as_dvec3());
        let depth = v.dot(forward);
        let offset = DVec2::new(v.dot(forward.cross(up)), -v.dot(up)) / depth * self.focal_pixels();
        (depth > 1e-3).then(|| DVec2::new(self.width as f64, self.height as f64) / 2.0 + offset)
    }

    /// Homography from the ceiling to photo pixels. On the ceiling the unit of length is its distance from the camera;
    /// x and z are those of the room.
    pub fn to_photo(&self) -> Homography {
        let camera = &self.camera;
        let (forward, up) = (camera.forward.as_dvec3(), camera.up.as_dvec3());
        let right = forward.cross(up);
        let distance = f64::from(self.distance);
        // Row of a matrix that takes a point (x, z, 1) of the ceiling, in units of `distance`, to the coordinate along
        // `axis` of the vector from the camera to this point.
        let from = camera.position.as_dvec3();
        let rows = |axis: DVec3| {
            DVec3::new(axis.x * distance, axis.z * distance, axis.y * distance - axis.x * from.x - axis.z * from.z)
        };
        let (f, c) = (self.focal_pixels(), DVec2::new(self.width as f64, self.height as f64) / 2.0);
        let (r, u, w) = (rows(right), rows(up), rows(forward));
        Homography(DMat3::from_cols(r * f + w * c.x, w * c.y - u * f, w).transpose())
    }
}

fn inside_picture(p: DVec2, size: DVec2) -> bool {
    p.min_element() > 1.0 && (size - p).min_element() > 1.0
}

/// Draws the size of a photo in pixels. Most photos are small, to save time; some have a megapixel.
fn size(dice: &mut Dice) -> (usize, usize) {
    let (width, height) = dice.weighted(&[((640, 480), 6.0), ((704, 470), 3.0), ((768, 432), 1.5), ((1152, 864), 1.0)]);
    if dice.chance(0.15) { (height, width) } else { (width, height) }
}
