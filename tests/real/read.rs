//! Tests features and segmentation on real photos: photos of ceilings, with the strokes in `tests/strokes`, and photos
//! with measured depth (RGB-D).
//!
//! The pictures are not part of the project; they are read from `LUXFER_TEST_DATA` (default `../shared/data`). If
//! `LUXFER_TEST_OUTPUT` names a folder, overlays for inspection are written there.

use crate::truth::{data, read_json};
use glam::{DMat3, DVec2, DVec3, Vec3};
use luxfer::exec::Pool;
use luxfer::features::{self, DepthKind, DepthMap, PlaneStroke, RoomView};
use luxfer::geometry::{FocalSource, Perspective};
use luxfer::image::Image;
use luxfer::image::io::{Encoding, encode_png, load, write_file};
use luxfer::job::Monitor;
use luxfer::rectify;
use luxfer::segment::{self, strokes};
use std::path::Path;
use std::time::Instant;

fn write_picture(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("LUXFER_TEST_OUTPUT") {
        let png = encode_png(image, 1.0).unwrap();
        write_file(&Path::new(&folder).join(name), &png).unwrap();
    }
}

/// The camera that a photo's JSON file states; its room axes follow from the vanishing points in the file.
fn camera(photo: &serde_json::Value) -> Perspective {
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let k = &photo["K_consistent_with_GT"];
    let (focal, cx, cy) = if k.is_object() {
        (number(&k["f"]), number(&k["cx"]), number(&k["cy"]))
    } else {
        (number(&photo["fx"]), number(&photo["cx"]), number(&photo["cy"]))
    };
    let direction = |point: &serde_json::Value| {
        let p: Vec<f64> = point["homogeneous"].as_array().unwrap().iter().map(number).collect();
        DVec3::new((p[0] - cx * p[2]) / focal, (p[1] - cy * p[2]) / focal, p[2]).normalize()
    };
    let points = if k.is_object() { &photo["derived_horizontal_vps"] } else { &photo["vanishing_points"] };
    let (h1, h2) = (direction(&points["h1"]), direction(&points["h2"]));
    // Column 2 is the horizontal axis closest to the viewing direction, column 1 points downwards.
    let (mut z, x) = if h1.z.abs() > h2.z.abs() { (h1, h2) } else { (h2, h1) };
    z *= z.z.signum();
    let mut y = z.cross(x).normalize();
    y *= y.y.signum();
    let x = y.cross(z).normalize();
    Perspective {
        focal,
        focal_source: FocalSource::Given,
        principal: DVec2::new(cx, cy),
        bend: 0.0,
        axes: DMat3::from_cols(x, y, x.cross(y)),
    }
}

