//! Benchmark of emissive textures: the quality of continued lamp patterns, compared with patch quilting alone and with
//! another program, and their time and memory.
//!
//! The designs have known statistics. An exemplar of each design is cut from a larger ceiling and continued to a
//! texture, whose statistics are compared with those of the design. `cargo bench --bench emission -- SECTION …` runs
//! some sections only.

mod harness;
#[path = "emission/photos.rs"]
mod photos;
#[path = "emission/recovery.rs"]
mod recovery;
#[path = "emission/score.rs"]
mod score;
#[path = "emission/tiles.rs"]
mod tiles;

use glam::{DMat2, DVec2};
use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, interleaved, time};
use luxfer::emission::{self, Emission, Input, Params};
use luxfer::exec::Pool;
use luxfer::image::{Image, io};
use luxfer::job::Monitor;
use luxfer::rng::Rng;
use score::{STATISTICS, Score};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;

const ROUNDS: usize = 5;
/// Sides of patches in working pixels; the sizes of Fig. 11 of the paper.
const BLOCKS: [usize; 8] = [25, 50, 75, 100, 125, 150, 175, 200];

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wants = |section: &str| chosen.is_empty() || chosen.iter().any(|c| c == section);
    let pool = Pool::new(2).expect("two threads");
    // The section that measures peak memory runs first, because a process keeps some of the memory that it has once
    // used.
    let sections: [(&str, fn()); 8] = [
        ("tiles", tiles::tiles),
        ("patterns", patterns),
        ("perspective", photos::perspective),
        ("ceilings", photos::ceilings),
        ("real", photos::real),
        ("recovery", recovery::recovery),
        ("seconds", seconds),
        ("knobs", knobs),
    ];
    for (name, section) in sections {
        if wants(name) {
            pool.run(section);
        }
    }
    if wants("peer")
        && let Err(reason) = peer(&pool)
    {
        absent("emission.vs_texture_synthesis", &reason);
    }
}

/// A design: a ceiling with a lamp at the sites of a lattice, of one or two kinds, and possibly with some sites left
/// empty.
struct Design {
    name: &'static str,
    periods: [DVec2; 2],
    /// Whether a point belongs to the lamp of a lattice site. Takes the point relative to the site in pixels, and the
    /// indices of the site.
    lamp: fn(DVec2, [i64; 2]) -> bool,
    /// Mean, minimum and maximum area of a lamp, in pixels.
    areas: [f64; 3],
    /// Share of the lattice sites that have a lamp.
    filled: f64,
}

/// Position of the lattice site (0, 0) of a design, in pixels.
const ORIGIN: DVec2 = DVec2::new(17.0, 11.0);

const DISC: f64 = std::f64::consts::PI * 81.0;

const DESIGNS: [Design; 6] = [
    Design {
        name: "square",
        periods: [DVec2::new(40.0, 0.0), DVec2::new(0.0, 40.0)],
        lamp: |p, _| p.abs().max_element() < 7.0,
        areas: [196.0; 3],
        filled: 1.0,
    },
    Design {
        name: "rectangular",
        periods: [DVec2::new(48.0, 0.0), DVec2::new(0.0, 40.0)],
        lamp: |p, _| p.x.abs() < 10.0 && p.y.abs() < 5.0,
        areas: [200.0; 3],
        filled: 1.0,
    },
    Design {
        name: "hexagonal",
        periods: [DVec2::new(44.0, 0.0), DVec2::new(22.0, 38.0)],
        lamp: |p, _| p.length() < 9.0,
        areas: [DISC; 3],
        filled: 1.0,
    },
    Design {
        name: "skewed",
        periods: [DVec2::new(40.0, 6.0), DVec2::new(-8.0, 46.0)],
        lamp: |p, _| p.length() < 9.0,
        areas: [DISC; 3],
        filled: 1.0,
    },
    Design {
        name: "two kinds",
        periods: [DVec2::new(50.0, 0.0), DVec2::new(0.0, 50.0)],
        lamp: |p, place| if place[0] % 2 == 0 { p.abs().max_element() < 12.0 } else { p.length() < 9.0 },
        areas: [(576.0 + DISC) / 2.0, DISC, 576.0],
        filled: 1.0,
    },
    Design {
        name: "10 % missing",
        periods: [DVec2::new(40.0, 0.0), DVec2::new(0.0, 36.0)],
        lamp: |p, place| {
            let places = [place[0] as u64, place[1] as u64];
            p.x.abs() < 8.0 && p.y.abs() < 6.0 && Rng::new(77, &places).next_f64() < 0.9
        },
        areas: [192.0; 3],
        filled: 0.9,
    },
];

