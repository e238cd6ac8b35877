//! Photos of bent and crumpled sheets, and photos by lenses that distort.

use super::paper::{Defects, NONE, Numbers, Profile, View};
use super::{params, picture};
use crate::image::{Image, pyramid};
use crate::job::Monitor;
use crate::rectify::{self, GridMap};
use crate::sheet::page::Page;
use crate::sheet::{Aligned, align, places, print};
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

const PHOTO: DVec2 = DVec2::new(1300.0, 1000.0);
/// Factor of the stated error that the true one exceeds in one of twenty photos.
const CONFIDENCE: f64 = 1.96;

/// Returns a photo of a sheet with blur, noise and light that falls off to one side, and the view that it shows.
fn photograph(sheet: &Image, defects: Defects, seed: u64) -> (Image, View) {
    let view = View::new(DVec2::new(sheet.width as f64, sheet.height as f64), PHOTO, defects, 45.0, seed);
    let job = Monitor::default();
    let map = GridMap::sample(PHOTO.x as usize, PHOTO.y as usize, |p| view.page(p)).unwrap();
    let sharp = rectify::warp_grid(sheet, &map, job.job()).unwrap();
    let mut photo = pyramid::blur(&sharp, 0.7, job.job()).unwrap();
    let mut numbers = Numbers(seed);
    for (i, pixel) in photo.data.chunks_exact_mut(3).enumerate() {
        let light = 0.9 - 0.45 * (i % PHOTO.x as usize) as f32 / PHOTO.x as f32;
        pixel.iter_mut().for_each(|v| *v = v.max(0.03) * light + 0.01 * numbers.noise() as f32);
    }
    (photo, view)
}

/// The root mean square distance, over the picture and in pixels of it, between true and found positions.
fn error(aligned: &Aligned, page: &Page, view: &View) -> f64 {
    let from_picture = page.from_picture(160, 120);
    let per_pixel = page.size[0] / 160.0;
    let square = |p: &DVec2| {
        let on_page = from_picture.apply(*p);
        let off = aligned.map.apply(*p) - view.photo(on_page);
        (view.derivative(on_page).inverse() * off / per_pixel).length_squared()
    };
    let places = places(160, 120);
    (places.iter().map(square).sum::<f64>() / places.len() as f64).sqrt()
}

fn aligned(photo: &Image) -> Aligned {
    align(photo, 160, 120, &params(), Monitor::default().job()).unwrap()
}

fn sheet_and_page() -> (Image, Page) {
    let sheet = print(&picture(), &params(), Monitor::default().job()).unwrap();
    (sheet, Page::new(&params(), 160, 120).unwrap())
}

/// Bent paper whose height is the given share of the page's longer side.
fn bent(bow: f64, angle: f64) -> Defects {
    Defects { bow, angle, ..NONE }
}

#[test]
fn bent_paper_and_lenses_that_distort_are_modelled() {
    let (sheet, page) = sheet_and_page();
    let barrel = |third: f64, fifth: f64, paper: Defects| Defects { barrel: [third, fifth], ..paper };
    let all = [
        bent(0.005, 0.0),
        bent(0.01, FRAC_PI_2),
        bent(0.01, 0.4),
        bent(0.02, 0.0),
        bent(0.04, 0.0),
        Defects { profile: Profile::Curl, ..bent(0.02, 0.0) },
        Defects { profile: Profile::Wave, ..bent(0.01, FRAC_PI_2) },
        barrel(0.01, 0.0, NONE),
        barrel(0.04, 0.0, NONE),
        barrel(0.03, -0.015, NONE),
        barrel(0.02, 0.0, bent(0.01, 0.0)),
        barrel(0.04, 0.0, bent(0.02, 1.0)),
    ];
    for (seed, defects) in all.into_iter().enumerate() {
        let (photo, view) = photograph(&sheet, defects, 10 + seed as u64);
        let found = aligned(&photo);
        let off = error(&found, &page, &view);
        assert!(off < 0.05 && off < CONFIDENCE * found.error, "{defects:?}: {off} {}", found.error);
        assert!(found.error < 0.1 && found.bend > 2.0 * off && found.bend > 0.02, "{defects:?}: {}", found.bend);
        assert_eq!((found.marks, found.dots), (10, page.dots.len()), "{defects:?}");
    }
}

