use super::lanes::Baseline;
use super::node::Node;
use super::packet::{Packet, TriangleRay};
use super::prepared_ray::PreparedRay;
use super::traverse::is_better;
use super::*;
use crate::exec::Pool;
use crate::job::Monitor;
use crate::rng::Rng;
use crate::simd::forced;
use glam::Vec3;
use std::sync::{Arc, Mutex};

fn build(triangles: &[[Vec3; 3]]) -> Accel {
    Accel::build(triangles, Monitor::default().job()).unwrap()
}

fn random_vec(rng: &mut Rng) -> Vec3 {
    Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0
}

/// The six walls of a box, each divided into `n * n` squares of two triangles.
fn tessellated_box(n: usize, low: Vec3, high: Vec3) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let at = |i: usize, j: usize| {
                let mut p = Vec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = i as f32 / n as f32;
                p[(axis + 2) % 3] = j as f32 / n as f32;
                low + (high - low) * p
            };
            for i in 0..n {
                for j in 0..n {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    triangles
}

fn brute_force(triangles: &[[Vec3; 3]], ray: &Ray) -> Option<Hit> {
    let triangle_ray = TriangleRay::new(&PreparedRay::new(ray).unwrap());
    let mut best: Option<Hit> = None;
    for id in 0..triangles.len() as u32 {
        let packet = Packet::new(triangles, &[id]);
        let (mask, hits) = packet.intersect::<Baseline>(&triangle_ray, ray.t_max);
        if mask & 1 != 0 {
            let hit = hits.store().lane(0, &packet);
            if is_better(&hit, best.as_ref(), ray.t_max) {
                best = Some(hit);
            }
        }
    }
    best
}

#[test]
fn hits_are_those_of_testing_every_triangle_on_every_kind_of_vector_unit() {
    let mut rng = Rng::new(1, &[]);
    for (scale, offset) in [(1.0, 0.0), (1e-4, 0.0), (1e6, 0.0), (1.0, 1e3), (1e-4, 1.0)] {
        let mut triangles = tessellated_box(4, Vec3::splat(-1.0), Vec3::ONE);
        for _ in 0..200 {
            let centre = random_vec(&mut rng);
            let size = 0.3 * rng.next_f32() * rng.next_f32();
            triangles.push(std::array::from_fn(|_| centre + random_vec(&mut rng) * size));
        }
        triangles.iter_mut().flatten().for_each(|p| *p = *p * scale + Vec3::splat(offset));
        let mut accel = build(&triangles);
        for i in 0..3000 {
            let mut origin = random_vec(&mut rng) * 1.5;
            let mut direction = random_vec(&mut rng);
            if i % 3 == 0 {
                // Rays along an axis from grid points pass through edges and vertices and lie in the planes of
                // triangles.
                origin = (origin * 4.0).round() / 4.0;
                direction = Vec3::AXES[i % 9 / 3] * if i % 2 == 0 { 1.0 } else { -1.0 };
            }
            let ray = Ray::new(origin * scale + Vec3::splat(offset), direction);
            let expected = brute_force(&triangles, &ray);
            for level in forced::levels() {
                accel.level = level;
                assert_eq!(accel.closest(&ray, |_| true), expected, "scale {scale}, offset {offset}, ray {i}");
                assert_eq!(accel.occluded(&ray, |_| true), expected.is_some());
            }
            if let Some(hit) = expected {
                let short = Ray { t_max: hit.t, ..ray };
                assert!(accel.closest(&short, |_| true).is_none(), "hits lie before t_max");
            }
        }
    }
}

#[test]
fn no_ray_escapes_a_closed_box_through_its_edges_and_vertices() {
    let mut rng = Rng::new(2, &[]);
    let mut escaped = 0;
    // At 1e6 from the origin, neighbouring `f32` values differ by 0.0625. In the last case but one, the side of a
    // square is more than 20 such steps. In the last case it is less than one step: squares collapse to lines and are
    // dropped.
    for (scale, offset) in [
        (1.0, Vec3::ZERO),
        (1e-4, Vec3::ZERO),
        (1e6, Vec3::ZERO),
        (1.0, Vec3::new(900.0, -70.0, 3.0)),
        (20.0, Vec3::splat(1e6)),
        (0.5, Vec3::splat(1e6)),
    ] {
        let n = 24;
        let triangles = tessellated_box(n, offset - Vec3::ONE * scale, offset + Vec3::new(1.0, 0.7, 1.3) * scale);
        let accel = build(&triangles);
        for _ in 0..100_000 {
            let [a, b, c] = triangles[rng.below(triangles.len())];
            // A vertex, a point on an edge, or a point on the diagonal that two triangles share.
            let target = match rng.below(3) {
                0 => a,
                1 => a.lerp(b, rng.next_f32()),
                _ => a.lerp(c, rng.next_f32()),
            };
            let origin = offset + random_vec(&mut rng) * 0.6 * scale;
            let ray = Ray::new(origin, target - origin);
            escaped += usize::from(accel.closest(&ray, |_| true).is_none());
        }
    }
    assert_eq!(escaped, 0);
}

#[test]
fn coincident_triangles_give_the_lowest_index_and_refused_hits_are_passed_over() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let accel = build(&[triangle; 37]);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    assert_eq!(accel.closest(&ray, |_| true).unwrap().triangle, 0);
    assert_eq!(accel.closest(&ray, |hit| hit.triangle >= 20).unwrap().triangle, 20);
    assert!(accel.closest(&ray, |_| false).is_none());
    assert!(accel.occluded(&ray, |hit| hit.triangle == 36));
    let hit = accel.closest(&ray, |_| true).unwrap();
    assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.25, 0.25));
}