/// An exemplar: the unwarped photo, the confidence of light at its pixels, and the mask of its valid pixels.
struct Exemplar {
    unwarped: Image,
    light: Image,
    valid: Image,
}

impl Design {
    /// Whether a point of the ceiling, in pixels, lies on a lamp.
    fn is_lit(&self, p: DVec2) -> bool {
        let p = p - ORIGIN;
        let base = (DMat2::from_cols(self.periods[0], self.periods[1]).inverse() * p).floor();
        (0..4).any(|i| {
            let place = base + DVec2::new(f64::from(i % 2), f64::from(i / 2));
            let at = self.periods[0] * place.x + self.periods[1] * place.y;
            (self.lamp)(p - at, [place.x as i64, place.y as i64])
        })
    }

    /// Positions of the lamps in a part of the ceiling of the given size, relative to a lattice site at its corner.
    fn places(&self, size: DVec2) -> Vec<DVec2> {
        let reach = 60;
        (-reach..=reach)
            .flat_map(|j| (-reach..=reach).map(move |i| [i, j]))
            .map(|place| (self.periods[0] * place[0] as f64 + self.periods[1] * place[1] as f64, place))
            .filter(|(at, place)| {
                (self.lamp)(DVec2::ZERO, *place) && at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all()
            })
            .map(|(at, _)| at)
            .collect()
    }

    /// Share of the lattice sites inside an exemplar that have a lamp; with random gaps it differs between exemplars.
    fn filled_in(&self, exemplar: &Exemplar) -> f64 {
        let (width, height) = (exemplar.valid.width as f64, exemplar.valid.height as f64);
        let is_shown = |p: DVec2| {
            let inside = p.cmpge(DVec2::ZERO).all() && p.x < width && p.y < height;
            inside && exemplar.valid.data[p.y as usize * exemplar.valid.width + p.x as usize] > 0.5
        };
        let places = (-60..=60i64).flat_map(|j| (-60..=60i64).map(move |i| [i, j]));
        let shown = places.filter(|&[i, j]| is_shown(ORIGIN + self.periods[0] * i as f64 + self.periods[1] * j as f64));
        let (lit, all) =
            shown.fold((0, 0), |(lit, all), place| (lit + usize::from((self.lamp)(DVec2::ZERO, place)), all + 1));
        f64::from(lit as u32) / f64::from(all)
    }

    /// Cuts an exemplar from the ceiling. It has the noise of a photo, an uncertain light mask, and two corners that
    /// count as outside the photo.
    fn exemplar(&self, side: usize) -> Exemplar {
        let is_lit = |x: usize, y: usize| self.is_lit(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let noise = |x: usize, y: usize, c: u64| 0.1 * Rng::new(9, &[x as u64, y as u64, c]).next_f32();
        let unwarped = Image::from_fn(side, side, |x, y| {
            let base = if is_lit(x, y) { [0.9, 0.8, 0.7] } else { [0.1, 0.1, 0.12] };
            std::array::from_fn::<f32, 3, _>(|c| base[c] + noise(x, y, c as u64))
        });
        let light = Image::from_fn(side, side, |x, y| {
            [(f32::from(is_lit(x, y)) + noise(x, y, 3) - noise(x, y, 4)).clamp(0.0, 1.0)]
        });
        let valid = Image::from_fn(side, side, |x, y| {
            let (u, v) = (x as f64 / side as f64, y as f64 / side as f64);
            [f32::from(u + 0.7 * v >= 0.25 && (1.0 - u) + 0.9 * v >= 0.3)]
        });
        let image = |image: luxfer::error::Result<Image>| image.expect("a small image");
        Exemplar { unwarped: image(unwarped), light: image(light), valid: image(valid) }
    }
}

impl Exemplar {
    fn input(&self) -> Input<'_> {
        Input { unwarped: &self.unwarped, light: &self.light, valid: &self.valid, photo: None }
    }

    fn run(&self, params: &Params) -> Emission {
        emission::run(&self.input(), params, Monitor::default().job()).expect("a texture")
    }
}

