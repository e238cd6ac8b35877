//! Tests of lights that run through the whole exemplar, such as long lines. Where a tileable texture repeats, the lines
//! must join. A lamp list must contain them.

use super::*;

/// Lines with a width of 6 pixels and a period of 24, along x or along y.
fn lines(along_x: bool) -> Design {
    Design::new(200, 190, move |x, y| (if along_x { y } else { x } - 5.0).rem_euclid(24.0) < 6.0)
}

/// The runs of lit texels in a cyclic row of texels, whose last texel is followed by the first. Returns the start and
/// the length of each run.
fn runs(lit: &[bool]) -> Vec<(usize, usize)> {
    let n = lit.len();
    let starts = (0..n).filter(|&i| lit[i] && !lit[(i + n - 1) % n]);
    starts.map(|i| (i, (0..n).take_while(|k| lit[(i + k) % n]).count())).collect()
}

#[test]
fn lines_meet_where_the_texture_repeats() {
    for (along_x, width, height, scale) in [
        (true, 500, 500, 1.0),
        (false, 500, 470, 1.0),
        (true, 333, 300, 1.0),
        (false, 301, 280, 1.3),
        (true, 210, 101, 0.7),
    ] {
        let exemplar = lines(along_x);
        let params = Params { width, height, scale, tileable: true, ..Params::default() };
        let result = exemplar.run(&params).unwrap();
        let across = if along_x { height } else { width };
        let count = (across as f64 * scale / 24.0).round() as usize;
        let period = across as f64 / count as f64;
        // `slack` is the tolerance for the width of a line, in exemplar pixels; one texel is `scale` pixels. Rounding
        // both edges to whole texels changes a width by at most one texel. If texels are larger than pixels, allow one
        // pixel more, because the pattern is stretched to a whole number of periods.
        let slack = if scale > 1.0 { scale + 1.0 } else { 1.0 };
        for k in 0..width * height / across {
            let at = |i: usize| if along_x { i * width + k } else { k * width + i };
            let lit: Vec<bool> = (0..across).map(|i| result.mask.data[at(i)] > 0.5).collect();
            let runs = runs(&lit);
            assert_eq!(runs.len(), count, "{width} x {height}, {k}: {runs:?}");
            for (i, (start, length)) in runs.iter().enumerate() {
                let after = runs[(i + 1) % count];
                let next = (after.0 + across - start - 1) % across + 1;
                let next = next as f64 + (after.1 as f64 - *length as f64) / 2.0;
                assert!((*length as f64 * scale - 6.0).abs() <= slack, "{width} x {height}, {k}: {runs:?}");
                assert!((next - period).abs() <= 1.0, "{width} x {height}, {k}: {runs:?}, {period}");
            }
        }
    }
}

#[test]
fn a_composition_lists_lines_and_whatever_follows_the_patches() {
    let net = || Design::new(240, 220, |x, y| (x - 5.0).rem_euclid(40.0) < 6.0 || (y - 9.0).rem_euclid(36.0) < 6.0);
    let mixed = Design::new(240, 220, |x, y| {
        let (u, v) = (x.rem_euclid(40.0), y.rem_euclid(40.0));
        v < 5.0 || (10.0..30.0).contains(&u) && (15.0..27.0).contains(&v)
    });
    let lamps = Design::new(200, 180, grid(33.0, 29.0, 12.0, 9.0));
    let whole = Params { width: 310, height: 290, ..Params::default() };
    for (name, exemplar, params) in [
        ("lines along x", lines(true), whole.clone()),
        ("lines along y", lines(false), Params { scale: 0.7, ..whole.clone() }),
        ("tileable lines", lines(false), Params { tileable: true, ..whole.clone() }),
        ("net", net(), whole.clone()),
        ("lines and lamps", mixed, whole.clone()),
        ("lamps as the patches cut them", lamps, Params { whole_lamps: false, ..whole }),
    ] {
        let job = Monitor::default();
        let composition = Composition::new(&exemplar.input(), &[], &params, job.job()).unwrap();
        let list = LampList::new(&composition, &exemplar.input(), &[], job.job()).unwrap();
        let listed: Vec<Luminaire> = (0..list.count()).map(|i| list.get(&composition, i).unwrap()).collect();
        assert!(list.get(&composition, list.count()).is_none());
        assert!((listed.iter().map(|l| l.flux_share).sum::<f64>() - 1.0).abs() < 1e-6, "{name}");
        let shown = exemplar.run(&params).unwrap().luminaires;
        assert_eq!(listed.len(), shown.len(), "{name}");
        for lamp in &shown {
            let apart = |l: &&Luminaire| l.centre.distance(lamp.centre);
            let same = listed.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            let size_off = (same.size - lamp.size).abs().max_element();
            assert!(apart(&same) < 1.0 && size_off < 1.5, "{name}: {same:?} {lamp:?}");
            assert!((same.area / lamp.area - 1.0).abs() < 0.02, "{name}: {same:?} {lamp:?}");
            assert!((same.colour - lamp.colour).abs().max_element() < 1e-3, "{name}: {same:?} {lamp:?}");
        }
    }
}

#[test]
fn lines_that_the_border_cuts_at_different_places_have_no_period_along_them() {
    // The lines begin at the left border and end at different places. Each resembles itself after any short shift.
    let ends = |y: f64| 120.0 + (y / 24.0).floor() * 17.0 % 40.0;
    let exemplar = Design::new(200, 190, move |x, y| (y - 5.0).rem_euclid(24.0) < 6.0 && x < ends(y));
    let monitor = Monitor::default();
    let exemplar = Exemplar::new(&exemplar.input(), 200.0, 0.0, monitor.job()).unwrap();
    let oblique = [DVec2::new(-12.0, 24.0), DVec2::new(37.0, 24.0)];
    let Law::Lattice([along, across]) = lattice::lattice(&exemplar, oblique) else { panic!("no lattice") };
    assert_eq!((along, across.x), (DVec2::X, 0.0));
    assert!((across.y - 24.0).abs() < 1e-6, "{across}");

    // Battens with two ends in view have a true period along them, and no vector of their lattice slides them.
    let battens = Design::new(400, 190, |x, y| (y - 5.0).rem_euclid(24.0) < 6.0 && (x - 10.0).rem_euclid(90.0) < 70.0);
    let battens = Exemplar::new(&battens.input(), 400.0, 0.0, monitor.job()).unwrap();
    let periods = [DVec2::new(90.0, 0.0), DVec2::new(0.0, 24.0)];
    let Law::Lattice(found) = lattice::lattice(&battens, periods) else { panic!("no lattice") };
    assert!(found.iter().zip(&periods).all(|(found, period)| (*found - *period).length() < 0.5), "{found:?}");

    // A net of lines is a single light, which overlaps its copy at its true periods.
    let net = Design::new(240, 220, |x, y| (x - 5.0).rem_euclid(40.0) < 6.0 || (y - 9.0).rem_euclid(36.0) < 6.0);
    let net = Exemplar::new(&net.input(), 240.0, 0.0, monitor.job()).unwrap();
    let periods = [DVec2::new(40.0, 0.0), DVec2::new(0.0, 36.0)];
    assert_eq!(lattice::lattice(&net, periods), Law::Lattice(periods));
}
