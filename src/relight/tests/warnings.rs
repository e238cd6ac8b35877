//! Tests of the warnings about channels that do not meet their target, and about targets that are only upper or lower
//! limits.

use super::*;
use glam::DVec3;

fn solution(status: [TargetStatus; 3], constraint: [Constraint; 3]) -> Solution {
    Solution {
        scale: DVec3::ONE,
        half_width: DVec3::splat(0.01),
        status,
        constraint,
        response: DVec3::ONE,
        background: DVec3::ZERO,
        delta_e: 0.1,
        paths: 1024,
    }
}

#[test]
fn channels_that_meet_their_target_raise_no_warning() {
    assert_eq!(solution([TargetStatus::Met; 3], [Constraint::Exactly; 3]).warnings(), []);
    assert_eq!(solution([TargetStatus::Met; 3], [Constraint::AtMost; 3]).warnings(), []);
}

#[test]
fn channels_that_are_not_met_are_named_with_the_reason() {
    let warnings =
        solution([TargetStatus::Dark, TargetStatus::Met, TargetStatus::TooBright], [Constraint::Exactly; 3]).warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!((warnings[0].code, warnings[0].severity), (Code::Unreachable, 2.0));
    let message = &warnings[0].message;
    assert!(message.contains("red, of which no light") && message.contains("blue, which other lights"), "{message}");
}

#[test]
fn a_clipped_target_raises_a_warning() {
    let warnings =
        solution([TargetStatus::Met; 3], [Constraint::AtLeast, Constraint::Exactly, Constraint::AtLeast]).warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!((warnings[0].code, warnings[0].severity), (Code::TargetClipped, 2.0));
    assert!(warnings[0].message.contains("red, blue"), "{}", warnings[0].message);
}
