//! Tests that each warning about textures is raised for a bad texture, and that a good texture raises none.

use super::*;
use crate::emission::{from_texture, statistics::Statistics};
use crate::image::Image;
use crate::job::Monitor;
use glam::DVec2;

/// A texture of four lamps. Its fields are set as if it had been made from a photo.
fn made() -> Emission {
    let lamps = Image::from_fn(32, 32, |x, y| [f32::from(x % 16 < 6 && y % 16 < 6); 3]).unwrap();
    let own = from_texture(&lamps, Monitor::default().job()).unwrap();
    assert_eq!(own.warnings(), [], "a texture of the caller's");
    Emission {
        exemplar_metadata: Image::new(4, 4, 3).unwrap(),
        law: Law::Lattice([DVec2::new(16.0, 0.0), DVec2::new(0.0, 16.0)]),
        regularity: 0.9,
        statistics: [Statistics::default(); 2],
        error: 0.02,
        exemplar_lamps: 4,
        ..own
    }
}

fn codes(emission: &Emission) -> Vec<Code> {
    emission.warnings().iter().map(|warning| warning.code).collect()
}

#[test]
fn a_good_texture_raises_nothing() {
    assert_eq!(codes(&made()), []);
}

#[test]
fn a_large_error_raises_a_warning() {
    let far = Emission { error: 0.64, ..made() };
    assert_eq!(codes(&far), [Code::PatternUncertain]);
    assert!(far.warnings()[0].message.contains("64 %"));
    // The warning is raised even if the error is hardly larger than the sampling error.
    assert_eq!(codes(&Emission { sampling_error: 0.6, ..far }), [Code::PatternUncertain]);
    assert_eq!(codes(&Emission { error: f64::NAN, ..made() }), [Code::PatternUncertain]);
}

#[test]
fn a_texture_further_from_the_photo_than_darkness_has_no_pattern() {
    assert_eq!(codes(&Emission { error: 1.0, ..made() }), [Code::PatternUncertain]);
    let hopeless = Emission { error: 2.52, ..made() };
    assert_eq!(codes(&hopeless), [Code::NoPattern]);
    assert!(hopeless.warnings()[0].message.contains("252 %"));
    assert_eq!(codes(&Emission { error: f64::INFINITY, ..made() }), [Code::NoPattern]);
}

#[test]
fn a_texture_by_another_law_is_still_doubted() {
    let second = Emission { error: 0.1, first_error: Some(2.52), ..made() };
    let warnings = second.warnings();
    assert_eq!((warnings[0].code, warnings[0].severity), (Code::NoPattern, 2.52));
    assert!(warnings[0].message.contains("10 %") && warnings[0].message.contains("252 %"), "{}", warnings[0].message);
    // A second attempt that found no better law does not change the warnings.
    let first = Emission { error: 2.52, first_error: Some(2.52), ..made() };
    assert_eq!(first.warnings(), Emission { error: 2.52, ..made() }.warnings());
}

#[test]
fn a_single_lamp_is_no_pattern_but_may_be_copied() {
    let single = Emission { exemplar_lamps: 1, ..made() };
    assert_eq!(codes(&single), [Code::FewLamps]);
    assert_eq!((single.warnings()[0].severity, single.warnings()[0].limit), (1.0, 2.0));
    assert_eq!(codes(&Emission { law: Law::Copy, ..single }), []);
}

#[test]
fn free_patches_raise_a_warning_where_they_differ() {
    let free = |error| Emission { law: Law::Free, regularity: 0.0, error, ..made() };
    assert_eq!(codes(&free(0.05)), []);
    assert_eq!(codes(&free(0.2)), [Code::NoLattice]);
    assert_eq!(codes(&free(0.9)), [Code::PatternUncertain, Code::NoLattice]);
    assert_eq!(codes(&Emission { error: 0.2, ..made() }), []);

    // Repetition as a whole counts as a missing lattice if the photo shows enough lamps for one.
    let whole = |exemplar_lamps| Emission { law: Law::Whole([DVec2::X, DVec2::Y]), exemplar_lamps, ..free(0.2) };
    assert_eq!(codes(&whole(5)), []);
    assert_eq!(codes(&whole(6)), [Code::NoLattice]);
}
