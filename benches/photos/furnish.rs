//! Furnishes generated rooms: walls, windows, floors, furniture, and objects under the ceiling.

use super::dice::Dice;
use super::forms::Form;
use super::room::{Class, Room};
use glam::{Vec2, Vec3};
use luxfer::image::Image;
use luxfer::scene::Mesh;

/// Adds four walls and a floor, and doors, pictures and windows on the walls.
pub fn walls(room: &mut Room, dice: &mut Dice) {
    let Vec3 { x, y, z } = room.size;
    let base = warm(dice, 0.45, 0.85);
    let plain = room.paint(base, 1.0);
    let accent = if dice.chance(0.35) { room.paint(any_colour(dice), 1.0) } else { plain };
    let (u, v, w) = (Vec3::X * x, Vec3::Y * y, Vec3::Z * z);
    // For each wall: its lower left corner as seen from inside, the vector along the wall, and the direction into the
    // room.
    let walls = [(Vec3::ZERO, u, Vec3::Z), (w + u, -u, Vec3::NEG_Z), (w, -w, Vec3::X), (u, w, Vec3::NEG_X)];
    let special = dice.below(4);
    let windows = if dice.chance(0.45) { dice.below(4) } else { usize::MAX };
    for (i, (corner, along, inwards)) in walls.into_iter().enumerate() {
        room.sheet(Class::Wall, if i == special { accent } else { plain }, corner, along, v);
        let (length, along) = (along.length(), along.normalize());
        let mut face = Face { room, corner, along, inwards, length, height: y };
        if i == windows {
            face.windows(dice);
        } else {
            face.doors_and_pictures(dice);
        }
        if i == special && dice.chance(0.15) {
            face.sconces(dice);
        }
        face.skirting(dice);
    }
    let floor = match dice.below(4) {
        0 => room.gloss(warm(dice, 0.25, 0.55), dice.between(0.1, 0.35)),
        1 => room.textured(planks(dice), Vec2::new(1.6, 1.6), 0.6),
        2 => room.textured(floor_tiles(dice), Vec2::splat(dice.pick(&[1.2, 2.0, 2.4])), 0.5),
        _ => room.paint(warm(dice, 0.08, 0.35), 1.0),
    };
    room.sheet(Class::Floor, floor, w, u, -w);
}

/// A wall as seen from inside.
struct Face<'a> {
    room: &'a mut Room,
    corner: Vec3,
    along: Vec3,
    inwards: Vec3,
    length: f32,
    height: f32,
}

