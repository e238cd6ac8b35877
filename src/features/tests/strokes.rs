//! Strokes on a plane of the room improve the layout found from lines alone.

use super::*;
use crate::features::Face;

/// Returns the pixels of a thick line.
fn painted(a: DVec2, b: DVec2, [width, height]: [usize; 2]) -> Vec<u32> {
    let near = |i: &u32| {
        let p = DVec2::new((*i as usize % width) as f64 + 0.5, (*i as usize / width) as f64 + 0.5);
        let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
        p.distance(a.lerp(b, t)) <= 3.0
    };
    (0..(width * height) as u32).filter(near).collect()
}

fn as_strokes(all: &[(Vec<u32>, bool)]) -> Vec<PlaneStroke<'_>> {
    all.iter().map(|(pixels, positive)| PlaneStroke { pixels, positive: *positive }).collect()
}

fn layout_of(camera: &Perspective, segments: &[(Segment, Option<usize>)], all: &[(Vec<u32>, bool)]) -> Layout {
    let strokes = as_strokes(all);
    let room = RoomView { perspective: camera, segments, strokes: &strokes, layout: None };
    search::find(&room, None, SIZE, Monitor::default().job()).unwrap()
}

const SIZE: [usize; 2] = [640, 480];

/// A furnished room with only some of its edges detected, and strokes mostly on its ceiling.
struct Cluttered {
    camera: Perspective,
    sides: [f64; 4],
    segments: Vec<(Segment, Option<usize>)>,
    strokes: Vec<(Vec<u32>, bool)>,
}

/// Random numbers within given bounds.
struct Random(Rng);

impl Random {
    fn within(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.0.next_f64()
    }
}

/// An edge in space: its two ends and the axis to which it is parallel.
type Edge = (DVec3, DVec3, usize);

/// Returns random pieces of the seams between the room's faces.
fn seams(random: &mut Random, [low, high]: [DVec3; 2]) -> Vec<Edge> {
    let mut lines = Vec::new();
    for (axis, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for corner in 0..4 {
            let (mut from, mut to) = (low, high);
            for (across, bit) in [(a, 1), (b, 2)] {
                from[across] = if corner & bit == bit { high[across] } else { low[across] };
                to[across] = from[across];
            }
            let is_behind = axis != 2 && from.z < 0.5;
            if is_behind || random.within(0.0, 1.0) > 0.6 {
                continue;
            }
            let pieces = (0..8).map(|i| (from.lerp(to, f64::from(i) / 8.0), from.lerp(to, f64::from(i + 1) / 8.0)));
            lines.extend(pieces.filter(|_| random.within(0.0, 1.0) < 0.5).map(|(p, q)| (p, q, axis)));
        }
    }
    lines
}

/// Returns random lines on the room's faces, each parallel to a room axis.
fn lines_on_faces(random: &mut Random, [low, high]: [DVec3; 2]) -> Vec<Edge> {
    let mut lines = Vec::new();
    for (across, at) in [(0, low.x), (0, high.x), (1, low.y), (1, high.y), (2, high.z)] {
        for _ in 0..random.within(2.0, 9.0) as usize {
            let axis = (across + 1 + usize::from(random.within(0.0, 1.0) < 0.5)) % 3;
            let mut from = DVec3::ZERO;
            from[across] = at;
            from[3 - across - axis] = random.within(low[3 - across - axis], high[3 - across - axis]);
            let mut to = from;
            from[axis] = random.within(low[axis], high[axis]);
            to[axis] = (from[axis] + random.within(0.1, 0.5) * (high[axis] - low[axis])).min(high[axis]);
            lines.push((from, to, axis));
        }
    }
    lines
}

