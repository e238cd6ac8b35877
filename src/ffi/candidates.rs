//! Candidates for the ceiling
//!
//! Lists the objects and the materials of a scene with their area, height and direction, sorted so that the likeliest
//! ceiling comes first. A host can show this list to let the user choose the surface that will carry the lights. Pass
//! the name of the chosen candidate to luxfer_scene_find_surface or luxfer_transfer_set_scene. A list is a copy: later
//! changes of the scene do not change it.

use super::context::Context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, c_string};
use super::scene::{luxfer_scene, missing};
use super::status::luxfer_status;
use crate::error::Result;
use crate::scene::surface::{self, Candidate, Kind};
use std::ffi::{CString, c_char};
use std::sync::Arc;

/// A list of candidates for the ceiling. See luxfer_scene_get_candidates.
pub struct luxfer_candidates {
    _opaque: [u8; 0],
}

/// Whether a candidate is an object or a material: a LUXFER_CANDIDATE_ value.
pub type luxfer_candidate_kind = i32;
/// An object: all meshes with one name.
pub const LUXFER_CANDIDATE_OBJECT: luxfer_candidate_kind = 0;
/// A material: all triangles that use it.
pub const LUXFER_CANDIDATE_MATERIAL: luxfer_candidate_kind = 1;

/// A candidate for the ceiling: an object or a material of a scene.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_candidate {
    /// sizeof(luxfer_candidate), set by the function that fills the struct.
    pub struct_size: u32,
    /// Whether the candidate is an object or a material: a LUXFER_CANDIDATE_ value.
    pub kind: luxfer_candidate_kind,
    /// Index of the object's first mesh in the scene, or index of the material.
    pub index: u32,
    /// Area of all triangles in m².
    pub area: f32,
    /// Area in m² of the level triangles. A triangle is level if it faces up or down and is inclined by at most 15
    /// degrees to the horizontal.
    pub level_area: f32,
    /// Mean height (y coordinate) in metres, weighted by area, of the level triangles, or of all triangles if no
    /// triangle is level.
    pub height: f32,
    /// Height (y coordinate) of the lowest point, in metres.
    pub low: f32,
    /// Height (y coordinate) of the highest point, in metres.
    pub high: f32,
    /// Mean normal of the front sides of all triangles, weighted by area: a unit vector, or 0 if the normals cancel,
    /// as for a closed box.
    pub normal: [f32; 3],
    /// Resemblance to a ceiling: s = (level_area / area) * min(1, level_area / F) * h², in [0, 1]. F is the floor area
    /// of the scene's bounding box in m², and h = (height - lowest y of the scene) / (height of the scene). A name with
    /// a word for a ceiling, such as "ceiling" or "Decke", raises the score to (1 + s) / 2, unless level_area is 0.
    pub score: f32,
    /// Number of triangles whose area is not 0.
    pub triangles: u64,
    /// Name of the object or material, in zero-terminated UTF-8. The string lives as long as the luxfer_candidates.
    pub name: *const c_char,
    /// The reason for the score: an English sentence that states area, level_area and height, and in percent the
    /// factors min(1, level_area / F) and h of the formula of the score; or that no triangle is level. It is
    /// zero-terminated UTF-8. The string lives as long as the luxfer_candidates.
    pub reason: *const c_char,
}

const SIZE: usize = 72;

versioned!(luxfer_candidate, [SIZE], {
    Self {
        struct_size: SIZE as u32,
        kind: LUXFER_CANDIDATE_OBJECT,
        index: 0,
        area: 0.0,
        level_area: 0.0,
        height: 0.0,
        low: 0.0,
        high: 0.0,
        normal: [0.0; 3],
        score: 0.0,
        triangles: 0,
        name: std::ptr::null(),
        reason: std::ptr::null(),
    }
});

/// The object behind a `luxfer_candidates` handle.
pub(super) struct Candidates {
    context: Arc<Context>,
    list: Vec<CandidateEntry>,
}

/// A candidate, with its name and its reason as C strings.
struct CandidateEntry {
    candidate: Candidate,
    name: CString,
    reason: CString,
}

impl Owned for Candidates {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_candidates {
    type Object = Candidates;
    const TAG: u64 = tag(b"lux.cand");
    const NAME: &'static str = "luxfer_candidates";
}

impl Candidates {
    fn get(&self, index: u32) -> Result<&CandidateEntry> {
        self.list.get(index as usize).ok_or_else(|| missing("candidate", index, self.list.len()))
    }
}

/// Creates a list of the candidates for the ceiling: all objects of a scene and all materials that its triangles use,
/// the likeliest ceiling first. The time of the call is proportional to the number of triangles. The caller releases
/// *candidates. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_candidates(
    scene: *mut luxfer_scene,
    candidates: *mut *mut luxfer_candidates,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Out::new(candidates, "candidates")?;
        let scene = object.snapshot();
        scene.validate()?;
        let entry = |candidate: Candidate| CandidateEntry {
            name: c_string(&candidate.name),
            reason: c_string(&candidate.reason),
            candidate,
        };
        let list = surface::candidates(&scene)?.into_iter().map(entry).collect();
        out.set(handle::give(Arc::new(Candidates { context: object.context().clone(), list })));
        Ok(())
    })
}

/// Gets the number of candidates in a list. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_candidates_get_count(
    candidates: *mut luxfer_candidates,
    count: *mut u32,
) -> luxfer_status {
    enter(candidates, |object| {
        Out::new(count, "count")?.set(u32::try_from(object.list.len()).unwrap_or(u32::MAX));
        Ok(())
    })
}

/// Gets one candidate of a list; index starts at 0. size is sizeof *candidate. Any thread.
/// LUXFER_NOT_FOUND if index is beyond the end of the list.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_candidates_get(
    candidates: *mut luxfer_candidates,
    index: u32,
    candidate: *mut luxfer_candidate,
    size: usize,
) -> luxfer_status {
    enter(candidates, |object| {
        let out = Report::new(candidate, size)?;
        let entry = object.get(index)?;
        let found = &entry.candidate;
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        out.set(luxfer_candidate {
            kind: match found.kind {
                Kind::Object => LUXFER_CANDIDATE_OBJECT,
                Kind::Material => LUXFER_CANDIDATE_MATERIAL,
            },
            index: count(found.index),
            area: found.area as f32,
            level_area: found.level_area as f32,
            height: found.height as f32,
            low: found.low as f32,
            high: found.high as f32,
            normal: found.normal.as_vec3().to_array(),
            score: found.score as f32,
            triangles: found.triangles as u64,
            name: entry.name.as_ptr(),
            reason: entry.reason.as_ptr(),
            ..luxfer_candidate::defaults()
        });
        Ok(())
    })
}
