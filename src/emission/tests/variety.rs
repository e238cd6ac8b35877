//! Tests that a texture keeps the variation between the lamps of its exemplar, even if the lamps lie on a lattice.

use super::*;
use crate::emission::analysis::evidence::Evidence;
use crate::emission::analysis::sites::Sites;
use crate::emission::exemplar::roles::Role;

/// Square lamps of 14 pixels with period 40. `level` gives the brightness of each lamp from its cell.
fn of_levels(side: usize, level: impl Fn([i64; 2]) -> f32) -> Design {
    let mut exemplar = Design::new(side, side, |x, y| {
        (x.rem_euclid(40.0) - 20.0).abs() < 7.0 && (y.rem_euclid(40.0) - 20.0).abs() < 7.0
    });
    for i in 0..side * side {
        let place = [(i % side / 40) as i64, (i / side / 40) as i64];
        exemplar.unwarped.data[3 * i..3 * i + 3].fill(level(place));
    }
    exemplar
}

/// Mean and standard deviation.
fn deviation(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
}

#[test]
fn lamps_on_a_lattice_vary_as_in_the_exemplar() {
    // Every lamp has a different brightness.
    let level = |[i, j]: [i64; 2]| 0.3 + 0.5 * Rng::new(5, &[i as u64, j as u64]).next_f32();
    let exemplar = of_levels(400, level);
    let result = exemplar.run(&Params { width: 1200, height: 1200, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)));
    let lamps = inner(&result.luminaires, 1200, 1200);
    let known: Vec<f64> = (0..100).map(|k| f64::from(level([k % 10, k / 10]))).collect();
    let source = |lamp: &Luminaire| {
        let off = |k: &usize| (known[*k] - f64::from(lamp.colour.y)).abs();
        let nearest = (0..100).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        assert!(off(&nearest) < 1e-4, "{}: a lamp of no level that the exemplar has", lamp.colour);
        nearest
    };
    let sources: Vec<usize> = lamps.iter().map(|lamp| source(lamp)).collect();

    // The texture must show most lamps of the exemplar, and no lamp far more often than the others.
    let mut times = [0; 100];
    sources.iter().for_each(|&k| times[k] += 1);
    let shown = times.iter().filter(|&&n| n > 0).count();
    assert!(shown >= 60, "{shown} of 100 are shown");
    assert!(times.iter().max().unwrap() * 15 < sources.len(), "{times:?}");

    // The mean and the standard deviation of the brightness must agree with the exemplar. Patches copy groups of lamps,
    // so both are only as precise as in a random sample of 100 lamps, the number of the exemplar. Allow three standard
    // errors of such a sample. The levels are uniformly distributed, for which the standard error of the deviation is
    // about half the standard error of the mean.
    let (mean, spread) = deviation(&sources.iter().map(|&k| known[k]).collect::<Vec<_>>());
    let (expected, exact) = deviation(&known);
    let standard = exact / (known.len() as f64).sqrt();
    assert!((mean - expected).abs() < 3.0 * standard, "{mean} {expected}");
    assert!((spread - exact).abs() < 1.5 * standard, "{spread} {exact}");
}

#[test]
fn lamps_off_their_places_stay_as_far_off_and_no_farther() {
    let (period, most) = (40.0, 2.0);
    let off = |i: i64, j: i64| {
        let mut rng = Rng::new(8, &[i as u64, j as u64]);
        (DVec2::new(rng.next_f64(), rng.next_f64()) * 2.0 - 1.0) * most
    };
    let exemplar = Design::new(480, 480, |x, y| {
        let (i, j) = ((x / period).floor(), (y / period).floor());
        let centre = (DVec2::new(i, j) + 0.5) * period + off(i as i64, j as i64);
        (DVec2::new(x, y) - centre).abs().max_element() < 8.0
    });
    let result = exemplar.run(&Params { width: 1200, height: 1000, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)), "{:?}", result.law);
    let basis = [DVec2::X * period, DVec2::Y * period];
    let phase = |result: &Emission, width: usize, height: usize| {
        let centres: Vec<DVec2> = inner(&result.luminaires, width, height).iter().map(|l| l.centre).collect();
        statistics::phase(&centres, basis)
    };
    let own = exemplar.run(&Params { width: 480, height: 480, ..Params::default() }).unwrap();
    let (own, made) = (phase(&own, 480, 480), phase(&result, 1200, 1000));
    // The offsets are uniform in a square with sides of 2 `most`, so their root mean square is √(2/3) `most`. The
    // texture must have the same value. If position errors accumulated over its thirty periods, the value would be
    // larger.
    assert!((own / ((2.0f64 / 3.0).sqrt() * most / period) - 1.0).abs() < 0.15, "{own}");
    assert!((made / own - 1.0).abs() < 0.15, "{made} {own}");
}