impl Face<'_> {
    /// Adds a flat box on the wall: `low` and `high` are its corners on the wall in metres, and it reaches from `from`
    /// to `to` metres away from the wall.
    fn plate(&mut self, class: Class, material: usize, low: Vec2, high: Vec2, (from, to): (f32, f32)) {
        let at = |p: Vec2, off: f32| self.corner + self.along * p.x + Vec3::Y * p.y + self.inwards * off;
        let (a, b) = (at(low, from), at(high, to));
        self.room.cuboid(class, material, a.min(b), a.max(b));
    }

    /// Adds a row of windows through which daylight shines.
    fn windows(&mut self, dice: &mut Dice) {
        let sky = Vec3::new(0.85, 1.0, 1.22) * dice.log_between(400.0, 5000.0);
        let glass = self.room.shining(sky);
        if dice.chance(0.7) {
            let view = self.room.texture(view(dice));
            self.room.scene.materials[glass].emission_texture = Some(view);
        }
        let frame = self.room.paint(Vec3::splat(dice.pick(&[0.8, 0.6, 0.1])), 1.0);
        let (width, gap) = (dice.between(0.8, 2.2), dice.between(0.2, 1.4));
        let sill = dice.pick(&[0.1, 0.9, 1.1]);
        let top = (self.height - dice.between(0.15, 0.6)).max(sill + 0.8);
        let count = ((self.length - 0.4) / (width + gap)).floor().min(8.0) as usize;
        let first = (self.length - count as f32 * (width + gap) + gap) / 2.0;
        for i in 0..count {
            let left = first + i as f32 * (width + gap);
            let at = self.corner + self.along * left + Vec3::Y * sill + self.inwards * 0.012;
            let pane = Mesh::parallelogram(at, self.along * width, Vec3::Y * (top - sill), glass);
            self.room.add(Class::Window, glass, pane);
            let mut bar = |low: Vec2, high: Vec2| self.plate(Class::Wall, frame, low, high, (0.0, 0.05));
            let (low, high, b) = (Vec2::new(left, sill), Vec2::new(left + width, top), 0.05);
            bar(low - b, Vec2::new(high.x + b, low.y));
            bar(Vec2::new(low.x - b, high.y), high + b);
            bar(Vec2::new(low.x - b, low.y), Vec2::new(low.x, high.y));
            bar(Vec2::new(high.x, low.y), Vec2::new(high.x + b, high.y));
            let middle = left + width / 2.0;
            bar(Vec2::new(middle - b / 2.0, low.y), Vec2::new(middle + b / 2.0, high.y));
        }
    }

    fn doors_and_pictures(&mut self, dice: &mut Dice) {
        let mut left = dice.between(0.2, 1.0);
        while left + 1.2 < self.length && dice.chance(0.8) {
            let colour = any_colour(dice);
            let material = self.room.paint(colour, 1.0);
            if dice.chance(0.3) {
                let high = Vec2::new(left + 0.9, 2.05f32.min(self.height - 0.1));
                self.plate(Class::Wall, material, Vec2::new(left, 0.0), high, (0.0, 0.02));
            } else {
                let size = Vec2::new(dice.between(0.4, 1.6), dice.between(0.4, 1.1));
                let low = Vec2::new(left, dice.between(0.9, 1.3));
                let high = (low + size).min(Vec2::new(self.length - 0.05, self.height - 0.15));
                let material = match dice.below(8) {
                    // The plate may also be a lit screen or sign, or a glossy white board.
                    0 => self.room.shining(any_colour(dice) * dice.between(150.0, 500.0)),
                    1 => self.room.gloss(Vec3::splat(0.82), 0.15),
                    _ => material,
                };
                self.plate(Class::Wall, material, low, high, (0.0, 0.03));
            }
            left += dice.between(1.4, 4.0);
        }
    }

    /// Adds a row of lamps on the wall.
    fn sconces(&mut self, dice: &mut Dice) {
        let lamp = self.room.shining(Vec3::new(1.25, 0.95, 0.65) * dice.between(800.0, 3000.0));
        let (step, level) = (dice.between(1.6, 3.0), dice.between(1.6, 2.0));
        let mut left = step / 2.0;
        while left + 0.3 < self.length {
            let low = Vec2::new(left, level.min(self.height - 0.6));
            self.plate(Class::Wall, lamp, low, low + Vec2::new(0.14, 0.25), (0.02, 0.1));
            left += step;
        }
    }

    fn skirting(&mut self, dice: &mut Dice) {
        let material = self.room.paint(Vec3::splat(dice.between(0.1, 0.7)), 1.0);
        let high = Vec2::new(self.length, 0.1);
        self.plate(Class::Wall, material, Vec2::ZERO, high, (0.0, 0.015));
        if dice.chance(0.3) {
            let low = Vec2::new(0.0, self.height - dice.between(0.06, 0.3));
            self.plate(
                Class::Wall,
                material,
                low,
                Vec2::new(self.length, self.height),
                (0.0, dice.between(0.02, 0.25)),
            );
        }
    }
}

/// Adds furniture, columns and hanging objects; their number varies from none to many.
pub fn things(room: &mut Room, dice: &mut Dice) {
    let plenty = dice.pick(&[0.1, 0.5, 0.9, 1.3]);
    let Vec3 { x, y, z } = room.size;
    let count = (plenty * x * z / 4.0).min(60.0) as usize;
    let paints: Vec<usize> = (0..6).map(|_| any_colour(dice)).map(|colour| room.paint(colour, 0.8)).collect();
    let screen = room.shining(Vec3::new(0.8, 1.0, 1.2) * dice.between(80.0, 250.0));
    for _ in 0..count {
        let (material, at) = (dice.pick(&paints), Vec3::new(dice.between(0.0, x), 0.0, dice.between(0.0, z)));
        let mut place = |size: Vec3, lift: f32| {
            let low = (at + Vec3::Y * lift).min(room.size - size).max(Vec3::new(0.0, lift, 0.0));
            room.cuboid(Class::Thing, material, low, low + size);
            low
        };
        match dice.below(6) {
            // A desk with a screen on it.
            0 | 1 => {
                let low = place(Vec3::new(dice.between(1.0, 1.8), 0.04, dice.between(0.6, 0.9)), 0.72);
                place(Vec3::new(0.4, 0.7, 0.5), 0.0);
                if dice.chance(0.5) {
                    let corner = low + Vec3::new(0.2, 0.15, 0.3);
                    let (u, v) = (Vec3::X * 0.5, Vec3::Y * 0.3);
                    let pane = if dice.chance(0.5) {
                        Mesh::parallelogram(corner, u, v, screen)
                    } else {
                        Mesh::parallelogram(corner + u, -u, v, screen)
                    };
                    room.add(Class::Thing, screen, pane);
                }
            }
            // A chair.
            2 => {
                place(Vec3::new(0.45, 0.06, 0.45), 0.44);
                place(Vec3::new(0.45, 0.5, 0.05), 0.5);
            }
            // A shelf or cupboard.
            3 => drop(place(Vec3::new(dice.between(0.6, 1.6), dice.between(0.9, 2.2).min(y - 0.2), 0.4), 0.0)),
            // A partition.
            4 => drop(place(Vec3::new(0.06, dice.between(1.2, 1.8), dice.between(1.0, 2.5)), 0.0)),
            _ => drop(place(Vec3::new(dice.between(0.3, 0.8), dice.between(0.3, 0.9), dice.between(0.3, 0.8)), 0.0)),
        }
    }
    if dice.chance(0.4) {
        rows(room, dice, &paints);
    }
    if dice.chance(0.2) {
        columns(room, dice);
    }
    if dice.chance(0.2) {
        hanging(room, dice);
    }
}

