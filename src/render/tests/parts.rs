//! Tests of renders in parts: any partition gives the same image, and parts that do not belong together are refused.

use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::render::parts::{self, File, Part};
use crate::rng::Rng;
use std::path::PathBuf;

/// A temporary folder, which is deleted at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("luxfer-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Renders a part, saves it to a file, and opens the file.
    fn part(&self, world: &World, params: &Params, part: &Part) -> File {
        let path = self.0.join(format!("{}-{}-{}-{}.exr", part.x, part.y, part.first, part.samples));
        parts::run(world, &viewer(), params, part, Monitor::default().job()).unwrap().save(&path).unwrap();
        File::open(&path).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn merged(world: &World, params: &Params, files: &[File]) -> Result<Film> {
    parts::merge(world, &viewer(), params, files, Monitor::default().job())
}

/// Parameters with light path expressions, all surface attributes, and a preview.
fn with_layers() -> Params {
    let mut outputs = Outputs { aovs: Aov::ALL.to_vec(), ..Outputs::default() };
    for (name, expression) in [("direct", "LDE"), ("rest", "L.*DDE"), ("glass", "L.*S.*E")] {
        outputs.add(name, expression).unwrap();
    }
    Params { width: 37, height: 21, samples: 24, preview: 1.0, outputs, ..Params::default() }
}

fn assert_same(one: &Film, other: &Film) {
    assert!(one.beauty == other.beauty && one.variance == other.variance && one.paths == other.paths);
    assert_eq!((one.samples, one.error, one.discarded), (other.samples, other.error, other.discarded));
    assert_eq!(one.layers.len(), other.layers.len());
    for (a, b) in one.layers.iter().zip(&other.layers) {
        assert!(a.name == b.name && a.image == b.image, "{}", a.name);
    }
    assert_eq!(one.preview.as_ref().map(|p| &p.image), other.preview.as_ref().map(|p| &p.image));
}

#[test]
fn any_parts_in_any_order_give_the_same_bits() {
    let (world, params, folder) = (world(everything()), with_layers(), Folder::new("same"));
    let whole = Part::whole(&params);
    let rendered = parts::run(&world, &viewer(), &params, &whole, Monitor::default().job()).unwrap();
    let whole = merged(&world, &params, &[folder.part(&world, &params, &whole)]).unwrap();
    assert_same(&rendered.film, &whole);
    assert_eq!(whole.samples, 24);
    assert!(whole.layers.iter().all(|l| l.image.data.iter().all(|v| !v.is_nan())) && whole.error > 0.0);
    let mut rng = Rng::new(9, &[]);
    for split in [[2, 1, 1], [1, 1, 3], [3, 2, 5], [1, 7, 2]] {
        let count = split.iter().product::<u32>();
        let all: Vec<Part> = (0..count).map(|i| Part::split(&params, split, i).unwrap()).collect();
        let mut files: Vec<File> = all.iter().map(|p| folder.part(&world, &params, p)).collect();
        for i in (1..files.len()).rev() {
            files.swap(i, rng.below(i + 1));
        }
        assert_same(&whole, &merged(&world, &params, &files).unwrap());
    }
    // Test an irregular partition with hardly any borders at multiples of 8.
    let odd = [
        Part { x: 0, y: 0, width: 5, height: 21, first: 0, samples: 24 },
        Part { x: 5, y: 0, width: 32, height: 3, first: 0, samples: 1 },
        Part { x: 5, y: 3, width: 32, height: 18, first: 0, samples: 1 },
        Part { x: 5, y: 0, width: 32, height: 21, first: 1, samples: 9 },
        Part { x: 5, y: 0, width: 32, height: 21, first: 10, samples: 14 },
    ];
    let files: Vec<File> = odd.iter().map(|p| folder.part(&world, &params, p)).collect();
    assert_same(&whole, &merged(&world, &params, &files).unwrap());
}

#[test]
fn parts_are_the_same_on_any_number_of_threads_and_show_themselves() {
    let (world, params) = (world(everything()), with_layers());
    let part = Part { x: 3, y: 9, width: 17, height: 9, first: 6, samples: 10 };
    let run = |threads| {
        let pool = Pool::new(threads).unwrap();
        pool.run(|| parts::run(&world, &viewer(), &params, &part, Monitor::default().job())).unwrap().film
    };
    let film = run(1);
    assert_same(&film, &run(3));
    assert_eq!((film.beauty.width, film.beauty.height, film.samples), (17, 9, 10));
    // The image of a part is a crop of the whole image, up to noise.
    let whole = render(&world, &viewer(), &Params { samples: 256, ..params });
    let (mut difference, mut sum) = (0.0, 0.0);
    for y in 0..9 {
        for x in 0..17 {
            let (a, b) = (film.beauty.rgb(x, y), whole.beauty.rgb(3 + x, 9 + y));
            difference += (a - b).element_sum();
            sum += b.element_sum();
        }
    }
    assert!((difference / sum).abs() < 0.1, "{difference} of {sum}");
}

#[test]
fn a_merged_image_has_the_mean_and_the_error_of_one_rendered_at_once() {
    let (world, params) = (world(everything()), Params { width: 24, height: 16, samples: 64, ..Params::default() });
    let (mut sums, mut squares, mut errors) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    // Most of the squared error comes from a few renders with rare bright paths. So a precise mean of the squared error
    // needs many renders.
    let count = 128;
    for seed in 0..count {
        let params = Params { seed: 100 + seed, ..params.clone() };
        let part = Part::whole(&params);
        let rendered = parts::run(&world, &viewer(), &params, &part, Monitor::default().job()).unwrap();
        for (i, film) in [rendered.film, render(&world, &viewer(), &params)].iter().enumerate() {
            let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / film.beauty.data.len() as f64;
            (sums[i], squares[i], errors[i]) =
                (sums[i] + mean, squares[i] + mean * mean, errors[i] + film.error.powi(2));
        }
    }
    let n = count as f64;
    let [a, b] = [0, 1].map(|i| (sums[i] / n, (squares[i] / n - (sums[i] / n).powi(2)) / (n - 1.0)));
    assert!((a.0 - b.0).abs() < 4.0 * (a.1 + b.1).sqrt(), "{a:?} {b:?}");
    // A render in parts and an ordinary render also state about equal mean squared errors.
    assert!((errors[0] / errors[1] - 1.0).abs() < 0.1, "{errors:?}");
}

#[test]
fn parts_that_do_not_belong_together_are_refused_by_name() {
    let (scene, folder) = (everything(), Folder::new("refused"));
    let world = world(scene.clone());
    let params = Params { width: 16, height: 12, samples: 8, ..Params::default() };
    let half = |index| Part::split(&params, [2, 1, 1], index).unwrap();
    let files = [folder.part(&world, &params, &half(0)), folder.part(&world, &params, &half(1))];
    assert!(merged(&world, &params, &files).is_ok());
    let refused = |world: &World, params: &Params, files: &[File], word: &str| {
        let error = merged(world, params, files).unwrap_err();
        assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains(word), "{word}: {}", error.message);
    };
    // Parts of another render are refused.
    let with = |change: &dyn Fn(&mut Params)| {
        let mut params = params.clone();
        change(&mut params);
        params
    };
    refused(&world, &with(&|p| p.seed = 7), &files, "seed");
    refused(&world, &with(&|p| p.samples = 9), &files, "samples");
    refused(&world, &with(&|p| p.height = 13), &files, "16 x 12");
    refused(&world, &with(&|p| p.preview = 1.0), &files, "layers");
    refused(&world, &with(&|p| p.outputs.add("direct", "LDE").unwrap()), &files, "layers");
    let mut other = scene;
    other.materials[0].roughness = 0.5;
    refused(&super::world(other), &params, &files, "scene");
    let aside = Camera { fov_y: 1.0, ..viewer() };
    let error = parts::merge(&world, &aside, &params, &files, Monitor::default().job()).unwrap_err();
    assert!(error.message.contains("camera"), "{}", error.message);
    // Overlaps and holes are refused.
    refused(&world, &params, &[files[0].clone(), files[1].clone(), files[0].clone()], "overlap");
    refused(&world, &params, &files[1..], "paths 0 to 7 of the 8 x 12 pixels at (0, 0)");
    refused(&world, &params, &[], "16 x 12 pixels at (0, 0)");
    let late = folder.part(&world, &params, &Part { first: 3, samples: 5, ..half(0) });
    refused(&world, &params, &[late, files[1].clone()], "paths 0 to 2 of the 8 x 12 pixels");
    // Parameters without a fixed number of paths are refused, and so are invalid parts.
    let run = |params: &Params, part: &Part| {
        parts::run(&world, &viewer(), params, part, Monitor::default().job()).err().unwrap().message
    };
    assert!(run(&with(&|p| p.target_error = 0.1), &half(0)).contains("target_error"));
    assert!(run(&with(&|p| p.pixel_error = 0.1), &half(0)).contains("pixel_error"));
    assert!(run(&with(&|p| p.relative_error = 0.1), &half(0)).contains("relative_error"));
    assert!(run(&with(&|p| p.time_budget_ms = 5), &half(0)).contains("time_budget_ms"));
    for part in [
        Part { width: 0, ..half(0) },
        Part { x: 16, width: 1, ..half(0) },
        Part { y: usize::MAX, ..half(0) },
        Part { first: 8, samples: 1, ..half(0) },
        Part { first: 2, samples: u32::MAX, ..half(0) },
    ] {
        assert!(run(&params, &part).contains("the part is"), "{part}");
    }
    for (split, index) in [([0, 1, 1], 0), ([17, 1, 1], 0), ([1, 1, 9], 0), ([2, 2, 2], 8)] {
        assert!(Part::split(&params, split, index).is_err(), "{split:?} {index}");
    }
}

