use super::*;
use glam::{DMat2, DQuat, DVec2, DVec3};

/// Calls `check` with numbers of every exponent and both signs, and with the special ones.
fn for_all(step: usize, mut check: impl FnMut(f32)) {
    for bits in (0..=u32::MAX).step_by(step) {
        check(f32::from_bits(bits));
    }
    for x in [0.0, 1.0, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN, f32::from_bits(1)] {
        check(x);
        check(-x);
    }
}

/// The difference between a result and the true value, in units of the last place of `f32`.
fn ulps(got: f32, want: f64) -> f64 {
    let rounded = want as f32;
    if !got.is_finite() || !rounded.is_finite() {
        return if got == rounded || got.is_nan() && rounded.is_nan() { 0.0 } else { f64::INFINITY };
    }
    let exponent = (rounded.to_bits() >> 23 & 255).max(1) as i32;
    (f64::from(got) - want).abs() / 2f64.powi(exponent - 127 - 23)
}

/// The largest error of a function over all arguments, with the argument.
fn largest_error(own: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) -> (f64, f32) {
    let mut worst = (0.0, 0.0);
    for_all(4001, |x| {
        let error = ulps(own(x), exact(f64::from(x)));
        if !(error <= worst.0) {
            worst = (error, x);
        }
    });
    worst
}

#[test]
fn own_functions_round_almost_exactly() {
    let functions: [(&str, fn(f32) -> f32, fn(f64) -> f64); 9] = [
        ("sin_cos, sine", |x| sin_cos(x).0, f64::sin),
        ("sin_cos, cosine", |x| sin_cos(x).1, f64::cos),
        ("sin", sin, f64::sin),
        ("cos", cos, f64::cos),
        ("tan", tan, f64::tan),
        ("exp", exp, f64::exp),
        ("exp2", exp2, f64::exp2),
        ("ln", ln, f64::ln),
        ("log2", log2, f64::log2),
    ];
    for (name, own, exact) in functions {
        let (error, x) = largest_error(own, exact);
        assert!(error < 0.52, "{name}({x:e}) is off by {error} ulp");
    }
    for power in [2.4, 1.0 / 2.4, 0.5, -1.0, 3.0, 17.3, 1e-3, 0.0, 1e20, f32::NAN, f32::INFINITY, -f32::INFINITY] {
        let (error, x) = largest_error(|x| powf(x, power), |x| x.powf(f64::from(power)));
        assert!(error < 0.52, "powf({x:e}, {power}) is off by {error} ulp");
    }
}

#[test]
fn zeros_keep_their_signs() {
    for function in [sin, tan, asin, atan, tanh, exp_m1, ln_1p, cbrt] {
        assert_eq!(function(-0f32).to_bits(), (-0f32).to_bits());
        assert_eq!(function(0f32).to_bits(), 0);
    }
}

#[test]
fn functions_of_the_crate_are_those_of_their_names() {
    let one: [(&str, fn(f64) -> f64, fn(f64) -> f64, fn(f32) -> f32); 15] = [
        ("sin", sin, f64::sin, sin),
        ("cos", cos, f64::cos, cos),
        ("tan", tan, f64::tan, tan),
        ("asin", asin, f64::asin, asin),
        ("acos", acos, f64::acos, acos),
        ("atan", atan, f64::atan, atan),
        ("tanh", tanh, f64::tanh, tanh),
        ("exp", exp, f64::exp, exp),
        ("exp2", exp2, f64::exp2, exp2),
        ("exp_m1", exp_m1, f64::exp_m1, exp_m1),
        ("ln", ln, f64::ln, ln),
        ("ln_1p", ln_1p, f64::ln_1p, ln_1p),
        ("log2", log2, f64::log2, log2),
        ("log10", log10, f64::log10, log10),
        ("cbrt", cbrt, f64::cbrt, cbrt),
    ];
    let close = |got: f64, want: f64, tolerance: f64| {
        got.is_nan() && want.is_nan() || (got - want).abs() <= tolerance * want.abs()
    };
    for i in -400..400 {
        let (x, y) = (f64::from(i) / 37.0 + 0.013, 1.7 - f64::from(i) / 91.0);
        for (name, own, std, of_single) in one {
            let (got, want) = (own(x), std(x));
            assert!(close(got, want, 1e-14), "{name}({x}) = {got}, not {want}");
            let (x, want) = (x as f32, std(f64::from(x as f32)));
            assert!(close(f64::from(of_single(x)), want, 4e-7), "{name}({x}) = {}, not {want}", of_single(x));
        }
        assert_eq!(sin_cos(x), (sin(x), cos(x)));
        let two = [
            (atan2(x, y), x.atan2(y), atan2(x as f32, y as f32)),
            (hypot(x, y), x.hypot(y), hypot(x as f32, y as f32)),
            (powf(x, y), x.powf(y), powf(x as f32, y as f32)),
        ];
        for (k, (got, want, of_single)) in two.into_iter().enumerate() {
            assert!(close(got, want, 1e-14), "{k} of {x} and {y}: {got}, not {want}");
            assert!(close(f64::from(of_single), want, 3e-6), "{k} of {x} and {y}: {of_single}, not {want}");
        }
    }
}

