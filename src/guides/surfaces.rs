//! The surface point that each pixel of a frame shows: a triangle, and a position on that triangle.
//! [`motion`](super::motion) finds these points in another frame, in which the objects may have moved or changed their
//! shape.

use crate::error::Result;
use crate::exec;
use crate::image::{try_collect, try_vec};
use crate::job::Job;
use crate::render::World;
use crate::rng::hash;
use crate::scene::{Camera, Mesh};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// The surface points that the pixel centres of a frame show.
#[derive(Clone, Debug)]
pub struct Surfaces {
    pub width: usize,
    pub height: usize,
    /// One point per pixel; `None` where there is no surface.
    pub points: Vec<Option<Point>>,
    /// The meshes of the scene in their order, followed by the faces of its luminaires.
    pub shapes: Vec<Shape>,
    pub camera: Camera,
}

/// A point on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the mesh in [`World::meshes`].
    pub mesh: u32,
    /// Indices of the triangle's corners among the vertices of the mesh.
    pub corners: [u32; 3],
    /// Barycentric coordinates of the point with respect to `corners[1]` and `corners[2]`.
    pub barycentric: Vec2,
}

/// The shape of a mesh in one frame.
#[derive(Clone, Debug)]
pub struct Shape {
    pub name: String,
    /// Number of vertices.
    pub count: usize,
    /// Hash of the triangles' vertex indices. If it is equal in two frames, a vertex index is taken to mean the same
    /// point of the mesh in both frames.
    topology: u64,
    /// Positions of the vertices; empty if no pixel shows the mesh.
    positions: Vec<Vec3>,
}

impl Shape {
    fn new(mesh: &Mesh, is_visible: bool) -> Result<Self> {
        let topology = mesh.triangles.iter().fold(mesh.triangles.len() as u64, |h, t| hash(h, &t.map(u64::from)));
        let positions = if is_visible { try_collect(mesh.positions.iter().copied())? } else { Vec::new() };
        Ok(Self { name: mesh.name.clone(), count: mesh.positions.len(), topology, positions })
    }

    /// Returns the corners of a point's triangle; `None` if no pixel shows the mesh.
    pub fn triangle(&self, point: &Point) -> Option<[Vec3; 3]> {
        (!self.positions.is_empty()).then(|| point.corners.map(|i| self.positions[i as usize]))
    }
}

impl Point {
    /// Returns the position of the point on the triangle `corners`.
    pub fn on(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        a + (b - a) * self.barycentric.x + (c - a) * self.barycentric.y
    }
}

impl Surfaces {
    /// Traces one ray through the centre of each pixel.
    pub fn trace(world: &World, camera: &Camera, width: usize, height: usize, job: Job) -> Result<Self> {
        let mut points = try_vec(width * height, None)?;
        let (columns, rows) = (width as f32, height as f32);
        exec::for_rows(&mut points, width, job, |y, row| {
            for (x, point) in row.iter_mut().enumerate() {
                let at = [(x as f32 + 0.5) / columns, (y as f32 + 0.5) / rows];
                let ray = world.ray(camera.position, camera.direction(at[0], at[1], columns / rows));
                *point = world.visible(&ray).map(|hit| {
                    let (mesh, triangle) = world.locate(hit.triangle);
                    let corners = world.mesh(mesh).triangles[triangle as usize];
                    Point { mesh, corners, barycentric: Vec2::new(hit.u, hit.v) }
                });
            }
        })?;
        let mut is_visible = try_vec(world.meshes().count(), false)?;
        points.iter().flatten().for_each(|p: &Point| is_visible[p.mesh as usize] = true);
        let mut shapes = Vec::with_capacity(is_visible.len());
        for (mesh, &is_visible) in world.meshes().zip(&is_visible) {
            job.check()?;
            shapes.push(Shape::new(mesh, is_visible)?);
        }
        Ok(Self { width, height, points, shapes, camera: camera.clone() })
    }

    /// For each mesh of this frame, returns the index of its counterpart in another frame: the mesh with the same name,
    /// number of vertices and triangle indices. If several meshes agree in all three, such as copies of a chair, they
    /// correspond in their order. `None` for a mesh without counterpart, and for such copies if the other frame has a
    /// different number of them.
    pub fn counterparts(&self, other: &Self) -> Vec<Option<u32>> {
        let (here, there) = (self.by_key(), other.by_key());
        let mut found = vec![None; self.shapes.len()];
        for (key, list) in here {
            if let Some(others) = there.get(&key).filter(|others| others.len() == list.len()) {
                list.iter().zip(others).for_each(|(&i, &j)| found[i as usize] = Some(j));
            }
        }
        found
    }

    /// Returns the indices of the meshes with each name, number of vertices and topology.
    fn by_key(&self) -> BTreeMap<(&str, usize, u64), Vec<u32>> {
        let mut map = BTreeMap::<_, Vec<u32>>::new();
        for (i, shape) in self.shapes.iter().enumerate() {
            map.entry((shape.name.as_str(), shape.count, shape.topology)).or_default().push(i as u32);
        }
        map
    }
}
