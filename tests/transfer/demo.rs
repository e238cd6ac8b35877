//! Tests the whole lighting transfer from the generated demonstration photo, whose camera and lamps are known exactly.

use glam::{DVec2, DVec4, Vec3};
use luxfer::demo::{self, photo};
use luxfer::emission::{Law, Luminaire};
use luxfer::error::ErrorKind;
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight;
use luxfer::render::World;
use luxfer::segment::StrokeSet;
use luxfer::transfer::{Input, Params, Pattern, Scale, Stage, Transfer};
use luxfer::warning::Code;
use std::sync::{Arc, OnceLock};

/// Width and height of the photo in pixels.
const SIZE: [usize; 2] = [540, 360];

/// Returns a small transfer with all inputs set, and the room that the photo shows.
fn prepared(pool: &Pool) -> (Transfer, demo::Exemplar) {
    static PHOTO: OnceLock<Arc<Image>> = OnceLock::new();
    let photo = PHOTO.get_or_init(|| photo_of(pool, 16, 3)).clone();
    prepared_with(photo)
}

fn photo_of(pool: &Pool, samples: u32, seed: u64) -> Arc<Image> {
    let room = demo::exemplar_room().unwrap();
    let camera = room.scene.cameras[room.camera].clone();
    let size = photo::Params { width: SIZE[0], height: SIZE[1], samples, seed };
    let scene = Arc::new(room.scene);
    let monitor = Monitor::default();
    let (picture, _) = pool.run(|| photo::photograph(scene, &camera, &size, monitor.job())).unwrap();
    Arc::new(picture)
}

fn prepared_with(photo: Arc<Image>) -> (Transfer, demo::Exemplar) {
    let room = demo::exemplar_room().unwrap();
    let camera = &room.scene.cameras[room.camera];
    let input = Input {
        strokes: demo::strokes(&room, SIZE[0], SIZE[1]).unwrap(),
        photo: Some(photo),
        scene: Some(Arc::new(demo::target_room().unwrap())),
        surface: "Ceiling".into(),
        ..Input::default()
    };
    let mut params = Params::default();
    params.relight.target_error = 0.02;
    params.render.width = 64;
    params.render.height = 36;
    params.render.samples = 8;
    // State the distance from the camera to the ceiling, which sets the scale of the pattern.
    params.plane_distance = f64::from(room.ceiling_height - camera.position.y);
    (Transfer { input, params, ..Transfer::default() }, room)
}