#[test]
fn scattered_lamps_among_those_of_a_lattice_stay_whole_and_it_in_step() {
    // Square lamps with a period of 48, and round lamps at random positions that do not touch the squares.
    let square = |p: DVec2| (p.rem_euclid(DVec2::splat(48.0)) - 24.0).abs().max_element();
    let mut rng = Rng::new(31, &[]);
    let mut discs: Vec<DVec2> = Vec::new();
    for _ in 0..6000 {
        let p = DVec2::new(rng.next_f64(), rng.next_f64()) * 480.0;
        if square(p) > 14.0 && discs.iter().all(|d| d.distance(p) > 40.0) {
            discs.push(p);
        }
    }
    let exemplar = Design::new(480, 480, |x, y| {
        let p = DVec2::new(x, y);
        square(p) < 8.0 || discs.iter().any(|d| d.distance(p) < 4.0)
    });
    let result =
        exemplar.run(&Params { width: 1152, height: 1056, centring: Centring::Never, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)), "{:?}", result.law);
    let lamps = inner(&result.luminaires, 1152, 1056);
    let (squares, round): (Vec<&Luminaire>, Vec<&Luminaire>) = lamps.into_iter().partition(|l| l.area > 150.0);
    assert!(squares.iter().all(|l| (l.area - 256.0).abs() < 30.0), "a square lamp is cut or has met another");
    assert!(round.iter().all(|l| (40.0..62.0).contains(&l.area)), "a round lamp is cut or has met another");
    // There must be two kinds, one for each shape.
    assert!(squares.iter().all(|l| l.kind == squares[0].kind) && round.iter().all(|l| l.kind == round[0].kind));
    let mut kinds = [squares[0].kind, round[0].kind];
    kinds.sort_unstable();
    assert_eq!(kinds, [1, 2]);
    let centres: Vec<DVec2> = squares.iter().map(|l| l.centre).collect();
    assert!(statistics::phase(&centres, [DVec2::X * 48.0, DVec2::Y * 48.0]) < 0.02);
    let cells = (1152.0 / 48.0) * (1056.0 / 48.0);
    assert!((squares.len() as f64 / cells - 1.0).abs() < 0.01, "{} of {cells}", squares.len());
    assert!(!round.is_empty());
}

#[test]
fn lamps_that_are_missing_do_not_hide_the_period_of_the_others() {
    // A tenth of the lamps is missing. Shifts with a small overlap compare few lamps and may correlate well by chance,
    // so the lattice search subtracts two standard errors from each correlation. It still finds a wrong lattice for
    // about one in twenty random choices of the missing lamps.
    let mut wrong = Vec::new();
    for draw in 0..24 {
        let exemplar = Design::new(480, 300, |x, y| {
            let cell = [(x / 40.0) as u64, (y / 36.0) as u64];
            grid(40.0, 36.0, 16.0, 12.0)(x, y) && Rng::new(draw, &cell).next_f64() < 0.9
        });
        let measured = measure(&exemplar.input(), &Params::default(), Monitor::default().job()).unwrap();
        let [a, b] = measured.analysis.law.lattice().unwrap();
        let per_cell = a.perp_dot(b).abs() / (40.0 * 36.0);
        if (per_cell - 1.0).abs() > 0.01 {
            wrong.push((draw, per_cell));
        }
    }
    assert!(wrong.len() <= 1, "draws, and places in a cell: {wrong:?}");
}

