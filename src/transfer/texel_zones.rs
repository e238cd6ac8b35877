//! Finds the parts of the surface's bounding rectangle where lamps may lie. The emission does not know surfaces, and
//! the scene does not know lamps; only the transfer knows both.

use crate::emission::TexelZone;
use crate::error::Result;
use crate::job::Job;
use crate::scene::Scene;
use crate::scene::surface::Surface;
use glam::{DVec2, DVec4, UVec2};

/// Finds for each texel whether light is allowed there; returns `None` if light is allowed everywhere. The texture has
/// `size` texels and covers the bounding rectangle of `surface`, whose axes are the axes of the rotated pattern. The
/// zones are given along the axes of `untouched`, the surface before the rotation.
pub(super) fn find(
    scene: &Scene,
    (surface, untouched): (&Surface, &Surface),
    margin: f64,
    zones: &[DVec4],
    size: UVec2,
    job: Job,
) -> Result<Option<Vec<TexelZone>>> {
    let keeps_margin = margin >= 0.0;
    if surface.is_rectangle() && !keeps_margin && zones.is_empty() {
        return Ok(None);
    }
    // With a negative margin, lamps may cross the surface's edge. Then also include texels that the surface covers
    // only in part.
    let covered = surface.covered_texels(scene, size, !keeps_margin)?;
    let texels_per_metre = size.as_dvec2() / surface.size.as_dvec2();
    let in_zone = |texel: DVec2| {
        let at = surface.to_other(untouched, texel / texels_per_metre);
        zones.iter().any(|z| at.x >= z.x && at.x <= z.z && at.y >= z.y && at.y <= z.w)
    };
    let margin = keeps_margin.then_some(margin * texels_per_metre.min_element());
    TexelZone::mark(size, &covered, in_zone, margin, job).map(Some)
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
        // 4 of 24 m² are hidden. The hidden texels cover slightly less: a strip one texel wide along the two inner
        // edges is open.
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
        // Select the surface by triangles, including the triangles of the beam: the beam lies in another plane and must
        // be left out.
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
