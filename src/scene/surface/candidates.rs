//! Lists the objects and materials of a scene as candidates for the surface that will carry the lights: their area,
//! height and direction, and how much each resembles a ceiling.
//!
//! A ceiling is level, lies high in the scene and covers much of the scene's floor plan. The score is l c h². Here l is
//! the level share of the candidate's area. c is the level area as a share of the scene's floor plan, at most 1. h is
//! the mean height of the level area above the scene's lowest point, as a share of the scene's height. A name that says
//! "ceiling" raises the score (`NAMED`). Only the order of scores has a meaning. Each triangle is read once, so that
//! large scenes are listed quickly.
//!
//! Not modelled: whether a surface is visible from the room. The upper side of a roof counts as much as its lower
//! side.

use super::ceiling_name::is_ceiling;
use crate::error::Result;
use crate::image::{try_collect, try_push, try_vec, try_with_capacity};
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// Cosine of 15 degrees: triangles inclined by less than this angle count as level. [convention]
const LEVEL: f64 = 0.965_925_826;

/// If a name contains a word for a ceiling, and at least one triangle is level, the score `s` becomes
/// `s + NAMED (1 - s)`. [convention]
const NAMED: f64 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// All meshes of one name.
    Object,
    /// All triangles of one material.
    Material,
}

/// An object or a material of the scene, with the measurements that indicate how likely it is to be the ceiling.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    pub kind: Kind,
    pub name: String,
    /// Index of the object's first mesh, or index of the material.
    pub index: usize,
    pub triangles: usize,
    /// Area of all triangles in m².
    pub area: f64,
    /// Area in m² of the level triangles, whether they face up or down.
    pub level_area: f64,
    /// Heights of the lowest and the highest point in metres.
    pub low: f64,
    pub high: f64,
    /// Area-weighted mean height in metres of the level triangles, or of all triangles if none is level.
    pub height: f64,
    /// Unit mean of the triangles' normals, weighted by area; 0 if the normals cancel.
    pub normal: DVec3,
    /// Resemblance to a ceiling, in `[0, 1]`; see the module documentation.
    pub score: f64,
    /// The reason for the score, as text for the user.
    pub reason: String,
}

/// Lists all objects, and all materials in use, the most likely ceiling first. Triangles without an area do not count.
pub fn candidates(scene: &Scene) -> Result<Vec<Candidate>> {
    // Measure each mesh once; the measurements of objects and materials are sums over meshes.
    let sums = try_collect(scene.meshes.iter().map(|mesh| {
        let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| p.as_dvec3()));
        corners.fold(Sums::default(), |mut sums, corners| {
            sums.add_triangle(corners);
            sums
        })
    }))?;
    let mut whole = Sums::default();
    sums.iter().for_each(|mesh| whole.add(mesh));

    // Meshes with the same name form one object.
    let mut order = try_collect(0..scene.meshes.len())?;
    order.sort_by_key(|&i| (&scene.meshes[i].name, i));
    let mut list = try_with_capacity(0)?;
    for object in order.chunk_by(|&a, &b| scene.meshes[a].name == scene.meshes[b].name) {
        let mut sum = Sums::default();
        object.iter().for_each(|&i| sum.add(&sums[i]));
        if sum.triangles > 0 {
            try_push(&mut list, sum.candidate(Kind::Object, &scene.meshes[object[0]].name, object[0], &whole))?;
        }
    }
    let mut materials = try_vec(scene.materials.len(), Sums::default())?;
    for (mesh, sum) in scene.meshes.iter().zip(&sums) {
        if let Some(material) = materials.get_mut(mesh.material) {
            material.add(sum);
        }
    }
    for (i, sum) in materials.iter().enumerate().filter(|(_, sum)| sum.triangles > 0) {
        try_push(&mut list, sum.candidate(Kind::Material, &scene.materials[i].name, i, &whole))?;
    }
    list.sort_by(|a, b| b.score.total_cmp(&a.score).then(b.area.total_cmp(&a.area)));
    Ok(list)
}

/// Sums over the triangles of a mesh, an object or a material.
#[derive(Clone)]
struct Sums {
    triangles: usize,
    area: f64,
    level_area: f64,
    /// Sums over triangles of the triangle's area times the height of its centre: over all triangles (`moment`), and
    /// over the level triangles (`level_moment`).
    moment: f64,
    level_moment: f64,
    /// Sum of the triangles' normals, each as long as the triangle's area.
    area_vector: DVec3,
    low: DVec3,
    high: DVec3,
}

impl Default for Sums {
    fn default() -> Self {
        Self {
            triangles: 0,
            area: 0.0,
            level_area: 0.0,
            moment: 0.0,
            level_moment: 0.0,
            area_vector: DVec3::ZERO,
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }
}

impl Sums {
    fn add_triangle(&mut self, [a, b, c]: [DVec3; 3]) {
        let area_vector = (b - a).cross(c - a) / 2.0;
        let area = area_vector.length();
        if !(area > 0.0 && area.is_finite()) {
            return;
        }
        let moment = area * (a.y + b.y + c.y) / 3.0;
        let is_level = area_vector.y.abs() >= LEVEL * area;
        self.add(&Self {
            triangles: 1,
            area,
            level_area: if is_level { area } else { 0.0 },
            moment,
            level_moment: if is_level { moment } else { 0.0 },
            area_vector,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
        });
    }

