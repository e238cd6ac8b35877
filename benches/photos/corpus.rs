//! Real photographs with strokes, from the corpus and from the test data, and the true lamps as far as they are known.

use super::masks::Mask;
use super::outline;
use super::shapes::{Lamps, Shape};
use super::truth::{Lamp, Photo, Truth};
use crate::harness::scenes::data;
use glam::{DMat3, DVec2};
use luxfer::geometry::{Homography, polygon};
use luxfer::image::Image;
use luxfer::image::io::{self, Encoding};
use luxfer::segment::strokes;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The quarter of the corpus that is set aside: nothing is tuned on it, and only `photos:held` runs it.
pub const HELD: [&str; 10] = [
    "cubicle_lines",
    "gym_hex",
    "junda_classroom_c4",
    "junda_theatre_l7",
    "library_phone_back",
    "library_phone_front",
    "lounge_troffers_a",
    "lounge_troffers_b",
    "north1800_corridor",
    "still_corridor_lowres",
];

/// Photos without a pattern of lamps: they show a single hanging lamp, a single small downlight, or single panels that
/// the border of the photo cuts.
const TRAPS: [&str; 4] = ["alma_glassroom", "alma_racks", "cmtc_discs", "foyer_sconces"];

/// Photos whose lamps lie on no plane, or shine away from the camera, according to the notes of the corpus ("no
/// plane", "no clean plane", "hanging" chandeliers, "uplight brighter than the lamps").
const WITHOUT_PLANE: [&str; 10] = [
    "aero_workshop",
    "chester_dining",
    "chester_patio",
    "civil_battens_a",
    "civil_battens_b",
    "hall_swags_lowres",
    "junda_tennis_s3",
    "north2408_indirect",
    "still_corridor_lowres",
    "still_stairs_lowres",
];

/// Distance in pixels between a lamp's polygon and the border of its photo, below which the border may cut the lamp.
/// [rounding]
const BORDER: f64 = 2.0;

/// Minimum thickness in photo pixels of a lamp that a run is expected to find. [convention: two pixels and their
/// blurred borders]
const MIN_THICKNESS: f64 = 4.0;

/// The name of a photo and the paths of its files.
pub struct Source {
    pub name: String,
    picture: PathBuf,
    strokes: PathBuf,
    truth: PathBuf,
}

/// Lists the photos of the test data that have strokes, in the order of their names.
pub fn sources() -> Result<Vec<Source>, String> {
    let corpus = data("corpus")?;
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/strokes");
    let mut all: Vec<Source> = named(&corpus, ".strokes.txt")?
        .into_iter()
        .map(|name| Source {
            picture: corpus.join(format!("{name}.jpg")),
            strokes: corpus.join(format!("{name}.strokes.txt")),
            truth: corpus.join(format!("{name}.json")),
            name,
        })
        .collect();
    for name in named(&own, ".txt")? {
        for (folder, kind) in [("photos", "jpg"), ("photos/hdri", "png")] {
            let Ok(picture) = data(&format!("{folder}/{name}.{kind}")) else { continue };
            let strokes = own.join(format!("{name}.txt"));
            all.push(Source { truth: picture.with_extension("json"), picture, strokes, name: name.clone() });
        }
    }
    all.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(all)
}

/// Names of the files in a folder that end in `suffix`, without the suffix.
fn named(folder: &Path, suffix: &str) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let name = |entry: std::fs::DirEntry| Some(entry.file_name().to_str()?.strip_suffix(suffix)?.to_string());
    Ok(entries.filter_map(|entry| name(entry.ok()?)).collect())
}

/// Reads a photo, its strokes and its true lamps.
pub fn load(source: &Source) -> Result<Photo, String> {
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()));
    let image = io::load(&source.picture, Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
    let strokes = strokes::parse(&read(&source.strokes)?, image.width, image.height).map_err(|e| e.to_string())?;
    let record: Value = serde_json::from_str(&read(&source.truth)?).map_err(|e| format!("{}: {e}", source.name))?;
    let truth = truth(&source.name, &record, &image);
    Ok(Photo { name: source.name.clone(), image: Arc::new(image), strokes, truth })
}