/// Returns edges of objects that stand on the floor or hang in the room.
fn objects(random: &mut Random, sides: &[f64; 4], [low, high]: [DVec3; 2]) -> Vec<Edge> {
    let mut lines = Vec::new();
    for _ in 0..random.within(2.0, 8.0) as usize {
        let size = DVec3::new(
            random.within(0.08, 0.35),
            random.within(0.1, 0.5) * (sides[2] + sides[3]),
            random.within(0.08, 0.3),
        );
        let level = if random.within(0.0, 1.0) < 0.7 { high.y - size.y } else { random.within(low.y, high.y - size.y) };
        let corner = DVec3::new(random.within(low.x, high.x - size.x), level, random.within(0.35, 1.0 - size.z));
        for (axis, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            for which in (0..4).filter(|_| random.within(0.0, 1.0) > 0.35) {
                let mut from = corner;
                from[a] += if which & 1 == 1 { size[a] } else { 0.0 };
                from[b] += if which & 2 == 2 { size[b] } else { 0.0 };
                let mut to = from;
                to[axis] += size[axis];
                lines.push((from, to, axis));
            }
        }
    }
    lines
}

/// Projects the edges as a photo shows them: broken into pieces, slightly displaced, and one in twenty assigned to a
/// random axis.
fn projected(random: &mut Random, camera: &Perspective, lines: Vec<Edge>) -> Vec<(Segment, Option<usize>)> {
    let seen = |p: DVec3| {
        let c = camera.axes * p;
        let at = camera.principal + c.truncate() * (camera.focal / c.z);
        let is_inside = at.cmpge(DVec2::ZERO).all() && at.x < SIZE[0] as f64 && at.y < SIZE[1] as f64;
        (c.z > 0.03 && is_inside).then_some(at)
    };
    let mut segments = Vec::new();
    for (from, to, axis) in lines {
        for i in 0..3 {
            let ends = [i, i + 1].map(|k| seen(from.lerp(to, f64::from(k) / 3.0)));
            let off = DVec2::new(random.within(-0.8, 0.8), random.within(-0.8, 0.8));
            let axis = if random.within(0.0, 1.0) < 0.05 { random.within(0.0, 3.0) as usize } else { axis };
            if let [Some(a), Some(b)] = ends
                && a.distance(b) > 12.0
            {
                segments.push((Segment { a: a + off, b: b + off }, Some(axis)));
            }
        }
    }
    segments
}

/// Returns two positive strokes on one face of the room, and a negative stroke on each other face that shows enough
/// pixels. Sometimes adds a negative stroke at a random place, as on an object in front of the faces.
fn random_strokes(random: &mut Random, camera: &Perspective, sides: &[f64; 4]) -> Vec<(Vec<u32>, bool)> {
    let mut places: [Vec<DVec2>; Face::COUNT] = Default::default();
    for _ in 0..400 {
        let place = DVec2::new(random.within(5.0, SIZE[0] as f64 - 5.0), random.within(5.0, SIZE[1] as f64 - 5.0));
        places[truth(camera, sides, place.x as usize, place.y as usize).1].push(place);
    }
    let wanted = if random.within(0.0, 1.0) < 0.7 { Face::Ceiling as usize } else { random.within(0.0, 5.0) as usize };
    let largest = (0..Face::COUNT).max_by_key(|&face| places[face].len()).unwrap();
    let plane = if places[wanted].len() >= 12 { wanted } else { largest };
    let mut strokes = Vec::new();
    for (face, places) in places.iter().enumerate().filter(|(_, places)| places.len() >= 12) {
        for pair in places.chunks(2).take(if face == plane { 2 } else { 1 }) {
            strokes.push((painted(pair[0], pair[1], SIZE), face == plane));
        }
    }
    if random.within(0.0, 1.0) < 0.3 {
        let place = DVec2::new(random.within(5.0, 635.0), random.within(5.0, 435.0));
        strokes.push((painted(place, place + DVec2::new(0.0, 40.0), SIZE), false));
    }
    strokes
}

impl Cluttered {
    fn new(seed: u64) -> Self {
        let mut random = Random(Rng::new(77, &[seed]));
        let mut sides = [0.0; 4];
        for (side, (smallest, largest)) in sides.iter_mut().zip([(0.3, 1.0), (0.3, 1.0), (0.15, 0.5), (0.25, 0.6f64)]) {
            *side = random.within(f64::ln(smallest), largest.ln()).exp();
        }
        let mut camera =
            camera(random.within(-0.5, 0.5), random.within(-0.25, 0.25), random.within(-0.03, 0.03), SIZE[0], SIZE[1]);
        camera.focal *= random.within(0.75, 1.25);
        let bounds = [DVec3::new(-sides[0], -sides[2], 0.05), DVec3::new(sides[1], sides[3], 1.0)];
        let mut lines = seams(&mut random, bounds);
        lines.extend(lines_on_faces(&mut random, bounds));
        lines.extend(objects(&mut random, &sides, bounds));
        let segments = projected(&mut random, &camera, lines);
        let strokes = random_strokes(&mut random, &camera, &sides);
        Self { camera, sides, segments, strokes }
    }

