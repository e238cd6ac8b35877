//! Designs of ceilings for generated rooms: which lamps a ceiling has, and where.

use super::dice::Dice;
use super::forms::Form;
use glam::Vec2;

/// One lamp of a ceiling.
#[derive(Clone, Debug)]
pub struct Fitting {
    pub form: Form,
    /// Centre in metres along x and z of the room.
    pub centre: Vec2,
    /// Number of the lamp's kind.
    pub kind: usize,
    /// Distance in metres from the ceiling down to the face that shines.
    pub drop: f32,
    pub is_lit: bool,
}

/// The lamps of a ceiling, with the parameters of their pattern.
#[derive(Clone, Debug)]
pub struct Ceiling {
    pub pattern: &'static str,
    pub fittings: Vec<Fitting>,
    /// Area in m² of a cell of the pattern and number of lamps in it; `None` if the pattern has no cells.
    pub cell: Option<(f32, usize)>,
    /// Beams that hang from the ceiling: z of the beams along x, and x of the beams along z; then the width and depth
    /// of a beam. All in metres.
    pub beams: Option<([Vec<f32>; 2], Vec2)>,
    /// Whether the lamps are panes of glass through which the sky shines.
    pub is_skylight: bool,
    /// Whether lamps shine unevenly, because of tubes behind the cover or a louvre.
    pub has_inside: bool,
}

/// The designs of ceilings, each with its relative frequency.
type Design = fn(&mut Dice, Vec2) -> Ceiling;
const DESIGNS: [(Design, f32); 11] = [
    (troffers, 22.0),
    (battens, 12.0),
    (slots, 10.0),
    (downlights, 14.0),
    (mixed, 8.0),
    (rings, 6.0),
    (hexagons, 3.0),
    (skylight, 7.0),
    (coffers, 6.0),
    (clusters, 6.0),
    (scattered, 6.0),
];

/// Makes a ceiling of `size` metres. `design` draws the design, `dice` all else, so that both are independent; some
/// lamps may be missing or switched off.
pub fn ceiling(design: &mut Dice, dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut ceiling = design.weighted(&DESIGNS)(dice, size);
    let is_pattern = ceiling.fittings.len() >= 8;
    if is_pattern && dice.chance(0.15) {
        let share = dice.between(0.05, 0.2);
        ceiling.fittings.retain(|_| !dice.chance(share));
    }
    if is_pattern && dice.chance(0.1) {
        let share = dice.between(0.04, 0.15);
        ceiling.fittings.iter_mut().for_each(|fitting| fitting.is_lit = !dice.chance(share));
    }
    ceiling
}

impl Ceiling {
    fn new(pattern: &'static str) -> Self {
        Self { pattern, fittings: Vec::new(), cell: None, beams: None, is_skylight: false, has_inside: false }
    }

    fn add(&mut self, form: &Form, centre: Vec2, kind: usize, drop: f32) {
        self.fittings.push(Fitting { form: form.clone(), centre, kind, drop, is_lit: true });
    }
}

/// Positions of a lattice that is centred on a ceiling; each position has room for a lamp of size `extent`.
fn lattice(size: Vec2, period: Vec2, extent: Vec2, shifted_rows: bool) -> Vec<Vec2> {
    let margin = (extent / 2.0 + 0.12).min(size / 2.0);
    let count = (((size - 2.0 * margin) / period).floor() + 1.0).max(Vec2::ONE).as_uvec2();
    let first = (size - (count.as_vec2() - 1.0) * period) / 2.0;
    let fits = |p: &Vec2| p.cmpge(margin - 1e-3).all() && p.cmple(size - margin + 1e-3).all();
    let at = |i: u32, j: u32| {
        let shift = if shifted_rows && j % 2 == 1 { 0.5 * period.x } else { 0.0 };
        first + period * Vec2::new(i as f32, j as f32) + Vec2::new(shift, 0.0)
    };
    (0..count.y).flat_map(|j| (0..count.x).map(move |i| (i, j))).map(|(i, j)| at(i, j)).filter(fits).collect()
}

/// Rectangular panels that replace tiles of a suspended ceiling.
fn troffers(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling { has_inside: dice.chance(0.5), ..Ceiling::new("troffers") };
    let panel = dice.pick(&[Vec2::new(0.6, 0.6), Vec2::new(1.2, 0.6), Vec2::new(0.6, 1.2), Vec2::new(1.2, 0.3)]) * 0.97;
    let period = panel + Vec2::new(dice.pick(&[0.6, 1.2, 1.2, 1.8, 2.4]), dice.pick(&[0.6, 1.2, 1.2, 1.8, 2.4]));
    let shifted = dice.chance(0.12);
    for place in lattice(size, period, panel, shifted) {
        out.add(&Form::Rectangle(panel), place, 0, 0.004);
    }
    out.cell = Some((period.element_product(), 1));
    out
}