#[test]
fn lamps_keep_their_size_and_spacing_and_the_ceiling_gets_its_colour() {
    let pool = Pool::new(0).unwrap();
    let (mut transfer, room) = prepared(&pool);
    let monitor = Monitor::default();
    pool.run(|| transfer.run(Stage::View, Stage::Render, monitor.job(), |_| {})).unwrap();
    assert_eq!(monitor.progress(), 1.0);
    let results = &transfer.results;
    assert_eq!(results.warnings(&transfer.input.strokes), [], "a clean photo raises no warning");

    // Check the camera, whose horizontal field of view is 66 degrees.
    let perspective = &results.view.as_ref().unwrap().perspective;
    let focal = 540.0 / 2.0 / 33f64.to_radians().tan();
    assert!((perspective.focal / focal - 1.0).abs() < 0.05, "focal length {} px, truly {focal}", perspective.focal);

    // Check the lamps: in metres, they have the size and spacing of those in the photo. Only whole lamps count,
    // because the border of the ceiling cuts others.
    let fixtures = transfer.results.fixtures().unwrap();
    let largest = fixtures.iter().map(|f| f.area).fold(0.0, f64::max);
    let whole: Vec<_> = fixtures.iter().filter(|f| f.area > 0.8 * largest).collect();
    let areas: Vec<f64> = fixtures.iter().map(|f| f.area).collect();
    assert!(whole.len() >= 4, "{} whole lamps of {}, in m²: {areas:.3?}", whole.len(), fixtures.len());
    // The mask of a lamp is never too small, but up to two pixels too large on each side: a lamp fifty times as bright
    // as white is clipped, and so are its blur and glow. At the fourth row of lamps, two pixels are 9 cm along the
    // ceiling. Like the spacing below, the scale may be off by 3 %.
    let side = f64::from(room.grid.size.x);
    let two_pixels = 2.0 * 4.7f64.powi(2) / (transfer.params.plane_distance * focal);
    let most = 1.03 * ((side + 2.0 * two_pixels) * (side + 2.0 * 2.0 * 4.7 / focal)).sqrt();
    for lamp in &whole {
        let seen = lamp.area.sqrt();
        assert!(seen > 0.97 * side && seen < most, "a lamp of {seen} m, truly {side}, at most {most}");
    }
    let nearest = |from: Vec3| {
        let others = whole.iter().map(|f| f64::from(f.position.distance(from))).filter(|d| *d > 0.1);
        others.fold(f64::INFINITY, f64::min)
    };
    let mut spacings: Vec<f64> = whole.iter().map(|f| nearest(f.position)).collect();
    spacings.sort_by(f64::total_cmp);
    let (spacing, period) = (spacings[spacings.len() / 2], f64::from(room.grid.period.min_element()));
    assert!((spacing / period - 1.0).abs() < 0.03, "lamps {spacing} m apart, truly {period}");

    // Check the colour: measured again with other paths, the ceiling of the lit scene has the colour of the photo's
    // ceiling.
    let lit = results.lit.as_ref().unwrap();
    let mesh = lit.placed.mesh;
    let triangles: Vec<_> = (0..lit.scene.meshes[mesh].triangles.len()).map(|t| (mesh, t)).collect();
    let target = results.target.unwrap() * transfer.params.white_luminance;
    let again = pool.run(|| {
        let world = World::build(lit.scene.clone(), monitor.job()).unwrap();
        let input =
            relight::Input { world: &world, emitter: lit.placed.material, target_triangles: &triangles, target };
        let params = relight::Params { seed: 77, ..transfer.params.relight.clone() };
        relight::run(&input, &params, monitor.job()).unwrap()
    });
    let stated = transfer.results.solution.as_ref().unwrap().error();
    for c in 0..3 {
        // Add the two independent confidence intervals, widened to 99.9 % because three channels are compared.
        let allowed = 1.8 * (stated + again.half_width[c]);
        assert!((again.scale[c] - 1.0).abs() < allowed, "channel {c}: {} +- {allowed}", again.scale[c]);
    }
}

#[test]
fn noise_in_the_photo_does_not_change_the_design() {
    let pool = Pool::new(0).unwrap();
    for (samples, seed) in [(8, 3), (16, 4)] {
        let (mut transfer, room) = prepared_with(photo_of(&pool, samples, seed));
        let monitor = Monitor::default();
        pool.run(|| transfer.run(Stage::View, Stage::Emission, monitor.job(), |_| {})).unwrap();
        let emission = transfer.results.emission.as_ref().unwrap();
        assert!(matches!(emission.law, Law::Lattice(_)), "{seed}: {:?}", emission.law);
        // The ceiling has as many lamps as fit at the photo's spacing, and no other lit regions.
        let ceiling = transfer.results.unsolved.as_ref().unwrap().surface.size.as_dvec2();
        let periods = ceiling / room.grid.period.as_dvec2();
        let (fewest, most) = (periods.floor().element_product(), (periods.floor() + 1.0).element_product());
        let count = emission.luminaires.len() as f64;
        assert!(count >= fewest && count <= most, "{seed}: {count} lamps, {fewest} to {most} fit");
    }
}