/// Luminance of a lamp in a synthetic exemplar: its colour plus the mean of the noise.
fn luminance() -> f64 {
    f64::from(luxfer::image::colour::luminance(glam::Vec3::new(0.95, 0.85, 0.75)))
}

/// Compares every design with its textures by three methods, for all sizes of patches. The plot shows the worst
/// statistic of all designs against the size of the patches, as in the paper's Fig. 11.
fn patterns() {
    let methods: [(&str, Params); 3] = [
        ("default", Params::default()),
        ("as in the paper", Params { min_regularity: 1.0, whole_lamps: false, ..Params::default() }),
        ("quilting", Params { min_regularity: 1.0, whole_lamps: false, guide_weight: 0.0, ..Params::default() }),
    ];
    let mut table = Table::new(["design", "method"].into_iter().chain(STATISTICS).chain(["broken", "stated error %"]));
    let (mut ours, mut behind) = (Score::default(), 0);
    let mut by_block = methods.each_ref().map(|_| BLOCKS.map(|block| [block as f64, 1e-4]));
    for design in &DESIGNS {
        let exemplar = design.exemplar(480);
        let filled = design.filled_in(&exemplar);
        let mut curves = by_block.iter_mut();
        let scores = methods.each_ref().map(|(method, params)| {
            let (mut worst, mut stated) = (Score::default(), 0.0f64);
            let curve = curves.next().expect("one curve per method");
            for (block, point) in BLOCKS.into_iter().zip(curve) {
                let result = exemplar.run(&Params { width: 800, height: 720, block, ..params.clone() });
                let score = Score::of(&result, design, filled, luminance());
                point[1] = score.worst().max(point[1]);
                worst = worst.worse(score);
                stated = stated.max(result.error);
                if block == 100 {
                    save(&result.texture, &format!("emission_{}_{}", design.name, method).replace([' ', '%'], "_"));
                }
            }
            let names = [design.name, method].map(str::to_string);
            table.row(names.into_iter().chain(worst.columns()).chain([format!("{:.1}", 100.0 * stated)]));
            worst
        });
        ours = ours.worse(scores[0]);
        behind += scores[1..].iter().map(|other| scores[0].behind(other)).sum::<usize>();
    }
    table.print("800 x 720 from 480 x 480 with two corners missing; the worst of patches of 25 to 200 pixels");
    let mut plot = Plot::new("Size of the patches", "side of a patch in pixels", "worst statistic");
    methods.iter().zip(by_block).for_each(|((name, _), points)| plot.add(name, points));
    written(&plot, "emission_blocks");
    figure("emission.worst_stat", 100.0 * ours.worst(), "%");
    figure("emission.lattice_rms", 100.0 * ours.phase(), "% of the period");
    figure("emission.pairs", 100.0 * ours.pairs(), "%");
    figure("emission.cut_lamps", ours.broken as f64, "lamps");
    figure("emission.behind_quilting", behind as f64, "statistics");
}

/// Measures the time of a synthesis against the size of the texture.
fn seconds() {
    let exemplar = DESIGNS[1].exemplar(512);
    let sides = [512, 1024, 2048, 4096];
    let mut runs = sides.map(|side| {
        let (exemplar, params) = (&exemplar, Params { width: side, height: side, ..Params::default() });
        move || {
            black_box(exemplar.run(&params));
        }
    });
    let [a, b, c, d] = &mut runs;
    let times = interleaved(Clock::Wall, ROUNDS, &mut [a, b, c, d]);
    let mut table = Table::new(["side", "seconds", "ns per texel"]);
    for (i, side) in sides.iter().enumerate() {
        let seconds = times.median(i);
        table.row([side.to_string(), format!("{seconds:.3}"), format!("{:.0}", 1e9 * seconds / (side * side) as f64)]);
    }
    table.print("From 512 x 512");
    figure("emission.2048.seconds", times.median(2), "s");
}