/// Tubes in housings under the ceiling, or bars that hang lower.
fn battens(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("battens");
    let batten = Vec2::new(dice.pick(&[1.2, 1.2, 1.5, 1.8]), dice.log_between(0.06, 0.2));
    let period = Vec2::new(batten.x + dice.pick(&[0.3, 0.6, 1.2]), dice.between(1.2, 2.8));
    let drop = if dice.chance(0.2) { dice.between(0.15, 0.5) } else { dice.between(0.04, 0.09) };
    let turned = dice.chance(0.5);
    let swap = |v: Vec2| if turned { Vec2::new(v.y, v.x) } else { v };
    for place in lattice(size, swap(period), swap(batten), false) {
        out.add(&Form::Rectangle(swap(batten)), place, 0, drop);
    }
    out.cell = Some((period.element_product(), 1));
    out
}

/// Lines of light that run from wall to wall.
fn slots(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("slots");
    let turned = dice.chance(0.6);
    let swap = |v: Vec2| if turned { Vec2::new(v.y, v.x) } else { v };
    let (length, spacing) = (swap(size).x - 2.0 * dice.between(0.2, 0.8), dice.between(1.0, 2.6));
    let width = dice.log_between(0.06, 0.22);
    // Some of the lines consist of two or three pieces.
    let pieces = if dice.chance(0.3) { dice.whole(2, 3) } else { 1 };
    let gap = if pieces > 1 { dice.between(0.25, 0.7) } else { 0.0 };
    let piece = Vec2::new((length - gap * (pieces as f32 - 1.0)) / pieces as f32, width);
    let drop = if dice.chance(0.25) { dice.between(0.1, 0.4) } else { 0.004 };
    for line in lattice(swap(size), Vec2::new(swap(size).x, spacing), Vec2::new(0.0, width), false) {
        for i in 0..pieces {
            let along = (i as f32 - (pieces as f32 - 1.0) / 2.0) * (piece.x + gap);
            out.add(&Form::Rectangle(swap(piece)), swap(line + Vec2::new(along, 0.0)), 0, drop);
        }
    }
    out.cell = Some((spacing * (piece.x + gap), 1));
    out
}

fn downlights(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("downlights");
    let form = Form::Disc(dice.log_between(0.045, 0.15));
    let across = dice.between(0.7, 1.8);
    let period = Vec2::new(across, if dice.chance(0.6) { across } else { dice.between(0.7, 1.8) });
    let shifted = dice.chance(0.2);
    for place in lattice(size, period, Vec2::splat(0.4), shifted) {
        out.add(&form, place, 0, 0.006);
    }
    out.cell = Some((period.element_product(), 1));
    out
}

/// Rectangular panels with small round lamps between them.
fn mixed(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling { pattern: "mixed", ..troffers(dice, size) };
    out.fittings.clear();
    let panel = dice.pick(&[Vec2::new(0.6, 0.6), Vec2::new(1.2, 0.6), Vec2::new(0.6, 1.2)]) * 0.97;
    let period = panel + Vec2::new(dice.between(1.2, 2.0), dice.between(1.2, 2.0));
    let small = Form::Disc(dice.log_between(0.06, 0.12));
    for place in lattice(size, period, panel, false) {
        out.add(&Form::Rectangle(panel), place, 0, 0.004);
        let between = place + period / 2.0;
        if between.cmplt(size - 0.2).all() {
            out.add(&small, between, 1, 0.006);
        }
    }
    out.cell = Some((period.element_product(), 2));
    out
}

fn rings(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("rings");
    let outer = dice.between(0.25, 0.6);
    let form = Form::Ring { outer, inner: outer * dice.between(0.6, 0.88) };
    let period = Vec2::splat(2.0 * outer) + Vec2::new(dice.between(0.6, 1.6), dice.between(0.6, 1.6));
    let drop = if dice.chance(0.4) { dice.between(0.1, 0.4) } else { 0.01 };
    for place in lattice(size, period, Vec2::splat(2.0 * outer), false) {
        out.add(&form, place, 0, drop);
    }
    out.cell = Some((period.element_product(), 1));
    out
}

