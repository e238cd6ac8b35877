//! Texture synthesis from photos of real ceilings, rectified to a view from straight below: each is continued to twice
//! its width and height.

use crate::truth::data;
use glam::DVec2;
use luxfer::emission::{Emission, Input, Law, Luminaire, Params, run};
use luxfer::exec::Pool;
use luxfer::image::io::{self, Encoding};
use luxfer::image::{Image, colour};
use luxfer::job::Monitor;

/// Loads a ceiling and the mask of its lights: the lamps that its JSON file lists or, if it lists none, the pixels
/// whose luminance exceeds `threshold`. `None` without test data.
fn ceiling(name: &str, threshold: f32) -> Option<(Image, Image)> {
    let folder = data("photo_truth/ceiling_ortho")?;
    let photo = io::load(&folder.join(format!("{name}.jpg")), Encoding::Srgb).unwrap();
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let (u0, v1, scale) = (number(&truth["u_range"][0]), number(&truth["v_range"][1]), number(&truth["px_per_unit"]));
    let side = |lamp: &serde_json::Value, key: &str| number(&lamp[key]);
    let corners = |l| [side(l, "u0") - u0, side(l, "u1") - u0, v1 - side(l, "v1"), v1 - side(l, "v0")];
    let items = truth["lights"]["items"].as_array().map_or(&[][..], |items| items);
    let lamps: Vec<[f64; 4]> = items.iter().map(|l| corners(l).map(|x| x * scale)).collect();
    let light = Image::from_fn(photo.width, photo.height, |x, y| {
        let (u, v) = (x as f64 + 0.5, y as f64 + 0.5);
        let listed = lamps.iter().any(|&[x0, x1, y0, y1]| x0 <= u && u < x1 && y0 <= v && v < y1);
        let bright = lamps.is_empty() && colour::luminance(photo.rgb(x, y)) > threshold;
        [f32::from(listed || bright)]
    });
    Some((photo, light.unwrap()))
}

fn doubled(name: &str, photo: &Image, light: &Image) -> Emission {
    let valid = Image::from_fn(photo.width, photo.height, |_, _| [1.0]).unwrap();
    let input = Input { unwarped: photo, light, valid: &valid, photo: None };
    let params = Params { width: 2 * photo.width, height: 2 * photo.height, ..Params::default() };
    let start = std::time::Instant::now();
    let result = Pool::new(2).unwrap().run(|| run(&input, &params, Monitor::default().job())).unwrap();
    eprintln!(
        "{name}: {:.2} s, {:?}, regularity {:.2}, {} lamps, error {:.3}, {:?}",
        start.elapsed().as_secs_f64(),
        result.law,
        result.regularity,
        result.luminaires.len(),
        result.error,
        result.statistics
    );
    for (suffix, image) in [("in", photo), ("out", &result.texture), ("metadata", &result.metadata)] {
        let path = std::env::temp_dir().join(format!("luxfer_emission_{name}_{suffix}.png"));
        io::write_file(&path, &io::encode_png(image, 1.0).unwrap()).unwrap();
    }
    result
}

#[test]
fn the_panels_of_the_corridor_go_on_at_their_period() {
    let Some((photo, light)) = ceiling("alma", 1.0) else { return };
    let result = doubled("alma", &photo, &light);
    let Law::Row([period, _]) = result.law else { panic!("{:?}", result.law) };
    // The true period of the panels is 3.2067 units of 150 pixels each.
    assert!((period - DVec2::new(0.0, 481.0)).length() < 6.0, "{period}");
    assert!(result.error < 0.1, "{}", result.error);
    let whole = result.luminaires.iter().filter(|l| l.size.distance(DVec2::new(181.0, 87.0)) < 8.0).count();
    assert!(whole >= 10, "{whole}");
}

#[test]
fn the_glass_ceiling_keeps_its_panes() {
    let Some((photo, light)) = ceiling("library", 1.0) else { return };
    let result = doubled("library", &photo, &light);
    assert!(result.error < 0.02, "{}", result.error);
    // Every pane of the texture has the size and the column of a pane in the photo, so the frames between panes keep
    // their width.
    let valid = Image::from_fn(photo.width, photo.height, |_, _| [1.0]).unwrap();
    let input = Input { unwarped: &photo, light: &light, valid: &valid, photo: None };
    let params = Params { width: photo.width, height: photo.height, ..Params::default() };
    let panes = run(&input, &params, Monitor::default().job()).unwrap().luminaires;
    assert_eq!(result.luminaires.len(), 4 * panes.len());
    let Law::Row([period, _]) = result.law else { panic!("{:?}", result.law) };
    let side = photo.width as f64;
    for lamp in &result.luminaires {
        let is_same = |pane: &Luminaire| {
            let apart = lamp.centre - pane.centre;
            let rows = apart.y / period.y;
            (apart.x / side - (apart.x / side).round()).abs() * side < 1.5
                && (rows - rows.round()).abs() < 0.02
                && (lamp.size - pane.size).abs().max_element() < 2.0
        };
        assert!(panes.iter().any(is_same), "{lamp:?}");
    }
    // Panes measure 60 or 154 by 68 or 167 pixels; no pane is cut, and no two panes touch.
    let size = DVec2::new(result.mask.width as f64, result.mask.height as f64);
    for lamp in &result.luminaires {
        let inside = lamp.outline.iter().all(|p| p.min_element() > 0.0 && (size - *p).min_element() > 0.0);
        assert!(!inside || (3_500.0..30_000.0).contains(&lamp.area), "{lamp:?}");
    }
}

#[test]
fn the_bowls_of_the_gallery_stay_whole() {
    let Some((photo, light)) = ceiling("gallery", 0.75) else { return };
    let result = doubled("gallery", &photo, &light);
    assert!(!result.luminaires.is_empty() && result.texture.count_non_finite() == 0);
}
