//! Tests rectification of photos whose principal point is not the centre of the image: photos from shift lenses, as
//! used for buildings, and cropped photos.

use glam::{DMat3, DQuat, DVec2, DVec3};
use luxfer::geometry::{FocalSource, Perspective, Segment};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::rectify::{self, Params, UnwarpParams, View};
use luxfer::rng::Rng;

const SIZE: [usize; 2] = [800, 600];
const FOCAL: f64 = 640.0;

/// A camera that looks nearly level, with its lens shifted up so far that the principal point lies below the photo's
/// lower border.
fn camera() -> Perspective {
    Perspective {
        focal: FOCAL,
        focal_source: FocalSource::Given,
        principal: DVec2::new(330.0, 650.0),
        bend: 0.0,
        axes: DMat3::from_quat(
            DQuat::from_rotation_z(0.02) * DQuat::from_rotation_x(0.06) * DQuat::from_rotation_y(0.45),
        ),
    }
}

/// The point where the ray through a pixel meets a ceiling one unit above the camera; `None` if the ray goes down.
fn on_ceiling(camera: &Perspective, pixel: DVec2) -> Option<DVec2> {
    let ray = camera.axes.transpose() * camera.ray(pixel);
    (ray.y < 0.0).then(|| DVec2::new(ray.x, ray.z) / -ray.y)
}

/// A ceiling of square lamps; the surroundings are dark.
fn photo(camera: &Perspective) -> Image {
    const SUB: usize = 4;
    let shade = |pixel: DVec2| match on_ceiling(camera, pixel) {
        Some(at) if at.abs().max_element() < 4.0 => {
            let tile = DVec2::new(at.x.rem_euclid(0.5), at.y.rem_euclid(0.5));
            if tile.min_element() > 0.1 && tile.max_element() < 0.4 { 0.9 } else { 0.25 }
        }
        _ => 0.05f32,
    };
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = |k: usize| DVec2::new((k % SUB) as f64 + 0.5, (k / SUB) as f64 + 0.5) / SUB as f64;
        let corner = DVec2::new(x as f64, y as f64);
        [(0..SUB * SUB).map(|k| shade(corner + at(k))).sum::<f32>() / (SUB * SUB) as f32; 3]
    })
    .unwrap()
}

fn mask(camera: &Perspective) -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = on_ceiling(camera, DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        [f32::from(at.is_some_and(|q| q.abs().max_element() < 3.5))]
    })
    .unwrap()
}

/// Random segments that run exactly towards the vanishing points of the three room axes.
fn segments(camera: &Perspective) -> Vec<Segment> {
    let mut rng = Rng::new(3, &[]);
    let mut between = |low: f64, high: f64| low + (high - low) * rng.next_f64();
    (0..120)
        .map(|i| {
            let vanishing = camera.vanishing_point(i % 3);
            let a = DVec2::new(between(0.0, SIZE[0] as f64), between(0.0, SIZE[1] as f64));
            let towards = (vanishing.truncate() - a * vanishing.z).normalize();
            Segment { a, b: a + towards * between(40.0, 160.0) }
        })
        .collect()
}

/// Errors of a view: the largest angle in degrees between its axes and the true axes, and the absolute logarithm of
/// the unwarped ceiling's aspect ratio divided by the true one.
fn errors(view: &View, truth: &Perspective, photo: &Image) -> (f64, f64) {
    let axes = [0, 1, 2].map(|k| view.perspective.axes.col(k));
    let off = |axis: DVec3| axes.iter().map(|a| a.dot(axis).abs().min(1.0).acos()).fold(9.0, f64::min);
    let degrees = (0..3).map(|k| off(truth.axes.col(k)).to_degrees()).fold(0.0, f64::max);
    let horizontal = UnwarpParams { axes: Some([0, 2]), ..UnwarpParams::default() };
    let flat = rectify::unwarp(photo, view, &mask(truth), &horizontal, Monitor::default().job()).unwrap();
    let corner = flat.corners.map(|c| on_ceiling(truth, c).unwrap());
    let (across, down) = (corner[1] - corner[0], corner[3] - corner[0]);
    let (w, h) = (flat.image.width as f64, flat.image.height as f64);
    (degrees, (across.length() / down.length() * h / w).ln().abs())
}

#[test]
fn exact_lines_give_the_camera_if_the_principal_point_is_given() {
    let (truth, job) = (camera(), Monitor::default());
    let photo = photo(&truth);
    let read = |principal: Option<DVec2>| {
        let params = Params { principal, ..Params::default() };
        rectify::view_from_segments(&segments(&truth), SIZE[0], SIZE[1], &params, job.job()).unwrap()
    };
    let view = read(Some(truth.principal));
    let (degrees, aspect) = errors(&view, &truth, &photo);
    println!(
        "principal point given: focal {:.2}, axes {degrees:.4} degrees, aspect {aspect:.4}",
        view.perspective.focal
    );
    assert_eq!(view.perspective.principal, truth.principal);
    assert!((view.perspective.focal / FOCAL - 1.0).abs() < 5e-3 && degrees < 0.1 && aspect < 0.01);
    // If the image centre is taken for the principal point, the estimated axes are wrong.
    let view = read(None);
    let (degrees, _) = errors(&view, &truth, &photo);
    println!("principal point not given: focal {:.2}, axes {degrees:.4} degrees", view.perspective.focal);
    assert!(degrees > 3.0);
}

#[test]
fn a_photo_of_a_shifted_lens_is_read_from_its_pixels() {
    let (truth, job) = (camera(), Monitor::default());
    let photo = photo(&truth);
    let read = |principal: Option<DVec2>| {
        let params = Params { principal, ..Params::default() };
        errors(&rectify::find_view(&photo, &params, job.job()).unwrap(), &truth, &photo)
    };
    let (given, guessed) = (read(Some(truth.principal)), read(None));
    println!(
        "with the principal point given and guessed: axes off by {:.2} and {:.2} degrees; aspect by {:.3} and {:.3}",
        given.0, guessed.0, given.1, guessed.1
    );
    assert!(given.0 < 2.0 && given.1 < 0.05);
    assert!(guessed.0 > 2.0 * given.0);
}
