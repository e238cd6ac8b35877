//! Tests of where the lamps of a pattern lie: offsets, centred lattices, tileable textures, and zones without lamps.

use super::*;
use crate::emission::lattice::copies;

#[test]
fn an_offset_shifts_the_lattice_and_the_copy() {
    let exemplar = Design::new(200, 180, grid(40.0, 36.0, 14.0, 10.0));
    let centres = |params: Params| -> Vec<DVec2> {
        let result = exemplar.run(&params).unwrap();
        inner(&result.luminaires, params.width, params.height).iter().map(|l| l.centre).collect()
    };
    // The periods are 40 along x and 36 along y. The two offsets below differ by one period along x and two along y, so
    // they give the same lattice. The smaller texture is a copy of a part of the exemplar.
    for (width, height) in [(400, 400), (120, 100)] {
        for offset in [DVec2::new(11.0, 25.0), DVec2::new(-29.0, -47.0)] {
            let params = Params { width, height, ..Params::default() };
            let (still, moved) = (centres(params.clone()), centres(Params { offset, ..params }));
            assert!(!still.is_empty() && !moved.is_empty());
            let phase = |c: &DVec2| (c.rem_euclid(DVec2::new(40.0, 36.0)) * 8.0).round();
            let all_alike = |list: &[DVec2], expected: DVec2| list.iter().all(|c| phase(c) == phase(&expected));
            assert!(all_alike(&still, still[0]), "{width}");
            assert!(all_alike(&moved, still[0] + offset), "{width} {offset}: {} {}", still[0], moved[0]);
        }
    }
}

#[test]
fn scattered_lamps_are_shifted_where_they_repeat_and_nowhere_else() {
    let (exemplar, _) = blobs(200, 180, 26.0);
    let params = Params { width: 400, height: 380, tileable: true, ..Params::default() };
    let moved = exemplar.run(&Params { offset: DVec2::new(130.0, -50.0), ..params.clone() }).unwrap();
    let still = exemplar.run(&params).unwrap();
    for (i, texel) in moved.texture.data.chunks_exact(3).enumerate() {
        let (x, y) = ((i % 400 + 400 - 130) % 400, (i / 400 + 50) % 380);
        assert_eq!(texel, still.texture.pixel(x, y));
    }
    let params = Params { tileable: false, offset: DVec2::X, ..params };
    let error = exemplar.run(&params).unwrap_err();
    assert!(
        error.kind == ErrorKind::InvalidArgument && error.message.contains("emission.offset is [1, 0]"),
        "{error:?}"
    );
}

/// Rows of battens, of discs and of squares lie at irregular distances along each row. If they repeat as a whole, the
/// free space between two repetitions is at least the smaller of the gaps between the rows.
#[test]
fn repetitions_of_the_exemplar_keep_its_rows_apart() {
    let is_within = |places: [f64; 4], x: f64, distance: f64| places.iter().any(|u| (x - u).abs() < distance);
    let exemplar = Design::new(240, 116, |x, y| {
        let batten = (y - 8.0).abs() < 3.0 && is_within([24.0, 61.0, 172.0, 219.0], x, 16.0);
        let disc = [33.0, 98.0, 124.0, 202.0].iter().any(|u| (x - u).hypot(y - 52.0) < 7.0);
        batten || disc || ((y - 108.0).abs() < 5.0 && is_within([22.0, 74.0, 95.0, 212.0], x, 5.0))
    });
    let params =
        Params { width: 720, height: 500, law: LawMode::Whole, centring: Centring::Never, ..Params::default() };
    let result = exemplar.run(&params).unwrap();
    let Law::Whole([_, down]) = result.law else { panic!("{:?}", result.law) };
    // Along y, the rows occupy 5 to 11, 45 to 59 and 103 to 113. The smaller of the two gaps is the one from 11 to 45.
    assert!(down.y >= 113.0 - 5.0 + 45.0 - 11.0 - 2.0, "{down}");
    let phase = |y: f64| {
        let off = |row: &f64| ((y - row) / down.y - ((y - row) / down.y).round()).abs() * down.y;
        [8.0, 52.0, 108.0].iter().map(off).fold(f64::MAX, f64::min)
    };
    assert!(result.luminaires.len() >= 30, "{}", result.luminaires.len());
    assert!(result.luminaires.iter().all(|lamp| phase(lamp.centre.y) < 1.0));
}

