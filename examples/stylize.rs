//! Stylises a target from image files and prints what the run did.
//!
//! `stylize ARTWORK OUTPUT [name=value …] SOURCE:TARGET[:WEIGHT] …`, for example
//! `stylize style.png out.png iterations=4 mode=nearest source_full.png:target_full.png`.

use luxfer::image::io::{Encoding, encode_png, load};
use luxfer::job::Monitor;
use luxfer::patch::Vote;
use luxfer::stylize::{Finder, Guide, Input, Mode, Params, Range, run};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [artwork, output, rest @ ..] = &arguments[..] else {
        return Err("usage: stylize ARTWORK OUTPUT [name=value ...] SOURCE:TARGET[:WEIGHT] ...".into());
    };
    let read = |path: &str| load(Path::new(path), Encoding::Srgb)?.to_rgb();
    let artwork = read(artwork)?;
    let (mut params, mut pairs, mut threads) = (Params::default(), Vec::new(), 0);
    let vote = |name: &str| match name {
        "plain" => Ok(Vote::Plain),
        "weighted" => Ok(Vote::Weighted),
        "nearest" => Ok(Vote::Nearest),
        _ => Err(format!("unknown vote {name}")),
    };
    for argument in rest {
        match argument.split_once('=') {
            Some(("threads", v)) => threads = v.parse()?,
            Some(("levels", v)) => params.levels = v.parse()?,
            Some(("iterations", v)) => params.iterations = v.parse()?,
            Some(("finest", v)) => params.finest_iterations = v.parse()?,
            Some(("sweeps", v)) => params.sweeps = v.parse()?,
            Some(("preset", v)) => {
                params = match v {
                    "paper" => Params::paper(),
                    "fast" => Params::fast(),
                    "preview" => Params::preview(),
                    _ => return Err(format!("unknown preset {v}").into()),
                }
            }
            Some(("finder", v)) => {
                params.finder = match v {
                    "patchmatch" => Finder::PatchMatch,
                    "table" => Finder::Table,
                    _ => return Err(format!("unknown finder {v}").into()),
                }
            }
            Some(("settle", v)) => params.settle = v.parse()?,
            Some(("passes", v)) => params.passes = v.parse()?,
            Some(("patch", v)) => params.patch = v.parse()?,
            Some(("coverage", v)) => params.coverage = v.parse()?,
            Some(("mu", v)) => params.guide_weight = v.parse()?,
            Some(("seed", v)) => params.seed = v.parse()?,
            Some(("preview", v)) => params.preview = v.parse()?,
            Some(("vote", v)) => params.vote = vote(v)?,
            Some(("final", v)) => params.final_vote = vote(v)?,
            Some(("mode", v)) => {
                params.mode = match v {
                    "budget" => Mode::Budget,
                    "uniform" => Mode::Uniform,
                    "nearest" => Mode::Nearest,
                    "greedy" => Mode::Greedy,
                    "litsphere" => Mode::LitSphere,
                    _ => return Err(format!("unknown mode {v}").into()),
                }
            }
            Some((name, _)) => return Err(format!("unknown parameter {name}").into()),
            None => {
                let parts: Vec<&str> = argument.split(':').collect();
                let [source, target, weight @ ..] = &parts[..] else {
                    return Err(format!("{argument} is not SOURCE:TARGET").into());
                };
                let weight: f32 = weight.first().map_or(Ok(1.0), |w| w.parse())?;
                pairs.push((read(source)?, read(target)?, weight));
            }
        }
    }
    let guides: Vec<Guide> = (pairs.iter())
        .map(|(source, target, weight)| Guide { source, target, weight: *weight, range: Range::Light })
        .collect();
    let input =
        Input { artwork: &artwork, guides: &guides, source_mask: None, target_mask: None, known: None, previous: None };
    let pool = luxfer::exec::Pool::new(threads)?;
    let monitor = Monitor::default();
    let clock = std::time::Instant::now();
    let result = pool.run(|| run(&input, &params, monitor.job()))?;
    let seconds = clock.elapsed().as_secs_f64();
    for level in &result.report.levels {
        println!("{} x {}: energy {:.5?}", level.width, level.height, level.energy);
        for passes in &level.passes {
            let line: Vec<String> =
                passes.iter().map(|p| format!("{:.1}({:.2})", 100.0 * p.coverage, p.knee)).collect();
            println!("   coverage % (knee): {}", line.join(" "));
        }
    }
    let usage = result.report.usage;
    let guide = &result.report.guide_error.data;
    let rms = (guide.iter().map(|v| f64::from(v * v)).sum::<f64>() / guide.len() as f64).sqrt();
    println!(
        "used {:.1} % most {} entropy {:.2} bits; guide error {rms:.4}; {seconds:.2} s",
        100.0 * usage.used,
        usage.most,
        usage.entropy
    );
    std::fs::write(output, encode_png(&result.image, 1.0)?)?;
    Ok(())
}