#[test]
fn empty_scenes_needles_and_invalid_triangles_are_handled() {
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert!(build(&[]).closest(&ray, |_| true).is_none());
    let nan = [Vec3::NAN, Vec3::X, Vec3::Y];
    let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let needle = [Vec3::Z, Vec3::new(1e-30, 0.0, 1.0), Vec3::new(0.0, 1e-30, 1.0)];
    let accel = build(&[nan, line, [Vec3::ONE; 3], needle]);
    assert_eq!(accel.dropped(), 3);
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::X] {
        assert!(accel.closest(&Ray::new(Vec3::ZERO, direction), |_| true).is_none());
    }
    assert!(accel.closest(&Ray::new(Vec3::NAN, Vec3::Z), |_| true).is_none());
}

#[test]
fn a_long_chain_of_nested_triangles_needs_no_deep_stack() {
    // The sizes run from 1e-12 to 1e12. Three quarters of the triangles lie in one cell of the Morton grid, so their
    // codes do not separate them.
    let triangles: Vec<[Vec3; 3]> = (0..2000)
        .map(|i| {
            let size = 10f32.powf(-12.0 + i as f32 * 0.012);
            [Vec3::new(-size, -size, size), Vec3::new(size, -size, size), Vec3::new(0.0, size, size)]
        })
        .collect();
    let accel = build(&triangles);
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert_eq!(accel.closest(&ray, |_| true), brute_force(&triangles, &ray));
    assert_eq!(accel.closest(&ray, |_| true).unwrap().triangle, 0);
}

/// A room of twelve large triangles with a finely divided block in it. The tree is large enough to be collapsed in
/// parallel parts, whose boxes differ much in size.
fn room_with_block() -> Vec<[Vec3; 3]> {
    let mut triangles = tessellated_box(1, Vec3::splat(-3.0), Vec3::splat(3.0));
    triangles.extend(tessellated_box(34, Vec3::new(-0.5, -3.0, 0.2), Vec3::new(0.7, 0.4, 1.1)));
    triangles
}

#[test]
fn every_triangle_lies_in_one_packet_inside_all_boxes_above_it() {
    let triangles = room_with_block();
    let mut accel = build(&triangles);
    let mut seen = vec![0; triangles.len()];
    let mut open = vec![(accel.root, accel.low, accel.high)];
    while let Some((child, low, high)) = open.pop() {
        if child.is_packet() {
            let packet = accel.lines.get_mut::<Packet>(child.line());
            for id in (0..8).map(|lane| packet.id(lane)).filter(|&id| id != u32::MAX) {
                seen[id as usize] += 1;
                assert!(triangles[id as usize].iter().all(|p| p.cmpge(low).all() && p.cmple(high).all()));
            }
        } else {
            let node = accel.lines.get_mut::<Node>(child.line());
            for lane in (0..8).filter(|&lane| !node.child(lane).is_empty()) {
                let corner = |side: usize| Vec3::from_array([0, 2, 4].map(|axis| node.bounds[axis + side].0[lane]));
                assert!(corner(0).cmpge(low).all() && corner(1).cmple(high).all());
                open.push((node.child(lane), corner(0), corner(1)));
            }
        }
    }
    assert!(seen.iter().all(|&count| count == 1));
}

