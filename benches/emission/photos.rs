//! Patterns from photos: ceilings photographed in perspective with noise, photos of real rooms, and real ceilings seen
//! straight from below.

use crate::harness::{Table, absent, figure, median};
use crate::score::{STATISTICS, Score};
use crate::{DESIGNS, Exemplar, save};
use glam::{DMat3, DVec2, Vec3};
use luxfer::emission::pairs::{self, Points};
use luxfer::emission::{self, Emission, Input, Luminaire, Params};
use luxfer::geometry::{Homography, PhotoMap};
use luxfer::image::Image;
use luxfer::image::colour::luminance;
use luxfer::image::io::{self, Encoding};
use luxfer::job::Monitor;
use luxfer::rectify;
use luxfer::rng::Rng;
use luxfer::segment::strokes;
use luxfer::transfer::{self, Stage, Transfer};
use std::path::PathBuf;
use std::sync::Arc;

/// Standard deviation in photo pixels of the blur of the light mask, as in a transfer.
const EDGE_BLUR: f32 = 0.9;
/// Side of the part of the plane that the photo shows, in unwarped pixels.
const PLANE: usize = 480;
/// Standard deviations of the noise of a photo's pixel, relative to white.
const NOISE: [f32; 3] = [0.0, 0.05, 0.15];

/// Linear colour of the photographed lamps, and grey level of the plane around them.
const LAMP: [f32; 3] = [0.9, 0.8, 0.7];
const PLANE_LIGHT: f32 = 0.1;

/// Photographs every design at an angle, then unwarps and continues the photo.
pub fn perspective() {
    let mut table = Table::new(["design", "noise %"].into_iter().chain(STATISTICS).chain(["broken"]));
    let mut all = Score::default();
    for design in &DESIGNS {
        for noise in NOISE {
            // The far side of the plane appears half as long as the near side.
            let rows = [[1.25, 0.42, 20.0], [0.0, 1.2, 10.0], [0.0, 0.0012, 1.0]];
            let to_photo = DMat3::from_cols_array_2d(&rows).transpose();
            let from_photo = to_photo.inverse();
            let photo = Image::from_fn(640, 384, |x, y| {
                const SAMPLES: usize = 4;
                let lit = (0..SAMPLES * SAMPLES).filter(|i| {
                    let step = DVec2::new((i % SAMPLES) as f64 + 0.5, (i / SAMPLES) as f64 + 0.5) / SAMPLES as f64;
                    let p = from_photo * (DVec2::new(x as f64, y as f64) + step).extend(1.0);
                    design.is_lit(p.truncate() / p.z)
                });
                let share = lit.count() as f32 / (SAMPLES * SAMPLES) as f32;
                std::array::from_fn::<f32, 3, _>(|c| {
                    let mut rng = Rng::new(31, &[x as u64, y as u64, c as u64]);
                    // The sum of four uniform numbers is nearly normal, with a variance of a third.
                    let normal = (0..4).map(|_| rng.next_f32() - 0.5).sum::<f32>() * 3f32.sqrt();
                    (PLANE_LIGHT + (LAMP[c] - PLANE_LIGHT) * share + noise * normal).max(0.0)
                })
            });
            let photo = photo.expect("a photo");
            // Make a probability of light as a segmentation would give it: it rises with the smoothed brightness from
            // 0 at 0.3 to 1 at 0.7.
            let smooth = luxfer::image::pyramid::blur(&photo, 0.9, Monitor::default().job()).expect("a blur");
            let sure = Image::from_fn(640, 384, |x, y| [((smooth.rgb(x, y).x - 0.3) / 0.4).clamp(0.0, 1.0)]);
            let (exemplar, result) = continued(&photo, &sure.expect("a mask"), &Homography(to_photo));
            let score = Score::of(&result, design, design.filled_in(&exemplar), f64::from(luminance(Vec3::from(LAMP))));
            all = all.worse(score);
            let names = [design.name.to_string(), format!("{:.0}", 100.0 * noise)];
            table.row(names.into_iter().chain(score.columns()));
            if noise == NOISE[2] {
                save(&photo, &format!("emission_{}_photographed", design.name.replace([' ', '%'], "_")));
                save(&result.texture, &format!("emission_{}_from_photo", design.name.replace([' ', '%'], "_")));
            }
        }
    }
    table.print("800 x 720 from photos of 640 x 384 in perspective and noise, unwarped to 480 x 480");
    figure("emission.perspective.worst_stat", 100.0 * all.worst(), "%");
    figure("emission.perspective.lattice_rms", 100.0 * all.phase(), "% of the period");
    figure("emission.perspective.cut_lamps", all.broken as f64, "lamps");
}

