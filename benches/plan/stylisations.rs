//! Plans stylisations and compares the predictions with the stylisations: several artworks for one exemplar scene, at
//! various sizes.

use super::harness::scenes::{Absent, data};
use super::harness::{Clock, time};
use super::outcomes::Outcomes;
use super::{Table, columns};
use luxfer::image::Image;
use luxfer::image::io::{Encoding, load};
use luxfer::image::pyramid::resize;
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::stylize::{self, Guide, Input, Params, Range};

const GUIDES: [&str; 4] = ["fullgi", "dirdif", "dirspc", "indirb"];
/// Factors for the sides of the exemplar and of the target.
const SIZES: [[f64; 2]; 4] = [[1.0, 1.0], [0.7, 0.4], [0.5, 0.8], [0.33, 0.33]];

pub fn measure(all: &mut Outcomes) {
    let head = ["artwork", "exemplar, target", "goal", "s expected", "s", "ratio", "error expected", "error", "ratio"];
    let mut table = Table::new(head);
    let mut artworks = vec!["ebsynth_stylit/source_style".to_string()];
    artworks.extend((1..=5).map(|i| format!("dcharata_extra_styles/source_style_{i}")));
    for (i, artwork) in artworks.iter().enumerate() {
        for (k, size) in SIZES.into_iter().enumerate() {
            if let Err(reason) = outcome(artwork, size, i + k, all, &mut table) {
                println!("# {artwork}: {reason}");
            }
        }
    }
    table.print("stylisations: one thread, its own time");
}

fn read(name: &str, size: [usize; 2]) -> Result<Image, Absent> {
    let file = data(&format!("stylit/{name}.png"))?;
    let image = load(&file, Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
    resize(&image, size[0], size[1], Monitor::default().job()).map_err(|e| e.to_string())
}

fn outcome(artwork: &str, size: [f64; 2], turn: usize, all: &mut Outcomes, table: &mut Table) -> Result<(), Absent> {
    let [source, target] = size.map(|s| [1200.0, 912.0].map(|side: f64| (s * side) as usize));
    let painted = read(artwork, source)?;
    let pairs = GUIDES.map(|g| {
        let side = |of: &str, size| read(&format!("ebsynth_stylit/{of}_{g}"), size);
        Ok::<_, Absent>((side("source", source)?, side("target", target)?))
    });
    let pairs = pairs.into_iter().collect::<Result<Vec<_>, _>>()?;
    let guide = |(source, target)| Guide { name: "light", source, target, weight: 1.0, range: Range::Light };
    let guides: Vec<Guide> = pairs.iter().map(|(s, t)| guide((s, t))).collect();
    let input = Input::new(&painted, &guides);

    // Alternate between errors and times; the times are such that the plan chooses different presets.
    let megapixels = (target[0] * target[1]) as f64 / 1e6;
    let goal = [Goal::Seconds(5.0 * megapixels), Goal::Error(0.05), Goal::Seconds(9.0 * megapixels), Goal::Error(0.04)]
        [turn % 4];
    let clock = || Clock::Thread.now();
    let job = Monitor::default();
    let plan = plan::stylisation(&input, &Params::default(), goal, &clock, job.job()).map_err(|e| e.to_string())?;
    let (seconds, output) = time(Clock::Thread, || stylize::run(&input, &plan.params, job.job()));
    let report = output.map_err(|e| e.to_string())?.report;
    let error = report.levels.last().and_then(|l| l.energy.last()).map_or(f64::NAN, |e| e.sqrt());
    all.times.push(seconds / plan.expected.seconds);
    all.errors.push(error / plan.expected.error);
    let goal = match goal {
        Goal::Seconds(s) => format!("{s:.2} s"),
        Goal::Error(e) => format!("{e}"),
    };
    let [source, target] = [source, target].map(|s| format!("{} x {}", s[0], s[1]));
    let head = [artwork.to_string(), format!("{source}, {target}"), goal];
    let cells = [columns([plan.expected.seconds, seconds]), columns([plan.expected.error, error])].concat();
    table.row(head.into_iter().chain(cells));
    Ok(())
}