fn truth(name: &str, record: &Value, photo: &Image) -> Truth {
    let [width, height] = [photo.width, photo.height];
    let listed = items(&record["luminaires"]);
    let drawn_anew = redrawn(name);
    let is_redrawn = !drawn_anew.is_empty();
    let (mut lamps, centres) = if is_redrawn {
        (drawn_anew, Vec::new())
    } else {
        let centre_only = listed.iter().filter(|item| lamp(item).is_none());
        let centres = centre_only.filter_map(|item| point(&item["centre_px"])).collect();
        (distinct(listed.iter().filter_map(lamp).collect(), [width, height]), centres)
    };
    let mut lights = Mask::new(width, height);
    lamps.iter().flat_map(|lamp| &lamp.polygons).for_each(|polygon| lights.fill(polygon));
    // Add the lamps that were measured in the ceiling seen straight on; the list by hand leaves some of them out.
    let measured = items(&record["luminaires_from_ceiling"]);
    measured.iter().filter_map(|item| drawn_polygon(&item["px_polygon"])).for_each(|polygon| lights.fill(&polygon));

    let mut parts = Vec::new();
    for lamp in &mut lamps {
        let parts_of = |polygon: &Vec<DVec2>| {
            if is_redrawn { vec![pixels(polygon, [width, height])] } else { outline::parts(photo, polygon, &lights) }
        };
        let shown: Vec<Vec<u32>> = lamp.polygons.iter().flat_map(parts_of).collect();
        lamp.pixels = shown.concat();
        parts.extend(shown);
    }
    let unlisted = unlisted(name, [width, height]);
    let to_photo = matrix(&record["H_image_from_ceiling"]);
    let layout = to_photo.and_then(|map| {
        let by_list = || if is_redrawn { None } else { listed_layout(&listed) };
        let known = measured_layout(record, &measured).or_else(by_list);
        known.or_else(|| shown_layout(&parts, &map, photo))
    });
    lamps.retain(|lamp| lamp.polygons.iter().any(|polygon| thickness(polygon) >= MIN_THICKNESS));
    Truth {
        lights,
        unlisted,
        plane: None,
        either: None,
        lamps,
        centres,
        layout,
        distance: None,
        to_photo,
        is_trap: TRAPS.contains(&name),
        may_decline: WITHOUT_PLANE.contains(&name),
    }
}

/// Removes lamps that are listed twice. Several seeds on one lamp have grown regions that contain each other; the
/// largest region is kept.
fn distinct(mut lamps: Vec<Lamp>, [width, height]: [usize; 2]) -> Vec<Lamp> {
    let drawn = |lamp: &Lamp| {
        let mut mask = Mask::new(width, height);
        lamp.polygons.iter().for_each(|polygon| mask.fill(polygon));
        mask
    };
    lamps.sort_by_key(|lamp| std::cmp::Reverse(drawn(lamp).count()));
    let mut kept: Vec<(Lamp, Mask)> = Vec::new();
    for lamp in lamps {
        let mask = drawn(&lamp);
        let is_within = |(_, other): &(Lamp, Mask)| 2 * mask.common(other) > mask.count();
        if !kept.iter().any(is_within) {
            kept.push((lamp, mask));
        }
    }
    kept.into_iter().map(|(lamp, _)| lamp).collect()
}

/// Shorter side in pixels of the smallest rectangle around a polygon of pixels.
fn thickness(polygon: &[DVec2]) -> f64 {
    Shape::of(polygon, None).map_or(0.0, |shape| shape.sides.y + 1.0)
}

/// The numbers in the lines of a list that begin with `name`.
fn numbers_of(list: &str, name: &str) -> Vec<Vec<f64>> {
    let lines = list.lines().map(str::split_whitespace);
    let of_name = lines.filter_map(|mut words| (words.next() == Some(name)).then_some(words));
    let number = |word: &str| word.parse().unwrap_or_else(|_| panic!("{name}: {word} is not a number"));
    of_name.map(|words| words.map(number).collect()).collect()
}

/// The lamps of a photo that are drawn anew (`redrawn.txt`); empty for most photos.
fn redrawn(name: &str) -> Vec<Lamp> {
    let corners = |numbers: &Vec<f64>| {
        assert!(numbers.len().is_multiple_of(2), "{name}: a corner of redrawn.txt has no y");
        numbers.chunks_exact(2).map(|c| DVec2::new(c[0], c[1])).collect()
    };
    let polygons: Vec<Vec<DVec2>> = numbers_of(include_str!("redrawn.txt"), name).iter().map(corners).collect();
    let lamp = |polygon: Vec<DVec2>| {
        let centre = polygon.iter().sum::<DVec2>() / polygon.len() as f64;
        Lamp { centre, polygons: vec![polygon], pixels: Vec::new() }
    };
    polygons.into_iter().map(lamp).collect()
}

/// The pixels inside a polygon, as `y * width + x`.
fn pixels(polygon: &[DVec2], [width, height]: [usize; 2]) -> Vec<u32> {
    let mut mask = Mask::new(width, height);
    mask.fill(polygon);
    (0..mask.on.len()).filter(|&i| mask.on[i]).map(|i| i as u32).collect()
}

/// Mask of the rectangles with lamps that the lists leave out (`unlisted.txt`); `None` if the photo has none.
fn unlisted(name: &str, [width, height]: [usize; 2]) -> Option<Mask> {
    let mut mask = Mask::new(width, height);
    for numbers in numbers_of(include_str!("unlisted.txt"), name) {
        if let &[x0, y0, x1, y1] = &numbers[..] {
            mask.fill(&[DVec2::new(x0, y0), DVec2::new(x1, y0), DVec2::new(x1, y1), DVec2::new(x0, y1)]);
        }
    }
    (mask.count() > 0).then_some(mask)
}

