//! Guides of the demonstration's scenes, and pictures that are painted by them.

use crate::harness::figure;
use glam::Vec3;
use luxfer::demo::artwork::{Style, draw};
use luxfer::demo::{sphere_on_table, still_life};
use luxfer::guides::{self, Extras, Guides, Surfaces, pairs};
use luxfer::image::Image;
use luxfer::image::colour::{delta_e_2000, linear_to_lab};
use luxfer::image::pyramid::blur;
use luxfer::job::Monitor;
use luxfer::render::World;
use luxfer::scene::{Camera, Scene};
use luxfer::stylize::{Guide, Input, Params, Range, run};
use std::sync::Arc;

/// Size of the frames, and paths per pixel of guides and of their reference.
const SIZE: [usize; 2] = [160, 120];
const SAMPLES: u32 = 16;
const REFERENCE: u32 = 128;
/// Factor by which the frame is finer that shows which points are hidden.
const FINER: usize = 5;

fn rendered(scene: &Scene, [width, height]: [usize; 2], samples: u32, smooth: bool) -> Guides {
    let params = guides::Params { width, height, samples, smooth, ..guides::Params::default() };
    let monitor = Monitor::default();
    let world = World::build(Arc::new(scene.clone()), monitor.job()).expect("a valid scene");
    guides::run(&world, &scene.cameras[0], &params, monitor.job()).expect("guides")
}

/// Prints the error of smoothed light and of noisy light, relative to the pixel but at least to a tenth of the mean.
/// Then the mean strength of edges: on pixels beside another object, and on those at least `INSIDE` pixels from any.
pub fn light_and_edges() {
    const INSIDE: usize = 4;
    let scene = still_life().expect("a scene");
    let reference = rendered(&scene, SIZE, REFERENCE, false);
    let smooth = rendered(&scene, SIZE, SAMPLES, true);
    for (i, name) in [(0, "full"), (3, "indirect")] {
        let truth = &reference.light[i].data;
        let least = 0.1 * truth.iter().sum::<f32>() / truth.len() as f32;
        let pairs = smooth.light[i].data.iter().zip(truth);
        let squares: f64 = pairs.map(|(a, b)| f64::from((a - b) / b.max(least)).powi(2)).sum();
        figure(&format!("constants.guides.{name}.error"), 100.0 * (squares / truth.len() as f64).sqrt(), "%");
    }
    let mesh = |x: usize, y: usize| smooth.surfaces.points[y * SIZE[0] + x].map(|p| p.mesh);
    let is_alone = |x: usize, y: usize, reach: usize| {
        let near = |v: usize, most: usize| v.saturating_sub(reach)..(v + reach + 1).min(most);
        near(y, SIZE[1]).all(|j| near(x, SIZE[0]).all(|i| mesh(i, j) == mesh(x, y)))
    };
    let strength = |is_in: &dyn Fn(usize, usize) -> bool| {
        let all = (0..SIZE[0] * SIZE[1]).map(|i| (i % SIZE[0], i / SIZE[0])).filter(|&(x, y)| is_in(x, y));
        let values: Vec<f64> = all.map(|(x, y)| f64::from(smooth.edges.pixel(x, y)[0])).collect();
        100.0 * values.iter().sum::<f64>() / values.len() as f64
    };
    figure("constants.guides.edges.outlines", strength(&|x, y| !is_alone(x, y, 1)), "% of full strength");
    figure("constants.guides.edges.inside", strength(&|x, y| is_alone(x, y, INSIDE)), "% of full strength");
}

fn place_of(surfaces: &Surfaces, i: usize) -> Option<Vec3> {
    let point = surfaces.points[i]?;
    Some(point.on(surfaces.shapes[point.mesh as usize].triangle(&point)?))
}

fn depth(position: Vec3, camera: &Camera) -> f32 {
    (position - camera.position).dot(camera.forward)
}