#[test]
fn the_pattern_lies_on_the_surface_as_the_settings_state() {
    let pool = Pool::new(0).unwrap();
    let monitor = Monitor::default();
    let (mut transfer, _) = prepared(&pool);
    pool.run(|| transfer.run(Stage::View, Stage::Unwarp, monitor.job(), |_| {})).unwrap();
    let mut lay = |pattern: Pattern, zones: &[DVec4]| {
        transfer.params.pattern = pattern;
        transfer.input.zones = zones.to_vec();
        pool.run(|| transfer.run(Stage::Emission, Stage::Emission, monitor.job(), |_| {})).unwrap();
        let emission = transfer.results.emission.clone().unwrap();
        let unsolved = transfer.results.unsolved.clone().unwrap();
        (emission.luminaires.clone(), unsolved.texel_size, unsolved.surface.clone())
    };
    let median = |mut list: Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list[list.len() / 2]
    };

    // Set the size of lamps to half a metre: their bounding boxes are correct within a texel on each side.
    let (lamps, texel, _) = lay(Pattern { scale: Scale::Lamp(0.5), ..Pattern::default() }, &[]);
    let length = median(lamps.iter().map(|l| l.size.x * texel).collect());
    assert!((length - 0.5).abs() < 0.05, "{length} m");

    // Set a spacing of 0.6 m and texels of 1 cm; keep lamps half a metre from every edge and away from a duct.
    let duct = DVec4::new(2.0, 0.0, 3.0, 4.0);
    let settings = Pattern { scale: Scale::Spacing(0.6), texel_size: 0.01, margin: 0.5, ..Pattern::default() };
    let (lamps, texel, surface) = lay(settings, &[duct]);
    assert!((texel - 0.01).abs() < 1e-6);
    let corners = || lamps.iter().flat_map(|l| &l.outline).map(|p| *p * texel);
    let size = surface.size.as_dvec2();
    for p in corners() {
        assert!(p.min_element() > 0.49 && (size - p).min_element() > 0.49, "a lamp reaches {p} of {size}");
        assert!(p.x < duct.x - 0.49 || p.x > duct.z + 0.49, "a lamp reaches {p}");
    }
    let nearest = |l: &Luminaire| {
        let others = lamps.iter().map(|o| o.centre.distance(l.centre)).filter(|d| *d > 1.0);
        others.fold(f64::INFINITY, f64::min) * texel
    };
    let spacing = median(lamps.iter().map(nearest).collect());
    assert!((spacing - 0.6).abs() < 0.03, "{spacing} m");

    // Rotate the pattern: the lamps lie along other axes, and the texture covers the rotated bounding rectangle of the
    // surface.
    let (_, _, turned) = lay(Pattern { rotation: 0.4, ..Pattern::default() }, &[]);
    assert!((turned.u_axis.dot(surface.u_axis) - 0.4f32.cos()).abs() < 1e-5);
    let (sin, cos) = 0.4f64.sin_cos();
    assert!(
        (turned.size.as_dvec2() - DVec2::new(size.x * cos + size.y * sin, size.x * sin + size.y * cos)).length() < 1e-3
    );
}

