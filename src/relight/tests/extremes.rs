//! Tests that reproduce results of the paper ("Single-Exemplar Lighting Style Transfer"), and tests with extreme
//! inputs.

use super::*;

/// "The red curtain and the floor, which has a wooden material, naturally impact the colour of the light": the solved
/// light is shifted towards blue (§8 and Fig. 16 of the paper).
#[test]
fn a_red_curtain_and_a_wooden_floor_make_the_light_bluer() {
    let solved = |floor: Vec3, curtain: Vec3| {
        let mut scene = room(Vec3::new(5.0, 2.7, 4.0), Vec3::splat(0.6), Vec3::splat(0.8), Vec3::ONE);
        for (mesh, colour) in [(0, floor), (2, curtain)] {
            scene.materials.push(Material { double_sided: false, ..Material::diffuse("paint", colour) });
            scene.meshes[mesh].material = scene.materials.len() - 1;
        }
        // A strip just below the ceiling emits; the ceiling is the target, as in the photo.
        let ceiling = scene.meshes[1].clone();
        scene.meshes[1].material = 0;
        let strip = Vec3::new(0.5, 0.0, 0.1);
        let centre = Vec3::new(2.5, 2.69, 2.0);
        let positions = ceiling.positions.iter().map(|p| {
            let from = (p - Vec3::new(2.5, 2.7, 2.0)) * strip;
            centre + from
        });
        scene.meshes.push(Mesh { positions: positions.collect(), ..ceiling });
        let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
        let input = Input { world: &world, emitter: 1, target_triangles: &[(1, 0), (1, 1)], target: Vec3::splat(50.0) };
        let params = Params { target_error: 0.01, ..Params::default() };
        Pool::new(2).unwrap().run(|| run(&input, &params, Monitor::default().job()).unwrap())
    };
    let grey = solved(Vec3::splat(0.3), Vec3::splat(0.3));
    let warm = solved(Vec3::new(0.45, 0.28, 0.15), Vec3::new(0.6, 0.05, 0.05));
    // The same target needs white light in a grey room, and bluish light in a warm one. The difference must exceed the
    // confidence intervals of both solutions.
    let blue = |s: &Solution| (s.scale.z / s.scale.x, (s.half_width.z / s.scale.z).hypot(s.half_width.x / s.scale.x));
    let ((neutral, e), (shifted, f)) = (blue(&grey), blue(&warm));
    assert!((neutral - 1.0).abs() < 1.5 * e, "{grey:?}");
    assert!(shifted > 1.2 * (1.0 + e + f), "{warm:?}");
}

/// Matching the ceiling and matching all visible surfaces give different light (the paper's Table 1): the ceiling is
/// lit by the wooden floor, whereas the grey walls are lit by the lamp.
#[test]
fn ceiling_and_overall_targets_differ() {
    let mut scene = room(Vec3::new(5.0, 2.7, 4.0), Vec3::splat(0.5), Vec3::splat(0.8), Vec3::ONE);
    for (mesh, colour) in [(0, Vec3::new(0.6, 0.35, 0.2)), (1, Vec3::splat(0.8))] {
        scene.materials.push(Material { double_sided: false, ..Material::diffuse("paint", colour) });
        scene.meshes[mesh].material = scene.materials.len() - 1;
    }
    let lamp = scene.meshes[1].clone();
    let positions = lamp.positions.iter().map(|p| (*p - Vec3::new(2.5, 2.7, 2.0)) * 0.3 + Vec3::new(2.5, 2.6, 2.0));
    scene.meshes.push(Mesh { material: 1, positions: positions.collect(), ..lamp });
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let solved = |triangles: &[(usize, usize)]| {
        let input = Input { world: &world, emitter: 1, target_triangles: triangles, target: Vec3::splat(30.0) };
        Pool::new(2).unwrap().run(|| run(&input, &Params::default(), Monitor::default().job()).unwrap())
    };
    let everything: Vec<(usize, usize)> = (0..6).flat_map(|mesh| [(mesh, 0), (mesh, 1)]).collect();
    let (ceiling, overall) = (solved(&[(1, 0), (1, 1)]), solved(&everything));
    let blue = |s: &Solution| s.scale.z / s.scale.x;
    let widths = |s: &Solution| (s.half_width / s.scale).dot(DVec3::X + DVec3::Z);
    let joint = widths(&ceiling) + widths(&overall);
    assert!(blue(&ceiling) > (1.0 + joint) * blue(&overall) && joint < 0.05, "{ceiling:?} {overall:?}");
    assert!(ceiling.scale.y > 1.1 * overall.scale.y, "{ceiling:?} {overall:?}");
}