fn continued(photo: &Image, light: &Image, to_photo: &Homography) -> (Exemplar, Emission) {
    let warp = |image: &Image| rectify::warp(image, to_photo, PLANE, PLANE, Monitor::default().job()).expect("a plane");
    let mut white = Image::new(photo.width, photo.height, 1).expect("a mask");
    white.data.fill(1.0);
    let exemplar = Exemplar { unwarped: warp(photo), light: warp(light), valid: warp(&white) };
    let input = Input { photo: Some((photo, (*to_photo).into())), ..exemplar.input() };
    let params = Params { width: 800, height: 720, ..Params::default() };
    let result = emission::run(&input, &params, Monitor::default().job()).expect("a texture");
    (exemplar, result)
}

fn data() -> PathBuf {
    std::env::var_os("LUXFER_TEST_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from)
}

/// Photos of the test data that are no exemplars, because their lights are no pattern in a plane, with the reason.
const NO_PATTERN: [(&str, &str); 7] = [
    ("chester_bar", "one skylight, cut off by the photo"),
    ("chester_chandelier", "chandeliers hang in the room, not in a plane"),
    ("peabody_gallery", "pendants hang in the room, four of them"),
    ("peabody_gallery2", "pendants hang in the room, three of them"),
    ("restaurant_chandeliers", "chandeliers hang in the room, not in a plane"),
    ("warehouse_b", "tubes hang between beams, at several heights"),
    ("yud_076", "coves hide the lamps: what is bright is the ceiling"),
];

/// Unwarps real photos, with the strokes of the tests, and continues them to twice their size.
pub fn real() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/strokes");
    let mut names: Vec<String> = std::fs::read_dir(&root)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_string()))
        .filter(|name| photo_of(name).is_some())
        .collect();
    names.sort();
    let mut table = table_of_real();
    let (mut lamps, mut errors) = (0, Vec::new());
    for name in &names {
        match unwarped(&root, name) {
            Ok((exemplar, photo, to_photo)) => {
                let input = Input { photo: Some((&photo, to_photo)), ..exemplar.input() };
                save(&exemplar.unwarped, &format!("emission_real_{name}_exemplar"));
                let result = row(&mut table, name, &input);
                lamps += result.exemplar_lamps;
                errors.push(result.error);
            }
            Err(reason) => println!("# {name}: {reason}"),
        }
    }
    table.print("Real photos, unwarped and continued to twice their size");
    figure("emission.real.whole_lamps", lamps as f64, "lamps shown completely, all photos");
    figure("emission.real.stated_error", 100.0 * median(&errors), "%, median");
    NO_PATTERN.iter().for_each(|(name, reason)| println!("# {name} is no exemplar: {reason}"));
}

/// Path of the photo with this name in the test data.
fn photo_of(name: &str) -> Option<PathBuf> {
    let files = [format!("photos/{name}.jpg"), format!("photos/hdri/{name}.png")];
    files.iter().map(|file| data().join(file)).find(|file| file.exists())
}

/// Returns the exemplar that a transfer unwarps from a photo of the test data, the photo, and the map from unwarped
/// pixels into the photo.
fn unwarped(root: &std::path::Path, name: &str) -> Result<(Exemplar, Image, PhotoMap), String> {
    let text = |e: luxfer::error::Error| e.message;
    let photo = io::load(&photo_of(name).ok_or("no photo")?, Encoding::Srgb).map_err(text)?;
    let drawn = std::fs::read_to_string(root.join(format!("{name}.txt"))).map_err(|e| e.to_string())?;
    let strokes = strokes::parse(&drawn, photo.width, photo.height).map_err(text)?;
    let input = transfer::Input { photo: Some(Arc::new(photo)), strokes, ..transfer::Input::default() };
    let mut transfer = Transfer { input, ..Transfer::default() };
    transfer.params.unwarp.max_side = 512;
    transfer.run(Stage::View, Stage::Unwarp, Monitor::default().job(), |_| {}).map_err(text)?;
    let results = &transfer.results;
    let (Some(lights), Some(plane)) = (&results.lights, &results.unwarped) else { return Err("no plane".into()) };
    let (width, height) = (plane.image.width, plane.image.height);
    let job = Monitor::default();
    // Blur the mask as a transfer does, so that the edge of a clipped lamp is not a staircase of whole pixels.
    let smooth = luxfer::image::pyramid::blur(&lights.confidence, EDGE_BLUR, job.job()).map_err(text)?;
    let light = rectify::warp_photo(&smooth, &plane.to_photo, width, height, job.job()).map_err(text)?;
    let photo = transfer.input.photo.as_deref().cloned().unwrap_or_default();
    let exemplar = Exemplar { unwarped: plane.image.clone(), light, valid: plane.valid.clone() };
    Ok((exemplar, photo, plane.to_photo))
}

