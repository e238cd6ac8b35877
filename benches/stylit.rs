//! Benchmark of stylisation on the real pair in the test data (ebsynth's StyLit example, 1200 × 912, four guides).
//! Arguments select sections: time and quality of the presets (`presets`); the time of an update (`update`); time and
//! memory up to 70 megapixels (`sizes`); comparison with plain EM, earlier methods and ebsynth (`baselines`); other
//! settings of the library's method (`methods`); quality against time for every setting (`knobs`); the final votes on
//! drawn styles and on pairs with a known truth (`votes`), and on sets that were set aside (`aside`); half-painted
//! pictures (`autocomplete`), exemplars with defects (`doubts`) and the direction of strokes (`directions`) of the
//! demonstration scenes, which need no test data.
//!
//! Pictures are scored by two judges: `harness/judge.rs`, and `tools/stylit_judge.py` beside the test data, which sees
//! images only. The script runs with `LUXFER_PYTHON`, `target/peers/judge` or `python3`, if it has numpy, scipy and
//! pillow. It searches nearest patches only at even offsets of the exemplar, so three of four patches of a perfect
//! copy lie between these offsets. The scores of the artwork itself (`stylit.artwork.*`) are therefore the floor of
//! `coherence` (117) and near the floor of `guide` (731); lower values come from smoother paint. If all exemplar
//! patches are used equally, the script's samples fall on 44.3 % of its cells on average (`stylit.bound.used`),
//! otherwise on fewer, so no picture reaches 45 %. `guide` has a standard error of 13 and consists mostly of similar
//! patches under different light: see `docs/notes/stylize.md`. Pictures go to `out/bench/`.

#[path = "stylit/autocomplete.rs"]
mod autocomplete;
#[path = "stylit/demonstration.rs"]
mod demonstration;
#[path = "stylit/directions.rs"]
mod directions;
#[path = "stylit/doubts.rs"]
mod doubts;
#[path = "stylit/earlier.rs"]
mod earlier;
#[path = "stylit/fidelity.rs"]
mod fidelity;
#[path = "stylit/greedy.rs"]
mod greedy;
mod harness;
#[path = "stylit/occurrence.rs"]
mod occurrence;
#[path = "stylit/uniform.rs"]
mod uniform;
#[path = "stylit/votes.rs"]
mod votes;

use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, interleaved, scenes, time};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::image::colour::{linear_to_srgb, srgb_to_linear};
use luxfer::image::io::{Encoding, encode_png, load};
use luxfer::image::pyramid::resize;
use luxfer::job::Monitor;
use luxfer::patch::VoteMode;
use luxfer::stylize::{Finder, Guide, Input, Output, Params, Range, Updater, run};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const GUIDES: [&str; 4] = ["fullgi", "dirdif", "dirspc", "indirb"];
const ROUNDS: usize = 3;

struct Pair {
    folder: PathBuf,
    artwork: Image,
    guides: Vec<(Image, Image)>,
}

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wants = |section: &str| chosen.is_empty() || chosen.iter().any(|c| c == section);
    let pool = Pool::new(2).expect("two threads");
    if wants("autocomplete") {
        autocomplete::measure(&pool);
    }
    if wants("doubts") {
        doubts::measure(&pool);
    }
    if wants("directions") {
        directions::measure(&pool);
    }
    let pair = match Pair::load(1) {
        Ok(pair) => pair,
        Err(reason) => {
            for name in ["full.seconds", "fast.seconds", "preview.seconds"] {
                absent(&format!("stylit.{name}"), &reason);
            }
            return judged_absent(&reason);
        }
    };
    if wants("presets") {
        presets(&pair, &pool);
    }
    if wants("update") {
        update(&pair, &pool);
    }
    if wants("sizes") {
        sizes(&pair, &pool);
    }
    if wants("baselines") {
        baselines(&pair, &pool);
    }
    if wants("votes") {
        votes::compare(&pair, &pool);
    }
    if wants("aside") {
        votes::compare_aside(&pair, &pool);
    }
    // Try methods and settings at half size, where a run takes a quarter of the time.
    let half = Pair::load(2).expect("it was there before");
    if wants("methods") {
        methods(&half, &pool);
    }
    if wants("knobs") {
        knobs(&half, &pool);
    }
}