/// In a closed room whose surfaces all emit `e` and have the albedo `ρ`, the radiance is `L = e / (1 - ρ)` everywhere,
/// for any size of the room. At an albedo of 0.99, paths are long.
#[test]
fn a_white_closed_room_and_rooms_of_any_size() {
    for size in [1e-6, 1.0, 1e6] {
        let mut scene = room(Vec3::splat(size), Vec3::splat(0.5), Vec3::splat(0.5), Vec3::ONE);
        scene.meshes.iter_mut().for_each(|m| m.material = 1);
        let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
        let triangles = [(0, 0), (0, 1)];
        let goal = Goal {
            geometry: TargetGeometry::Surface(&triangles),
            quantity: Quantity::Incident,
            target: Vec3::ONE,
            aspect: Aspect::Colour,
            constraint: EXACTLY,
            weight: 1.0,
        };
        let grid = Goal {
            geometry: TargetGeometry::Grid {
                origin: Vec3::splat(0.2 * size),
                across: Vec3::X * 0.5 * size,
                down: Vec3::Z * 0.5 * size,
                normal: Vec3::Y,
            },
            ..goal
        };
        let lamps = EmissionLamps::of_meshes(world.scene(), 1).unwrap();
        let params = Params { paths: 1 << 14, target_error: 0.0, ..Params::default() };
        let responses = Pool::new(2)
            .unwrap()
            .run(|| lamp_responses(&world, 1, &lamps, &[grid], &params, Monitor::default().job()).unwrap());
        // The emitted and reflected radiance of every wall is e / (1 - ρ) = 2 in total. Each of the six walls is a
        // lamp and contributes to this total.
        let all = responses.all(0);
        assert_eq!(lamps.count(), 6);
        assert!((all.mean.x - 2.0).abs() < 4.0 * all.standard_error.x + 1e-5, "size {size}: {all:?}");
        assert!(all.standard_error.x < 0.02);
    }
    let scene = room(Vec3::ONE, Vec3::splat(0.99), Vec3::splat(0.99), Vec3::ONE);
    let params = Params { quantity: Quantity::Incident, paths: 1 << 13, target_error: 0.0, ..Params::default() };
    let solution = solve(&scene, Vec3::ONE, &params).unwrap();
    // One wall of six emits, and every wall absorbs 1 % of the light: in equilibrium, the mean radiance is about 1/6 /
    // 0.01 = 16.7.
    let mean = solution.response.x;
    assert!((mean / (1.0 / 0.06) - 1.0).abs() < 0.1, "{mean}");
}

/// In empty space, light from the lamps of a convex vault never returns to the vault. The error message says so.
#[test]
fn a_convex_ceiling_receives_no_light_of_its_own() {
    let (apex, ring) = (Vec3::Y, |i: u32| Vec3::new((i as f32 * 0.785).cos(), 0.0, (i as f32 * 0.785).sin()) * 2.0);
    let cap = |from: u32, to: u32, material: usize| Mesh {
        material,
        positions: (from..to).flat_map(|i| [apex, ring(i + 1), ring(i)]).collect(),
        triangles: (from..to).map(|i| i - from).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    };
    let scene = Scene {
        meshes: vec![cap(0, 5, 0), cap(5, 8, 1)],
        materials: vec![
            Material::diffuse("vault", Vec3::splat(0.8)),
            Material { emission: Vec3::ONE, ..Material::diffuse("lamps", Vec3::splat(0.8)) },
        ],
        ..Scene::default()
    };
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let triangles: Vec<(usize, usize)> = (0..5).map(|t| (0, t)).collect();
    let input = Input { world: &world, emitter: 1, target_triangles: &triangles, target: Vec3::ONE };
    let params = Params { paths: 1 << 14, ..Params::default() };
    let error = Pool::new(1).unwrap().run(|| run(&input, &params, Monitor::default().job())).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unreachable);
    assert!(error.message.contains("no light of the emission finds its way back"), "{error}");
}

/// A lamp that the target sees edge-on, or not at all, has no response.
#[test]
fn a_lamp_seen_edge_on_is_dark() {
    // The ceiling emits; the target is coplanar with it, and everything else is black.
    let mut scene = room(Vec3::ONE, Vec3::ZERO, Vec3::ZERO, Vec3::ONE);
    let mut beside = scene.meshes[1].clone();
    beside.positions.iter_mut().for_each(|p| p.x += 1.0);
    beside.material = 0;
    scene.materials[0].base_color = Vec3::ZERO;
    scene.meshes.push(beside);
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let input = Input { world: &world, emitter: 1, target_triangles: &[(6, 0), (6, 1)], target: Vec3::ONE };
    let params = Params { quantity: Quantity::Incident, paths: 1 << 12, ..Params::default() };
    let error = Pool::new(1).unwrap().run(|| run(&input, &params, Monitor::default().job())).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unreachable);
    let goal = Goal {
        geometry: TargetGeometry::Surface(input.target_triangles),
        quantity: Quantity::Incident,
        target: Vec3::ONE,
        aspect: Aspect::Colour,
        constraint: EXACTLY,
        weight: 1.0,
    };
    let lamps = EmissionLamps::of_meshes(world.scene(), 1).unwrap();
    let responses = Pool::new(1)
        .unwrap()
        .run(|| lamp_responses(&world, 1, &lamps, &[goal], &params, Monitor::default().job()).unwrap());
    let error = powers(&responses, &[goal], &GroupParams::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unreachable);
}