    /// Returns the share of the view on the correct face, and the median of |ln(found depth / true depth)| after both
    /// depths have been brought to one scale.
    fn judge(&self, layout: &Layout) -> [f64; 2] {
        let pixels = (4..SIZE[1]).step_by(8).flat_map(|y| (4..SIZE[0]).step_by(8).map(move |x| (x, y)));
        let (mut right, mut logs) = (0, Vec::new());
        for (x, y) in pixels {
            let (z, face) = truth(&self.camera, &self.sides, x, y);
            let (found, other) = truth(&self.camera, &layout.sides, x, y);
            right += usize::from(face == other);
            logs.push((found / z).ln());
        }
        let middle = |logs: &mut Vec<f64>| {
            logs.sort_by(f64::total_cmp);
            logs[logs.len() / 2]
        };
        let scale = middle(&mut logs);
        logs.iter_mut().for_each(|log| *log = (*log - scale).abs());
        [right as f64 / logs.len() as f64, middle(&mut logs)]
    }
}

#[test]
fn strokes_bring_more_of_cluttered_rooms_onto_the_right_face() {
    const ROOMS: u64 = 150;
    let mut means = [[0.0; 2]; 2];
    for room in (0..ROOMS).map(Cluttered::new) {
        for (mean, strokes) in means.iter_mut().zip([&[], &room.strokes[..]]) {
            let judged = room.judge(&layout_of(&room.camera, &room.segments, strokes));
            *mean = std::array::from_fn(|k| mean[k] + judged[k] / ROOMS as f64);
        }
    }
    for (name, [right, off]) in ["lines", "lines and strokes"].iter().zip(means) {
        println!("{name}: {:.1} % on the right face, depth off by {:.1} %", 100.0 * right, 100.0 * off.exp_m1());
    }
    let [lines, both] = means;
    assert!(both[0] > lines[0] + 0.025 && both[0] > 0.85, "{means:?}");
    assert!(both[1] < 0.9 * lines[1], "{means:?}");
}

/// The seam of the ceiling is hidden, and a picture rail lies below it. From lines alone, the ceiling is found at the
/// height of the rail; a stroke between rail and ceiling must correct this.
#[test]
fn a_stroke_above_the_picture_rail_raises_the_ceiling() {
    let camera = camera(0.1, 0.2, 0.0, SIZE[0], SIZE[1]);
    let sides = [0.5, 0.6, 0.4, 0.35];
    let at = |x: f64, y: f64, z: f64| {
        let c = camera.axes * DVec3::new(x, y, z);
        camera.principal + c.truncate() * (camera.focal / c.z)
    };
    let rail = -0.25;
    let mut segments = room_segments(&camera, &sides, SIZE[0], SIZE[1]);
    let is_low = |(s, axis): &(Segment, Option<usize>)| {
        let ray = camera.axes.transpose() * camera.ray(s.midpoint());
        *axis == Some(VERTICAL) || ray.y / ray.z > rail
    };
    segments.retain(is_low);
    segments.extend((0..6).map(|i| {
        let [x, next] = [i, i + 1].map(|k| -0.5 + 1.1 * f64::from(k) / 6.0);
        (Segment { a: at(x, rail, 1.0), b: at(next, rail, 1.0) }, Some(0))
    }));
    let strokes = [
        (painted(at(-0.2, -0.4, 0.8), at(0.3, -0.4, 0.85), SIZE), true),
        (painted(at(-0.3, -0.36, 1.0), at(0.4, -0.36, 1.0), SIZE), false),
        (painted(at(-0.3, 0.1, 1.0), at(0.4, 0.2, 1.0), SIZE), false),
    ];
    let without = layout_of(&camera, &segments, &[]);
    let with = layout_of(&camera, &segments, &strokes);
    println!("{without:?} {with:?}");
    assert!((without.sides[2] / -rail - 1.0).abs() < 0.03, "{without:?}");
    assert!((with.sides[2] / sides[2] - 1.0).abs() < 0.15, "{with:?}");
    // The strokes do not say which face of the room the positive ones mark; the search infers it. If positive and
    // negative strokes are swapped, the positive ones mark the back wall. The ceiling must be found at the same height.
    let turned = strokes.map(|(pixels, positive)| (pixels, !positive));
    assert!((layout_of(&camera, &segments, &turned).sides[2] / sides[2] - 1.0).abs() < 0.15);
}

