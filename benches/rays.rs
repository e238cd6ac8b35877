//! Benchmark of ray tracing against Embree 3: rays per second and build time, in one process, in turns.
//!
//! Each scene has three kinds of rays: camera rays (coherent); rays after the first hit of a path, cosine-distributed
//! over the surfaces (incoherent); and shadow rays between surfaces and lights or other surfaces (any hit). All rays
//! are traced on one thread. The headline ratio is against Embree with default settings, whose triangle test is not
//! watertight. The ratio against Embree's robust mode, which corresponds to this library, is printed beside it.

mod harness;

use glam::{Vec3, Vec3A};
use harness::embree::{self, Embree};
use harness::scenes::{self, Setting};
use harness::{Clock, Table, absent, figure, interleaved, peak_memory, time};
use luxfer::accel::{Accel, Ray};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::World;
use luxfer::rng::{self, Rng};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle;
use std::hint::black_box;
use std::sync::Arc;

/// Number of rays of each kind.
const RAYS: usize = 100_000;
const ROUNDS: usize = 9;

/// Argument that makes the process only load a scene of ten million triangles and print its peak memory.
const LOAD_10M: &str = "--load-10m";

fn main() {
    let pool = Pool::new(2).expect("two threads");
    if std::env::args().any(|arg| arg == LOAD_10M) {
        return load_10m(&pool);
    }
    // Names on the command line select scenes: `cargo bench --bench rays -- demo kitchen`.
    let chosen: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with("--")).collect();
    let all = chosen.is_empty();
    // Run on a thread of the pool, as the library builds its structures: handing work over to the pool would take as
    // long as building a structure for 38 triangles.
    pool.run(|| compare(|name| all || chosen.iter().any(|c| c == name)));
    if all {
        ties(&pool);
        peak_of_10m();
    }
}

/// Measures all chosen scenes against Embree.
fn compare(is_chosen: impl Fn(&str) -> bool) {
    let engines = Embree::open(2);
    if let Err(reason) = &engines {
        println!("# no Embree: {reason}");
    }
    let mut table = Table::new(["scene", "rays", "Mray/s", "Embree", "ratio", "quartiles", "ratio to robust"]);
    let mut built =
        Table::new(["scene", "triangles", "seconds", "Embree", "ratio", "bytes/triangle", "Embree", "dropped"]);
    let settings = [
        ("planes8k", Ok(scenes::planes("planes8k", 8_000))),
        ("planes128k", Ok(scenes::planes("planes128k", 128_000))),
        ("planes3m", Ok(scenes::planes("planes3m", 3_200_000))),
        ("demo", scenes::demo_room()),
        ("office", scenes::demo_office()),
        ("cornell", scenes::cornell()),
        ("kitchen", scenes::kitchen()),
        ("apartment", scenes::apartment()),
        ("sponza", scenes::sponza()),
    ];
    for (name, setting) in settings.into_iter().filter(|(name, _)| is_chosen(name)) {
        match setting {
            Ok(setting) => measure(&setting, engines.as_ref(), &mut table, &mut built),
            Err(reason) => {
                for kind in ["closest", "any"] {
                    if is_headline(kind, name) {
                        absent(&format!("rays.{kind}.{name}.vs_embree"), &reason);
                    }
                }
            }
        }
    }
    table.print("Rays per second on one thread; ratios are ours over Embree's");
    built.print("Building on two threads; ratios are our time over Embree's");
}