/// Adds desks with chairs in rows, as in classrooms and offices.
fn rows(room: &mut Room, dice: &mut Dice, paints: &[usize]) {
    let (desk, chair) = (dice.pick(paints), dice.pick(paints));
    let period = Vec2::new(dice.between(1.6, 2.4), dice.between(1.3, 2.0));
    let count = ((Vec2::new(room.size.x, room.size.z) - 1.5) / period).as_uvec2();
    for (i, j) in (0..count.y.min(8)).flat_map(|j| (0..count.x.min(6)).map(move |i| (i, j))) {
        let at = Vec3::new(0.9 + period.x * i as f32, 0.0, 0.9 + period.y * j as f32);
        let mut place = |material: usize, low: Vec3, size: Vec3| {
            room.cuboid(Class::Thing, material, at + low, at + low + size);
        };
        place(desk, Vec3::new(0.0, 0.72, 0.0), Vec3::new(1.2, 0.03, 0.6));
        for x in [0.05, 1.1] {
            place(desk, Vec3::new(x, 0.0, 0.05), Vec3::new(0.05, 0.72, 0.5));
        }
        place(chair, Vec3::new(0.4, 0.42, 0.65), Vec3::new(0.42, 0.05, 0.42));
        place(chair, Vec3::new(0.4, 0.45, 1.02), Vec3::new(0.42, 0.42, 0.04));
    }
}

fn columns(room: &mut Room, dice: &mut Dice) {
    let Vec3 { x, y, z } = room.size;
    let colour = warm(dice, 0.2, 0.8);
    let (material, side) = (room.paint(colour, 1.0), dice.between(0.12, 0.5));
    for i in 0..dice.whole(1, 4) {
        let at = Vec3::new(x * dice.pick(&[0.25, 0.5, 0.75]), 0.0, z * (0.2 + 0.2 * i as f32));
        room.cuboid(Class::Thing, material, at, at + Vec3::new(side, y, side));
    }
}

/// Adds a duct, a sign or rails under the ceiling.
fn hanging(room: &mut Room, dice: &mut Dice) {
    let Vec3 { x, y, z } = room.size;
    let material = room.paint(Vec3::splat(dice.pick(&[0.75, 0.5, 0.1])), 0.6);
    let top = y - dice.between(0.05, 0.4);
    match dice.below(3) {
        0 => {
            let (from, side) = (dice.between(0.1, 0.8) * x, dice.between(0.15, 0.5));
            room.cuboid(Class::Hanging, material, Vec3::new(from, top - side, 0.0), Vec3::new(from + side, top, z));
        }
        1 => {
            let at = Vec3::new(dice.between(0.2, 0.6) * x, top - 0.5, dice.between(0.3, 0.7) * z);
            room.cuboid(Class::Hanging, material, at, at + Vec3::new(1.4, 0.35, 0.05));
        }
        _ => {
            for i in 0..dice.whole(1, 3) {
                let at = z * (0.25 + 0.25 * i as f32);
                room.cuboid(Class::Hanging, material, Vec3::new(0.0, top - 0.05, at), Vec3::new(x, top, at + 0.05));
            }
        }
    }
}

/// Adds a lower rim of `width` metres around the ceiling.
pub fn rim(room: &mut Room, dice: &mut Dice, width: f32) {
    if width == 0.0 {
        return;
    }
    let Vec3 { x, y, z } = room.size;
    let material = room.paint(Vec3::splat(dice.between(0.6, 0.85)), 1.0);
    let low = y - dice.between(0.12, 0.35);
    for (from, to) in [
        ([0.0, 0.0], [x, width]),
        ([0.0, z - width], [x, z]),
        ([0.0, width], [width, z - width]),
        ([x - width, width], [x, z - width]),
    ] {
        room.cuboid(Class::Hanging, material, Vec3::new(from[0], low, from[1]), Vec3::new(to[0], y, to[1]));
    }
}

