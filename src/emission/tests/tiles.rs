//! Tests that a texture rendered in tiles has the same bits as the texture rendered at once, and that a lamp list
//! agrees with the rendered texture.

use super::*;

#[test]
fn tiles_have_the_bits_of_the_whole_in_any_order() {
    let lattice = || Design::new(200, 180, grid(33.0, 29.0, 12.0, 9.0)).with_corners_cut();
    // Three cases need special rendering. At a scale of 0.11, the edges of lamps may have crumbs. Without
    // `whole_lamps`, lights are copied patch by patch. The border of the exemplar cuts each of the `lines`, so each
    // line is copied as one piece.
    let lines = Design::new(200, 200, |x, y| (y - 5.0).rem_euclid(24.0) < 6.0 && x < 120.0);
    let free = blobs(200, 180, 22.0).0;
    for (exemplar, params) in [
        (lattice(), Params { scale: 1.3, ..Params::default() }),
        (lattice(), Params { scale: 0.11, even_lamps: true, ..Params::default() }),
        (lattice(), Params { whole_lamps: false, ..Params::default() }),
        (free, Params { scale: 0.5, tileable: true, ..Params::default() }),
        (lines, Params::default()),
    ] {
        let params = Params { width: 310, height: 290, ..params };
        let whole = exemplar.run(&params).unwrap();
        let composition = Composition::new(&exemplar.input(), &[], &params, Monitor::default().job()).unwrap();
        let mut tiles: Vec<Tile> = (0..12)
            .map(|i| Tile { x: i % 3 * 110, y: i / 3 * 77, width: 90 + 20 * usize::from(i % 3 < 2), height: 77 })
            .map(|t| Tile { height: t.height.min(290 - t.y), ..t })
            .collect();
        tiles.push(Tile { x: 200, y: 133, width: 1, height: 1 });
        for (n, tile) in tiles.into_iter().rev().enumerate() {
            let render = || composition.tile(&exemplar.input(), &[], tile, Monitor::default().job()).unwrap();
            let (texture, mask) = Pool::new(1 + n % 3).unwrap().run(render);
            for y in 0..tile.height {
                let start = (tile.y + y) * 310 + tile.x;
                let row = |image: &Image, from: usize| {
                    let n = image.channels;
                    image.data[from * n..(from + tile.width) * n].iter().map(|v| v.to_bits()).collect::<Vec<_>>()
                };
                assert_eq!(row(&texture, y * tile.width), row(&whole.texture, start), "{params:?} {tile:?} {y}");
                assert_eq!(row(&mask, y * tile.width), row(&whole.mask, start));
            }
        }
    }
}

#[test]
fn tiles_that_are_no_part_of_the_texture_are_refused() {
    let exemplar = Design::new(100, 90, grid(33.0, 29.0, 12.0, 9.0));
    let params = Params { width: 200, height: 150, ..Params::default() };
    let composition = Composition::new(&exemplar.input(), &[], &params, Monitor::default().job()).unwrap();
    for (x, y, width, height) in [(0, 0, 0, 1), (0, 0, 201, 1), (150, 0, 51, 1), (0, 150, 1, 1), (usize::MAX, 1, 2, 2)]
    {
        let tile = Tile { x, y, width, height };
        let error = composition.tile(&exemplar.input(), &[], tile, Monitor::default().job()).unwrap_err();
        assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains("200 x 150"), "{}", error.message);
    }
    let other = Design::new(90, 100, grid(33.0, 29.0, 12.0, 9.0));
    assert!(composition.tile(&other.input(), &[], composition.whole(), Monitor::default().job()).is_err());
}