impl Pair {
    fn load(shrink: usize) -> Result<Self, String> {
        let folder = scenes::data("stylit/ebsynth_stylit")?;
        let read = |name: String| -> Result<Image, String> {
            let image = load(&folder.join(name), Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
            let (width, height) = (image.width / shrink, image.height / shrink);
            resize(&image, width, height, Monitor::default().job()).map_err(|e| e.to_string())
        };
        let guide = |g: &&str| Ok((read(format!("source_{g}.png"))?, read(format!("target_{g}.png"))?));
        let guides = GUIDES.iter().map(guide).collect::<Result<_, String>>()?;
        Ok(Self { artwork: read("source_style.png".into())?, guides, folder: folder.clone() })
    }

    /// The pair with guides that are rounded to `bits` bits per channel in display encoding.
    fn coarsened(&self, bits: u32) -> Self {
        let steps = ((1 << bits) - 1) as f32;
        let coarse = |image: &Image| {
            let mut image = image.clone();
            image.data.iter_mut().for_each(|v| *v = srgb_to_linear((linear_to_srgb(*v) * steps).round() / steps));
            image
        };
        let guides = self.guides.iter().map(|(source, target)| (coarse(source), coarse(target))).collect();
        Self { folder: self.folder.clone(), artwork: self.artwork.clone(), guides }
    }

    fn guides(&self) -> Vec<Guide<'_>> {
        let names = GUIDES.iter().zip(&self.guides);
        names.map(|(name, (source, target))| Guide { name, source, target, weight: 1.0, range: Range::Light }).collect()
    }

    fn stylise(&self, params: &Params, pool: &Pool) -> Output {
        let guides = self.guides();
        let monitor = Monitor::default();
        pool.run(|| run(&input(&self.artwork, &guides), params, monitor.job())).expect("valid input")
    }
}

fn input<'a>(artwork: &'a Image, guides: &'a [Guide<'a>]) -> Input<'a> {
    Input::new(artwork, guides)
}

/// Times the presets in turns, and scores their results.
fn presets(pair: &Pair, pool: &Pool) {
    let presets = [("full", Params::default()), ("fast", Params::fast()), ("preview", Params::preview())];
    let outputs = std::cell::RefCell::new([None, None, None]);
    let mut contenders: Vec<Box<dyn FnMut()>> = Vec::new();
    for (i, (_, params)) in presets.iter().enumerate() {
        let outputs = &outputs;
        contenders.push(Box::new(move || outputs.borrow_mut()[i] = Some(pair.stylise(params, pool))));
    }
    let mut turns: Vec<&mut dyn FnMut()> = contenders.iter_mut().map(|r| &mut **r as &mut dyn FnMut()).collect();
    let timings = interleaved(Clock::Wall, ROUNDS, &mut turns);
    drop(contenders);

    let mut table = Table::new(["preset", "seconds", "energy", "used %", "entropy", "guide error", "texture"]);
    let outputs = outputs.into_inner();
    for (i, (name, _)) in presets.iter().enumerate() {
        let Some(output) = &outputs[i] else { continue };
        let seconds = timings.median(i);
        table.row([vec![name.to_string(), format!("{seconds:.2}")], numbers(output, &pair.artwork)].concat());
        save(&format!("stylit_{name}"), &output.image);
        figure(&format!("stylit.{name}.seconds"), seconds, "s");
    }
    table.print("presets, 1200 x 912, 2 threads");
    if let Some(peak) = harness::peak_memory() {
        println!("  peak memory {:.0} MiB", peak as f64 / f64::from(1 << 20));
    }
    match judge(pair, &folder().join("stylit_full.png")) {
        Ok(line) => judged("full", &line),
        Err(reason) => judged_absent(&reason),
    }
    // Score a perfect copy, and compute the maximum share of cells on which the script's samples can fall.
    if let Ok(line) = judge(pair, &pair.folder.join("source_style.png")) {
        judged("artwork", &line);
    }
    let cells = (pair.artwork.width.div_ceil(4) * pair.artwork.height.div_ceil(4)) as f64;
    figure("stylit.bound.used", 100.0 * (1.0 - (1.0 - 1.0 / cells).powf(JUDGE_SAMPLES)), "%");
}

/// Cells of a table: energy (Eq. 3), share of the exemplar that is used, entropy of its use, guide error, and share of
/// the texture that is kept.
fn numbers(output: &Output, artwork: &Image) -> Vec<String> {
    let energy = output.report.levels.last().and_then(|l| l.energy.last().copied()).unwrap_or(0.0);
    let guide = &output.report.guide_error.data;
    let rms = (guide.iter().map(|v| f64::from(v * v)).sum::<f64>() / guide.len() as f64).sqrt();
    let usage = output.report.usage;
    vec![
        format!("{:.3}e-3", 1e3 * energy),
        format!("{:.1}", 100.0 * usage.used),
        format!("{:.2}", usage.entropy),
        format!("{rms:.4}"),
        format!("{:.3}", texture(&output.image) / texture(artwork)),
    ]
}

