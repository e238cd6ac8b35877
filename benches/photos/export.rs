//! Writes labelled generated photos, from which a classifier can learn.

use super::made::{LEARNING, Made, made};
use super::shapes::Shape;
use serde_json::{Value, json};
use std::path::Path;

const PHOTOS: usize = 1000;

/// Writes photos of the learning seeds into a folder: `export FOLDER [COUNT [FIRST]]`.
///
/// For each seed it writes `SEED.jpg`, `SEED.labels.png` (red: class; green + 256 × blue: number of the lamp, 65535
/// for none), `SEED.strokes.txt`, `SEED.ten.txt` (ten strokes) and `SEED.json`: the camera, the plane, the pattern,
/// and each lamp with its kind and its outline.
pub fn export(words: &[String]) {
    let Some(folder) = words.first() else { return println!("# name a folder: photos:export:FOLDER") };
    let number = |i: usize| words.get(i).and_then(|word| word.parse::<u64>().ok());
    let (count, first) = (number(1).unwrap_or(PHOTOS as u64), number(2).unwrap_or(LEARNING));
    for seed in first..first + count {
        if let Err(reason) = write(Path::new(folder), seed, &made(seed)) {
            return println!("# {folder}: {reason}");
        }
    }
    println!("# {count} photos are in {folder}");
}

fn write(folder: &Path, seed: u64, made: &Made) -> Result<(), String> {
    let text = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(text)?;
    let path = |kind: &str| folder.join(format!("{seed}.{kind}"));
    std::fs::write(path("jpg"), &made.file).map_err(text)?;
    made.labels().save(path("labels.png")).map_err(|e| e.to_string())?;
    std::fs::write(path("strokes.txt"), &made.strokes).map_err(text)?;
    std::fs::write(path("ten.txt"), &made.ten).map_err(text)?;
    let record = serde_json::to_string_pretty(&record(seed, made)).map_err(|e| e.to_string())?;
    std::fs::write(path("json"), record).map_err(text)
}

fn record(seed: u64, made: &Made) -> Value {
    let (room, shot) = (&made.room, &made.shot);
    let camera = &shot.camera;
    let to_photo = made.photo.truth.to_photo.map(|map| map.0.transpose().to_cols_array());
    let lamp = |(number, fitting): (usize, &super::ceiling::Fitting)| {
        let outline: Vec<[f32; 2]> =
            fitting.form.outline(0.0).iter().map(|p| (fitting.centre + *p).to_array()).collect();
        json!({"number": number, "kind": fitting.kind, "lit": fitting.is_lit, "drop": fitting.drop,
               "centre": fitting.centre.to_array(), "outline": outline, "filled": fitting.form.filled()})
    };
    let layout = made.photo.truth.layout.as_ref();
    json!({
        "seed": seed,
        "pattern": room.ceiling.pattern,
        "size_m": room.size.to_array(),
        "camera": {
            "position_m": camera.position.to_array(),
            "forward": camera.forward.to_array(),
            "up": camera.up.to_array(),
            "focal_px": shot.focal_pixels(),
            "focal_mm": shot.focal,
            "distance_m": shot.distance,
            "photo_from_plane": to_photo,
            "conventions": "metres, y up; plane: x and z of the room over distance_m; pixels from the top left corner",
        },
        "classes": {"1": "ceiling", "2": "lamp", "3": "wall", "4": "floor", "5": "window", "6": "thing", "7": "hanging"},
        "lamps": room.ceiling.fittings.iter().enumerate().map(lamp).collect::<Vec<_>>(),
        "whole_lamps": layout.map(|lamps| lamps.whole.iter().map(|s: &Shape| json!({"centre": s.centre.to_array(), "sides": s.sides.to_array(), "area": s.area})).collect::<Vec<_>>()),
        "lit_share": layout.and_then(|lamps| lamps.lit),
    })
}
