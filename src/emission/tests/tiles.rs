//! A texture rendered in tiles is the texture rendered at once.

use super::*;

#[test]
fn tiles_have_the_bits_of_the_whole_in_any_order() {
    let lattice = || Design::new(200, 180, grid(33.0, 29.0, 12.0, 9.0)).with_corners_cut();
    // Lights that run out of the exemplar follow the patches; large lamps in fine texels lose crumbs of their edges.
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
        let plan = Plan::new(&exemplar.input(), &[], &params, Monitor::default().job()).unwrap();
        let mut tiles: Vec<Tile> = (0..12)
            .map(|i| Tile { x: i % 3 * 110, y: i / 3 * 77, width: 90 + 20 * usize::from(i % 3 < 2), height: 77 })
            .map(|t| Tile { height: t.height.min(290 - t.y), ..t })
            .collect();
        tiles.push(Tile { x: 200, y: 133, width: 1, height: 1 });
        for (n, tile) in tiles.into_iter().rev().enumerate() {
            let render = || plan.tile(&exemplar.input(), &[], tile, Monitor::default().job()).unwrap();
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
    let plan = Plan::new(&exemplar.input(), &[], &params, Monitor::default().job()).unwrap();
    for (x, y, width, height) in [(0, 0, 0, 1), (0, 0, 201, 1), (150, 0, 51, 1), (0, 150, 1, 1), (usize::MAX, 1, 2, 2)]
    {
        let tile = Tile { x, y, width, height };
        let error = plan.tile(&exemplar.input(), &[], tile, Monitor::default().job()).unwrap_err();
        assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains("200 x 150"), "{}", error.message);
    }
    let other = Design::new(90, 100, grid(33.0, 29.0, 12.0, 9.0));
    assert!(plan.tile(&other.input(), &[], plan.whole(), Monitor::default().job()).is_err());
}