#[test]
fn a_composition_lists_the_lamps_that_its_texture_shows() {
    let lattice = || Design::new(200, 180, grid(33.0, 29.0, 12.0, 9.0)).with_corners_cut();
    let round = Design::new(200, 180, |x, y| (x.rem_euclid(40.0) - 20.0).hypot(y.rem_euclid(40.0) - 20.0) < 9.0);
    let whole_pixels = Params { width: 310, height: 290, ..Params::default() };
    for (exemplar, params) in [
        (lattice(), whole_pixels.clone()),
        (lattice(), Params { tileable: true, ..whole_pixels.clone() }),
        (lattice(), Params { scale: 0.37, ..whole_pixels.clone() }),
        (round, Params { scale: 0.7, even_lamps: true, ..whole_pixels.clone() }),
        // Here the texture is smaller than the exemplar, so it is a copied part of it.
        (lattice(), Params { width: 110, height: 90, scale: 1.1, ..whole_pixels }),
    ] {
        let job = Monitor::default();
        let composition = Composition::new(&exemplar.input(), &[], &params, job.job()).unwrap();
        let list = LampList::new(&composition, &exemplar.input(), &[], job.job()).unwrap();
        let listed: Vec<Luminaire> = (0..list.count()).map(|i| list.get(&composition, i).unwrap()).collect();
        assert!(list.get(&composition, list.count()).is_none());
        let shown = exemplar.run(&params).unwrap().luminaires;
        // `listed` or `shown` alone may contain a sliver of a lamp at the border. So compare only lamps of more than 8
        // texels.
        let large = |list: &[Luminaire]| list.iter().filter(|l| l.area > 8.0).cloned().collect::<Vec<_>>();
        let (listed, shown) = (large(&listed), large(&shown));
        assert_eq!(listed.len(), shown.len(), "{params:?}");
        assert!((listed.iter().map(|l| l.flux_share).sum::<f64>() - 1.0).abs() < 0.01);
        for lamp in &shown {
            let apart = |l: &&Luminaire| l.centre.distance(lamp.centre);
            let same = listed.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            // If the lamp lies inside the texture and a texel is one unwarped pixel, allow only rounding errors.
            // Otherwise allow about one texel.
            let size = DVec2::new(params.width as f64, params.height as f64);
            let is_inside = lamp.outline.iter().all(|p| p.min_element() > 0.0 && p.cmplt(size).all());
            if params.scale == 1.0 && is_inside {
                assert_eq!((same.size, same.area), (lamp.size, lamp.area));
                assert!(same.centre.distance(lamp.centre) < 1e-9 && same.outline.len() == lamp.outline.len());
                assert!(same.outline.iter().zip(&lamp.outline).all(|(p, q)| p.distance(*q) < 1e-9));
                assert!((same.colour - lamp.colour).abs().max_element() < 1e-4);
            }
            let (off, perimeter) = (same.centre.distance(lamp.centre), 2.0 * lamp.size.element_sum());
            assert!(off < 1.0 && (same.area - lamp.area).abs() < 0.6 * perimeter, "{params:?} {same:?} {lamp:?}");
            // Do not compare the size of a lamp that the border cuts. In the composition's list (`same`), it has the
            // size of the complete lamp. In the finished texture (`lamp`), it has the size of the visible part.
            let size_off = (same.size - lamp.size).abs().max_element();
            assert!(!is_inside || size_off < 2.5, "{} {}", same.size, lamp.size);
            assert!(!is_inside || (same.kind, lamp.kind) == (1, 1), "{} {}", same.kind, lamp.kind);
        }
    }
}

#[test]
fn a_composition_of_blended_styles_lists_the_lamps_of_each() {
    let exemplar = |side: f64| {
        Design::new(280, 280, move |x, y| {
            (x.rem_euclid(40.0) - 20.0).abs().max((y.rem_euclid(40.0) - 20.0).abs()) < side / 2.0
        })
    };
    let (small, large) = (exemplar(8.0), exemplar(18.0));
    let ramp = Image::from_fn(2, 1, |x, _| [x as f32]).unwrap();
    let params = Params { width: 800, height: 600, ..Params::default() };
    let styles = [Style { input: large.input(), scale: 1.0, weights: &ramp }];
    let job = Monitor::default();
    let composition = Composition::new(&small.input(), &styles, &params, job.job()).unwrap();
    let list = LampList::new(&composition, &small.input(), &styles, job.job()).unwrap();
    let shown = blend(&small.input(), &styles, &params, job.job()).unwrap().luminaires;
    let areas = |lamps: &mut dyn Iterator<Item = f64>| {
        let mut areas: Vec<f64> = lamps.collect();
        areas.sort_by(f64::total_cmp);
        areas
    };
    let listed = areas(&mut (0..list.count()).map(|i| list.get(&composition, i).unwrap().area));
    let shown = areas(&mut shown.iter().map(|l| l.area));
    assert!(listed.len() == shown.len() && listed.iter().zip(&shown).all(|(a, b)| (a - b).abs() < 1e-9));
    // The lamps have 8² = 64 and 18² = 324 pixels. Noise of up to 0.1 in the light mask changes the areas slightly.
    assert!((listed[0] / 64.0 - 1.0).abs() < 0.02 && (listed[listed.len() - 1] / 324.0 - 1.0).abs() < 0.01);
    assert!(LampList::new(&composition, &small.input(), &[], job.job()).is_err());
}
