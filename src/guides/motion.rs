//! Computes for each pixel of a frame where its surface point was in the previous frame. Camera and objects may have
//! moved, and meshes may have changed their shape, like the skin of an animated figure.
//!
//! The surface point that a pixel shows is a triangle and a position on it. The vertices of the triangle in the
//! previous frame give the previous position of the point, exactly. The point was visible if the previous frame shows
//! the same mesh there, from the same side and at about the same depth.

use super::surfaces::{Point, Surfaces};
use crate::error::{Error, Result};
use crate::exec;
use crate::image::{Comparison, Image, neighbourhood, try_vec};
use crate::job::Job;
use crate::maths;
use crate::scene::Camera;
use glam::Vec3;

/// A point at depth d in the previous frame counts as occluded there if d > (1 + DEPTH_TOLERANCE) s. Here s is the
/// depth of the surface that the previous frame shows at the point's position. [bench constants:motion]
const DEPTH_TOLERANCE: f32 = 0.02;

/// The motion between two frames.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The displacement in pixels from each pixel to the position of its surface point in the previous frame. The two
    /// channels are x (right) and y (down), NaN where the previous frame does not show the point.
    pub image: Image,
    /// The visible objects of the frame without counterpart in the previous frame; see [`Surfaces::counterparts`].
    pub unmatched: Vec<Unmatched>,
}

/// An object without counterpart in the previous frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmatched {
    pub name: String,
    /// Number of pixels that show the object.
    pub pixels: usize,
    /// Column and row of one of these pixels.
    pub place: [usize; 2],
}

/// Computes the motion of each pixel since the previous frame.
pub fn motion(now: &Surfaces, before: &Surfaces, job: Job) -> Result<Motion> {
    let (width, height) = (now.width, now.height);
    if (width, height) != (before.width, before.height) {
        return Err(Error::argument(format!(
            "this frame is {width} x {height} and the frame before is {} x {}; they must have the same size",
            before.width, before.height
        )));
    }
    let mut image = Image::new(width, height, 2)?;
    let frames = Frames { now, before, counterparts: now.counterparts(before) };
    exec::for_rows(&mut image.data, 2 * width, job, |y, row| {
        for (x, motion) in row.chunks_exact_mut(2).enumerate() {
            let [cx, cy] = [x as f32 + 0.5, y as f32 + 0.5];
            let place = frames.previous_place(x, y);
            motion.copy_from_slice(&place.map_or([f32::NAN; 2], |[u, v]| [u - cx, v - cy]));
        }
    })?;
    Ok(Motion { image, unmatched: frames.unmatched()? })
}

/// The given motion of a pixel is wrong if it differs by more than this number of pixels from the true motion of the
/// pixel and of each of its eight neighbours. The neighbours count because a renderer may give a pixel at a silhouette
/// the motion of the object or the motion of the background. [convention]
const MAX_ERROR: f32 = 1.0;

/// Compares a given motion with the true motion of the surfaces, where both are known.
pub fn deviation(given: &Image, now: &Surfaces, before: &Surfaces, job: Job) -> Result<Comparison> {
    if given.channels != 2 {
        return Err(Error::argument(format!("motion has {} channels; it must have 2", given.channels)));
    }
    let exact = motion(now, before, job)?.image;
    exact.check_same_size("the guides", given, "the motion")?;
    let size = [exact.width, exact.height];
    Comparison::of(size, MAX_ERROR, job, |x, y| {
        // Leave out pixels that the previous frame does not show: no true motion is known there.
        if !exact.pixel(x, y)[0].is_finite() {
            return None;
        }
        let given = given.pixel(x, y);
        let error = |(x, y)| {
            let exact = exact.pixel(x, y);
            maths::hypot(given[0] - exact[0], given[1] - exact[1])
        };
        // `f32::min` ignores NaN, so the minimum is infinite if the given motion is NaN. Such pixels are left out.
        let min_error = neighbourhood([x, y], size).map(error).fold(f32::INFINITY, f32::min);
        min_error.is_finite().then_some(min_error)
    })
}

/// Two consecutive frames of a sequence.
struct Frames<'a> {
    now: &'a Surfaces,
    before: &'a Surfaces,
    /// For each mesh of `now`, the index of the same mesh in `before`; `None` if `before` lacks it.
    counterparts: Vec<Option<u32>>,
}