/// If scattered lamps repeat as a whole with these periods, the lowest lamp lies beside the highest one of the next
/// copy. Copies of another width, and a slightly larger area, keep the lamps apart.
#[test]
fn repetitions_of_scattered_lamps_keep_their_distances() {
    let lamps = [[149, 97], [258, 120], [69, 169], [229, 259], [105, 264], [209, 366], [75, 378], [120, 476]];
    let is_lit = |x: f64, y: f64| lamps.iter().any(|[u, v]| (x - f64::from(*u)).hypot(y - f64::from(*v)) < 11.0);
    let exemplar = Exemplar::new(&Design::new(324, 509, is_lit).input(), 200.0, 0.0, Monitor::default().job()).unwrap();
    let cell = DVec2::new(231.0, 442.0);
    let smallest = |cell: DVec2| {
        let copies = [0.0, 1.0, 2.0].map(|v| [0.0, 1.0, 2.0].map(|u| cell * DVec2::new(u, v)));
        let shifts = copies.as_flattened();
        let centres: Vec<DVec2> =
            lamps.iter().flat_map(|[u, v]| shifts.iter().map(|s| DVec2::new(*u as f64, *v as f64) + *s)).collect();
        statistics::nearest_distances(&centres).into_iter().fold(f64::INFINITY, f64::min)
    };
    assert!(smallest(cell) < 70.0, "{}", smallest(cell));
    let apart = copies::keep_distances(&exemplar, cell, DVec2::splat(150.0));
    assert!(smallest(apart) > 80.0, "{} {apart}", smallest(apart));
    assert!((0.999..1.36).contains(&(apart.element_product() / cell.element_product())), "{apart}");
    // Periods with enough room stay, and no period falls below the minimum.
    let wide = DVec2::new(320.0, 500.0);
    assert_eq!(copies::keep_distances(&exemplar, wide, DVec2::ZERO), wide);
    assert_eq!(copies::keep_distances(&exemplar, cell, cell * 1.4), cell);
}

#[test]
fn centred_lattices_leave_the_same_room_on_all_sides() {
    let plain = Design::new(300, 280, grid(40.0, 36.0, 14.0, 10.0)).with_corners_cut();
    let hexagonal = Design::new(320, 300, |x, y| {
        let (u, v) = ((x - 9.0).rem_euclid(44.0) - 22.0, (y - 5.0).rem_euclid(76.0) - 38.0);
        u.hypot(v) < 9.0 || (u.abs() - 22.0).hypot(v.abs() - 38.0) < 9.0
    });
    let alone = Design::new(80, 60, |x, y| (x - 33.0).abs() < 10.0 && (y - 25.0).abs() < 8.0);
    for (exemplar, width, height) in
        [(&plain, 400, 396), (&plain, 430, 370), (&plain, 260, 200), (&hexagonal, 615, 520), (&alone, 240, 180)]
    {
        let params = Params { width, height, centring: Centring::Always, ..Params::default() };
        let result = exemplar.run(&params).unwrap();
        // The texture must be symmetric under a rotation by 180° about its centre, and no lamp may be cut.
        let size = DVec2::new(width as f64, height as f64);
        for lamp in &result.luminaires {
            let opposite = size - lamp.centre;
            let nearest = result.luminaires.iter().map(|l| l.centre.distance(opposite)).fold(f64::MAX, f64::min);
            assert!(nearest < 1.5, "{width} x {height}: {} {nearest}", lamp.centre);
        }
        assert_eq!(inner(&result.luminaires, width, height).len(), result.luminaires.len(), "{width} x {height}");
        let moved = exemplar.run(&Params { offset: DVec2::new(3.0, 5.0), ..params }).unwrap();
        let expected = result.luminaires[result.luminaires.len() / 2].centre + DVec2::new(3.0, 5.0);
        let nearest = moved.luminaires.iter().map(|l| l.centre.distance(expected)).fold(f64::MAX, f64::min);
        assert!(nearest < 1.0, "{width} x {height}: {nearest}");
    }
}

