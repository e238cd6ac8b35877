//! Finds the parts of the surface's bounding rectangle where lamps may lie.

use crate::emission::TexelZone;
use crate::error::Result;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::scene::Scene;
use crate::scene::surface::Surface;
use crate::segment;
use glam::{DVec2, DVec3, DVec4, UVec2};

/// Width in texels by which triangles are enlarged, so that no texel between two adjacent triangles is lost. [rounding]
const CRACK: f64 = 1e-3;
/// A surface counts as a full rectangle if its area is at least this share of its bounding rectangle's area.
/// [rounding]
const FULL: f32 = 0.9999;

/// Finds for each texel whether light is allowed there; returns `None` if light is allowed everywhere. The texture has
/// `size` texels and covers the bounding rectangle of `surface`, whose axes are those of the rotated pattern. The
/// zones are given along the axes of `untouched`, the surface before the rotation.
pub(super) fn find(
    scene: &Scene,
    (surface, untouched): (&Surface, &Surface),
    margin: f64,
    zones: &[DVec4],
    size: UVec2,
    job: Job,
) -> Result<Option<Vec<TexelZone>>> {
    let is_full = surface.area >= FULL * surface.size.element_product();
    let keeps_margin = margin >= 0.0;
    if is_full && !keeps_margin && zones.is_empty() {
        return Ok(None);
    }
    let (width, height) = (size.x as usize, size.y as usize);
    let density = size.as_dvec2() / surface.size.as_dvec2();

    // Find the texels that the surface covers. If lamps may cross the surface's edge (no margin), include texels of
    // which only a part is visible.
    let slack = if keeps_margin { CRACK } else { 1.0 };
    let covered = coverage(scene, surface, size, slack)?;

    // Mark the texels where no lamp may be: those in zones and, if lamps must keep a margin, those off the surface.
    // Then dilate the marked texels by the margin.
    let mut blocked = Image::new(width, height, 1)?;
    for (i, out) in blocked.data.iter_mut().enumerate() {
        let texel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let at = on_other(surface, untouched, texel / density);
        let in_zone = zones.iter().any(|z| at.x >= z.x && at.x <= z.z && at.y >= z.y && at.y <= z.w);
        *out = f32::from(in_zone || (keeps_margin && !covered[i]));
    }
    let radius = (margin.max(0.0) * density.min_element()).min(65_536.0);
    let blocked = segment::dilate(&blocked, radius as f32, job)?;
    let beyond = |x: usize, y: usize| {
        let edge = (x.min(y).min(width - 1 - x).min(height - 1 - y)) as f64;
        keeps_margin && edge < radius.max(1.0)
    };

    let mut texel_zones = try_vec(width * height, TexelZone::Open)?;
    for (i, out) in texel_zones.iter_mut().enumerate() {
        *out = match () {
            _ if blocked.data[i] > 0.5 || beyond(i % width, i / width) => TexelZone::KeepOut,
            _ if !covered[i] => TexelZone::Hidden,
            _ => TexelZone::Open,
        };
    }
    Ok(Some(texel_zones))
}

/// Converts a point on one surface, in metres from its corner, to coordinates of another surface in the same plane.
fn on_other(from: &Surface, to: &Surface, at: DVec2) -> DVec2 {
    let point = from.origin.as_dvec3() + from.u_axis.as_dvec3() * at.x + from.v_axis.as_dvec3() * at.y;
    let offset = point - to.origin.as_dvec3();
    DVec2::new(offset.dot(to.u_axis.as_dvec3()), offset.dot(to.v_axis.as_dvec3()))
}