#[test]
fn a_scene_built_in_parts_gives_the_hits_of_testing_every_triangle() {
    let triangles = room_with_block();
    let accel = build(&triangles);
    let mut rng = Rng::new(5, &[]);
    for _ in 0..150 {
        let ray = Ray::new(random_vec(&mut rng) * 2.9, random_vec(&mut rng));
        assert_eq!(accel.closest(&ray, |_| true), brute_force(&triangles, &ray));
    }
}

#[test]
fn a_part_gives_the_hits_of_the_whole_within_its_box() {
    let mut triangles = room_with_block();
    // Add coincident triangles, of which the lowest index is hit, and degenerate ones.
    triangles.extend_from_within(100..400);
    triangles.insert(50, [Vec3::ONE; 3]);
    let whole = build(&triangles);
    let (low, high) = (Vec3::new(-0.6, -3.0, 0.0), Vec3::new(0.2, 0.5, 0.9));
    let job = Monitor::default();
    let (margin, all) = (Vec3::splat(1e-4), triangles.len());
    let part = whole.part([low - margin, high + margin], all, job.job()).unwrap().unwrap();
    let mut rng = Rng::new(6, &[]);
    let within = |rng: &mut Rng| low + (high - low) * (random_vec(rng) * 0.5 + 0.5);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..2000 {
        let (from, to) = (within(&mut rng), within(&mut rng));
        let segment = Ray { origin: from, direction: to - from, t_max: 1.0 };
        assert_eq!(part.closest(&segment, |_| true), whole.closest(&segment, |_| true));
        assert_eq!(part.occluded(&segment, |_| true), whole.occluded(&segment, |_| true));
        // The ray has no end. If `part` gives a hit inside the box (t < 1), it is also the nearest hit of the whole
        // structure.
        let ray = Ray::new(from, to - from);
        match part.closest(&ray, |_| true).filter(|hit| hit.t < 1.0) {
            Some(hit) => hits += usize::from(whole.closest(&ray, |_| true) == Some(hit)),
            None => misses += 1,
        }
    }
    assert!(hits + misses == 2000 && hits > 200 && misses > 200, "{hits} {misses}");
    let bytes = |accel: &Accel| accel.bytes() as f64;
    assert!(bytes(&part) < 0.7 * bytes(&whole), "{} {}", bytes(&part), bytes(&whole));
    assert!(whole.part([low, high], 10, job.job()).unwrap().is_none());
    assert!(whole.part([Vec3::splat(9.0), Vec3::splat(10.0)], all, job.job()).unwrap().is_none());
    assert!(build(&[]).part([low, high], all, job.job()).unwrap().is_none());
}

#[test]
fn the_structure_is_the_same_to_the_bit_on_any_number_of_threads() {
    let triangles = room_with_block();
    let [a, b] = [1, 3].map(|threads| Pool::new(threads).unwrap().run(|| build(&triangles)));
    assert_eq!((a.root, a.stack_need), (b.root, b.stack_need));
    // Compare the lines as integers: unused lanes hold NaN, which would compare unequal.
    assert!(a.lines.as_slice() == b.lines.as_slice());
}

#[test]
fn ten_thousand_copies_of_one_triangle_are_each_met_once() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mut accel = build(&[triangle; 10_000]);
    let ray = Ray::new(Vec3::new(0.2, 0.3, 1.0), Vec3::NEG_Z);
    for level in forced::levels() {
        accel.level = level;
        let mut met = vec![0; 10_000];
        let refuse = |hit: &Hit| {
            met[hit.triangle as usize] += 1;
            false
        };
        assert!(!accel.occluded(&ray, refuse));
        assert!(met.iter().all(|&count| count == 1));
        assert_eq!(accel.closest(&ray, |_| true).unwrap().triangle, 0);
        assert_eq!(accel.closest(&ray, |hit| hit.triangle >= 9_999).unwrap().triangle, 9_999);
    }
}

