//! A layout with a low `trust` raises a warning; a depth map does not.

use super::*;
use crate::features::{Layout, Params, run};
use crate::image::Image;
use crate::job::Monitor;

fn features(depth_source: DepthSource, trust: f64) -> Features {
    let photo = Image::from_fn(24, 16, |x, y| [x as f32 / 24.0, 0.5, y as f32 / 16.0]).unwrap();
    let input = crate::features::Input { photo: &photo, depth: None, room: None };
    let made = run(&input, &Params::default(), Monitor::default().job()).unwrap();
    let layout = (depth_source == DepthSource::Layout).then_some(Layout { sides: [1.0; 4], score: 0.5, trust });
    Features { depth_source, layout, ..made }
}

#[test]
fn a_layout_warns_by_its_trust() {
    assert_eq!(features(DepthSource::Layout, 0.8).warnings(), []);
    let warnings = features(DepthSource::Layout, 0.02).warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!((warnings[0].code, warnings[0].severity), (Code::LayoutUncertain, 0.02));
    assert!(warnings[0].message.contains("2.0 %"), "{}", warnings[0].message);
}

#[test]
fn depth_that_is_given_is_believed_and_none_at_all_is_not() {
    assert_eq!(features(DepthSource::Caller, 0.0).warnings(), []);
    assert_eq!(features(DepthSource::Network, 0.0).warnings(), []);
    assert_eq!(features(DepthSource::Neutral, 0.0).warnings()[0].code, Code::LayoutUncertain);
}
