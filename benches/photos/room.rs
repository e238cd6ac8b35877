//! Rooms from seeds: a ceiling with its lamps, walls, a floor and furniture.

use super::ceiling::{self, Ceiling, Fitting};
use super::dice::Dice;
use super::forms::Form;
use super::furnish;
use glam::{Vec2, Vec3};
use luxfer::image::Image;
use luxfer::scene::{Material, Mesh, Scene, Texture, TextureRef};

/// Colours of white lamps, from warm to cool, with luminance of about 1.
const WHITES: [Vec3; 5] = [
    Vec3::new(1.35, 0.93, 0.53),
    Vec3::new(1.22, 0.96, 0.70),
    Vec3::new(1.10, 0.98, 0.88),
    Vec3::new(1.0, 1.0, 1.0),
    Vec3::new(0.94, 1.0, 1.12),
];
const SKY: Vec3 = Vec3::new(0.80, 1.0, 1.35);
/// Colours of coloured lamps.
const COLOURS: [Vec3; 6] = [
    Vec3::new(2.6, 0.5, 0.3),
    Vec3::new(0.3, 0.5, 5.0),
    Vec3::new(0.4, 1.3, 0.5),
    Vec3::new(1.6, 0.6, 2.6),
    Vec3::new(0.4, 1.1, 1.6),
    Vec3::new(1.8, 0.9, 0.1),
];

/// The class of a mesh, which becomes the class of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// The plane: the ceiling with frames of lamps and lamps that are switched off.
    Ceiling = 1,
    /// A lamp that is switched on.
    Lamp = 2,
    Wall = 3,
    Floor = 4,
    Window = 5,
    /// Furniture, columns, screens.
    Thing = 6,
    /// Objects that hang from the ceiling and are neither ceiling nor lamp: beams, ducts, housings of lamps.
    Hanging = 7,
}

/// A generated room, before it is photographed.
pub struct Room {
    pub scene: Scene,
    /// Class of each mesh, and for lamps the number of the lamp in the ceiling.
    pub classes: Vec<(Class, usize)>,
    pub ceiling: Ceiling,
    /// Width, height and depth in metres; a corner of the floor is the origin.
    pub size: Vec3,
}

impl Room {
    /// Makes the room of a seed; `design` is the seed that draws the design of the ceiling.
    pub fn new(seed: u64, design: u64) -> Self {
        let mut dice = Dice::new(seed, 1);
        let hall = dice.chance(0.2);
        let size = Vec3::new(
            dice.log_between(if hall { 8.0 } else { 3.2 }, if hall { 18.0 } else { 9.0 }),
            if hall { dice.between(3.2, 6.0) } else { dice.between(2.4, 3.4) },
            dice.log_between(if hall { 12.0 } else { 4.5 }, if hall { 28.0 } else { 14.0 }),
        );
        // Some rooms have a lower rim around the ceiling.
        let rim = if dice.chance(0.12) { dice.between(0.3, 0.9) } else { 0.0 };
        let inner = Vec2::new(size.x, size.z) - 2.0 * rim;
        let mut ceiling = ceiling::ceiling(&mut Dice::new(design, 12), &mut Dice::new(seed, 2), inner);
        ceiling.fittings.iter_mut().for_each(|fitting| fitting.centre += rim);
        if let Some((lines, _)) = &mut ceiling.beams {
            lines.iter_mut().flatten().for_each(|at| *at += rim);
        }
        let mut room = Self { scene: Scene::default(), classes: Vec::new(), ceiling, size };
        room.add_ceiling(&mut Dice::new(seed, 3));
        room.add_lamps(&mut Dice::new(seed, 4));
        furnish::rim(&mut room, &mut Dice::new(seed, 11), rim);
        furnish::outlets(&mut room, &mut Dice::new(seed, 13));
        furnish::walls(&mut room, &mut Dice::new(seed, 5));
        furnish::things(&mut room, &mut Dice::new(seed, 6));
        room
    }

    pub fn paint(&mut self, colour: Vec3, roughness: f32) -> usize {
        self.scene.materials.push(Material { roughness, ..Material::diffuse("Paint", colour) });
        self.scene.materials.len() - 1
    }

    /// Adds a glossy paint, a paint under a clear layer; returns its material.
    pub fn gloss(&mut self, colour: Vec3, roughness: f32) -> usize {
        let material = self.paint(colour, roughness);
        self.scene.materials[material].ior = 1.5;
        material
    }

    /// Adds an image as a texture that materials can use.
    pub fn texture(&mut self, image: Image) -> TextureRef {
        self.scene.textures.push(Texture::new("Texture", image));
        TextureRef::new(self.scene.textures.len() - 1)
    }

    /// Adds a paint with an image that repeats every `period` metres; returns its material.
    pub fn textured(&mut self, image: Image, period: Vec2, roughness: f32) -> usize {
        self.scene.textures.push(Texture::new("Pattern", image));
        let texture = TextureRef {
            transform: glam::Mat3::from_scale(period.recip()),
            ..TextureRef::new(self.scene.textures.len() - 1)
        };
        let material = self.paint(Vec3::ONE, roughness);
        self.scene.materials[material].base_color_texture = Some(texture);
        material
    }