/// Measures the peak memory of preparing a scene of ten million triangles for rendering, in a separate process.
fn peak_of_10m() {
    const NAME: &str = "peak.scene_10m_tris.mb";
    let run = || {
        let output = std::process::Command::new(std::env::current_exe()?).arg(LOAD_10M).output()?;
        Ok::<_, std::io::Error>(String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    match run().map(|text| text.parse::<f64>()) {
        Ok(Ok(mebibytes)) => figure(NAME, mebibytes, "MB"),
        other => absent(NAME, &format!("the process that loads it gave {other:?}")),
    }
}

fn load_10m(pool: &Pool) {
    let scene = Arc::new(scenes::planes("planes10m", 10_000_000).scene);
    let world = pool.run(|| World::build(scene, Monitor::default().job())).expect("a scene to trace");
    black_box(&world);
    println!("{:.0}", peak_memory().map_or(f64::NAN, |bytes| bytes as f64 / 1e6));
}

/// Measures the hardest case for binary trees on rooms: regular grids, where all merges of neighbouring boxes have
/// equal cost. The trees of the crate obvhs over exact boxes, and over boxes enlarged by up to 1/1000 so that no two
/// are equal, are traced by obvhs and compared with this library's structure over the exact boxes.
fn ties(pool: &Pool) {
    const TIE_RAYS: usize = 5_000;
    let mut table =
        Table::new(["triangles", "boxes", "tree cost", "triangles met per ray", "Mray/s (obvhs)", "Mray/s (ours)"]);
    for count in [8_000, 128_000] {
        let setting = scenes::planes("planes", count);
        let triangles = setting.triangles();
        let accel = pool.run(|| Accel::build(&triangles, Monitor::default().job())).expect("a scene to trace");
        let rays = &Rays::new(&setting, &accel, &triangles).bounce[..TIE_RAYS];
        let (seconds, _) =
            time(Clock::Thread, || black_box(rays.iter().filter(|ray| accel.closest(ray, |_| true).is_some()).count()));
        let ours = format!("{:.2}", TIE_RAYS as f64 / seconds * 1e-6);
        let shapes: Vec<Triangle> =
            triangles.iter().map(|t| Triangle { v0: t[0].into(), v1: t[1].into(), v2: t[2].into() }).collect();
        for (name, amount) in [("exact", 0.0), ("enlarged", 1e-3)] {
            let boxes: Vec<Aabb> =
                shapes.iter().enumerate().map(|(i, shape)| enlarged(shape.aabb(), i, amount)).collect();
            let indices = (0..boxes.len() as u32).collect();
            let mut builder = PlocBuilder::with_capacity(boxes.len());
            let tree = pool.run(|| builder.build(PlocSearchDistance::Low, &boxes, indices, SortPrecision::U64, 0));
            let mut met = 0u64;
            let (seconds, _) = time(Clock::Thread, || {
                for ray in rays {
                    let ray = ObvhsRay::new_inf(ray.origin.into(), ray.direction.into());
                    tree.ray_traverse(ray, &mut RayHit::none(), |ray, slot| {
                        met += 1;
                        shapes[tree.primitive_indices[slot] as usize].intersect(ray)
                    });
                }
            });
            table.row([
                triangles.len().to_string(),
                name.into(),
                format!("{:.1}", tree_cost(&tree)),
                format!("{:.1}", met as f64 / TIE_RAYS as f64),
                format!("{:.3}", TIE_RAYS as f64 / seconds * 1e-6),
                ours.clone(),
            ]);
        }
    }
    table.print("Ties among equal merges: obvhs's binary tree on tessellated planes");
}

fn enlarged(shape: Aabb, index: usize, amount: f32) -> Aabb {
    let share = (rng::mix(index as u64 + 1) >> 40) as f32 / (1 << 24) as f32;
    let grow = Vec3A::splat(shape.diagonal().max_element() * share * amount);
    Aabb::new(shape.min - grow, shape.max + grow)
}

/// Expected number of boxes that a random line through the scene hits (surface area heuristic without constants).
fn tree_cost(tree: &Bvh2) -> f32 {
    tree.nodes.iter().map(|node| node.aabb().half_area()).sum::<f32>() / tree.nodes[0].aabb().half_area()
}

fn is_headline(kind: &str, scene: &str) -> bool {
    match kind {
        "closest" => ["planes8k", "planes128k", "planes3m", "demo", "kitchen"].contains(&scene),
        "any" => ["planes128k", "kitchen"].contains(&scene),
        _ => false,
    }
}

fn measure(setting: &Setting, embree: Result<&Embree, &String>, table: &mut Table, built: &mut Table) {
    let triangles = setting.triangles();
    let (positions, indices) = one_mesh(setting);
    let monitor = Monitor::default();
    let build = || Accel::build(&triangles, monitor.job()).expect("a scene to trace");
    let accel = build();

    // Time the builds.
    let mut row = vec![setting.name.to_string(), triangles.len().to_string()];
    let per_triangle = |bytes: usize| format!("{:.1}", bytes as f64 / triangles.len() as f64);
    match &embree {
        Ok(embree) => {
            let rounds = if triangles.len() > 1_000_000 { 5 } else { ROUNDS };
            let timings = interleaved(
                Clock::Wall,
                rounds,
                &mut [&mut || drop(black_box(build())), &mut || {
                    drop(black_box(embree.build(&positions, &indices, false)))
                }],
            );
            let ratio = timings.ratio(0, 1);
            row.extend([0, 1].map(|i| format!("{:.4}", timings.median(i))));
            row.extend([format!("{ratio:.2}"), per_triangle(accel.bytes())]);
            row.push(per_triangle(embree.build(&positions, &indices, false).bytes));
            if setting.name == "planes3m" {
                figure("bvh.build.planes3m.vs_embree", ratio, "x");
            }
        }
        Err(reason) => {
            let (seconds, _) = time(Clock::Wall, build);
            row.extend([format!("{seconds:.4}"), "-".into(), "-".into(), per_triangle(accel.bytes()), "-".into()]);
            if setting.name == "planes3m" {
                absent("bvh.build.planes3m.vs_embree", reason);
            }
        }
    }
    row.push(accel.dropped().to_string());
    built.row(row);

    // Time the tracing.
    let rays = Rays::new(setting, &accel, &triangles);
    let peers = embree.map(|e| [false, true].map(|robust| e.build(&positions, &indices, robust)));
    for (kind, rays, any) in
        [("coherent", &rays.camera, false), ("closest", &rays.bounce, false), ("any", &rays.shadow, true)]
    {
        measure_tracing(setting.name, kind, &accel, peers.as_ref().map_err(|reason| *reason), rays, any, table);
    }
}

/// Number of rays that hit the scene, traced by this library.
fn our_hits(accel: &Accel, rays: &[Ray], any: bool) -> usize {
    match any {
        false => rays.iter().filter(|ray| accel.closest(ray, |_| true).is_some()).count(),
        true => rays.iter().filter(|ray| accel.occluded(ray, |_| true)).count(),
    }
}

/// Number of rays that hit the scene, traced by Embree.
fn embree_hits(scene: &embree::Scene, rays: &[Ray], any: bool) -> usize {
    let is_hit = |ray: &Ray| match any {
        false => {
            let mut hit = embree::RayHit::new(ray.origin, ray.direction, ray.t_max);
            scene.closest(&mut hit);
            hit.triangle != u32::MAX
        }
        true => scene.occluded(&mut embree::Ray::new(ray.origin, ray.direction, ray.t_max)),
    };
    rays.iter().filter(|ray| is_hit(ray)).count()
}

/// Times the tracing of one kind of rays; `peers` are Embree's scenes in default mode and in robust mode.
fn measure_tracing(
    scene: &str,
    kind: &str,
    accel: &Accel,
    peers: Result<&[embree::Scene; 2], &String>,
    rays: &[Ray],
    any: bool,
    table: &mut Table,
) {
    let ours = || our_hits(accel, rays, any);
    let speed = |seconds: f64| format!("{:.2}", rays.len() as f64 / seconds * 1e-6);
    let name = format!("rays.{kind}.{scene}.vs_embree");
    match peers {
        Ok([default, robust]) => {
            check(kind, scene, accel, robust, rays, any);
            let timings = interleaved(
                Clock::Thread,
                ROUNDS,
                &mut [
                    &mut || _ = black_box(ours()),
                    &mut || _ = black_box(embree_hits(default, rays, any)),
                    &mut || _ = black_box(embree_hits(robust, rays, any)),
                ],
            );
            let ratio = timings.ratio(1, 0);
            let [low, high] = timings.quartiles(1, 0);
            table.row([
                scene.into(),
                kind.into(),
                speed(timings.median(0)),
                speed(timings.median(1)),
                format!("{ratio:.2}"),
                format!("{low:.2}-{high:.2}"),
                format!("{:.2}", timings.ratio(2, 0)),
            ]);
            if is_headline(kind, scene) {
                figure(&name, ratio, "x");
            }
        }
        Err(reason) => {
            let (seconds, _) = time(Clock::Thread, ours);
            table.row([scene, kind, &speed(seconds), "-", "-", "-", "-"]);
            if is_headline(kind, scene) {
                absent(&name, reason);
            }
        }
    }
}

/// Checks that this library and Embree do equal work. A warning is printed if more than a thousandth of the rays hit
/// in only one of them or at another distance, which is more than rounding causes.
fn check(kind: &str, scene: &str, accel: &Accel, robust: &embree::Scene, rays: &[Ray], any: bool) {
    let mut differ = 0;
    for ray in rays {
        let mut theirs = embree::RayHit::new(ray.origin, ray.direction, ray.t_max);
        robust.closest(&mut theirs);
        let ours = accel.closest(ray, |_| true);
        differ += usize::from(match (ours, theirs.triangle) {
            (None, u32::MAX) => false,
            (Some(_), u32::MAX) | (None, _) => true,
            (Some(hit), _) => !any && (hit.t - theirs.ray.t_far).abs() > 1e-4 * hit.t,
        });
    }
    if differ * 1000 > rays.len() {
        println!("# {scene}, {kind}: {differ} of {} rays hit something else", rays.len());
    }
}

struct Rays {
    camera: Vec<Ray>,
    bounce: Vec<Ray>,
    shadow: Vec<Ray>,
}

impl Rays {
    fn new(setting: &Setting, accel: &Accel, triangles: &[[Vec3; 3]]) -> Self {
        let mut rng = Rng::new(3, &[]);
        // Camera rays: a grid of pixels in scan order.
        let side = (RAYS as f64).sqrt() as usize;
        let mut camera = Vec::with_capacity(RAYS);
        for i in 0..side * side {
            let (x, y) = ((i % side) as f32 + rng.next_f32(), (i / side) as f32 + rng.next_f32());
            let direction = setting.camera.direction(x / side as f32, y / side as f32, setting.aspect());
            camera.push(Ray::new(setting.camera.position, direction.normalize()));
        }
        // Other rays: from paths of up to five bounces, each starting with a random camera ray.
        let (low, high) = accel.bounds();
        let step = (high - low).length() * 1e-5;
        let lights = setting.light_points();
        let (mut bounce, mut shadow, mut places) =
            (Vec::with_capacity(RAYS), Vec::with_capacity(RAYS), Vec::<Vec3>::new());
        while bounce.len() < RAYS || shadow.len() < RAYS {
            let mut ray = camera[rng.below(camera.len())];
            for _ in 0..6 {
                let Some(hit) = accel.closest(&ray, |_| true) else { break };
                let [a, b, c] = triangles[hit.triangle as usize];
                let mut normal = (b - a).cross(c - a).normalize_or_zero();
                if normal.dot(ray.direction) > 0.0 {
                    normal = -normal;
                }
                let at = ray.at(hit.t) + normal * step;
                if !places.is_empty() && shadow.len() < RAYS {
                    let lit = rng.below(2) == 0 && !lights.is_empty();
                    let end = if lit { lights[rng.below(lights.len())] } else { places[rng.below(places.len())] };
                    shadow.push(Ray { t_max: 0.999, ..Ray::new(at, end - at) });
                }
                places.push(at);
                ray = Ray::new(at, cosine(normal, &mut rng));
                if bounce.len() < RAYS {
                    bounce.push(ray);
                }
            }
        }
        Self { camera, bounce, shadow }
    }
}

/// A random direction with cosine distribution around a normal.
fn cosine(normal: Vec3, rng: &mut Rng) -> Vec3 {
    let z = 2.0 * rng.next_f32() - 1.0;
    let (sin, cos) = (std::f32::consts::TAU * rng.next_f32()).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    (normal + Vec3::new(r * cos, r * sin, z) * 0.9999).normalize_or(normal)
}

/// The whole scene as one mesh, which Embree takes.
fn one_mesh(setting: &Setting) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for mesh in &setting.scene.meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(&mesh.positions);
        indices.extend(mesh.triangles.iter().map(|t| t.map(|i| first + i)));
    }
    (positions, indices)
}