#[test]
fn flat_paper_is_as_exact_as_before() {
    let (sheet, page) = sheet_and_page();
    for seed in 0..3 {
        let (photo, view) = photograph(&sheet, NONE, seed);
        let found = aligned(&photo);
        let off = error(&found, &page, &view);
        assert!(off < 0.02 && off < CONFIDENCE * found.error && found.error < 0.03, "{off} {}", found.error);
        assert!(found.bend < 0.01, "{}", found.bend);
    }
}

#[test]
fn crumpled_paper_shows_in_the_stated_error() {
    let (sheet, page) = sheet_and_page();
    let flat = aligned(&photograph(&sheet, NONE, 1).0).error;
    let mut covered = 0;
    for seed in 0..6 {
        let crumpled = Defects { relief: [0.003, 0.2], ..NONE };
        let (photo, view) = photograph(&sheet, crumpled, 30 + seed);
        let found = aligned(&photo);
        let off = error(&found, &page, &view);
        covered += usize::from(off < CONFIDENCE * found.error);
        assert!(off > 0.03 && off < 4.0 * found.error, "{seed}: {off} {}", found.error);
        assert!(found.error > 10.0 * flat, "{seed}: {} {flat}", found.error);
    }
    assert!(covered >= 5, "{covered}");
}

#[test]
fn sheets_without_dots_are_aligned_too() {
    let (mut sheet, page) = sheet_and_page();
    for dot in &page.dots {
        let reach = page.dot_radius + 2.0;
        for y in (dot.y - reach) as usize..(dot.y + reach) as usize {
            for x in (dot.x - reach) as usize..(dot.x + reach) as usize {
                sheet.pixel_mut(x, y).fill(1.0);
            }
        }
    }
    for (limit, defects) in [(0.03, NONE), (0.1, bent(0.01, 0.0)), (0.1, Defects { barrel: [0.02, 0.0], ..NONE })] {
        let (photo, view) = photograph(&sheet, defects, 3);
        let found = aligned(&photo);
        let off = error(&found, &page, &view);
        assert_eq!((found.marks, found.dots), (10, 0));
        assert!(off < limit && off < CONFIDENCE * found.error, "{defects:?}: {off} {}", found.error);
    }
}

/// Paint covers one mark and a quarter of the dots, and moves the edges of an eighth.
#[test]
fn covered_marks_and_dots_are_left_out() {
    let (mut sheet, page) = sheet_and_page();
    let mut cover = |centre: DVec2, radius: f64| {
        for y in (centre.y - radius) as usize..=(centre.y + radius) as usize {
            for x in (centre.x - radius) as usize..=(centre.x + radius) as usize {
                if centre.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)) < radius {
                    sheet.pixel_mut(x, y).copy_from_slice(&[0.5, 0.2, 0.1]);
                }
            }
        }
    };
    cover(page.marks[2], 1.3 * page.radius);
    let hidden: Vec<DVec2> = page.dots.iter().copied().step_by(4).collect();
    let moved: Vec<DVec2> = page.dots.iter().copied().skip(2).step_by(8).collect();
    hidden.iter().for_each(|dot| cover(*dot, 2.0 * page.dot_radius));
    moved.iter().for_each(|dot| cover(*dot + 0.7 * page.dot_radius, 0.8 * page.dot_radius));
    for seed in 4..6 {
        let (photo, view) = photograph(&sheet, bent(0.01, 0.0), seed);
        let found = aligned(&photo);
        let off = error(&found, &page, &view);
        // As exact as sheets without paint.
        assert!(off < 0.02 && off < CONFIDENCE * found.error && found.error < 0.03, "{off} {}", found.error);
        assert_eq!((found.marks, found.dots), (9, page.dots.len() - hidden.len() - moved.len()));
    }
}