#[test]
fn the_border_of_a_copied_part_cuts_no_lamp_if_it_can() {
    let exemplar = Design::new(300, 280, grid(40.0, 36.0, 14.0, 10.0));
    for (width, height) in [(100, 90), (124, 100)] {
        let result = exemplar.run(&Params { width, height, ..Params::default() }).unwrap();
        assert_eq!(result.law, Law::Copy);
        assert_eq!(inner(&result.luminaires, width, height).len(), result.luminaires.len(), "{width} x {height}");
        assert!(!result.luminaires.is_empty());
    }
}

#[test]
fn a_pattern_that_continues_beyond_the_photo_is_centred_unless_the_caller_keeps_its_place() {
    let exemplar = Design::new(200, 180, grid(40.0, 36.0, 14.0, 10.0));
    let params = Params { width: 420, height: 396, ..Params::default() };
    let cut = |params: &Params| {
        let lamps = exemplar.run(params).unwrap().luminaires;
        lamps.len() - inner(&lamps, params.width, params.height).len()
    };
    assert_eq!(cut(&params), 0);
    assert_eq!(cut(&Params { centring: Centring::Always, ..params.clone() }), 0);
    let kept = Params { centring: Centring::Never, ..params };
    assert!(cut(&kept) > 0);
}

#[test]
fn lamps_without_a_place_are_left_out() {
    let exemplar = Design::new(200, 200, grid(40.0, 40.0, 14.0, 14.0));
    let result = exemplar.run(&Params { width: 400, height: 400, ..Params::default() }).unwrap();
    let restricted = |zones: &dyn Fn(usize, usize) -> TexelZone| {
        let zones: Vec<TexelZone> = (0..400 * 400).map(|i| zones(i % 400, i / 400)).collect();
        let mut emission = result.clone();
        emission.restrict(&zones, Monitor::default().job()).map(|()| emission)
    };
    // A keep-out zone that touches one lamp must remove all of that lamp, and no other lamp.
    let lamp = &result.luminaires[result.luminaires.len() / 2];
    let corner = lamp.outline[0];
    let touched = restricted(&|x, y| {
        let near = (x as f64 + 0.5 - corner.x).abs() < 1.0 && (y as f64 + 0.5 - corner.y).abs() < 1.0;
        if near { TexelZone::KeepOut } else { TexelZone::Open }
    })
    .unwrap();
    assert_eq!(touched.luminaires.len(), result.luminaires.len() - 1);
    assert!(touched.luminaires.iter().all(|l| l.centre != lamp.centre));
    let lit = |e: &Emission| e.mask.data.iter().sum::<f32>() as f64;
    assert_eq!(lit(&touched), lit(&result) - 196.0);
    assert!((touched.luminaires.iter().map(|l| l.flux_share).sum::<f64>() - 1.0).abs() < 1e-6);
    // Texels that the removed lamp covers partly must be removed as well. Such texels exist only if texels are larger
    // than unwarped pixels.
    let coarse = exemplar.run(&Params { width: 150, height: 150, scale: 2.7, ..Params::default() }).unwrap();
    let lamp_out = &coarse.luminaires[coarse.luminaires.len() / 2];
    let at = lamp_out.centre.y as usize * 150 + lamp_out.centre.x as usize;
    let mut without = coarse.clone();
    let zones: Vec<TexelZone> =
        (0..150 * 150).map(|i| if i == at { TexelZone::KeepOut } else { TexelZone::Open }).collect();
    without.restrict(&zones, Monitor::default().job()).unwrap();
    let near = |i: usize| DVec2::new((i % 150) as f64 + 0.5, (i / 150) as f64 + 0.5).distance(lamp_out.centre) < 7.0;
    assert!((0..150 * 150).filter(|&i| near(i)).all(|i| without.texture.data[3 * i..3 * i + 3] == [0.0; 3]));
    assert!(
        (0..150 * 150)
            .filter(|&i| !near(i))
            .all(|i| without.texture.pixel(i % 150, i / 150) == coarse.texture.pixel(i % 150, i / 150))
    );
    // A hidden zone cuts off the part of a lamp that lies in it.
    let half =
        restricted(&|x, _| if x < lamp.centre.x as usize { TexelZone::Hidden } else { TexelZone::Open }).unwrap();
    assert!(half.luminaires.iter().any(|l| (l.area - lamp.area / 2.0).abs() < 15.0));
    assert!(
        half.texture.data.chunks_exact(3).enumerate().all(|(i, t)| i % 400 >= lamp.centre.x as usize || t == [0.0; 3])
    );
    assert_eq!(restricted(&|_, _| TexelZone::KeepOut).unwrap_err().kind, ErrorKind::Degenerate);
}