/// Measures quality against time for three settings: the working resolution, the size of patches and the number of
/// candidates per patch. The patches are at free positions, where synthesis takes nearly all of the time.
fn knobs() {
    let mut plot = Plot::new("Emission: statistics against time", "seconds", "worst statistic");
    let mut table =
        Table::new(["working side", "patch", "candidates", "seconds"].into_iter().chain(STATISTICS).chain(["broken"]));
    let design = &DESIGNS[5];
    let exemplar = design.exemplar(480);
    let filled = design.filled_in(&exemplar);
    let mut point = |working_side: usize, relative: f64, candidates: usize| {
        let block = (relative * 60.0 * working_side as f64 / 480.0) as usize;
        let free = Params { width: 1024, height: 1024, min_regularity: 1.0, ..Params::default() };
        let params = Params { working_side, block, candidates, ..free };
        let (seconds, result) = time(Clock::Wall, || exemplar.run(&params));
        let score = Score::of(&result, design, filled, luminance());
        let settings = [working_side, block, candidates].map(|n| n.to_string());
        table.row(settings.into_iter().chain([format!("{seconds:.3}")]).chain(score.columns()));
        [seconds, score.worst().max(1e-4)]
    };
    let candidates = Params::default().candidates;
    for working_side in [64, 128, 256, 512] {
        let points: Vec<[f64; 2]> = [0.5, 1.0, 2.0].map(|relative| point(working_side, relative, candidates)).into();
        plot.add(&format!("patches of a quarter to one period, working side {working_side}"), points);
    }
    let points: Vec<[f64; 2]> = [4, 16, 64, 192, 1024].map(|candidates| point(256, 1.0, candidates)).into();
    plot.add("4 to 1024 candidates, working side 256", points);
    table.print("1024 x 1024 from 480 x 480, free patches");
    written(&plot, "emission_knobs");
}

fn written(plot: &Plot, name: &str) {
    if let Err(reason) = plot.write(name) {
        println!("# the plot was not written: {reason}");
    }
}

/// Compares with the program of the crate texture-synthesis on the same exemplar.
fn peer(pool: &Pool) -> Result<(), String> {
    let program = Path::new("target/peers/texture_synthesis/bin/texture-synthesis");
    if !program.exists() {
        return Err("texture-synthesis is not installed (benches/peers/install.sh texture_synthesis)".into());
    }
    let design = &DESIGNS[1];
    let mut exemplar = design.exemplar(256);
    exemplar.valid.data.fill(1.0);
    save(&exemplar.unwarped, "emission_peer_exemplar");
    let (theirs, output) = time(Clock::Wall, || {
        Command::new(program)
            .args(["--out-size", "1024", "--threads", "2", "-o", "out/bench/emission_peer.png"])
            .args(["generate", "out/bench/emission_peer_exemplar.png"])
            .output()
    });
    let output = output.map_err(|e| e.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let params = Params { width: 1024, height: 1024, ..Params::default() };
    let (ours, result) = pool.run(|| time(Clock::Wall, || exemplar.run(&params)));
    let bytes = std::fs::read("out/bench/emission_peer.png").map_err(|e| e.to_string())?;
    let picture = io::decode(&bytes, io::Encoding::Srgb).map_err(|e| e.to_string())?;
    // Treat pixels brighter than one half as lamps, and set all others to black.
    let mut lamps = picture.to_rgb().map_err(|e| e.to_string())?;
    for pixel in lamps.data.chunks_exact_mut(3) {
        if pixel[1] < 0.5 {
            pixel.fill(0.0);
        }
    }
    let peer_result = emission::from_texture(&lamps, Monitor::default().job()).map_err(|e| e.to_string())?;
    let mut table = Table::new(["program", "seconds"].into_iter().chain(STATISTICS).chain(["broken"]));
    let programs = [("luxfer", ours, &result), ("texture-synthesis", theirs, &peer_result)];
    let scores = programs.map(|(name, seconds, result)| {
        let score = Score::of(result, design, design.filled, luminance());
        table.row([name.to_string(), format!("{seconds:.2}")].into_iter().chain(score.columns()));
        score
    });
    table.print("1024 x 1024 from 256 x 256");
    figure("emission.behind_texture_synthesis", scores[0].behind(&scores[1]) as f64, "statistics");
    figure("emission.vs_texture_synthesis", theirs / ours, "x");
    Ok(())
}

fn save(texture: &Image, name: &str) {
    let written = std::fs::create_dir_all("out/bench").map_err(|e| e.to_string()).and_then(|()| {
        let png = io::encode_png(texture, 1.0).map_err(|e| e.to_string())?;
        io::write_file(Path::new(&format!("out/bench/{name}.png")), &png).map_err(|e| e.to_string())
    });
    if let Err(reason) = written {
        println!("# out/bench/{name}.png was not written: {reason}");
    }
}
