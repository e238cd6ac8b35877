//! Results of lamps
//!
//! The functions of this section return the powers that the solver has found, the light that each goal receives, and
//! the contribution of each lamp to each goal.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::lamps::luxfer_lamps;
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, copy_text};
use super::relight::{luxfer_outcome, outcome_value};
use super::scene::missing;
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind};
use crate::image::colour::luminance;
use crate::relight::Quantity;
use glam::DVec3;
use std::f64::consts::PI;
use std::ffi::c_char;

/// Summary of the solution for lamps.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_lamps_report {
    /// sizeof(luxfer_lamps_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of lamps.
    pub lamps: u32,
    /// Number of groups.
    pub groups: u32,
    /// Number of goals.
    pub goals: u32,
    /// Number of paths traced for each goal.
    pub paths: u32,
    /// 1 if all goals of positive weight are met, else 0: luxfer_lamps_get_reason then gives the reason.
    pub all_goals_satisfied: u32,
}

versioned!(luxfer_lamps_report, [24], {
    Self { struct_size: 24, lamps: 0, groups: 0, goals: 0, paths: 0, all_goals_satisfied: 0 }
});

/// The solution for one lamp.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_lamp {
    /// sizeof(luxfer_lamp), set by the function that fills the struct.
    pub struct_size: u32,
    /// Index of the group that the lamp belongs to.
    pub group: u32,
    /// Centre of the lamp: (u, v, 0) in texture coordinates if the emission has a texture, else the position in metres;
    /// 0 for directional lights.
    pub centre: [f64; 3],
    /// Factor for the lamp's emission, per channel, >= 0.
    pub scale: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field scale.
    pub half_width: [f64; 3],
}

versioned!(luxfer_lamp, [80], {
    Self { struct_size: 80, group: 0, centre: [0.0; 3], scale: [0.0; 3], half_width: [0.0; 3] }
});

/// The light that the surface or grid of one goal receives with the powers found.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_lamps_goal {
    /// sizeof(luxfer_lamps_goal), set by the function that fills the struct.
    pub struct_size: u32,
    /// Whether each channel meets its target: a LUXFER_OUTCOME_ value.
    pub outcome: [luxfer_outcome; 3],
    /// Target: the mean radiance that the goal's surface should have, in cd/m² per channel. For a grid, it is the
    /// wanted illuminance divided by pi.
    pub target: [f64; 3],
    /// Mean radiance of the goal's surface with the powers found, in cd/m² per channel.
    pub achieved: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field achieved, in cd/m².
    pub half_width: [f64; 3],
    /// Mean radiance of the goal's surface from all light but the lamps, in cd/m² per channel.
    pub background: [f64; 3],
    /// Target in lux: pi times the luminance of the field target. This field and the three fields below are set only
    /// for goals of illuminance: grids, and meshes with LUXFER_QUANTITY_INCIDENT. They are 0 for other goals.
    pub target_lux: f64,
    /// Illuminance with the powers found, in lux.
    pub achieved_lux: f64,
    /// Half-width of the 95 % confidence interval of achieved_lux, in lux. It is an upper bound, computed as if the
    /// errors of all channels had the same sign.
    pub half_width_lux: f64,
    /// Illuminance from all light but the lamps, in lux.
    pub background_lux: f64,
}

versioned!(luxfer_lamps_goal, [144], {
    let zero = [0.0; 3];
    Self {
        struct_size: 144,
        outcome: [0; 3],
        target: zero,
        achieved: zero,
        half_width: zero,
        background: zero,
        target_lux: 0.0,
        achieved_lux: 0.0,
        half_width_lux: 0.0,
        background_lux: 0.0,
    }
});

/// The light that the surface or grid of one goal receives from one lamp.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_lamps_response {
    /// sizeof(luxfer_lamps_response), set by the function that fills the struct.
    pub struct_size: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Mean radiance of the goal's surface from the lamp at scale 1, in cd/m² per channel.
    pub mean: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field mean, per channel, in cd/m².
    pub half_width: [f64; 3],
}

versioned!(luxfer_lamps_response, [56], {
    Self { struct_size: 56, reserved: 0, mean: [0.0; 3], half_width: [0.0; 3] }
});

/// Gets the summary of the result. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_report(
    lamps: *mut luxfer_lamps,
    report: *mut luxfer_lamps_report,
    size: usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        let out = Report::new(report, size)?;
        let o = stage.output()?;
        out.set(luxfer_lamps_report {
            lamps: o.lamps.count() as u32,
            groups: o.solution.scale.len() as u32,
            goals: o.targets.len() as u32,
            paths: o.responses.paths,
            all_goals_satisfied: u32::from(o.solution.unreachable.is_none()),
            ..luxfer_lamps_report::defaults()
        });
        Ok(())
    })
}