/// For each texel, whether its centre lies in a triangle of the surface, or within `slack` texels of one.
fn coverage(scene: &Scene, surface: &Surface, size: UVec2, slack: f64) -> Result<Vec<bool>> {
    let (width, height) = (size.x as usize, size.y as usize);
    let mut covered = try_vec(width * height, false)?;
    let density = size.as_dvec2() / surface.size.as_dvec2();
    for &(mesh, triangle) in &surface.triangles {
        let mut corners = scene.meshes[mesh].corners(triangle).map(|p| {
            let from: DVec3 = p.as_dvec3() - surface.origin.as_dvec3();
            DVec2::new(from.dot(surface.u_axis.as_dvec3()), from.dot(surface.v_axis.as_dvec3())) * density
        });
        if (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) < 0.0 {
            corners.swap(1, 2);
        }
        // Compute the edges; a point inside has positive signed distances from all three.
        let edges = [0, 1, 2].map(|i| {
            let along = (corners[(i + 1) % 3] - corners[i]).normalize_or_zero();
            (corners[i], along)
        });
        let (low, high) = corners.iter().fold((corners[0], corners[0]), |(l, h), c| (l.min(*c), h.max(*c)));
        let first = (low - slack - 0.5).ceil().max(DVec2::ZERO).as_uvec2();
        let end = (high + slack + 0.5).floor().max(DVec2::ZERO).as_uvec2().min(size);
        for y in first.y..end.y {
            for x in first.x..end.x {
                let texel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                if edges.iter().all(|(from, along)| along.perp_dot(texel - *from) >= -slack) {
                    covered[y as usize * width + x as usize] = true;
                }
            }
        }
    }
    Ok(covered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::scene::{Mesh, surface};
    use glam::Vec3;

    /// An L-shaped ceiling of 6 × 4 m without a corner of 2 × 2 m, and a floor below it.
    fn l_shaped() -> (Scene, Surface) {
        let corners = [[0., 0.], [6., 0.], [6., 2.], [4., 2.], [4., 4.], [0., 4.]];
        let ceiling = Mesh {
            name: "Ceiling".into(),
            positions: corners.map(|[x, z]| Vec3::new(x, 3.0, z)).into(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]],
            ..Mesh::default()
        };
        let floor = Mesh { positions: ceiling.positions.iter().map(|p| p.with_y(0.0)).collect(), ..ceiling.clone() };
        let floor = Mesh { name: "Floor".into(), ..floor };
        let scene = Scene {
            meshes: vec![ceiling, floor],
            materials: vec![crate::scene::Material::default()],
            ..Scene::default()
        };
        let surface = surface::find(&scene, "Ceiling").unwrap();
        (scene, surface)
    }

    fn share(texel_zones: &[TexelZone], of: TexelZone) -> f64 {
        texel_zones.iter().filter(|g| **g == of).count() as f64 / texel_zones.len() as f64
    }

    #[test]
    fn what_the_surface_does_not_cover_is_hidden_or_kept_out() {
        let (scene, surface) = l_shaped();
        let size = UVec2::new(600, 400);
        let of = |margin: f64, zones: &[DVec4]| {
            find(&scene, (&surface, &surface), margin, zones, size, Monitor::default().job()).unwrap().unwrap()
        };
        // 4 of 24 m² are hidden. The texels found are fewer by a strip of one texel along the two inner edges.
        let cut = of(-1.0, &[]);
        assert!((share(&cut, TexelZone::Hidden) - 1.0 / 6.0).abs() < 0.004 && share(&cut, TexelZone::KeepOut) == 0.0);
        // With a margin of 0.3 m, the open part is the L shrunk by the margin. Its inner corner is rounded with a
        // radius of 0.3 m.
        let kept = of(0.3, &[]);
        let exact = 5.4 * 3.4 - (2.0 * 2.0 + std::f64::consts::FRAC_PI_4 * 0.09 - 0.09);
        assert!(
            (share(&kept, TexelZone::Open) * 24.0 - exact).abs() < 0.08,
            "{}",
            share(&kept, TexelZone::Open) * 24.0
        );
        // A zone of 2 × 1 m inside the L.
        let zone = of(-1.0, &[DVec4::new(1.0, 2.5, 3.0, 3.5)]);
        assert!((share(&zone, TexelZone::KeepOut) * 24.0 - 2.0).abs() < 0.05);
        assert_eq!(zone[300 * 600 + 200], TexelZone::KeepOut);
    }

    #[test]
    fn turned_surfaces_keep_their_zones_and_their_area() {
        let (scene, surface) = l_shaped();
        let turned = surface.turned(&scene, 0.5).unwrap();
        let size = (turned.size * 100.0).round().as_uvec2();
        let zone = DVec4::new(1.0, 2.5, 3.0, 3.5);
        let texel_zones =
            find(&scene, (&turned, &surface), 0.0, &[zone], size, Monitor::default().job()).unwrap().unwrap();
        let area = f64::from(turned.size.element_product());
        assert!(
            (share(&texel_zones, TexelZone::Open) * area - 18.0).abs() < 0.15,
            "{}",
            share(&texel_zones, TexelZone::Open) * area
        );
        assert!((turned.size.x - (6.0 * 0.5f32.cos() + 2.0 * 0.5f32.sin())).abs() < 1.5);
    }

    #[test]
    fn parts_of_a_ceiling_between_beams_share_one_pattern() {
        // Two slabs of one material, each 2.5 m wide, with a beam of 1 m between them. The underside of the beam is
        // lower.
        let slab = |name: &str, x: f32, width: f32, y: f32, material: usize| Mesh {
            name: name.into(),
            material,
            positions: [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]
                .map(|[u, v]| Vec3::new(x + u * width, y, v * 4.0))
                .into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let paint = |name: &str| crate::scene::Material { name: name.into(), ..crate::scene::Material::default() };
        let scene = Scene {
            meshes: vec![
                slab("Left", 0.0, 2.5, 3.0, 0),
                slab("Right", 3.5, 2.5, 3.0, 0),
                slab("Beam", 2.5, 1.0, 2.7, 1),
                slab("Floor", 0.0, 6.0, 0.0, 1),
            ],
            materials: vec![paint("Plaster"), paint("Concrete")],
            ..Scene::default()
        };
        let by_name = surface::find(&scene, "Plaster").unwrap();
        // Select the surface by triangles, including those of the beam: the beam lies in another plane and must be
        // left out.
        let listed: Vec<(usize, usize)> = (0..3).flat_map(|mesh| [(mesh, 0), (mesh, 1)]).collect();
        assert_eq!(surface::from_triangles(&scene, &listed).unwrap(), by_name);
        assert_eq!(by_name.triangles, [(0, 0), (0, 1), (1, 0), (1, 1)]);
        // Both slabs must share one rectangle, and so one pattern. The beam's part of the rectangle is hidden.
        assert!((by_name.size.element_product() - 24.0).abs() < 1e-3, "{}", by_name.size);
        let size = UVec2::new(600, 400);
        let texel_zones =
            find(&scene, (&by_name, &by_name), -1.0, &[], size, Monitor::default().job()).unwrap().unwrap();
        assert!((share(&texel_zones, TexelZone::Hidden) - 1.0 / 6.0).abs() < 0.01);
    }

    #[test]
    fn a_whole_rectangle_without_wishes_needs_nothing() {
        let (mut scene, _) = l_shaped();
        scene.meshes[0].positions[3] = Vec3::new(6.0, 3.0, 3.0);
        scene.meshes[0].positions[4] = Vec3::new(6.0, 3.0, 4.0);
        let surface = surface::find(&scene, "Ceiling").unwrap();
        let size = UVec2::new(60, 40);
        let job = Monitor::default();
        assert!(find(&scene, (&surface, &surface), -1.0, &[], size, job.job()).unwrap().is_none());
    }
}