#[test]
fn few_triangles_among_broken_ones_are_found_at_every_scale() {
    for scale in [1e-4, 1.0, 1e6, 1e15] {
        for count in [1, 5] {
            let square = |i: usize| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| (p + Vec3::new(0.0, 0.0, i as f32)) * scale);
            let mut triangles: Vec<[Vec3; 3]> = (0..count).map(square).collect();
            // Add degenerate triangles: one with a NaN corner, one that is a point, and one that is a line.
            triangles.insert(1, [Vec3::NAN, Vec3::X, Vec3::Y]);
            triangles.insert(0, [Vec3::X * scale; 3]);
            triangles.push([Vec3::ZERO, Vec3::X * scale, Vec3::X * 2.0 * scale]);
            let accel = build(&triangles);
            assert_eq!(accel.dropped(), 3);
            let from_above = Ray::new(Vec3::new(0.25, 0.25, 9.0) * scale, Vec3::NEG_Z);
            assert_eq!(accel.closest(&from_above, |_| true), brute_force(&triangles, &from_above));
            assert!(accel.closest(&from_above, |_| true).is_some());
            assert!(accel.occluded(&from_above, |_| true));
            assert!(!accel.occluded(&Ray { t_max: 0.5 * scale, ..from_above }, |_| true));
        }
    }
}

#[test]
fn rays_of_any_bit_patterns_are_handled() {
    let extremes = [0.0, -0.0, 1.0, -0.3, 1e-45, -1e-38, 1e-30, 1e-18, 1e15, -1e30, 3.4e38, f32::INFINITY, f32::NAN];
    let mut accel = build(&room_with_block());
    let mut rng = Rng::new(6, &[]);
    for _ in 0..20_000 {
        let mut number = || extremes[rng.below(extremes.len())];
        let [origin, direction] = [0; 2].map(|_| Vec3::from([0; 3].map(|_| number())));
        let ray = Ray { t_max: number(), ..Ray::new(origin, direction) };
        for level in forced::levels() {
            accel.level = level;
            if let Some(hit) = accel.closest(&ray, |_| true) {
                assert!(hit.t > 0.0 && hit.t < ray.t_max, "{ray:?}: {hit:?}");
            }
            accel.occluded(&ray, |_| true);
        }
    }
}

#[test]
fn many_small_triangles_in_a_huge_scene_take_no_longer_than_elsewhere() {
    let mut rng = Rng::new(7, &[]);
    let place = Vec3::new(1e6, -2e6, 3e6);
    let mut triangles = vec![[Vec3::ZERO, Vec3::X * 1e15, Vec3::Y * 1e15]];
    triangles.extend((0..30_000).map(|_| [0; 3].map(|_| place + random_vec(&mut rng))));
    let start = std::time::Instant::now();
    let accel = build(&triangles);
    // An algorithm of quadratic time would take minutes.
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    let ray = Ray::new(place + Vec3::Z * 9.0, Vec3::NEG_Z);
    assert_eq!(accel.closest(&ray, |_| true), brute_force(&triangles, &ray));
}

/// Builds the acceleration structure over three million triangles in a room, once without and once with a distant
/// triangle. The distant triangle makes the cells of the Morton grid so large (0.1 m) that hundreds of triangles share
/// a cell and thus a code.
#[cfg(target_os = "linux")]
#[test]
fn a_cancel_is_answered_within_50_ms_while_three_million_triangles_are_built() {
    /// CPU time of this thread in nanoseconds, accurate to a few milliseconds. Other load on the machine does not
    /// count.
    fn now() -> u64 {
        let schedstat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
        schedstat.split_whitespace().next().unwrap().parse().unwrap()
    }
    #[derive(Default)]
    struct Silence {
        since: Option<u64>,
        longest: u64,
    }
    for far in [None, Some(1e5)] {
        let mut triangles = tessellated_box(500, Vec3::ZERO, Vec3::new(4.0, 3.0, 5.0));
        triangles.extend(far.map(|at| [Vec3::X, Vec3::Y, Vec3::Z].map(|p| (Vec3::ONE + p) * at)));
        let silence = Arc::new(Mutex::new(Silence::default()));
        let shared = silence.clone();
        let at_check = move || {
            let mut silence = shared.lock().unwrap();
            let now = now();
            silence.longest = silence.longest.max(now - silence.since.unwrap_or(now));
            silence.since = Some(now);
        };
        let mut monitor = Monitor::default();
        monitor.at_check = Some(Box::new(at_check));
        // Run on a single thread: it does all the work, so its intervals between checks are the longest possible.
        Pool::new(1).unwrap().run(|| Accel::build(&triangles, monitor.job())).unwrap();
        let longest = silence.lock().unwrap().longest as f64 * 1e-6;
        assert!(longest > 0.0 && longest < 50.0, "{longest} ms");
    }
}
