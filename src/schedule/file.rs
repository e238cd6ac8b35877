//! Writes the luminaire schedule to a file: CSV for spreadsheets, with one row per fixture; JSON for programs,
//! including the outlines.
//!
//! Numbers have seven significant digits, about the precision of `f32`.

use super::Fixture;
use glam::Vec3;
use std::fmt::Write;

const COLUMNS: [&str; 19] = [
    "x_m",
    "y_m",
    "z_m",
    "normal_x",
    "normal_y",
    "normal_z",
    "axis_x",
    "axis_y",
    "axis_z",
    "length_m",
    "width_m",
    "area_m2",
    "red_cd_m2",
    "green_cd_m2",
    "blue_cd_m2",
    "flux_lm",
    "cct_k",
    "duv",
    "kind",
];

fn row(fixture: &Fixture) -> [f64; 19] {
    let [p, n, a, r] =
        [fixture.position, fixture.normal, fixture.axis, fixture.radiance].map(|v: Vec3| v.as_dvec3().to_array());
    let size = fixture.size;
    let kind = f64::from(fixture.kind);
    let tail = [size.x, size.y, fixture.area, r[0], r[1], r[2], fixture.flux, fixture.cct, fixture.duv, kind];
    std::array::from_fn(|i| match i / 3 {
        0 => p[i],
        1 => n[i - 3],
        2 => a[i - 6],
        _ => tail[i - 9],
    })
}

/// Formats a number without an exponent, so that every reader accepts it. NaN and infinite values become 0.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(0.0);
    if rounded.is_finite() { rounded.to_string() } else { "0".into() }
}

/// Formats the fixtures as comma-separated values, with a header line that names quantities and units.
pub fn to_csv(fixtures: &[Fixture]) -> String {
    let mut out = COLUMNS.join(",");
    out.push('\n');
    for fixture in fixtures {
        out.push_str(&row(fixture).map(number).join(","));
        out.push('\n');
    }
    out
}

/// Formats the fixtures as `{"fixtures": [{"x_m": …, "outline_m": [[x, y, z], …]}, …]}`.
pub fn to_json(fixtures: &[Fixture]) -> String {
    let mut out = String::from("{\"fixtures\": [");
    for (i, fixture) in fixtures.iter().enumerate() {
        out.push_str(if i == 0 { "\n  {" } else { ",\n  {" });
        for (name, value) in COLUMNS.iter().zip(row(fixture)) {
            // Writing to a string cannot fail.
            let _ = write!(out, "\"{name}\": {}, ", number(value));
        }
        let corner = |c: &Vec3| format!("[{}]", c.as_dvec3().to_array().map(number).join(", "));
        let outline: Vec<String> = fixture.outline.iter().map(corner).collect();
        let _ = write!(out, "\"outline_m\": [{}]}}", outline.join(", "));
    }
    out.push_str("\n]}\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn fixture(x: f32) -> Fixture {
        Fixture {
            position: Vec3::new(x, 2.5, -1.0),
            normal: Vec3::NEG_Y,
            axis: Vec3::X,
            size: DVec2::new(1.2, 0.3),
            area: 0.36,
            radiance: Vec3::new(5000.0, 4000.0, 1.0 / 3.0),
            flux: 4321.123456789,
            cct: 3000.0,
            duv: -0.0012,
            kind: 2,
            outline: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
        }
    }

    #[test]
    fn rows_have_a_value_for_every_column() {
        let csv = to_csv(&[fixture(0.1), fixture(1e-9)]);
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.split(',').count() == COLUMNS.len()), "{csv}");
        assert_eq!(lines[1], "0.1,2.5,-1,0,-1,0,1,0,0,1.2,0.3,0.36,5000,4000,0.3333333,4321.123,3000,-0.0012,2");
        assert!(lines[2].split(',').all(|v| v.parse::<f64>().is_ok()));
        assert_eq!(to_csv(&[]).lines().count(), 1);
    }

    #[test]
    fn json_parses_with_or_without_fixtures() {
        for count in 0..3 {
            let all: Vec<Fixture> = (0..count).map(|i| fixture(i as f32)).collect();
            let parsed: serde_json::Value = serde_json::from_str(&to_json(&all)).unwrap();
            let list = parsed["fixtures"].as_array().unwrap();
            assert_eq!(list.len(), count);
            assert!(list.iter().all(|f| f["flux_lm"] == 4321.123 && f["outline_m"][1][0] == 1.0));
        }
    }
}