    /// Adds a material that emits light from its front side.
    pub fn shining(&mut self, emission: Vec3) -> usize {
        let black = Material::diffuse("Lamp", Vec3::splat(0.05));
        self.scene.materials.push(Material { emission, double_sided: false, ..black });
        self.scene.materials.len() - 1
    }

    pub fn add(&mut self, class: Class, material: usize, mesh: Mesh) {
        self.add_numbered((class, 0), material, mesh);
    }

    fn add_numbered(&mut self, class: (Class, usize), material: usize, mesh: Mesh) {
        self.scene.meshes.push(Mesh { name: format!("{:?}", class.0), material, ..mesh });
        self.classes.push(class);
    }

    /// Adds a rectangle whose texture coordinates are in metres.
    pub fn sheet(&mut self, class: Class, material: usize, corner: Vec3, u: Vec3, v: Vec3) {
        let mut mesh = Mesh::parallelogram(corner, u, v, material);
        mesh.uvs[0].iter_mut().for_each(|uv| *uv *= Vec2::new(u.length(), v.length()));
        self.add(class, material, mesh);
    }

    pub fn cuboid(&mut self, class: Class, material: usize, low: Vec3, high: Vec3) {
        self.add(class, material, cuboid(low, high));
    }

    fn add_ceiling(&mut self, dice: &mut Dice) {
        let Vec3 { x, y, z } = self.size;
        let grey =
            dice.weighted(&[(0.85, 6.0), (0.72, 3.0), (0.45, 1.2), (0.2, 0.6), (0.05, 0.7)]) * dice.between(0.9, 1.05);
        let tint = Vec3::new(1.0, 1.0 - dice.between(0.0, 0.03), 1.0 - dice.between(0.0, 0.08));
        let tiled = matches!(self.ceiling.pattern, "troffers" | "mixed") || dice.chance(0.3);
        let material = match () {
            _ if dice.chance(0.08) => self.gloss(tint * grey, dice.between(0.08, 0.3)),
            _ if tiled => self.textured(tiles(dice, tint * grey), Vec2::splat(0.6 * 8.0), 1.0),
            _ if dice.chance(0.12) => self.textured(slats(dice), Vec2::new(1.2, 3.0), 1.0),
            _ => self.paint(tint * grey, 1.0),
        };
        self.sheet(Class::Ceiling, material, Vec3::Y * y, Vec3::X * x, Vec3::Z * z);

        // Add the beams between the coffers.
        let Some(([along_x, along_z], beam)) = self.ceiling.beams.clone() else { return };
        let wood = if dice.chance(0.4) { Vec3::new(0.25, 0.14, 0.07) } else { tint * grey };
        let material = self.paint(wood, 1.0);
        let low = |at: f32| (at - beam.x / 2.0, at + beam.x / 2.0);
        let clip = |v: f32, end: f32| v.clamp(0.0, end);
        for (from, to) in along_x.into_iter().map(low) {
            let (from, to) = (clip(from, z), clip(to, z));
            self.cuboid(Class::Hanging, material, Vec3::new(0.0, y - beam.y, from), Vec3::new(x, y, to));
        }
        for (from, to) in along_z.into_iter().map(low) {
            let (from, to) = (clip(from, x), clip(to, x));
            self.cuboid(Class::Hanging, material, Vec3::new(from, y - beam.y, 0.0), Vec3::new(to, y, z));
        }
    }

    fn add_lamps(&mut self, dice: &mut Dice) {
        let white = if self.ceiling.is_skylight { SKY } else { dice.pick(&WHITES) };
        let coloured = !self.ceiling.is_skylight && dice.chance(0.07);
        let kinds = 1 + self.ceiling.fittings.iter().map(|f| f.kind).max().unwrap_or(0);
        // Lamps with a small area are brighter.
        let area = self.ceiling.fittings.first().map_or(1.0, |f| f.form.area());
        let strength = dice.log_between(1500.0, 6000.0) * (0.3 / area).clamp(0.6, 8.0);
        let mut materials: Vec<usize> =
            (0..kinds).map(|_| self.shining(white * strength * dice.between(0.7, 1.4))).collect();
        if coloured {
            materials.extend((0..dice.whole(1, 3)).map(|_| self.shining(dice.pick(&COLOURS) * strength * 0.6)));
        }
        if self.ceiling.has_inside {
            self.scene.textures.push(Texture::new("Inside", inside(dice)));
            let texture = TextureRef::new(self.scene.textures.len() - 1);
            materials.iter().for_each(|&m| self.scene.materials[m].emission_texture = Some(texture));
        }
        let out = self.paint(Vec3::splat(0.55), 1.0);
        let frame = dice.chance(0.5).then(|| self.paint(Vec3::splat(dice.pick(&[0.8, 0.5, 0.12])), 1.0));
        let housing = self.paint(Vec3::splat(dice.pick(&[0.8, 0.7, 0.1])), 0.5);
        let spread = dice.pick(&[0.0, 0.0, 0.05]);
        for (number, fitting) in self.ceiling.fittings.clone().into_iter().enumerate() {
            let mut material = if coloured { dice.pick(&materials) } else { materials[fitting.kind] };
            if spread > 0.0 {
                // Lamps of different age differ in brightness.
                let own = self.scene.materials[material].clone();
                let emission = own.emission * (1.0 + spread * dice.normal()).max(0.5);
                self.scene.materials.push(Material { emission, ..own });
                material = self.scene.materials.len() - 1;
            }
            self.add_fitting(number, &fitting, material, out, frame, housing);
        }
    }