/// Mean square of the Laplacian of the encoded green channel: the power of fine texture.
fn texture(image: &Image) -> f64 {
    let green = |x: usize, y: usize| f64::from(linear_to_srgb(image.pixel(x, y)[1]));
    let mut sum = 0.0;
    for y in 1..image.height - 1 {
        for x in 1..image.width - 1 {
            let around = green(x - 1, y) + green(x + 1, y) + green(x, y - 1) + green(x, y + 1);
            sum += (around - 4.0 * green(x, y)).powi(2);
        }
    }
    sum / (image.width * image.height) as f64
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench")
}

fn save(name: &str, image: &Image) {
    std::fs::create_dir_all(folder()).expect("out/bench can be made");
    let png = encode_png(image, 1.0).expect("three channels");
    std::fs::write(folder().join(name).with_extension("png"), png).expect("out/bench can be written");
    println!("picture out/bench/{name}.png");
}

/// Line that the script prints for a picture of the pair. If the picture is the artwork itself, it is scored against
/// its own scene.
fn judge(pair: &Pair, picture: &Path) -> Result<String, String> {
    let program = scenes::data("../tools/stylit_judge.py")?;
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/judge/bin/python");
    let own = if own.exists() { own.display().to_string() } else { "python3".to_string() };
    let python = std::env::var("LUXFER_PYTHON").unwrap_or(own);
    let artwork = pair.folder.join("source_style.png");
    let target = if picture == artwork { "source" } else { "target" };
    let mut command = Command::new(&python);
    command.arg(program).arg(artwork).arg(picture);
    for guide in GUIDES {
        let side = |side: &str| pair.folder.join(format!("{side}_{guide}.png")).display().to_string();
        command.arg(format!("{}:{}", side("source"), side(target)));
    }
    let output = command.output().map_err(|e| format!("{python} does not start: {e}"))?;
    let error = String::from_utf8_lossy(&output.stderr);
    let last = error.lines().last().unwrap_or("").to_string();
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{python}: {last}"))
    }
}

/// Scores that the script prints: the name of each, the text before its number in the line, and its unit.
const JUDGED: [(&str, &str, &str); 5] = [
    ("coherence", "coherence ", "-"),
    ("guide", "guide ", "-"),
    ("used", "used ", "%"),
    ("hf", "hf ", "-"),
    ("hf_worst", "(min ", "-"),
];

/// Number of patches of the picture that the script samples.
const JUDGE_SAMPLES: f64 = 40_000.0;

/// The number that follows `before` in the script's line.
fn number<'a>(line: &'a str, before: &str) -> Option<&'a str> {
    line.split(before).nth(1)?.split([' ', '%', ')', '\n']).next()
}

/// Prints the script's scores of a picture as figures; `of` is the name of the picture.
fn judged(of: &str, line: &str) {
    for (name, before, unit) in JUDGED {
        match number(line, before).and_then(|n| n.parse().ok()) {
            Some(value) => figure(&format!("stylit.{of}.{name}"), value, unit),
            None => absent(&format!("stylit.{of}.{name}"), "the judge's line has no such number"),
        }
    }
}

fn judged_absent(reason: &str) {
    for (name, _, _) in JUDGED {
        absent(&format!("stylit.full.{name}"), reason);
    }
}

/// Measures the time to update the picture after a brush stroke in the artwork, in preview.
fn update(pair: &Pair, pool: &Pool) {
    let guides = pair.guides();
    let monitor = Monitor::default();
    let (mut study, _) = pool
        .run(|| Updater::new(&input(&pair.artwork, &guides), &Params::preview(), &|_| (), monitor.job()))
        .expect("valid input");
    let (width, height) = (pair.artwork.width, pair.artwork.height);
    let stroke = Image::from_fn(width, height, |x, y| {
        let inside = (500..700).contains(&x) && (y as isize - 300 - (x as isize - 500) / 4).abs() < 15;
        [f32::from(u8::from(inside))]
    })
    .expect("a size that exists");
    let mut painted = pair.artwork.clone();
    for (pixel, _) in painted.data.chunks_exact_mut(3).zip(&stroke.data).filter(|(_, s)| **s > 0.5) {
        pixel.copy_from_slice(&[0.05, 0.3, 0.1]);
    }
    let mut seconds = Vec::new();
    for _ in 0..5 {
        let repaint = || pool.run(|| study.repaint(&painted, &stroke, monitor.job())).expect("valid input");
        seconds.push(time(Clock::Wall, repaint).0);
    }
    println!("\nupdate after a stroke of 200 x 30 pixels, preview");
    figure("stylit.update.seconds", harness::median(&seconds), "s");
}

