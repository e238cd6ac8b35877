use super::*;
use crate::demo;
use crate::job::Monitor;
use std::sync::Arc;

fn rendered(scene: crate::scene::Scene, width: usize, samples: u32) -> Guides {
    let camera = scene.cameras[0].clone();
    let job = Monitor::default();
    let world = World::build(Arc::new(scene), job.job()).unwrap();
    let params = Params { width, height: width * 3 / 4, samples, ..Params::default() };
    run(&world, &camera, &params, job.job()).unwrap()
}

#[test]
fn the_kinds_of_light_are_separated() {
    let g = rendered(demo::sphere_on_table().unwrap(), 120, 32);
    let mean = |image: &Image| image.data.iter().map(|v| f64::from(*v)).sum::<f64>() / image.data.len() as f64;
    let [full, direct, specular, indirect, two, caustics] = [0, 1, 2, 3, 4, 5].map(|i| mean(&g.light[i]));
    assert!(
        direct < two && two < full && specular < direct && indirect < direct && caustics < direct,
        "{full} {direct} {specular} {indirect} {two} {caustics}"
    );
    // The ball casts a caustic onto table and wall, but none onto itself, because it is convex.
    assert!(caustics > 0.0 && f64::from(g.light[5].pixel(60, 45)[0]) < 0.1 * caustics);
    // Only the ball is glossy, and the normal varies only on the ball.
    assert!(g.light[2].pixel(5, 5).iter().all(|v| *v == 0.0));
    let middle = g.normals.pixel(60, 42);
    assert!(middle[2] > 0.8, "the ball faces the camera: {middle:?}");
    assert_ne!(g.materials.pixel(60, 45), g.materials.pixel(5, 5));
    // The rim of the ball is an edge; the table is not.
    let row: Vec<f32> = (0..120).map(|x| g.edges.pixel(x, 45)[0]).collect();
    assert!(row.iter().filter(|e| **e > 0.5).count() >= 2 && row[3] < 0.1 && row[60] < 0.1, "{row:?}");
}

#[test]
fn smoothing_keeps_the_light_and_lowers_its_noise() {
    let scene = || demo::sphere_on_table().unwrap();
    let truth = rendered(scene(), 64, 512);
    let noisy = {
        let scene = scene();
        let camera = scene.cameras[0].clone();
        let job = Monitor::default();
        let world = World::build(Arc::new(scene), job.job()).unwrap();
        let params = Params { width: 64, height: 48, samples: 16, smooth: false, ..Params::default() };
        run(&world, &camera, &params, job.job()).unwrap()
    };
    let smooth = rendered(scene(), 64, 16);
    for i in [1, 3] {
        let error = |g: &Guides| -> f64 {
            let pairs = g.light[i].data.iter().zip(&truth.light[i].data);
            pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum()
        };
        assert!(error(&smooth) < 0.7 * error(&noisy), "{} {} {}", LIGHT[i].0, error(&smooth), error(&noisy));
    }
}

#[test]
fn pairs_share_their_exposure() {
    let a = rendered(demo::sphere_on_table().unwrap(), 48, 4);
    let mut b = a.clone();
    let all = Extras { normals: true, edges: true, materials: true, caustics: true };
    let names: Vec<&str> = pairs(&a, &b, all).unwrap().iter().map(|p| p.name).collect();
    assert_eq!(
        names,
        ["full", "direct", "specular", "indirect", "two bounces", "caustics", "normals", "edges", "materials"]
    );
    assert_eq!(pairs(&a, &b, Extras::default()).unwrap().len(), 5);
    // Exemplar and target get the same exposure, so a target twice as bright as the exemplar stays twice as bright.
    b.light[0].data.iter_mut().for_each(|v| *v *= 2.0);
    let full = &pairs(&a, &b, Extras::default()).unwrap()[0];
    let dim = full.target.data.iter().position(|v| *v < 0.5 && *v > 0.05).unwrap();
    assert!((full.target.data[dim] / full.source.data[dim] - 2.0).abs() < 1e-3);
    assert!(full.target.data.iter().all(|v| (0.0..=1.0).contains(v)));
}

mod motion;