/// Gets the solution for one lamp; index starts at 0. size is sizeof *lamp. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such lamp.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_lamp(
    lamps: *mut luxfer_lamps,
    index: u32,
    lamp: *mut luxfer_lamp,
    size: usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        let out = Report::new(lamp, size)?;
        let o = stage.output()?;
        let &group = o.group_of.get(index as usize).ok_or_else(|| missing("lamp", index, o.group_of.len()))?;
        out.set(luxfer_lamp {
            group,
            centre: o.lamps.centres()[index as usize].as_dvec3().to_array(),
            scale: o.solution.scale[group as usize].to_array(),
            half_width: o.solution.half_width[group as usize].to_array(),
            ..luxfer_lamp::defaults()
        });
        Ok(())
    })
}

/// Gets the light that the surface or grid of one goal receives; index starts at 0. size is sizeof *goal. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_goal(
    lamps: *mut luxfer_lamps,
    index: u32,
    goal: *mut luxfer_lamps_goal,
    size: usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        let out = Report::new(goal, size)?;
        let o = stage.output()?;
        let i = index as usize;
        let outcome = o.solution.outcomes.get(i).ok_or_else(|| missing("goal", index, o.targets.len()))?;
        let (target, background) = (o.targets[i].as_dvec3(), o.responses.background(i).mean);
        let is_incident = o.quantities[i] == Quantity::Incident;
        let lux = |radiance: DVec3| if is_incident { PI * f64::from(luminance(radiance.as_vec3())) } else { 0.0 };
        out.set(luxfer_lamps_goal {
            outcome: outcome.status.map(outcome_value),
            target: target.to_array(),
            achieved: outcome.achieved.to_array(),
            half_width: outcome.half_width.to_array(),
            background: background.to_array(),
            target_lux: lux(target),
            achieved_lux: lux(outcome.achieved),
            half_width_lux: lux(outcome.half_width),
            background_lux: lux(background),
            ..luxfer_lamps_goal::defaults()
        });
        Ok(())
    })
}

/// Gets the light that the surface or grid of a goal receives from one lamp, for hosts that mix the light of the lamps
/// themselves; the indices goal and lamp start at 0. size is sizeof *response. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal or lamp.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_response(
    lamps: *mut luxfer_lamps,
    goal: u32,
    lamp: u32,
    response: *mut luxfer_lamps_response,
    size: usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        let out = Report::new(response, size)?;
        let o = stage.output()?;
        if goal as usize >= o.responses.goals() {
            return Err(missing("goal", goal, o.responses.goals()));
        }
        if lamp as usize >= o.responses.lamps() {
            return Err(missing("lamp", lamp, o.responses.lamps()));
        }
        let estimate = o.responses.lamp(goal as usize, lamp as usize);
        out.set(luxfer_lamps_response {
            mean: estimate.mean.to_array(),
            half_width: estimate.half_width().to_array(),
            ..luxfer_lamps_response::defaults()
        });
        Ok(())
    })
}

/// Copies the reason why goals are not met, in English, into buffer as zero-terminated UTF-8, truncated to capacity
/// bytes including the zero. buffer may be NULL if capacity is 0. The text is empty if all goals of positive weight are
/// met. *needed, unless NULL, receives the capacity that the whole text needs. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_reason(
    lamps: *mut luxfer_lamps,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        let output = stage.output()?;
        copy_text(output.solution.unreachable.as_deref().unwrap_or(""), buffer, capacity, needed)
    })
}

/// Gets the emission texture of the solution: the texture of the material, in which every lamp is multiplied by its
/// factor luxfer_lamp.scale; linear RGB, in the unit of the old texture. Texels outside the lamps are unchanged. The
/// caller releases *texture. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if the emission has no texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_get_texture(
    lamps: *mut luxfer_lamps,
    texture: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(lamps, |stage| {
        let out = Out::new(texture, "texture")?;
        let o = stage.output()?;
        let map = o.material.and_then(|m| o.scene.materials[m].emission_texture);
        let map = map.ok_or_else(|| {
            Error::new(ErrorKind::NotFound, "the emission has no texture: scale its meshes or lights")
        })?;
        let image = &o.scene.textures[map.texture].image;
        let scale: Vec<DVec3> = o.group_of.iter().map(|&g| o.solution.scale[g as usize]).collect();
        let scaled = Pixels::counted(stage.context(), image.width, image.height, 3, || o.lamps.scaled(image, &scale))?;
        out.set(handle::give(scaled));
        Ok(())
    })
}