/// Measures time and memory against the size of the target, in fast quality, up to 70 megapixels, with a fixed
/// exemplar. The bytes per pixel are the growth of memory since the smallest target, without the input.
fn sizes(pair: &Pair, pool: &Pool) {
    let mut smallest = None;
    let mut table = Table::new([
        "target",
        "megapixels",
        "seconds",
        "seconds per megapixel",
        "peak MiB",
        "of it input",
        "bytes per pixel beside it",
        "ms to cancel",
    ]);
    for scale in [1, 2, 4, 8] {
        harness::forget_peak_memory();
        let job = Monitor::default();
        let large = |(source, target): &(Image, Image)| {
            let target = pool.run(|| resize(target, target.width * scale, target.height * scale, job.job()));
            (source.clone(), target.expect("memory for the input"))
        };
        let guides = pair.guides.iter().map(large).collect();
        let larger = Pair { folder: pair.folder.clone(), artwork: pair.artwork.clone(), guides };
        let (seconds, output) = time(Clock::Wall, || larger.stylise(&Params::fast(), pool));
        let (width, height) = (output.image.width, output.image.height);
        let megapixels = (width * height) as f64 * 1e-6;
        let input: usize = larger.guides.iter().map(|(a, b)| 4 * (a.data.len() + b.data.len())).sum();
        let mib = |bytes: u64| format!("{:.0}", bytes as f64 / f64::from(1 << 20));
        // Read the peak memory of this run before further runs.
        let peak = harness::peak_memory();
        let here = peak.map(|peak| (megapixels * 1e6, peak as f64 - input as f64));
        smallest = smallest.or(here);
        let growth = here.zip(smallest).filter(|(here, first)| here.0 > first.0);
        let added = growth.map(|(here, first)| (here.1 - first.1) / (here.0 - first.0));
        drop(output);
        let waits = cancel_waits(&larger, pool);
        table.row([
            format!("{width} x {height}"),
            format!("{megapixels:.1}"),
            format!("{seconds:.1}"),
            format!("{:.2}", seconds / megapixels),
            peak.map_or("unknown".to_string(), mib),
            mib(input as u64),
            added.map_or("-".to_string(), |bytes| format!("{bytes:.0}")),
            format!("{:.0}", 1e3 * waits),
        ]);
    }
    table.print("fast quality, 2 threads");
}

/// Longest time in seconds from a cancel request to the end of the run. The requests come while the run reads its
/// input, on the coarse levels, and early and late on the finest level.
fn cancel_waits(pair: &Pair, pool: &Pool) -> f64 {
    let guides = pair.guides();
    let wait = |after: f64| {
        let monitor = Monitor::default();
        std::thread::scope(|scope| {
            let (guides, job) = (&guides, monitor.job());
            let stylised = move || run(&input(&pair.artwork, guides), &Params::fast(), job);
            let stopped = scope.spawn(move || pool.run(stylised).is_err());
            while monitor.progress() < after {
                std::thread::sleep(Duration::from_millis(1));
            }
            let asked = Instant::now();
            monitor.cancel();
            assert!(stopped.join().expect("it does not panic"), "the run ended before the cancel request");
            asked.elapsed().as_secs_f64()
        })
    };
    [0.0, 0.02, 0.15, 0.3, 0.45].into_iter().map(wait).fold(0.0, f64::max)
}

/// Settings of plain EM: without the budget, each target patch takes its nearest exemplar patch.
fn plain_em() -> Params {
    Params { coverage: 0.0, settle: 0, search_iterations: 3, ..Params::default() }
}