fn hexagons(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("hexagons");
    let radius = dice.between(0.25, 0.5);
    let across = 2.0 * radius + dice.between(0.4, 1.2);
    let period = Vec2::new(across, across * 0.866);
    for place in lattice(size, period, Vec2::splat(2.0 * radius), true) {
        out.add(&Form::Hexagon(radius), place, 0, 0.01);
    }
    out.cell = Some((period.element_product(), 1));
    out
}

/// Glass panes between bars; in some skylights a diagonal bar halves each pane.
fn skylight(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling { is_skylight: true, ..Ceiling::new("skylight") };
    let pane = Vec2::new(dice.between(0.5, 1.3), dice.between(0.5, 1.3));
    let bar = dice.log_between(0.04, 0.14);
    let is_halved = dice.chance(0.25);
    let period = pane + bar;
    let border = if dice.chance(0.4) { 0.1 } else { dice.between(0.5, 0.25 * size.min_element()) };
    let (low, inner) = (Vec2::splat(border), size - 2.0 * border);
    for place in lattice(inner, period, pane - 0.2, false) {
        if !is_halved {
            out.add(&Form::Rectangle(pane), low + place, 0, 0.004);
            continue;
        }
        let (h, cut) = (pane / 2.0, bar / pane.length() * Vec2::new(pane.x, pane.y));
        let near = vec![Vec2::new(-h.x, -h.y), Vec2::new(h.x - cut.x, -h.y), Vec2::new(-h.x, h.y - cut.y)];
        let far = near.iter().map(|p| -*p).collect();
        out.add(&Form::Pane(near), low + place, 0, 0.004);
        out.add(&Form::Pane(far), low + place, 0, 0.004);
    }
    out.cell = Some((period.element_product(), 1 + usize::from(is_halved)));
    out
}

/// Beams that divide the ceiling into fields, with a lamp in each field.
fn coffers(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("coffers");
    let period = Vec2::new(dice.between(1.4, 2.4), dice.between(1.4, 2.4));
    let beam = Vec2::new(dice.between(0.12, 0.25), dice.between(0.08, 0.28));
    let form = match dice.below(3) {
        0 => Form::Disc(dice.between(0.12, 0.3)),
        1 => Form::Rectangle(Vec2::splat(dice.between(0.45, 0.8))),
        _ => Form::Rectangle(Vec2::new(dice.between(0.6, 1.0), dice.between(0.2, 0.4))),
    };
    let places = lattice(size, period, period - 0.3, false);
    places.iter().for_each(|place| out.add(&form, *place, 0, 0.006));
    let lines = |axis: usize| {
        let mut at: Vec<f32> =
            places.iter().flat_map(|p| [p[axis] - period[axis] / 2.0, p[axis] + period[axis] / 2.0]).collect();
        at.sort_by(f32::total_cmp);
        at.dedup_by(|a, b| (*a - *b).abs() < 1e-2);
        at
    };
    out.beams = Some(([lines(1), lines(0)], beam));
    out.cell = Some((period.element_product(), 1));
    out
}

/// A lattice of groups of small lamps.
fn clusters(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("clusters");
    let (radius, apart) = (dice.log_between(0.04, 0.08), dice.between(0.18, 0.36));
    let group: &[[f32; 2]] = dice.pick(&[
        &[[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]][..],
        &[[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]],
        &[[-1.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [0.0, 1.0]],
    ]);
    let period = Vec2::new(dice.between(1.3, 2.4), dice.between(1.3, 2.4));
    for place in lattice(size, period, Vec2::splat(2.0 * apart), false) {
        group.iter().for_each(|p| out.add(&Form::Disc(radius), place + Vec2::from(*p) * apart, 0, 0.006));
    }
    out.cell = Some((period.element_product(), group.len()));
    out
}

/// Small lamps at random positions, with a minimum distance between lamps.
fn scattered(dice: &mut Dice, size: Vec2) -> Ceiling {
    let mut out = Ceiling::new("scattered");
    let (radius, apart) = (dice.log_between(0.045, 0.12), dice.between(0.6, 1.1));
    for _ in 0..(8.0 * size.element_product() / (apart * apart)) as usize {
        let place = Vec2::new(dice.between(0.3, size.x - 0.3), dice.between(0.3, size.y - 0.3));
        if out.fittings.iter().all(|fitting| fitting.centre.distance(place) > apart) && out.fittings.len() < 160 {
            out.add(&Form::Disc(radius), place, 0, 0.006);
        }
    }
    out
}