#[test]
fn tileable_textures_repeat_without_a_seam() {
    let lattice = Design::new(300, 280, grid(37.3, 51.7, 11.0, 23.0)).with_corners_cut();
    let hexagonal = Design::new(320, 300, |x, y| {
        let (u, v) = ((x - 9.0).rem_euclid(44.0) - 22.0, (y - 5.0).rem_euclid(76.0) - 38.0);
        u.hypot(v) < 9.0 || (u.abs() - 22.0).hypot(v.abs() - 38.0) < 9.0
    });
    let (free, _) = blobs(256, 256, 26.0);
    for (name, exemplar, width, height, scale) in
        [("lattice", lattice, 500, 470, 1.0), ("hexagonal", hexagonal, 333, 420, 1.3), ("free", free, 500, 450, 1.0)]
    {
        let params = Params { width, height, scale, tileable: true, ..Params::default() };
        let result = exemplar.run(&params).unwrap();
        assert_eq!(matches!(result.law, Law::Free), name == "free");
        // Lay two copies of the texture side by side along each axis, and take the lamps whose centres lie in the
        // central quarter, which is as large as the texture. These must be all lamps of the texture, once each and
        // complete.
        let again = |i: usize| (i / (2 * width) % height) * width + i % (2 * width) % width;
        let repeated = components::find(2 * width, 2 * height, |i| result.mask.data[again(i)] > 0.5).unwrap();
        let size = DVec2::new(width as f64, height as f64);
        let in_middle = |c: &&components::Component| {
            let from_corner = c.centre - size / 2.0;
            from_corner.cmpge(DVec2::ZERO).all() && from_corner.cmplt(size).all()
        };
        let areas: Vec<f64> = repeated.list.iter().filter(in_middle).map(|c| c.area as f64).collect();
        let (least, most) = (areas.iter().copied().fold(f64::MAX, f64::min), areas.iter().copied().fold(0.0, f64::max));
        assert_eq!(areas.iter().sum::<f64>(), result.mask.data.iter().sum::<f32>() as f64, "{name}");
        match name {
            // The radii are 4 to 7 pixels, so a disc has 50 to 154 texels. The exemplar's border may cut discs
            // slightly.
            "free" => assert!(least > 0.9 * 16.0 * std::f64::consts::PI && most < 160.0, "{least} {most}"),
            _ => assert!(least > 0.85 * most, "{name}: lamps of {least} to {most} texels"),
        }
        if let Some([a, b]) = result.law.lattice() {
            // Each cell of the stretched lattice must contain one lamp. The lamps must be stretched with the lattice,
            // not keep the distances that they have in the exemplar.
            let lamps = inner(&result.luminaires, width, height);
            let centres: Vec<DVec2> = lamps.iter().map(|l| l.centre).collect();
            let basis = [a / scale, b / scale];
            let phase = statistics::phase(&centres, basis);
            assert!(phase < 0.02, "{name}: {phase}");
            let expected = size.element_product() / basis[0].perp_dot(basis[1]).abs();
            let lit = result.mask.data.iter().sum::<f32>() as f64;
            let mean = lamps.iter().map(|l| l.area).sum::<f64>() / lamps.len() as f64;
            assert!((lit / mean / expected - 1.0).abs() < 0.02, "{name}: {} {expected}", lit / mean);
            let steps = DMat2::from_cols(a, b).inverse() * DVec2::new(width as f64 * scale, 0.0);
            assert!((steps - steps.round()).length() < 1e-9);
        }
    }
    let exemplar = Design::new(200, 200, grid(40.0, 40.0, 14.0, 14.0));
    let small = exemplar.run(&Params { width: 9, height: 9, tileable: true, ..Params::default() }).unwrap_err();
    assert_eq!(small.kind, ErrorKind::Degenerate);
}