#[test]
fn damaged_files_are_errors_and_a_cancel_leaves_none() {
    let (world, folder) = (world(everything()), Folder::new("damaged"));
    let params = Params { width: 16, height: 12, samples: 8, ..Params::default() };
    let part = Part::whole(&params);
    let file = folder.part(&world, &params, &part);
    let path = folder.0.join("0-0-0-8.exr");
    let bytes = std::fs::read(&path).unwrap();
    let mut rng = Rng::new(3, &[]);
    for round in 0..120 {
        let mut damaged = bytes.clone();
        if round % 3 == 0 {
            damaged.truncate(rng.below(bytes.len()));
        } else {
            for _ in 0..=rng.below(4) {
                // In every third round, corrupt the first 2000 bytes alone, which hold the header.
                let at = rng.below(if round % 3 == 1 { 2000 } else { bytes.len() });
                damaged[at] = rng.next_u32() as u8;
            }
        }
        std::fs::write(&path, &damaged).unwrap();
        // Damage may go unnoticed, for example in pixel values. Nothing may panic, and an error of the merge must be
        // `Format` or `InvalidArgument`.
        if let Ok(file) = File::open(&path) {
            let _ = merged(&world, &params, &[file]);
        }
        if let Err(error) = merged(&world, &params, std::slice::from_ref(&file)) {
            assert!(matches!(error.kind, ErrorKind::Format | ErrorKind::InvalidArgument), "{}", error.message);
        }
    }
    assert_eq!(File::open(&folder.0.join("none.exr")).unwrap_err().kind, ErrorKind::Io);
    std::fs::write(&path, crate::image::io::encode_png(&render(&world, &viewer(), &params).beauty, 1.0).unwrap())
        .unwrap();
    assert_eq!(File::open(&path).unwrap_err().kind, ErrorKind::Format);

    let monitor = Monitor::default();
    monitor.cancel();
    let result = parts::run(&world, &viewer(), &params, &part, monitor.job());
    assert_eq!(result.err().unwrap(), Error::cancelled());
}

#[test]
fn a_split_is_even_and_leaves_nothing_out() {
    for (width, height, samples) in [(64, 48, 16), (37, 21, 5), (1, 1, 1), (1920, 1080, 256)] {
        let params = Params { width, height, samples, ..Params::default() };
        for split in [[1, 1, 1], [3, 1, 2], [7, 5, 3]] {
            let split = [split[0].min(width as u32), split[1].min(height as u32), split[2].min(samples)];
            let mut total = 0;
            for index in 0..split.iter().product() {
                let part = Part::split(&params, split, index).unwrap();
                let volume = part.width * part.height * part.samples as usize;
                assert!(volume > 0 && part.x + part.width <= width && part.y + part.height <= height);
                let even = (width * height) as f64 * f64::from(samples) / f64::from(split.iter().product::<u32>());
                assert!(width < 100 || (volume as f64 / even - 1.0).abs() < 0.1, "{part} {split:?}");
                total += volume;
            }
            assert_eq!(total, width * height * samples as usize);
        }
    }
}
