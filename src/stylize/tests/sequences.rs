//! Frames of sequences: patches astride silhouettes, light that changes, and motion that is wrong.

use super::*;
use crate::image::Comparison;
use crate::patch::NONE;

/// The frame in which the ball has its centre at `x`: the guide of light, and a guide that marks the ball.
fn frame(x: f32) -> (Image, Image) {
    let light = scene(90, 70, x, 36.0, 18.0);
    let mark = Image::from_fn(90, 70, |x, y| [light.pixel(x, y)[2]]).unwrap();
    (light, mark)
}

fn with_mark<'a>(a: &'a (Image, Image), b: &'a (Image, Image)) -> [Guide<'a>; 2] {
    let mark = Guide { name: "mark", range: Range::Data, ..guide(&a.1, &b.1) };
    [guide(&a.0, &b.0), mark]
}

#[test]
fn patches_astride_a_silhouette_keep_no_match() {
    let a = scene(60, 50, 30.0, 25.0, 15.0);
    let art = artwork(&a);
    let guides = [guide(&a, &a)];
    let monitor = Monitor::default();
    let problem = level::Problem::new(&input(&art, &guides), &Params::default(), monitor.job()).unwrap();
    let before = crate::patch::Field::proportional(
        56,
        46,
        &level::Level::new(&problem, &Params::default(), 1.0, 1, monitor.job()).unwrap().allowed,
    )
    .unwrap();
    // The right part of the picture has moved left by 4 pixels, and the last column was not visible in the previous
    // frame.
    let motion = |x: usize| match x {
        0..30 => [0.0, 0.0],
        30..59 => [4.0, 0.0],
        _ => [f32::NAN, 0.0],
    };
    let motion = Image::from_fn(60, 50, |x, _| motion(x)).unwrap();
    let moved = animate::moved(&before, &motion, &problem, 0, monitor.job()).unwrap();
    for x in 0..56 {
        // The patch at x covers the columns x to x + 4.
        let expected = match x {
            0..26 => 10 * 56 + x as u32,
            30..52 => 10 * 56 + x as u32 + 4,
            _ => NONE,
        };
        assert_eq!(moved.from[10 * 56 + x], expected, "{x}");
    }
}

#[test]
fn paint_follows_light_that_fades_slowly() {
    let a = scene(80, 60, 40.0, 30.0, 18.0);
    let art = artwork(&a);
    let target = |t: usize| {
        let mut image = scene(90, 70, 40.0, 36.0, 18.0);
        image.data.chunks_exact_mut(3).for_each(|p| p[..2].iter_mut().for_each(|v| *v *= 0.96f32.powi(t as i32)));
        image
    };
    let still = Image::new(90, 70, 2).unwrap();
    // Returns the mean lightness of the last of nine frames. `remembers` says whether each frame gets the record of the
    // previous frame.
    let last = |remembers: bool| {
        let mut output = stylise(&input(&art, &[guide(&a, &target(0))]), &Params::default()).unwrap();
        for t in 1..9 {
            let now = target(t);
            let guides = [guide(&a, &now)];
            let guide_record = remembers.then_some(&output.guide_record);
            let next =
                Input { previous: Some(&output.field), motion: Some(&still), guide_record, ..input(&art, &guides) };
            output = stylise(&next, &Params { seed: t as u64, ..Params::default() }).unwrap();
        }
        mean(&output.image)
    };
    let first = mean(&stylise(&input(&art, &[guide(&a, &target(0))]), &Params::default()).unwrap().image);
    let fresh = mean(&stylise(&input(&art, &[guide(&a, &target(8))]), &Params::default()).unwrap().image);
    let share = |end: f64| (end - first) / (fresh - first);
    let (with, without) = (share(last(true)), share(last(false)));
    assert!((0.8..1.2).contains(&with) && with > without, "{with} {without}: {first} {fresh}");
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|v| f64::from(*v)).sum::<f64>() / image.data.len() as f64
}

#[test]
fn light_that_stays_keeps_all_paint() {
    let a = scene(80, 60, 40.0, 30.0, 18.0);
    let (art, target) = (artwork(&a), scene(90, 70, 40.0, 36.0, 18.0));
    let guides = [guide(&a, &target)];
    let first = stylise(&input(&art, &guides), &Params::default()).unwrap();
    let still = Image::new(90, 70, 2).unwrap();
    let again = |guide_record| Input {
        previous: Some(&first.field),
        motion: Some(&still),
        guide_record,
        ..input(&art, &guides)
    };
    let params = Params { seed: 2, ..Params::default() };
    let [with, without] =
        [Some(&first.guide_record), None].map(|guide_record| stylise(&again(guide_record), &params).unwrap());
    assert!(with.image == without.image && with.guide_record == first.guide_record);
}

#[test]
fn wrong_motion_is_noticed_by_guides_of_data() {
    let a = frame(40.0);
    let (before, now) = (frame(40.0), frame(46.0));
    let art = artwork(&a.0);
    let params = Params::fast();
    for preview in [false, true] {
        let params = Params { preview, ..params.clone() };
        let first = stylise(&input(&art, &with_mark(&a, &before)), &params).unwrap();
        let guides = with_mark(&a, &now);
        let agreement = |motion: &dyn Fn(usize, usize) -> [f32; 2]| {
            let motion = Image::from_fn(90, 70, motion).unwrap();
            let guide_record = Some(&first.guide_record);
            let next =
                Input { previous: Some(&first.field), motion: Some(&motion), guide_record, ..input(&art, &guides) };
            stylise(&next, &params).unwrap().report.agreement
        };
        let ball = |x: usize, y: usize| now.1.pixel(x, y)[0] > 0.5;
        let uncovered = |x: usize, y: usize| before.1.pixel(x, y)[0] > 0.5 && !ball(x, y);
        let right = agreement(&|x, y| match (ball(x, y), uncovered(x, y)) {
            (true, _) => [-6.0, 0.0],
            (false, true) => [f32::NAN; 2],
            _ => [0.0, 0.0],
        });
        assert_eq!(right.wrong, 0, "{right:?}");
        assert_eq!(right.place, None);
        assert!(motion_disagrees(right).is_none());
        if preview {
            assert_eq!(right, Comparison::default());
            continue;
        }
        // With zero motion, pixels at the ball's front edge lead to background in the previous frame, and pixels just
        // behind the ball lead to the ball.
        let wrong = agreement(&|_, _| [0.0, 0.0]);
        assert!(wrong.compared == 90 * 70 && wrong.wrong > 0, "{wrong:?}");
        let [x, y] = wrong.place.unwrap();
        assert_ne!(before.1.pixel(x, y), now.1.pixel(x, y));
        let warning = motion_disagrees(wrong).unwrap();
        assert!(warning.severity == wrong.wrong as f64 / wrong.compared as f64 && warning.place.is_some());
    }
}