struct Photo {
    name: &'static str,
    path: &'static str,
    /// File with the true mask of the lights, and the minimum intersection over union that the found mask must reach.
    lights: Option<(&'static str, f64)>,
}

/// The minimum intersections over union are 0.02 to 0.04 below the measured values: shifting all edges by one pixel
/// changes the values by about as much.
const PHOTOS: [Photo; 10] = [
    Photo { name: "alma_corridor", path: "photos/alma_corridor.jpg", lights: Some(("alma_corridor_mask.png", 0.93)) },
    Photo {
        name: "alma_glassroom",
        path: "photos/alma_glassroom.jpg",
        lights: Some(("alma_glassroom_mask.png", 0.95)),
    },
    Photo { name: "alma_racks", path: "photos/alma_racks.jpg", lights: Some(("alma_racks_mask.png", 0.92)) },
    Photo {
        name: "peabody_atrium",
        path: "photos/peabody_atrium.jpg",
        lights: Some(("peabody_atrium_mask.png", 0.88)),
    },
    Photo { name: "yud_008", path: "photos/yud_008.jpg", lights: None },
    Photo { name: "yud_009", path: "photos/yud_009.jpg", lights: None },
    Photo { name: "yud_037", path: "photos/yud_037.jpg", lights: None },
    Photo { name: "warehouse_a", path: "photos/hdri/warehouse_a.png", lights: None },
    Photo { name: "st_fagans", path: "photos/hdri/st_fagans.png", lights: None },
    Photo { name: "autoshop", path: "photos/hdri/autoshop.png", lights: None },
];

/// Overlay for inspection: the dimmed photo with the plane in green, its lights in yellow, and the strokes.
fn overlay(photo: &Image, plane: &Image, lights: &Image, set: &segment::StrokeSet) -> Image {
    let mut out = photo.to_rgb().unwrap();
    for (i, p) in out.data.chunks_exact_mut(3).enumerate() {
        p.iter_mut().for_each(|v| *v *= 0.6);
        if lights.data[i] > 0.5 {
            p.copy_from_slice(&[1.0, 0.8, 0.0]);
        } else if plane.data[i] > 0.5 {
            p[1] += 0.15;
        }
    }
    for (strokes, colours) in
        [(&set.plane, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (&set.lights, [[0.0, 0.0, 1.0], [0.9, 0.9, 0.5]])]
    {
        for stroke in strokes {
            for &i in &stroke.pixels {
                out.data[3 * i as usize..3 * i as usize + 3].copy_from_slice(&colours[usize::from(stroke.positive)]);
            }
        }
    }
    out
}

fn iou(a: &Image, b: &Image) -> f64 {
    let pairs = || a.data.iter().zip(&b.data).map(|(a, b)| (*a > 0.5, *b > 0.5));
    let both = pairs().filter(|(a, b)| *a && *b).count();
    both as f64 / pairs().filter(|(a, b)| *a || *b).count().max(1) as f64
}

#[test]
fn ceilings_and_their_lights_are_found_in_real_photos() {
    let Some(data) = data("") else { return };
    let pool = Pool::new(0).unwrap();
    let mut failed = Vec::new();
    for Photo { name, path, lights: truth } in PHOTOS {
        let photo = load(&data.join(path), Encoding::Srgb).unwrap();
        let known = camera(&read_json(&data.join(path).with_extension("json")));
        let text = std::fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/strokes").join(name).with_extension("txt"),
        );
        let set = strokes::parse(&text.unwrap(), photo.width, photo.height).unwrap();

        // The focal length and the principal point are given; lines and room axes are estimated.
        let monitor = Monitor::default();
        let params =
            rectify::Params { focal: Some(known.focal), principal: Some(known.principal), ..Default::default() };
        let view = pool.run(|| rectify::find_view(&photo, &params, monitor.job())).unwrap();
        let painted: Vec<_> =
            set.plane_strokes().map(|s| PlaneStroke { pixels: &s.pixels, positive: s.positive }).collect();
        let room =
            RoomView { perspective: &view.perspective, segments: &view.segments, strokes: &painted, layout: None };
        let started = Instant::now();
        let input = features::Input { photo: &photo, depth: None, room: Some(room) };
        let features = pool.run(|| features::run(&input, &Default::default(), monitor.job())).unwrap();
        let features_ms = started.elapsed().as_secs_f64() * 1e3;

        let started = Instant::now();
        let examples = set.plane_examples();
        let input = segment::Input { features: &features.image, strokes: &examples, region: None };
        let plane = pool.run(|| segment::run(&input, &Default::default(), monitor.job())).unwrap();
        let plane_ms = started.elapsed().as_secs_f64() * 1e3;
        let input = segment::Input { features: &features.image, strokes: &set.lights, region: Some(&plane.mask) };
        let lights = pool.run(|| segment::run(&input, &segment::Params::for_lights(), monitor.job())).unwrap();

        write_picture(&format!("{name}.png"), &overlay(&photo, &plane.mask, &lights.mask, &set));
        let share = |m: &Image| m.data.iter().sum::<f32>() / m.data.len() as f32;
        println!(
            "{name}: plane {:.3} ({:?}, error {:.3}), lights {:.4} ({:?}, error {:.3}); features {features_ms:.0} ms, plane {plane_ms:.0} ms",
            share(&plane.mask),
            plane.model,
            plane.error,
            share(&lights.mask),
            lights.model,
            lights.error
        );
        assert_eq!(plane.confidence.count_non_finite() + lights.confidence.count_non_finite(), 0);
        if let Some((file, least)) = truth {
            let truth = load(&data.join("photo_truth/masks").join(file), Encoding::Linear).unwrap().channel(0).unwrap();
            let agreement = iou(&lights.mask, &truth);
            println!("{name}: lights' intersection over union {agreement:.3}");
            if agreement < least {
                failed.push((name, agreement));
            }
        }
    }
    assert!(failed.is_empty(), "intersection over union too small: {failed:?}");
}

#[test]
fn measured_depth_gives_smooth_walls_and_upright_normals() {
    let Some(data) = data("") else { return };
    let pool = Pool::new(0).unwrap();
    let intrinsics = &read_json(&data.join("rgbd/rgbd.json"))["K"];
    let k = |name: &str| intrinsics[name].as_f64().unwrap();
    let perspective = Perspective {
        focal: (k("fx") + k("fy")) / 2.0,
        focal_source: FocalSource::Given,
        principal: DVec2::new(k("cx"), k("cy")),
        bend: 0.0,
        axes: DMat3::IDENTITY,
    };
    for name in ["nyu_00000", "nyu_00050", "nyu_00100"] {
        let photo = load(&data.join(format!("rgbd/{name}_rgb.jpg")), Encoding::Srgb).unwrap();
        let depth = load(&data.join(format!("rgbd/{name}_depth.png")), Encoding::Linear).unwrap().channel(0).unwrap();
        let map = DepthMap { image: &depth, kind: DepthKind::AlongZ };
        let room = RoomView { perspective: &perspective, segments: &[], strokes: &[], layout: None };
        let input = features::Input { photo: &photo, depth: Some(map), room: Some(room) };
        let started = Instant::now();
        let got = pool.run(|| features::run(&input, &Default::default(), Monitor::default().job())).unwrap();
        println!("{name}: {:.0} ms", started.elapsed().as_secs_f64() * 1e3);
        assert_eq!(got.image.count_non_finite(), 0);
        let holes = depth.data.iter().filter(|&&d| d == 0.0).count();
        assert_eq!(got.depth_confidence.data.iter().filter(|&&c| c == 0.0).count(), holes);

        // Nearby measured pixels mostly lie on one surface, so their normals must mostly agree.
        let mut angles: Vec<f32> = Vec::new();
        for y in 0..photo.height {
            for x in 0..photo.width - 8 {
                if depth.pixel(x, y)[0] > 0.0 && depth.pixel(x + 8, y)[0] > 0.0 {
                    let normal = |x: usize| Vec3::from_slice(&got.image.pixel(x, y)[7..10]);
                    angles.push(normal(x).angle_between(normal(x + 8)).to_degrees());
                }
            }
        }
        angles.sort_by(f32::total_cmp);
        println!("{name}: median angle between normals 8 pixels apart {:.2} degrees", angles[angles.len() / 2]);
        let picture = Image::from_fn(photo.width, photo.height, |x, y| {
            let p = got.image.pixel(x, y);
            [0.5 + 0.5 * p[7], 0.5 + 0.5 * p[8], 0.5 - 0.5 * p[9]]
        });
        write_picture(&format!("{name}_normals.png"), &picture.unwrap());
    }
}