    fn add(&mut self, other: &Self) {
        self.triangles += other.triangles;
        self.area += other.area;
        self.level_area += other.level_area;
        self.moment += other.moment;
        self.level_moment += other.level_moment;
        self.area_vector += other.area_vector;
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    fn height(&self) -> f64 {
        if self.level_area > 0.0 { self.level_moment / self.level_area } else { self.moment / self.area }
    }

    fn candidate(&self, kind: Kind, name: &str, index: usize, scene: &Self) -> Candidate {
        let share = |part: f64, whole: f64| if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 };
        let size = scene.high - scene.low;
        let plan = DVec2::new(size.x, size.z).element_product();
        let [level, cover, above] = [
            share(self.level_area, self.area),
            share(self.level_area, plan),
            share(self.height() - scene.low.y, size.y),
        ];
        // Square the relative height, because a surface at half the height is hardly a ceiling.
        let score = level * cover * above * above;
        let is_named = is_ceiling(name);
        Candidate {
            kind,
            name: name.into(),
            index,
            triangles: self.triangles,
            area: self.area,
            level_area: self.level_area,
            low: self.low.y,
            high: self.high.y,
            height: self.height(),
            normal: self.area_vector.normalize_or_zero(),
            score: if is_named && self.level_area > 0.0 { score + NAMED * (1.0 - score) } else { score },
            reason: self.reason(cover, above, is_named),
        }
    }

    fn reason(&self, cover: f64, above: f64, is_named: bool) -> String {
        let named = if is_named { "; its name says that it is a ceiling" } else { "" };
        if self.level_area == 0.0 {
            return format!("none of its {:.1} m² is level{named}", self.area);
        }
        format!(
            "{:.1} of its {:.1} m² are level, at {:.2} m, which is {:.0} % of the scene's height, and cover {:.0} % of \
             its plan{named}",
            self.level_area,
            self.area,
            self.height(),
            100.0 * above,
            100.0 * cover
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh};
    use glam::Vec3;

    /// A room of 6 x 4 x 3 m with a floor, a ceiling in two meshes, a wall and a desk.
    fn room() -> Scene {
        let sheet = |name: &str, corner: Vec3, u: Vec3, v: Vec3, material: usize| Mesh {
            name: name.into(),
            ..Mesh::parallelogram(corner, u, v, material)
        };
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        Scene {
            meshes: vec![
                sheet("Floor", Vec3::ZERO, 4.0 * z, 6.0 * x, 0),
                sheet("Slab", 3.0 * y, 3.0 * x, 4.0 * z, 1),
                sheet("Wall", Vec3::ZERO, 6.0 * x, 3.0 * y, 1),
                sheet("Slab", 3.0 * y + 3.0 * x, 3.0 * x, 4.0 * z, 1),
                sheet("Desk", 0.75 * y, z, 2.0 * x, 0),
                Mesh { name: "Empty".into(), ..Mesh::default() },
            ],
            materials: vec![
                Material::diffuse("Wood", Vec3::ONE),
                Material::diffuse("Plaster", Vec3::ONE),
                Material::diffuse("Unused", Vec3::ONE),
            ],
            ..Scene::default()
        }
    }

    fn names(list: &[Candidate]) -> Vec<(Kind, &str)> {
        list.iter().map(|c| (c.kind, c.name.as_str())).collect()
    }

    #[test]
    fn the_ceiling_comes_first_with_its_figures() {
        let list = candidates(&room()).unwrap();
        use Kind::{Material, Object};
        assert_eq!(names(&list)[..2], [(Object, "Slab"), (Material, "Plaster")]);
        assert_eq!(list.len(), 6, "{:?}", names(&list));
        let slab = &list[0];
        assert_eq!((slab.index, slab.triangles, slab.score), (1, 4, 1.0));
        assert_eq!([slab.area, slab.level_area, slab.height, slab.low, slab.high], [24.0, 24.0, 3.0, 3.0, 3.0]);
        assert_eq!(slab.normal, DVec3::NEG_Y);
        let words = "24.0 of its 24.0 m² are level, at 3.00 m, which is 100 % of the scene's height, and cover 100 % of its plan";
        assert_eq!(slab.reason, words);
        // If the ceiling and a wall share a material, the height of the material is the height of its level triangles
        // alone.
        let plaster = &list[1];
        assert_eq!((plaster.index, plaster.area, plaster.level_area, plaster.height), (1, 42.0, 24.0, 3.0));
        let find = |name: &str| list.iter().find(|c| c.name == name).unwrap();
        assert_eq!((find("Floor").score, find("Wall").score, find("Wall").height), (0.0, 0.0, 1.5));
        assert!(find("Wall").reason.starts_with("none of its 18.0 m² is level"), "{}", find("Wall").reason);
        let desk = find("Desk").score;
        assert!(desk > 0.0 && desk < 0.01, "{desk}");
    }

    #[test]
    fn a_name_counts_but_not_for_a_wall() {
        let mut scene = room();
        scene.meshes[4].name = "Zimmerdecke".into();
        scene.meshes[2].name = "Ceiling edge".into();
        let list = candidates(&scene).unwrap();
        let find = |name: &str| list.iter().find(|c| c.name == name).unwrap();
        assert!((0.5..0.51).contains(&find("Zimmerdecke").score), "{}", find("Zimmerdecke").score);
        assert!(find("Zimmerdecke").reason.ends_with("its name says that it is a ceiling"));
        assert_eq!(find("Ceiling edge").score, 0.0);
        assert!(candidates(&Scene::default()).unwrap().is_empty());
    }
}
