//! Tests of the second attempt, by other laws, after a texture that is worse than darkness.

use super::*;
use crate::emission::other_laws::try_other_laws;

#[test]
fn a_texture_that_is_worse_than_darkness_is_replaced_by_a_better_law() {
    let design = Design::new(300, 262, grid(40.0, 40.0, 14.0, 14.0));
    let params = Params { width: 400, height: 380, ..Params::default() };
    let again = |first: Emission, params: &Params| {
        try_other_laws(first, &design.input(), params, Monitor::default().job()).unwrap()
    };
    // Make a texture by patches without a period, and give it a large error, so that it counts as a failed first
    // texture.
    let first = design.run(&Params { law: LawMode::Free, ..params.clone() }).unwrap();
    let bad = Emission { error: 2.5, ..first.clone() };
    let second = again(bad.clone(), &params);
    assert!(matches!(second.law, Law::Lattice(_)), "{:?}", second.law);
    assert_eq!(second.first_error, Some(2.5));
    assert!(second.error < 0.02, "{}", second.error);
    assert_eq!(second.texture.data, design.run(&params).unwrap().texture.data);

    // No other law is tried if the caller asks for a law, or if the texture differs less from the photo than a texture
    // without light does.
    let asked = again(bad.clone(), &Params { law: LawMode::Free, ..params.clone() });
    assert_eq!((asked.law, asked.first_error, asked.error), (Law::Free, None, 2.5));
    let fair = again(Emission { error: 0.9, ..first.clone() }, &params);
    assert_eq!((fair.law, fair.first_error), (Law::Free, None));

    // The textures of all laws are compared with the statistics that were expected of the first texture, not only with
    // their own expectations. Here ten times as much light is expected, and no law gives that much.
    let mut expected = first.statistics[0];
    expected.lit *= 10.0;
    let hopeless = again(Emission { error: 1.3, statistics: [expected; 2], ..first }, &params);
    assert!((hopeless.error - 0.9).abs() < 0.02 && hopeless.first_error == Some(1.3), "{}", hopeless.error);
}

#[test]
fn a_cancelled_second_attempt_is_an_error() {
    let design = Design::new(300, 262, grid(40.0, 40.0, 14.0, 14.0));
    let params = Params { width: 400, height: 380, ..Params::default() };
    let first = Emission { error: 2.5, ..design.run(&params).unwrap() };
    let monitor = Monitor::default();
    monitor.cancel();
    let stopped = try_other_laws(first, &design.input(), &params, monitor.job()).unwrap_err();
    assert_eq!(stopped.kind, ErrorKind::Cancelled);
}