#[test]
fn a_mirrored_room_is_laid_out_as_the_mirrored_box() {
    let flip = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let width = SIZE[0] as f64;
    let across = |p: DVec2| DVec2::new(width - p.x, p.y);
    for room in (0..12).map(Cluttered::new) {
        let mirrored = Perspective {
            principal: across(room.camera.principal),
            axes: flip * room.camera.axes * flip,
            ..room.camera
        };
        // Reverse the order of the segments and of their end points.
        let segments: Vec<_> =
            (room.segments.iter().rev()).map(|(s, axis)| (Segment { a: across(s.b), b: across(s.a) }, *axis)).collect();
        let moved = |&p: &u32| {
            let (x, y) = (p as usize % SIZE[0], p as usize / SIZE[0]);
            (y * SIZE[0] + SIZE[0] - 1 - x) as u32
        };
        let strokes: Vec<_> =
            room.strokes.iter().map(|(pixels, positive)| (pixels.iter().map(moved).collect(), *positive)).collect();
        let [left, right, top, bottom] = layout_of(&room.camera, &room.segments, &room.strokes).sides;
        let found = layout_of(&mirrored, &segments, &strokes).sides;
        for (a, b) in [right, left, top, bottom].iter().zip(found) {
            assert!((a / b - 1.0).abs() < 1e-9, "{left} {right} {top} {bottom}, {found:?}");
        }
    }
}

#[test]
fn strokes_alone_shape_the_room() {
    let camera = camera(0.0, 0.0, 0.0, SIZE[0], SIZE[1]);
    let line = |y: f64| painted(DVec2::new(250.0, y), DVec2::new(390.0, y), SIZE);
    // Without evidence, the seam between ceiling and back wall lies 0.4 focal lengths above the centre, in row 35. The
    // strokes place it lower.
    let strokes = [(line(20.0), true), (line(140.0), true), (line(160.0), false), (line(300.0), false)];
    let layout = layout_of(&camera, &[], &strokes);
    let face = |y: usize| truth(&camera, &layout.sides, 320, y).1;
    assert_eq!(
        [20, 138, 161, 300].map(face),
        [Face::Ceiling, Face::Ceiling, Face::Back, Face::Back].map(|f| f as usize)
    );
    assert_eq!(layout.trust, 0.0, "no line says how far");
}

#[test]
fn strokes_of_one_kind_outside_the_photo_or_contradictory() {
    let room = Cluttered::new(3);
    let plain = layout_of(&room.camera, &room.segments, &[]);
    let beyond = vec![(SIZE[0] * SIZE[1]) as u32, u32::MAX];
    // Negative strokes, which lie off the plane, are uninformative without a stroke on the plane.
    let others: Vec<_> = room.strokes.iter().filter(|s| !s.1).cloned().collect();
    for silent in [vec![(beyond.clone(), true)], vec![(vec![], true)], others, vec![(beyond, false)]] {
        assert_eq!(layout_of(&room.camera, &room.segments, &silent), plain);
    }
    // Strokes of both kinds on every pixel contradict each other, but still yield a valid box.
    let all: Vec<u32> = (0..(SIZE[0] * SIZE[1]) as u32).collect();
    let layout = layout_of(&room.camera, &room.segments, &[(all.clone(), true), (all, false)]);
    assert!(layout.sides.iter().all(|s| s.is_finite() && *s > 0.0) && (0.0..=1.0).contains(&layout.trust));
}