/// Compares luxfer with plain EM, earlier methods and ebsynth, by the script's scores, by Eq. 3, and as pictures.
/// luxfer runs before and after the others, so that other work on the machine affects all of them.
fn baselines(pair: &Pair, pool: &Pool) {
    let mut made: Vec<Outcome> = Vec::new();
    let stylise = |file: &str, params: &Params| {
        let (seconds, output) = time(Clock::Wall, || pair.stylise(params, pool));
        save(file, &output.image);
        (seconds, folder().join(file).with_extension("png"))
    };
    let (before, ours) = stylise("stylit_full", &Params::default());

    made.extend(compare_plain_em(&stylise, before));

    for (name, file, method) in earlier::METHODS {
        let (seconds, picture) = time(Clock::Wall, || pool.run(|| earlier::run(pair, method)));
        save(file, &picture);
        made.push((name.to_string(), Some(seconds), folder().join(file).with_extension("png")));
    }

    let theirs = match ebsynth(pair) {
        Ok((seconds, file)) => {
            made.push(("ebsynth".to_string(), Some(seconds), file));
            Some(seconds)
        }
        Err(reason) => {
            absent("stylit.ebsynth.seconds", &reason);
            None
        }
    };
    let (after, _) = time(Clock::Wall, || pair.stylise(&Params::default(), pool));
    made.insert(0, ("ours, full".to_string(), Some(0.5 * (before + after)), ours));
    made.push(("the artwork itself".to_string(), None, pair.folder.join("source_style.png")));
    if let Some(theirs) = theirs {
        figure("stylit.ebsynth.seconds", theirs, "s");
        figure("stylit.ebsynth.speedup", 2.0 * theirs / (before + after), "x");
    }

    score(pair, pool, &made);
}

/// Runs plain EM with luxfer's numbers of iterations, and with as many iterations as fit into luxfer's time.
fn compare_plain_em(stylise: &impl Fn(&str, &Params) -> (f64, PathBuf), seconds_of_ours: f64) -> [Outcome; 2] {
    let plain = Params { vote: VoteMode::Plain, final_vote: VoteMode::Plain, ..plain_em() };
    let (seconds, file) = stylise("stylit_plain_em", &plain);
    let short = ("plain EM".to_string(), Some(seconds), file);
    let more = |count: usize| ((count as f64 * seconds_of_ours / seconds).round() as usize).clamp(1, 100);
    let longer = Params {
        iterations: more(plain.iterations),
        coarse_iterations: more(plain.coarse_iterations),
        finest_iterations: more(plain.finest_iterations + plain.polish),
        polish: 0,
        ..plain.clone()
    };
    let name = format!("plain EM, {} + {} iterations", longer.iterations, longer.finest_iterations);
    let (seconds, file) = stylise("stylit_plain_em_long", &longer);
    [short, (name, Some(seconds), file)]
}

/// A picture to score: its name, the seconds it took, and its file.
type Outcome = (String, Option<f64>, PathBuf);

/// Prints the scores of pictures.
fn score(pair: &Pair, pool: &Pool, made: &[Outcome]) {
    let head =
        ["", "seconds", "coherence", "guide", "used %", "hf", "hf worst", "Eq. 3", "verbatim %", "at all offsets"];
    let mut table = Table::new(head);
    for (name, seconds, file) in made {
        let mut row = vec![name.clone(), seconds.map_or("-".to_string(), |s| format!("{s:.2}"))];
        let line = judge(pair, file).unwrap_or_default();
        row.extend(JUDGED.map(|(_, before, _)| number(&line, before).unwrap_or("-").to_string()));
        if seconds.is_some() {
            let picture = load(file, Encoding::Srgb).and_then(|i| i.to_rgb()).expect("written just now");
            let j = pool.run(|| harness::judge::judge(&picture, &pair.artwork, &pair.guides));
            row.extend([
                format!("{:.3}e-3", 1e3 * j.energy),
                format!("{:.1}", j.verbatim),
                format!("{:.1}", j.coherence),
            ]);
        }
        table.row(row);
    }
    table.print("baselines, 1200 x 912, 2 threads; five columns by stylit_judge.py, three by harness/judge.rs");
}

/// Runs ebsynth with its default settings and the weights of our guides; returns its seconds and the path of its
/// picture.
fn ebsynth(pair: &Pair) -> Result<(f64, PathBuf), String> {
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/ebsynth/bin/ebsynth");
    if !program.exists() {
        return Err(format!("{} is not there: benches/peers/install.sh could not fetch its source", program.display()));
    }
    let picture = folder().join("stylit_ebsynth.png");
    let mut command = Command::new(&program);
    command.env("OMP_NUM_THREADS", "2").args(["-backend", "cpu"]);
    command.arg("-style").arg(pair.folder.join("source_style.png"));
    for guide in GUIDES {
        let side = |side: &str| pair.folder.join(format!("{side}_{guide}.png"));
        command.arg("-guide").arg(side("source")).arg(side("target")).args(["-weight", "0.5"]);
    }
    command.arg("-output").arg(&picture);
    let (seconds, output) = time(Clock::Wall, || command.output());
    match output {
        Ok(output) if output.status.success() => Ok((seconds, picture)),
        Ok(output) => Err(format!("ebsynth ended with {}", output.status)),
        Err(error) => Err(format!("ebsynth does not start: {error}")),
    }
}