#[test]
fn a_row_goes_on_as_the_exemplar_does_and_again_beside_itself() {
    // A column of seven panes. The first and the last are shorter than the others, as in a skylight between walls.
    let exemplar = Design::new(100, 480, |x, y| {
        let pane = ((y - 60.0) / 50.0).floor();
        let along = (y - 60.0).rem_euclid(50.0);
        let short = pane == 0.0 || pane == 6.0;
        (30.0..70.0).contains(&x) && (0.0..7.0).contains(&pane) && along < if short { 20.0 } else { 36.0 }
    });
    let result = exemplar.run(&Params { width: 250, height: 960, ..Params::default() }).unwrap();
    let Law::Row([period, across]) = result.law else { panic!("{:?}", result.law) };
    assert!((period - DVec2::Y * 50.0).length() < 0.5 && across == DVec2::X * 100.0, "{period} {across}");
    for (i, &m) in result.mask.data.iter().enumerate().filter(|(i, _)| i % 250 >= 100) {
        assert_eq!(m, result.mask.data[i - 100]);
    }
    // The texture must begin like the exemplar: a short pane, five long ones and a short one. No pane may be cut.
    let first: Vec<f64> = (result.luminaires.iter())
        .filter(|l| l.centre.x < 100.0 && l.centre.y < 480.0)
        .map(|l| (l.area / 40.0).round())
        .collect();
    assert_eq!(first[..7], [20.0, 36.0, 36.0, 36.0, 36.0, 36.0, 20.0]);
    let is_whole = |l: &&Luminaire| [800.0, 1440.0].iter().any(|area| (l.area / area - 1.0).abs() < 0.01);
    assert!(inner(&result.luminaires, 250, 960).iter().all(is_whole));
}

#[test]
fn rows_at_both_borders_go_on_at_their_own_distance() {
    // Two columns of lamps, with a gap of 76 pixels, near the left and the right border. If the exemplar repeated with
    // its width, the gap between the right column of one copy and the left column of the next would be only 4 pixels.
    let exemplar = Design::new(100, 480, |x, y| {
        ((2.0..12.0).contains(&x) || (88.0..98.0).contains(&x)) && (y - 7.0).rem_euclid(50.0) < 30.0
    });
    let result = exemplar.run(&Params { width: 600, height: 480, ..Params::default() }).unwrap();
    let Law::Row([period, across]) = result.law else { panic!("{:?}", result.law) };
    assert!((period - DVec2::Y * 50.0).length() < 0.5 && across == DVec2::X * 172.0, "{period} {across}");
    let mut columns: Vec<f64> = inner(&result.luminaires, 600, 480).iter().map(|l| l.centre.x).collect();
    columns.sort_by(f64::total_cmp);
    columns.dedup_by(|a, b| (*a - *b).abs() < 5.0);
    assert!(columns.len() > 5 && columns.windows(2).all(|pair| (pair[1] - pair[0] - 86.0).abs() < 2.0), "{columns:?}");
}