/// Continues ceilings that were photographed straight from below and whose lamps are annotated.
pub fn ceilings() {
    let mut table = table_of_real();
    for name in ["library", "alma"] {
        let Some(exemplar) = ceiling(name) else {
            absent(&format!("emission.{name}.cut_lamps"), "the data is missing");
            continue;
        };
        let result = row(&mut table, name, &exemplar.input());
        save(&exemplar.unwarped, &format!("emission_{name}_exemplar"));
        save(&result.texture, &format!("emission_{name}"));
        let own = whole_areas(&exemplar.run(&Params {
            width: exemplar.light.width,
            height: exemplar.light.height,
            ..Params::default()
        }));
        let (least, most) = (own.iter().fold(f64::MAX, |a, b| a.min(*b)), own.iter().fold(0.0f64, |a, b| a.max(*b)));
        let broken = whole_areas(&result).into_iter().filter(|a| *a < 0.7 * least || *a > 1.3 * most).count();
        figure(&format!("emission.{name}.cut_lamps"), broken as f64, "lamps");
        figure(&format!("emission.{name}.worst_stat"), 100.0 * result.error, "%");
    }
    table.print("Ceilings seen straight from below, continued to twice their size");
}

fn ceiling(name: &str) -> Option<Exemplar> {
    let folder = data().join("photo_truth/ceiling_ortho");
    let unwarped = io::load(&folder.join(format!("{name}.jpg")), Encoding::Srgb).ok()?;
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).ok()?;
    let truth: serde_json::Value = serde_json::from_str(&text).ok()?;
    let number = |v: &serde_json::Value| v.as_f64().unwrap_or(f64::NAN);
    let (u0, v1, scale) = (number(&truth["u_range"][0]), number(&truth["v_range"][1]), number(&truth["px_per_unit"]));
    let lamps: Vec<[f64; 4]> = (truth["lights"]["items"].as_array()?.iter())
        .map(|l| [number(&l["u0"]) - u0, number(&l["u1"]) - u0, v1 - number(&l["v1"]), v1 - number(&l["v0"])])
        .map(|corners| corners.map(|c| c * scale))
        .collect();
    let is_lit = |x: f64, y: f64| lamps.iter().any(|&[x0, x1, y0, y1]| x0 <= x && x < x1 && y0 <= y && y < y1);
    let (width, height) = (unwarped.width, unwarped.height);
    let light = Image::from_fn(width, height, |x, y| [f32::from(is_lit(x as f64 + 0.5, y as f64 + 0.5))]).ok()?;
    let valid = Image::from_fn(width, height, |_, _| [1.0]).ok()?;
    Some(Exemplar { unwarped, light, valid })
}

fn table_of_real() -> Table {
    Table::new([
        "photo",
        "law",
        "regularity",
        "whole lamps",
        "lamps",
        "lit %",
        "area",
        "spacing",
        "pairs %",
        "stated error %",
        "sampling %",
    ])
}

/// Synthesises a texture of twice the width and height of its exemplar, and adds a row to the table that compares the
/// texture with the exemplar.
fn row(table: &mut Table, name: &str, input: &Input) -> Emission {
    let (width, height) = (2 * input.light.width, 2 * input.light.height);
    let params = Params { width, height, ..Params::default() };
    let result = emission::run(input, &params, Monitor::default().job()).expect("a texture");
    let own = emission::run(
        input,
        &Params { width: width / 2, height: height / 2, whole_lamps: true, ..params },
        Monitor::default().job(),
    )
    .expect("a texture");
    let [before, after] = result.statistics;
    let pair = |a: f64, b: f64, digits: usize| format!("{a:.digits$} → {b:.digits$}");
    table.row([
        name.to_string(),
        format!("{:?}", result.law).split('(').next().unwrap_or("").to_string(),
        format!("{:.2}", result.regularity),
        result.exemplar_lamps.to_string(),
        result.luminaires.len().to_string(),
        pair(100.0 * before.lit, 100.0 * after.lit, 2),
        pair(before.area, after.area, 0),
        pair(before.spacing, after.spacing, 0),
        pair_distance(&own, &result).map_or("-".into(), |d| format!("{:.0}", 100.0 * d)),
        format!("{:.1}", 100.0 * result.error),
        format!("{:.1}", 100.0 * result.sampling_error),
    ]);
    save(&result.texture, &format!("emission_real_{name}"));
    result
}

/// Difference between the distributions of distances between lamps in two textures; `None` if one has too few lamps.
pub fn pair_distance(of: &Emission, from: &Emission) -> Option<f64> {
    let centres = |e: &Emission| whole(e).iter().map(|l| l.centre).collect::<Vec<DVec2>>();
    let size = |e: &Emission| DVec2::new(e.mask.width as f64, e.mask.height as f64);
    let (a, b) = (centres(of), centres(from));
    pairs::distance(&Points { at: &a, size: size(of) }, &Points { at: &b, size: size(from) })
}

/// Lamps of a texture that do not touch its border.
pub fn whole(result: &Emission) -> Vec<&Luminaire> {
    let size = DVec2::new(result.mask.width as f64, result.mask.height as f64);
    let inside = |l: &&Luminaire| l.outline.iter().all(|p| p.min_element() > 0.0 && (size - *p).min_element() > 0.0);
    result.luminaires.iter().filter(inside).collect()
}

fn whole_areas(result: &Emission) -> Vec<f64> {
    whole(result).iter().map(|l| l.area).collect()
}