impl Frames<'_> {
    /// Returns the position, in pixels of the previous frame, of the surface point that the pixel (x, y) of this frame
    /// shows; `None` if the previous frame does not show the point.
    fn previous_place(&self, x: usize, y: usize) -> Option<[f32; 2]> {
        let (now, before) = (self.now, self.before);
        let size = [now.width as f32, now.height as f32];
        let to_pixels = |[u, v]: [f32; 2]| [u * size[0], v * size[1]];
        let inside = |[u, v]: [f32; 2]| u >= 0.0 && v >= 0.0 && u < size[0] && v < size[1];
        let Some(point) = &now.points[y * now.width + x] else {
            // The background is infinitely far away: only the camera's rotation moves it.
            let ray = now.camera.direction((x as f32 + 0.5) / size[0], (y as f32 + 0.5) / size[1], size[0] / size[1]);
            let place = to_pixels(before.camera.project(ray, size[0] / size[1])?.0);
            return (inside(place) && before.at(place).is_none()).then_some(place);
        };
        let mesh = self.counterparts[point.mesh as usize]?;
        let old = Point { mesh, ..*point };
        let triangle = before.shapes[mesh as usize].triangle(&old)?;
        let offset = old.on(triangle) - before.camera.position;
        let (place, depth) = before.camera.project(offset, size[0] / size[1])?;
        let place = to_pixels(place);
        let seen = inside(place)
            && before.at(place).is_some_and(|there| there.mesh == mesh)
            && depth <= before.depth_near(place) * (1.0 + DEPTH_TOLERANCE)
            && front(triangle, &before.camera) == front(now.shapes[point.mesh as usize].triangle(point)?, &now.camera);
        seen.then_some(place)
    }

    /// Lists the visible objects without counterpart.
    fn unmatched(&self) -> Result<Vec<Unmatched>> {
        let mut counts = try_vec(self.counterparts.len(), (0, 0))?;
        for (i, point) in self.now.points.iter().enumerate() {
            let mesh = point.map(|p| p.mesh as usize).filter(|mesh| self.counterparts[*mesh].is_none());
            if let Some((count, place)) = mesh.map(|mesh| &mut counts[mesh]) {
                (*count, *place) = (*count + 1, i);
            }
        }
        let width = self.now.width;
        let seen = counts.into_iter().zip(&self.now.shapes).filter(|((count, _), _)| *count > 0);
        let describe = |((pixels, i), shape): ((usize, usize), &super::surfaces::Shape)| Unmatched {
            name: shape.name.clone(),
            pixels,
            place: [i % width, i / width],
        };
        Ok(seen.map(describe).collect())
    }
}

impl Surfaces {
    /// Returns the surface point that the pixel at a position shows; `None` if the pixel shows no surface.
    fn at(&self, [x, y]: [f32; 2]) -> Option<&Point> {
        self.points[y as usize * self.width + x as usize].as_ref()
    }

    /// Returns a depth of the surface that a frame shows at a position inside a pixel; infinity if the pixel shows no
    /// surface. It is the larger of two depths: the depth of the surface point at the pixel's centre, and the depth at
    /// which the plane of this point's triangle meets the ray through the position, if the plane lies in front of the
    /// camera there. The two depths differ on a surface seen at a grazing angle.
    fn depth_near(&self, [x, y]: [f32; 2]) -> f32 {
        let triangle =
            self.at([x, y]).and_then(|point| Some((point, self.shapes[point.mesh as usize].triangle(point)?)));
        let Some((point, [a, b, c])) = triangle else { return f32::INFINITY };
        let (width, height) = (self.width as f32, self.height as f32);
        // The component of this direction along the viewing direction is 1, so ray parameters are depths.
        let direction = self.camera.direction(x / width, y / height, width / height);
        let normal = (b - a).cross(c - a);
        let on_plane = normal.dot(a - self.camera.position) / normal.dot(direction);
        let centre = (point.on([a, b, c]) - self.camera.position).dot(self.camera.forward);
        if on_plane > 0.0 { centre.max(on_plane) } else { centre }
    }
}

/// Whether the camera sees the front of a triangle: the side on which its corners wind counter-clockwise.
fn front([a, b, c]: [Vec3; 3], camera: &Camera) -> bool {
    (b - a).cross(c - a).dot(camera.position - a) > 0.0
}