    fn add_fitting(
        &mut self,
        number: usize,
        fitting: &Fitting,
        lit: usize,
        out: usize,
        frame: Option<usize>,
        housing: usize,
    ) {
        let height = self.size.y;
        let at = |drop: f32| Vec3::new(fitting.centre.x, height - drop, fitting.centre.y);
        let low = fitting.form.outline(0.0).into_iter().fold(Vec2::MAX, Vec2::min);
        if fitting.drop >= 0.03 {
            // Add a housing between the lamp and the ceiling, or around a lamp that hangs below the ceiling.
            let (a, b) = (fitting.centre + low, fitting.centre - low);
            let top = if fitting.drop > 0.12 { height - fitting.drop + 0.06 } else { height };
            let bottom = height - fitting.drop + 0.002;
            if !matches!(fitting.form, Form::Ring { .. }) {
                self.cuboid(Class::Hanging, housing, Vec3::new(a.x, bottom, a.y), Vec3::new(b.x, top, b.y));
            }
        } else if let Some(frame) = frame {
            let grown = match &fitting.form {
                Form::Rectangle(size) => Some(Form::Rectangle(*size + 0.05)),
                Form::Disc(radius) => Some(Form::Disc(radius * 1.25)),
                _ => None,
            };
            if let Some(form) = grown {
                self.add(Class::Ceiling, frame, form.mesh(at(0.5 * fitting.drop), 0.0));
            }
        }
        let mesh = fitting.form.mesh(at(fitting.drop), 0.0);
        match fitting.is_lit {
            true => self.add_numbered((Class::Lamp, number), lit, mesh),
            false => self.add(Class::Ceiling, out, mesh),
        }
    }
}

/// A closed box with its front faces outwards.
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for side in super::hall::cuboid("", 0, [low, high]) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(side.positions);
        mesh.triangles.extend(side.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    mesh
}

/// A texture of eight by eight ceiling tiles between bars, with small differences of brightness.
fn tiles(dice: &mut Dice, colour: Vec3) -> Image {
    const SIDE: usize = 64;
    let bar = dice.between(0.75, 1.0);
    let spread = dice.between(0.0, 0.03);
    let shades: Vec<f32> = (0..64).map(|_| 1.0 + spread * dice.normal()).collect();
    let specks: Vec<f32> = (0..997).map(|_| if dice.chance(0.05) { 0.85 } else { 1.0 }).collect();
    Image::from_fn(8 * SIDE, 8 * SIDE, |x, y| {
        let on_bar = x % SIDE < 2 || y % SIDE < 2;
        let shade = if on_bar { bar } else { shades[y / SIDE * 8 + x / SIDE] * specks[(x * 31 + y * 389) % 997] };
        (colour * shade).to_array()
    })
    .expect("tiles")
}

/// A texture of wooden slats with dark gaps.
fn slats(dice: &mut Dice) -> Image {
    let wood = Vec3::new(0.45, 0.27, 0.13) * dice.between(0.6, 1.3);
    let shades: Vec<f32> = (0..8).map(|_| 1.0 + 0.12 * dice.normal()).collect();
    Image::from_fn(256, 64, |x, _| (wood * if x % 32 < 5 { 0.15 } else { shades[x / 32] }).to_array()).expect("slats")
}

/// A texture of uneven emission of a lamp: two tubes behind its cover, a louvre before it, or a bright centre.
fn inside(dice: &mut Dice) -> Image {
    let kind = dice.below(3);
    let depth = dice.between(0.2, 0.6);
    Image::from_fn(32, 32, |x, y| {
        let (s, t) = ((x as f32 + 0.5) / 32.0, (y as f32 + 0.5) / 32.0);
        let shade = match kind {
            0 => 1.0 - depth * (1.0 - (-((s - 0.3) / 0.09).powi(2)).exp() - (-((s - 0.7) / 0.09).powi(2)).exp()),
            1 if x % 8 == 0 || y % 8 == 0 => 1.0 - depth,
            1 => 1.0,
            _ => 1.0 - depth * ((s - 0.5).abs().max((t - 0.5).abs()) * 2.0).powi(2),
        };
        [shade; 3]
    })
    .expect("a cover")
}