#[test]
fn lamps_are_missing_as_often_as_where_the_exemplar_shows_their_places_whole() {
    // About a quarter of the 9 × 9 places has no lamp. The border cuts the outermost places in half.
    let has_lamp = |i: i64, j: i64| Rng::new(3, &[i as u64, j as u64]).next_f64() < 0.75;
    let exemplar = Design::new(320, 320, |x, y| {
        let (u, v) = (x + 10.0, y + 10.0);
        let at_lamp = u.rem_euclid(40.0) < 20.0 && v.rem_euclid(40.0) < 20.0;
        at_lamp && has_lamp((u / 40.0) as i64, (v / 40.0) as i64)
    });
    let whole = (1..8).flat_map(|j| (1..8).map(move |i| (i, j)));
    let expected = whole.filter(|&(i, j)| has_lamp(i, j)).count() as f64 / 49.0;
    let seeds = 1..=6;
    let mut sum = 0.0;
    for seed in seeds.clone() {
        let result = exemplar.run(&Params { width: 800, height: 800, seed, ..Params::default() }).unwrap();
        assert!(matches!(result.law, Law::Lattice(_)), "{:?}", result.law);
        // Divide the lit area by the area of a lamp, 20 × 20, and by the number of cells, also 20 × 20.
        sum += result.mask.data.iter().map(|&m| f64::from(m)).sum::<f64>() / 400.0 / 400.0;
    }
    let filled = sum / seeds.count() as f64;
    // If patches could show the dark places at the border, but not the lit ones, the number of lamps would be lower by
    // about an eighth.
    assert!((filled / expected - 1.0).abs() < 0.05, "{filled} {expected}");
}

/// The exemplar, and the sites of its whole lamps for a lattice.
fn sites(design: &Design, basis: [DVec2; 2]) -> (Exemplar, Sites) {
    let exemplar = Exemplar::new(&design.input(), 200.0, 0.0, Monitor::default().job()).unwrap();
    let sites = Sites::new(&exemplar, &exemplar.measured_lamps(Role::is_whole), Law::Lattice(basis)).unwrap();
    (exemplar, sites)
}

#[test]
fn a_lamp_off_the_lattice_is_not_repeated_in_every_cell() {
    // Four rows of two lamps, and a lamp between two further rows.
    let is_lit = |x: f64, y: f64| {
        let is_at = |u: f64, v: f64| (x - u).abs() < 9.0 && (y - v).abs() < 5.0;
        [20.0, 60.0, 100.0, 140.0].iter().any(|v| is_at(30.0, *v) || is_at(80.0, *v)) || is_at(30.0, 168.0)
    };
    let (_, sites) = sites(&Design::new(110, 200, is_lit), [DVec2::X * 50.0, DVec2::Y * 40.0]);
    let of_lamps = |count: usize| sites.list.iter().find(|site| site.lamps.len() == count).unwrap();
    assert_eq!(of_lamps(8).occupancy(), 1.0);
    // Of the nine places among the lamps, one has a lamp.
    let stray = of_lamps(1);
    assert!(stray.occupancy() < 0.3 && stray.hole_count >= 3, "{} {}", stray.occupancy(), stray.hole_count);
}

#[test]
fn two_lamps_show_no_lattice_and_three_that_lie_askew_do() {
    let show = |lamps: &[DVec2]| {
        let design = Design::new(400, 260, |x, y| lamps.iter().any(|lamp| lamp.distance(DVec2::new(x, y)) < 7.0));
        let (exemplar, sites) = sites(&design, [DVec2::X * 90.0, DVec2::Y * 120.0]);
        sites.show_both_periods(&Evidence::of(&exemplar))
    };
    let [one, two, three] = [DVec2::new(100.0, 80.0), DVec2::new(280.0, 80.0), DVec2::new(190.0, 200.0)];
    assert!(!show(&[one, two]));
    assert!(show(&[one, two, three]));
    // The third lamp may be cut by the border.
    assert!(show(&[one, two, DVec2::new(10.0, 200.0), DVec2::new(370.0, 257.0)]));
    // All steps are multiples of one.
    assert!(!show(&[one, DVec2::new(190.0, 200.0)]));
}
