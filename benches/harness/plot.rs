//! Writes curves as numbers (CSV) and as a picture (SVG) into `out/bench/`.

use std::fmt::Write;
use std::path::PathBuf;

/// Curves in one diagram with logarithmic axes. Points with a coordinate that is not positive are left out.
pub struct Plot {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub series: Vec<Series>,
}

pub struct Series {
    pub name: String,
    pub points: Vec<[f64; 2]>,
}

/// Size in SVG units of the area with the curves.
const SIZE: [f64; 2] = [510.0, 385.0];
/// Space in SVG units for labels: at the left, top and bottom.
const MARGIN: [f64; 3] = [70.0, 40.0, 55.0];
/// Width of the legend in SVG units: a constant part, and the width of a letter.
const LEGEND: [f64; 2] = [44.0, 6.6];
/// Colours that people with red-green colour blindness can tell apart (Okabe and Ito 2008).
const COLOURS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8a8a00"];

/// Writes a file into `out/bench/`, which is created if necessary.
pub fn write_out(name: &str, text: &str) -> std::io::Result<()> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join(name), text)
}

/// Quotes a cell of a CSV file.
pub fn quoted(cell: &str) -> String {
    format!("\"{}\"", cell.replace('"', "\"\""))
}

impl Plot {
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self { title: title.into(), x_label: x_label.into(), y_label: y_label.into(), series: Vec::new() }
    }

    pub fn add(&mut self, name: &str, points: impl IntoIterator<Item = [f64; 2]>) {
        self.series.push(Series { name: name.into(), points: points.into_iter().collect() });
    }

    /// Writes `out/bench/<name>.csv` and `.svg` and prints their paths.
    pub fn write(&self, name: &str) -> std::io::Result<()> {
        write_out(&format!("{name}.csv"), &self.csv())?;
        write_out(&format!("{name}.svg"), &self.svg())?;
        println!("plot out/bench/{name}.svg (numbers in {name}.csv)");
        Ok(())
    }

    fn csv(&self) -> String {
        let mut out = format!("series,{},{}\n", quoted(&self.x_label), quoted(&self.y_label));
        for series in &self.series {
            for [x, y] in &series.points {
                let _ = writeln!(out, "{},{x},{y}", quoted(&series.name));
            }
        }
        out
    }

    fn svg(&self) -> String {
        let [left, top, bottom] = MARGIN;
        let longest = self.series.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
        let right = LEGEND[0] + LEGEND[1] * longest as f64;
        let [width, height] = [left + SIZE[0] + right, top + SIZE[1] + bottom];
        let axes = [0, 1].map(|k| Axis::covering(self.series.iter().flat_map(|s| s.points.iter().map(move |p| p[k]))));
        let x = |v: f64| left + axes[0].place(v) * (width - left - right);
        let y = |v: f64| height - bottom - axes[1].place(v) * (height - top - bottom);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        let text = |out: &mut String, x: f64, y: f64, anchor: &str, extra: &str, s: &str| {
            let s = s.replace('&', "&amp;").replace('<', "&lt;");
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\"{extra}>{s}</text>");
        };
        let (middle, centre) = ((left + width - right) / 2.0, (top + height - bottom) / 2.0);
        text(&mut out, middle, 22.0, "middle", " font-size=\"15\"", &self.title);
        text(&mut out, middle, height - 12.0, "middle", "", &self.x_label);
        text(&mut out, 16.0, centre, "middle", &format!(" transform=\"rotate(-90 16 {centre})\""), &self.y_label);
        // Draw the grid lines and their numbers.
        for v in axes[0].ticks() {
            let _ = writeln!(out, "<path d=\"M{:.1} {top}V{:.1}\" stroke=\"#ddd\"/>", x(v), height - bottom);
            text(&mut out, x(v), height - bottom + 18.0, "middle", "", &number(v));
        }
        for v in axes[1].ticks() {
            let _ = writeln!(out, "<path d=\"M{left} {:.1}H{:.1}\" stroke=\"#ddd\"/>", y(v), width - right);
            text(&mut out, left - 6.0, y(v) + 4.0, "end", "", &number(v));
        }
        // Draw the curves, and their names in the legend.
        for (i, series) in self.series.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let places: Vec<String> = series
                .points
                .iter()
                .filter(|p| p.iter().all(|v| is_drawable(*v)))
                .map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1])))
                .collect();
            let line = places.join(" ");
            let _ = writeln!(out, "<polyline points=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>");
            for place in &places {
                let (cx, cy) = place.split_once(',').unwrap_or_default();
                let _ = writeln!(out, "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"3\" fill=\"{colour}\"/>");
            }
            let at = top + 16.0 + 18.0 * i as f64;
            let from = width - right + 12.0;
            let _ = writeln!(out, "<path d=\"M{from} {:.1}h18\" stroke=\"{colour}\" stroke-width=\"2\"/>", at - 4.0);
            text(&mut out, from + 24.0, at, "start", "", &series.name);
        }
        out + "</svg>\n"
    }
}

fn is_drawable(v: f64) -> bool {
    v.is_finite() && v > 0.0
}

/// A logarithmic axis; its ends are decimal logarithms.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn covering(values: impl Iterator<Item = f64>) -> Self {
        let logs = values.filter(|v| is_drawable(*v)).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let pad = (0.05 * (high - low)).max(0.05);
        Self { low: low - pad, high: high + pad }
    }

    /// Position of a value on the axis, from 0 at the low end to 1 at the high end.
    fn place(&self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    /// Values at which the axis has grid lines: powers of ten, and on short axes values between them.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let steps: &[&str] = match self.high - self.low {
            span if span > 2.5 => &["1"],
            span if span > 0.7 => &["1", "2", "5"],
            _ => &["1", "1.5", "2", "3", "4", "5", "7"],
        };
        let all = decades.flat_map(|d| steps.iter().filter_map(move |s| format!("{s}e{d}").parse().ok()));
        all.filter(|v| (0.0..=1.0).contains(&self.place(*v))).collect()
    }
}

fn number(v: f64) -> String {
    if (1e-3..1e4).contains(&v) { format!("{v}") } else { format!("{v:e}") }
}