/// Compares the budget with plain EM and with a search by table.
fn methods(pair: &Pair, pool: &Pool) {
    let mut table = Table::new(["method", "seconds", "energy", "used %", "entropy", "guide error", "texture"]);
    for (name, params) in [
        ("error budget (Fiser 2016)", Params::default()),
        ("the paper's settings", Params::paper()),
        ("nearest (Wexler 2007)", plain_em()),
        ("nearest, mean", Params { final_vote: VoteMode::Plain, vote: VoteMode::Plain, ..plain_em() }),
        ("error budget by table", Params { finder: Finder::KdTree, ..Params::default() }),
    ] {
        let (seconds, output) = time(Clock::Wall, || pair.stylise(&params, pool));
        table.row([vec![name.to_string(), format!("{seconds:.2}")], numbers(&output, &pair.artwork)].concat());
    }
    table.print("methods, 600 x 456");
}

/// Measures the energy against time, varying one setting at a time. The energy is computed from the picture, because
/// some settings change the energy that a run itself reports.
fn knobs(pair: &Pair, pool: &Pool) {
    let mut knobs: Vec<(&str, Vec<(String, Params)>)> = Vec::new();
    let mut knob = |name: &'static str, values: &[usize], set: fn(&mut Params, usize)| {
        let with = |v: &usize| {
            let mut params = Params::default();
            set(&mut params, *v);
            (v.to_string(), params)
        };
        knobs.push((name, values.iter().map(with).collect()));
    };
    knob("levels", &[2, 4, 6], |p, v| p.levels = v);
    knob("iterations", &[1, 3, 6, 9], |p, v| p.iterations = v);
    knob("coarse iterations", &[1, 6, 12, 24, 48], |p, v| p.coarse_iterations = v);
    knob("finest iterations", &[1, 2, 4], |p, v| p.finest_iterations = v);
    knob("search iterations", &[1, 2, 4], |p, v| p.search_iterations = v);
    knob("guide weight", &[1, 2, 4, 8], |p, v| p.guide_weight = v as f32);
    knob("coarse guides", &[1, 2, 4, 8], |p, v| p.coarse_guides = v as f32);
    knob("passes", &[2, 3, 6, 12], |p, v| p.passes = v);
    knob("settle", &[0, 1, 2, 4], |p, v| p.settle = v);
    knob("coverage %", &[50, 70, 90, 95, 99], |p, v| p.coverage = v as f32 / 100.0);
    knob("patch", &[3, 5, 7], |p, v| p.patch = v);
    let votes = [VoteMode::Plain, VoteMode::Weighted, VoteMode::Nearest, VoteMode::Majority, VoteMode::Adaptive];
    let last = |&final_vote: &VoteMode| (format!("{final_vote:?}"), Params { final_vote, ..Params::default() });
    knobs.push(("last vote", votes.iter().map(last).collect()));

    let mut table = Table::new(["knob", "seconds", "Eq. 3", "energy", "used %", "entropy", "guide error", "texture"]);
    let mut plot = Plot::new("Stylisation, one knob at a time (600 x 456)", "seconds", "energy (Eq. 3)");
    let mut measure = |title: String, of: &Pair, params: &Params| {
        let (seconds, output) = time(Clock::Wall, || of.stylise(params, pool));
        let energy = pool.run(|| harness::judge::energy(&output.image, &pair.artwork, &pair.guides));
        let head = vec![title, format!("{seconds:.2}"), format!("{:.3}e-3", 1e3 * energy)];
        table.row([head, numbers(&output, &pair.artwork)].concat());
        [seconds, energy]
    };
    for (name, values) in knobs {
        let curve = values.into_iter().map(|(value, params)| {
            let mark = if params == Params::default() { " (default)" } else { "" };
            measure(format!("{name} {value}{mark}"), pair, &params)
        });
        plot.add(name, curve.collect::<Vec<_>>());
    }
    let curve = [2, 4, 6].map(|bits| measure(format!("guide bits {bits}"), &pair.coarsened(bits), &Params::default()));
    plot.add("guide bits", curve);
    table.print("knobs, 600 x 456");
    plot.write("stylit_knobs").expect("out/bench can be written");
}