#[test]
fn integer_powers_are_products() {
    for x in [1.7f64, -0.3, 1e30, 0.0, f64::NAN, f64::INFINITY] {
        let products = [1.0, x, x * x, x * (x * x), (x * x) * (x * x)];
        for (n, product) in (0..).zip(products) {
            assert_eq!(powi(x, n).to_bits(), product.to_bits(), "{x} to the power {n}");
            assert_eq!(powi(x, -n).to_bits(), (1.0 / product).to_bits(), "{x} to the power -{n}");
            assert_eq!(powi(x as f32, 2).to_bits(), (x as f32 * x as f32).to_bits());
        }
    }
    assert_eq!(powi(2f64, i32::MIN), 0.0);
}

#[test]
fn rotations_are_those_of_glam() {
    for i in -9..9 {
        let angle = 0.7 * f64::from(i);
        let axis = DVec3::new(0.6, 0.0, -0.8);
        assert!(direction_at(angle).abs_diff_eq(DVec2::from_angle(angle), 1e-15));
        assert!((angle_of(direction_at(angle)) - DVec2::from_angle(angle).to_angle()).abs() < 1e-15);
        assert!(rotation_2d(angle).abs_diff_eq(DMat2::from_angle(angle), 1e-15));
        assert!(rotation_about(axis, angle).abs_diff_eq(DQuat::from_axis_angle(axis, angle), 1e-15));
        assert!(rotation_by(axis * angle).abs_diff_eq(DQuat::from_scaled_axis(axis * angle), 1e-15));
    }
}

/// Records the bits of all functions, so that a platform with other bits fails.
#[test]
fn the_bits_are_those_recorded() {
    let mut hash = 0;
    let mut add = |bits: u64| hash = crate::rng::mix(hash ^ bits);
    for i in -3000..3000 {
        let (x, y) = (f64::from(i) * 0.013, f64::from(7 * i % 1000) * 0.0071);
        let two = [atan2(x, y), powf(x, y), hypot(x, y), powi(x, i % 9), sin_cos(x).0, sin_cos(x).1];
        let one = [sin, cos, tan, asin, acos, atan, tanh, exp, exp2, exp_m1, ln, ln_1p, log2, log10, cbrt];
        one.map(|function| function(x)).into_iter().chain(two).for_each(|v| add(canonical(v)));
        let (x, y) = (x as f32, y as f32);
        let two = [atan2(x, y), powf(x, y), hypot(x, y), powi(x, i % 9), sin_cos(x).0, sin_cos(x).1];
        let one = [sin, cos, tan, asin, acos, atan, tanh, exp, exp2, exp_m1, ln, ln_1p, log2, log10, cbrt];
        one.map(|function| function(x)).into_iter().chain(two).for_each(|v| add(canonical(f64::from(v))));
    }
    assert_eq!(hash, 0x9489_056e_ce29_daa0, "{hash:#x}");
}

/// The bits of a number. All NaN count as one: the sign of a NaN that an operation makes differs between processors.
fn canonical(value: f64) -> u64 {
    if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
}