#[test]
fn what_is_missing_is_named_and_a_cancelled_run_keeps_what_it_has() {
    let pool = Pool::new(0).unwrap();
    let monitor = Monitor::default();
    let empty = pool.run(|| Transfer::default().run(Stage::View, Stage::Render, monitor.job(), |_| {})).unwrap_err();
    assert_eq!((empty.kind, empty.message.contains("set the photo")), (ErrorKind::InvalidOperation, true), "{empty}");

    let (mut transfer, _) = prepared(&pool);
    let late = pool.run(|| transfer.run(Stage::Emission, Stage::Render, monitor.job(), |_| {})).unwrap_err();
    assert_eq!((late.kind, late.message.contains("run stage Lights")), (ErrorKind::InvalidOperation, true), "{late}");
    let backwards = pool.run(|| transfer.run(Stage::Render, Stage::View, monitor.job(), |_| {})).unwrap_err();
    assert_eq!(backwards.kind, ErrorKind::InvalidArgument);
    // Settings of the last stage and the name of the surface are checked before the work starts.
    let mut wrong = transfer.clone();
    wrong.params.render.width = 0;
    let early = pool.run(|| wrong.run(Stage::View, Stage::Render, monitor.job(), |_| {})).unwrap_err();
    assert!(early.message.contains("stage Render") && early.message.contains("width is 0"), "{early}");
    let mut nowhere = transfer.clone();
    nowhere.input.surface = "Sky".into();
    let early = pool.run(|| nowhere.run(Stage::View, Stage::Render, monitor.job(), |_| {})).unwrap_err();
    assert_eq!(early.kind, ErrorKind::NotFound);
    assert!(nowhere.results.view.is_none());

    // Cancel the run once the lights are found; then resume it from there.
    let cancelling = Monitor::default();
    let run = pool.run(|| {
        transfer.run(Stage::View, Stage::Render, cancelling.job(), |results| {
            if results.lights.is_some() {
                cancelling.cancel();
            }
        })
    });
    assert_eq!(run.unwrap_err().kind, ErrorKind::Cancelled);
    assert!(transfer.results.lights.is_some() && transfer.results.unwarped.is_none());
    pool.run(|| transfer.run(Stage::Unwarp, Stage::Emission, monitor.job(), |_| {})).unwrap();
    assert!(transfer.results.emission.is_some());

    // A texture of the caller replaces the synthesised one.
    let stripe = Image::from_fn(12, 8, |x, _| if x == 3 { [1.0, 0.9, 0.8] } else { [0.0; 3] }).unwrap();
    transfer.input.texture = Some(Arc::new(stripe.clone()));
    pool.run(|| transfer.run(Stage::Emission, Stage::Relight, monitor.job(), |_| {})).unwrap();
    assert_eq!(transfer.results.emission.as_ref().unwrap().texture, stripe);
    let fixtures = transfer.results.fixtures().unwrap();
    assert_eq!(fixtures.len(), 1);
    assert!((fixtures[0].area - 6.0 * 4.0 / 12.0).abs() < 1e-3, "{} m²", fixtures[0].area);
    transfer.input.texture = Some(Arc::new(Image::new(4, 4, 3).unwrap()));
    let black = pool.run(|| transfer.run(Stage::Emission, Stage::Emission, monitor.job(), |_| {})).unwrap_err();
    assert_eq!(black.kind, ErrorKind::Degenerate, "{black}");
    transfer.input.texture = None;

    // A missing surface, or a plane without light, is an error.
    transfer.input.surface = "No such thing".into();
    let wrong = pool.run(|| transfer.run(Stage::Emission, Stage::Emission, monitor.job(), |_| {})).unwrap_err();
    assert_eq!(wrong.kind, ErrorKind::NotFound, "{wrong}");
    transfer.input.surface = "Ceiling".into();
    let lights = Arc::make_mut(transfer.results.lights.as_mut().unwrap());
    lights.confidence.data.fill(0.0);
    lights.mask.data.fill(0.0);
    let dark = pool.run(|| transfer.run(Stage::Emission, Stage::Emission, monitor.job(), |_| {})).unwrap_err();
    assert_eq!(dark.kind, ErrorKind::Degenerate, "{dark}");
}

#[test]
fn without_strokes_the_ceiling_and_its_lamps_are_proposed_with_a_warning() {
    let pool = Pool::new(0).unwrap();
    let (mut transfer, _) = prepared(&pool);
    let monitor = Monitor::default();
    pool.run(|| transfer.run(Stage::View, Stage::Lights, monitor.job(), |_| {})).unwrap();
    let masks = |transfer: &Transfer| {
        let results = &transfer.results;
        [&results.plane, &results.lights].map(|mask| mask.as_ref().unwrap().mask.clone())
    };
    let painted = masks(&transfer);
    transfer.input.strokes = StrokeSet::default();
    pool.run(|| transfer.run(Stage::View, Stage::Emission, monitor.job(), |_| {})).unwrap();
    for ((painted, proposed), least) in painted.iter().zip(&masks(&transfer)).zip([0.85, 0.8]) {
        let count = |is: &dyn Fn(bool, bool) -> bool| {
            painted.data.iter().zip(&proposed.data).filter(|(a, b)| is(**a > 0.5, **b > 0.5)).count() as f64
        };
        let iou = count(&|a, b| a && b) / count(&|a, b| a || b);
        assert!(iou > least, "intersection over union {iou}");
    }
    let warnings = transfer.results.warnings(&transfer.input.strokes);
    let proposed = warnings.iter().filter(|(_, w)| w.code == Code::Proposed).map(|(stage, _)| *stage);
    assert_eq!(proposed.collect::<Vec<_>>(), [Some(Stage::Plane), Some(Stage::Lights)]);
}