/// Prints the share of the pixels of a frame that are wrongly taken for hidden, or for visible, in the frame before,
/// whose camera stood to one side. A frame that is `FINER` times as fine shows the truth.
pub fn motion() {
    let [mut lost, mut wrong, mut count] = [0, 0, 0];
    for step in [0.02, 0.1, 0.3] {
        let mut scene = still_life().expect("a scene");
        let now = rendered(&scene, SIZE, 1, false).surfaces;
        let camera = &mut scene.cameras[0];
        camera.position += camera.forward.cross(camera.up) * step;
        let camera = camera.clone();
        let before = rendered(&scene, SIZE, 1, false).surfaces;
        let [width, height] = SIZE.map(|side| side * FINER);
        let fine = rendered(&scene, [width, height], 1, false).surfaces;
        let motion = guides::motion(&now, &before, Monitor::default().job()).expect("equal sizes").image;
        for i in 0..SIZE[0] * SIZE[1] {
            let Some(position) = place_of(&now, i) else { continue };
            let aspect = SIZE[0] as f32 / SIZE[1] as f32;
            let Some(([u, v], _)) = camera.project(position - camera.position, aspect) else { continue };
            let inside = |t: f32| (0.02..0.98).contains(&t);
            if !inside(u) || !inside(v) {
                continue;
            }
            let at = (v * height as f32) as usize * width + (u * width as f32) as usize;
            let Some(shown) = place_of(&fine, at) else { continue };
            count += 1;
            let is_visible = depth(position, &camera) < 1.004 * depth(shown, &camera);
            let is_found = motion.data[2 * i].is_finite();
            lost += u64::from(is_visible && !is_found);
            wrong += u64::from(!is_visible && is_found);
        }
    }
    figure("constants.motion.lost", 100.0 * lost as f64 / count as f64, "% of the pixels");
    figure("constants.motion.hidden_found", 100.0 * wrong as f64 / count as f64, "% of the pixels");
}

/// Paints the still life after artworks of the ball, by the guides of light and by all guides. Prints the difference in
/// tone from the artist's own picture of the still life (mean CIEDE2000 of blurred pictures), the error of the guides
/// and the share of the exemplar that is used.
pub fn paint() {
    let [source, target] =
        [sphere_on_table(), still_life()].map(|s| rendered(&s.expect("a scene"), [240, 180], 16, true));
    let all = Extras { normals: true, edges: true, materials: true, ..Extras::default() };
    for (name, extras) in [("light", Extras::default()), ("all", all)] {
        let [mut tone, mut error, mut used] = [0.0; 3];
        let styles = [Style::Paint, Style::Pen];
        for style in styles {
            let [artwork, truth] = [&source, &target].map(|g| draw(style, g).expect("an artwork"));
            let pairs = pairs(&source, &target, extras).expect("guides");
            let range = |is_light: bool| if is_light { Range::Light } else { Range::Data };
            let guides: Vec<Guide> = pairs
                .iter()
                .map(|p| Guide {
                    name: p.name,
                    source: &p.source,
                    target: &p.target,
                    weight: 1.0,
                    range: range(p.is_light),
                })
                .collect();
            let output = run(&Input::new(&artwork, &guides), &Params::default(), Monitor::default().job());
            let output = output.expect("valid input");
            tone += apart(&output.image, &truth) / styles.len() as f64;
            let errors = &output.report.guide_error.data;
            let squares: f64 = errors.iter().map(|v| f64::from(v * v)).sum();
            error += (squares / errors.len() as f64).sqrt() / styles.len() as f64;
            used += 100.0 * output.report.usage.used / styles.len() as f64;
        }
        figure(&format!("constants.paint.{name}.tone"), tone, "dE2000");
        figure(&format!("constants.paint.{name}.guide_error"), error, "-");
        figure(&format!("constants.paint.{name}.used"), used, "%");
    }
}

/// Mean CIEDE2000 difference of two pictures after a blur of four pixels.
fn apart(a: &Image, b: &Image) -> f64 {
    let [a, b] = [a, b].map(|image| blur(image, 4.0, Monitor::default().job()).expect("a blur"));
    let lab = |image: &Image, i: usize| linear_to_lab(image.rgb(i % image.width, i / image.width));
    let count = a.width * a.height;
    (0..count).map(|i| delta_e_2000(lab(&a, i), lab(&b, i))).sum::<f64>() / count as f64
}