/// The lamps as measured in the ceiling seen straight on. Each lamp has its own position, but the median size of all
/// lamps of that ceiling: the size of a single lamp is less certain, because the stitching of the panorama and the
/// threshold make it smaller by up to a half.
fn measured_layout(record: &Value, measured: &[Value]) -> Option<Lamps> {
    let all = &record["luminaires_from_ceiling"];
    let half = point(&all["size_uv_median"])? / 2.0;
    let corners = measured.iter().filter_map(|item| plane_corners(&item["ceiling_uv"]));
    let whole: Vec<Shape> = corners
        .filter_map(|corners| {
            let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
            let signs = [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
            Shape::of(&signs.map(|sign| middle + sign * half), None)
        })
        .collect();
    (!whole.is_empty()).then(|| Lamps { whole, lit: lit(all), ..Lamps::default() })
}

/// The lamps as the list by hand gives them in their plane.
fn listed_layout(listed: &[Value]) -> Option<Lamps> {
    let corners = listed.iter().filter_map(|item| plane_corners(&item["ceiling_uv"]));
    let whole: Vec<Shape> = corners.filter_map(|corners| Shape::of(&corners, None)).collect();
    (!whole.is_empty()).then(|| Lamps { whole, ..Lamps::default() }.with_bars().with_kinds())
}

/// The lamps that the photo shows whole, from their pixels mapped into the plane.
fn shown_layout(parts: &[Vec<u32>], to_photo: &Homography, photo: &Image) -> Option<Lamps> {
    let size = DVec2::new(photo.width as f64, photo.height as f64);
    let from_photo = to_photo.inverse();
    let shape = |part: &Vec<u32>| {
        let pixels: Vec<[DVec2; 4]> = part.iter().map(|&pixel| outline::corners(pixel, photo.width)).collect();
        let is_whole = |p: &DVec2| p.min_element() > BORDER && (size - *p).min_element() > BORDER;
        if !pixels.iter().flatten().all(is_whole) {
            return None;
        }
        let pixels: Vec<[DVec2; 4]> = pixels.into_iter().map(|corners| corners.map(|p| from_photo.apply(p))).collect();
        let area: f64 = pixels.iter().map(|corners| polygon::area(corners).abs()).sum();
        let corners = pixels.concat();
        corners.iter().all(|p| p.is_finite()).then(|| Shape::of(&corners, Some(area))).flatten()
    };
    let whole: Vec<Shape> = parts.iter().filter_map(shape).collect();
    (!whole.is_empty()).then(|| Lamps { whole, ..Lamps::default() })
}

/// Lit share of the lattice: the area of a lamp divided by the area of a cell. It serves as the lower and as the upper
/// bound of the lit share.
fn lit(measured: &Value) -> Option<[f64; 2]> {
    let number = |value: &Value| value.as_f64();
    let size = number(&measured["size_uv_median"][0])? * number(&measured["size_uv_median"][1])?;
    let cell = number(&measured["gap_u_median"])? * number(&measured["gap_v_median"])?;
    Some([size / cell; 2])
}

fn items(list: &Value) -> Vec<Value> {
    list["items"].as_array().cloned().unwrap_or_default()
}

/// Reads a lamp of the list by hand; `None` if only its centre is known.
fn lamp(item: &Value) -> Option<Lamp> {
    let drawn = item["polygons"].as_array().into_iter().flatten();
    let polygons: Vec<Vec<DVec2>> =
        drawn.chain([&item["px_polygon_clipped_to_image"]]).filter_map(drawn_polygon).collect();
    let first = polygons.first()?;
    let middle = first.iter().sum::<DVec2>() / first.len() as f64;
    Some(Lamp { centre: point(&item["centre_px"]).unwrap_or(middle), polygons, pixels: Vec::new() })
}

/// Corners in the plane: from a rectangle `[u0, u1, v0, v1]`, or as listed one by one.
fn plane_corners(value: &Value) -> Option<Vec<DVec2>> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    match numbers.as_deref() {
        Some(&[u0, u1, v0, v1]) => {
            Some(vec![DVec2::new(u0, v0), DVec2::new(u1, v0), DVec2::new(u1, v1), DVec2::new(u0, v1)])
        }
        _ => drawn_polygon(value),
    }
}

fn drawn_polygon(value: &Value) -> Option<Vec<DVec2>> {
    let corners: Option<Vec<DVec2>> = value.as_array()?.iter().map(point).collect();
    corners.filter(|corners| corners.len() > 2)
}

fn point(value: &Value) -> Option<DVec2> {
    Some(DVec2::new(value[0].as_f64()?, value[1].as_f64()?))
}

fn matrix(value: &Value) -> Option<Homography> {
    let numbers: Option<Vec<f64>> =
        value.as_array()?.iter().filter_map(|row| row.as_array()).flatten().map(Value::as_f64).collect();
    let numbers: [f64; 9] = numbers?.try_into().ok()?;
    Some(Homography(DMat3::from_cols_array(&numbers).transpose()))
}
