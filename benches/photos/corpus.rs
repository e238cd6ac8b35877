//! Real photographs with strokes: the corpus and the photos of the test data, and what is known of their lamps.

use super::masks::Mask;
use super::shapes::{Lamps, Shape};
use super::truth::{Lamp, Photo, Truth};
use crate::harness::scenes::data;
use glam::{DMat3, DVec2};
use luxfer::geometry::Homography;
use luxfer::image::io::{self, Encoding};
use luxfer::segment::strokes;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The quarter of the corpus that nothing is tuned on: only `photos:held` runs it.
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

/// Photos that hold no pattern of lamps: a single hanging lamp, a single small downlight.
const TRAPS: [&str; 2] = ["cmtc_discs", "foyer_sconces"];

/// Pixels between a lamp's polygon and the border of its photo below which the border may cut the lamp. [rounding]
const BORDER: f64 = 2.0;

/// Where the files of a photo are.
pub struct Source {
    pub name: String,
    picture: PathBuf,
    strokes: PathBuf,
    truth: PathBuf,
}

/// The photos of the test data that have strokes, in the order of their names.
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

/// Names of the files of a folder that end in a suffix, without it.
fn named(folder: &Path, suffix: &str) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let name = |entry: std::fs::DirEntry| Some(entry.file_name().to_str()?.strip_suffix(suffix)?.to_string());
    Ok(entries.filter_map(|entry| name(entry.ok()?)).collect())
}

/// Reads a photo, its strokes and its truth.
pub fn load(source: &Source) -> Result<Photo, String> {
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()));
    let image = io::load(&source.picture, Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
    let strokes = strokes::parse(&read(&source.strokes)?, image.width, image.height).map_err(|e| e.to_string())?;
    let record: Value = serde_json::from_str(&read(&source.truth)?).map_err(|e| format!("{}: {e}", source.name))?;
    let truth = truth(&source.name, &record, [image.width, image.height]);
    Ok(Photo { name: source.name.clone(), image: Arc::new(image), strokes, truth })
}

fn truth(name: &str, record: &Value, [width, height]: [usize; 2]) -> Truth {
    let listed = items(&record["luminaires"]);
    let lamps: Vec<Lamp> = listed.iter().filter_map(lamp).collect();
    let mut lights = Mask::new(width, height);
    lamps.iter().flat_map(|lamp| &lamp.polygons).for_each(|polygon| lights.fill(polygon));
    // Lamps measured in the ceiling seen straight on, some of which the list by hand leaves out.
    let measured = items(&record["luminaires_from_ceiling"]);
    measured.iter().filter_map(|item| polygon(&item["px_polygon"])).for_each(|polygon| lights.fill(&polygon));

    let unlisted = unlisted(name, [width, height]);
    let to_photo = matrix(&record["H_image_from_ceiling"]);
    let size = DVec2::new(width as f64, height as f64);
    let layout = to_photo.and_then(|map| layout(record, &listed, &measured, &lamps, &map, size));
    Truth { lights, unlisted, plane: None, either: None, lamps, layout, to_photo, is_trap: TRAPS.contains(&name) }
}

/// Lamps that the lists leave out.
fn unlisted(name: &str, [width, height]: [usize; 2]) -> Option<Mask> {
    let mut mask = Mask::new(width, height);
    for line in include_str!("unlisted.txt").lines() {
        let mut words = line.split_whitespace();
        let is_wanted = words.next() == Some(name);
        let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        if let (true, &[x0, y0, x1, y1]) = (is_wanted, &numbers[..]) {
            mask.fill(&[DVec2::new(x0, y0), DVec2::new(x1, y0), DVec2::new(x1, y1), DVec2::new(x0, y1)]);
        }
    }
    (mask.count() > 0).then_some(mask)
}

/// The lamps in their plane: as measured there, else as the photo shows the whole ones.
fn layout(
    record: &Value,
    listed: &[Value],
    measured: &[Value],
    lamps: &[Lamp],
    to_photo: &Homography,
    size: DVec2,
) -> Option<Lamps> {
    let on_plane = |items: &[Value]| -> Vec<Shape> {
        let corners = items.iter().filter_map(|item| plane_corners(&item["ceiling_uv"]));
        corners.filter_map(|corners| Shape::of(&corners, None)).collect()
    };
    let exact = [on_plane(measured), on_plane(listed)].concat();
    if !exact.is_empty() {
        return Some(Lamps {
            whole: exact,
            kinds: Vec::new(),
            cut: Vec::new(),
            others: Vec::new(),
            lit: lit(&record["luminaires_from_ceiling"]),
        });
    }
    let from_photo = to_photo.inverse();
    let is_whole = |p: &DVec2| p.min_element() > BORDER && (size - *p).min_element() > BORDER;
    let whole = lamps.iter().flat_map(|lamp| &lamp.polygons).filter(|polygon| polygon.iter().all(is_whole));
    let shape = |polygon: &Vec<DVec2>| {
        let corners: Vec<DVec2> = polygon.iter().map(|p| from_photo.apply(*p)).collect();
        corners.iter().all(|p| p.is_finite()).then(|| Shape::of(&corners, None)).flatten()
    };
    let whole: Vec<Shape> = whole.filter_map(shape).collect();
    (!whole.is_empty()).then(|| Lamps { whole, kinds: Vec::new(), cut: Vec::new(), others: Vec::new(), lit: None })
}

/// The share of a lattice that is lit.
fn lit(measured: &Value) -> Option<[f64; 2]> {
    let number = |value: &Value| value.as_f64();
    let size = number(&measured["size_uv_median"][0])? * number(&measured["size_uv_median"][1])?;
    let cell = number(&measured["gap_u_median"])? * number(&measured["gap_v_median"])?;
    Some([size / cell; 2])
}

fn items(list: &Value) -> Vec<Value> {
    list["items"].as_array().cloned().unwrap_or_default()
}

/// A lamp of the list by hand, unless only its centre is known.
fn lamp(item: &Value) -> Option<Lamp> {
    let drawn = item["polygons"].as_array().into_iter().flatten();
    let polygons: Vec<Vec<DVec2>> = drawn.chain([&item["px_polygon_clipped_to_image"]]).filter_map(polygon).collect();
    let first = polygons.first()?;
    let middle = first.iter().sum::<DVec2>() / first.len() as f64;
    Some(Lamp { centre: point(&item["centre_px"]).unwrap_or(middle), polygons, pixels: Vec::new() })
}

/// The corners of a rectangle `[u0, u1, v0, v1]`, or the corners themselves.
fn plane_corners(value: &Value) -> Option<Vec<DVec2>> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    match numbers.as_deref() {
        Some(&[u0, u1, v0, v1]) => {
            Some(vec![DVec2::new(u0, v0), DVec2::new(u1, v0), DVec2::new(u1, v1), DVec2::new(u0, v1)])
        }
        _ => polygon(value),
    }
}

fn polygon(value: &Value) -> Option<Vec<DVec2>> {
    let corners: Option<Vec<DVec2>> = value.as_array()?.iter().map(point).collect();
    corners.filter(|corners| corners.len() > 2)
}

fn point(value: &Value) -> Option<DVec2> {
    Some(DVec2::new(value[0].as_f64()?, value[1].as_f64()?))
}

fn matrix(value: &Value) -> Option<Homography> {
    let numbers: Option<Vec<f64>> =
        value.as_array()?.iter().flat_map(|row| row.as_array()).flatten().map(Value::as_f64).collect();
    let numbers: [f64; 9] = numbers?.try_into().ok()?;
    Some(Homography(DMat3::from_cols_array(&numbers).transpose()))
}