/// Adds other objects in the ceiling: air outlets, loudspeakers, detectors, hatches. They belong to the plane and are
/// no lamps.
pub fn outlets(room: &mut Room, dice: &mut Dice) {
    if dice.chance(0.45) {
        return;
    }
    let grille = room.texture(grille(dice));
    let grey = room.paint(Vec3::splat(0.8), 1.0);
    room.scene.materials[grey].base_color_texture = Some(grille);
    let white = room.paint(Vec3::splat(dice.between(0.6, 0.9)), 1.0);
    let Vec3 { x, y, z } = room.size;
    let kinds =
        [Form::Rectangle(Vec2::splat(0.55)), Form::Rectangle(Vec2::new(0.9, 0.2)), Form::Disc(0.1), Form::Disc(0.06)];
    for _ in 0..(x * z / dice.between(6.0, 16.0)).min(24.0) as usize {
        let kind = dice.below(kinds.len());
        let at = Vec2::new(dice.between(0.5, x - 0.5), dice.between(0.5, z - 0.5));
        let is_free = room.ceiling.fittings.iter().all(|fitting| {
            let reach = fitting.form.outline(0.0).iter().map(|p| p.length()).fold(0.0, f32::max);
            fitting.centre.distance(at) > reach + 0.5
        });
        if is_free {
            let mesh = kinds[kind].mesh(Vec3::new(at.x, y - 0.008, at.y), 0.0);
            room.add(Class::Ceiling, if kind < 2 { grey } else { white }, mesh);
        }
    }
}

/// A texture of an air outlet: slats over a dark box.
fn grille(dice: &mut Dice) -> Image {
    let dark = dice.between(0.1, 0.6);
    Image::from_fn(32, 32, |x, y| [if y % 8 < 3 && x > 2 && x < 29 { dark } else { 1.0 }; 3]).expect("a grille")
}

/// A texture of the view through a window: the sky above a darker skyline.
fn view(dice: &mut Dice) -> Image {
    let (skyline, dark) = (dice.between(0.2, 0.8), dice.between(0.05, 0.5));
    let heights: Vec<f32> = (0..8).map(|_| skyline + 0.12 * dice.normal()).collect();
    Image::from_fn(64, 64, |x, y| {
        // The texture coordinate v rises towards the top of the pane.
        let ground = (y as f32 + 0.5) / 64.0 < heights[x / 8];
        [if ground { dark * (0.7 + 0.3 * ((x / 3 + y / 5) % 2) as f32) } else { 1.0 }; 3]
    })
    .expect("a view")
}

/// A colour near grey, slightly warm, with a brightness between `low` and `high`.
fn warm(dice: &mut Dice, low: f32, high: f32) -> Vec3 {
    Vec3::new(1.0, 1.0 - dice.between(0.0, 0.06), 1.0 - dice.between(0.0, 0.16)) * dice.between(low, high)
}

fn any_colour(dice: &mut Dice) -> Vec3 {
    let value = dice.between(0.05, 0.7);
    let grey = dice.between(0.2, 1.0);
    Vec3::from_array(std::array::from_fn(|_| value * (grey + (1.0 - grey) * dice.between(0.1, 1.0))))
}

fn planks(dice: &mut Dice) -> Image {
    let wood = Vec3::new(0.42, 0.27, 0.15) * dice.between(0.5, 1.3);
    let shades: Vec<f32> = (0..32).map(|_| 1.0 + 0.15 * dice.normal()).collect();
    Image::from_fn(256, 256, |x, y| {
        let row = y / 32;
        let plank = shades[(row * 4 + (x + row * 77) / 64) % 32];
        (wood * if y % 32 == 0 || (x + row * 77) % 128 == 0 { 0.4 } else { plank }).to_array()
    })
    .expect("planks")
}

fn floor_tiles(dice: &mut Dice) -> Image {
    let colours = [warm(dice, 0.2, 0.7), warm(dice, 0.2, 0.7)];
    let chequered = dice.chance(0.4);
    Image::from_fn(256, 256, |x, y| {
        let tile = if chequered { (x / 64 + y / 64) % 2 } else { 0 };
        (colours[tile] * if x % 64 == 0 || y % 64 == 0 { 0.5 } else { 1.0 }).to_array()
    })
    .expect("tiles")
}
