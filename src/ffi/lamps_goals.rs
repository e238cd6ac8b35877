//! Goals of lamps
//!
//! A goal is a surface or a calculation grid that should receive a given light, exactly or as a limit. The dimming
//! levels of the lamps' drivers are set here too.

use super::geometry::list;
use super::guard::enter;
use super::illuminance::luxfer_illuminance_grid;
use super::lamps::{Inputs, Output, luxfer_lamps};
use super::params;
use super::relight::{luxfer_constraint, luxfer_quantity, quantity, read_constraints};
use super::scene::{colour, missing, read_colour};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use super::stored_goal::{StoredGeometry, StoredGoal};
use crate::error::{Error, Result, check_range};
use crate::relight::{Aspect, Constraint, MAX_LEVELS, MAX_WEIGHT, Quantity};

/// Adds a goal: rgb is the mean radiance that a mesh should have, in cd/m² per channel, each in [0, 1e15]. quantity is
/// a LUXFER_QUANTITY_ value. weight, in [0, 1e12], is the weight of this goal relative to the other goals. Any thread.
/// LUXFER_NOT_FOUND if the scene has no such mesh; LUXFER_INVALID_OPERATION before luxfer_lamps_set_scene;
/// LUXFER_INVALID_ARGUMENT if rgb or weight is out of range.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_add_mesh(
    lamps: *mut luxfer_lamps,
    mesh: u32,
    quantity: luxfer_quantity,
    rgb: *const f32,
    weight: f64,
) -> luxfer_status {
    enter(lamps, |stage| {
        let (quantity, target) = (self::quantity(quantity)?, read_colour(rgb)?);
        let constraint = [Constraint::Exactly; 3];
        add(
            stage,
            StoredGoal {
                geometry: StoredGeometry::Mesh(mesh),
                quantity,
                target,
                aspect: Aspect::Colour,
                constraint,
                weight,
            },
        )
    })
}

/// Adds a goal: the mean illuminance in lux that a calculation grid should have, from light of any colour. grid may be
/// NULL for its default. weight, in [0, 1e12], is the weight of this goal relative to the other goals. Any thread.
/// LUXFER_INVALID_ARGUMENT if lux is not in [0, 1e15] or weight is out of range; LUXFER_INVALID_OPERATION before
/// luxfer_lamps_set_scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_add_grid(
    lamps: *mut luxfer_lamps,
    grid: *const luxfer_illuminance_grid,
    lux: f32,
    weight: f64,
) -> luxfer_status {
    enter(lamps, |stage| {
        let [origin, across, down, normal] = params::read(grid)?.vectors()?;
        let target = colour("lux", [lux; 3])? / std::f32::consts::PI;
        let geometry = StoredGeometry::Grid { origin, across, down, normal };
        let (quantity, constraint) = (Quantity::Incident, [Constraint::Exactly; 3]);
        add(stage, StoredGoal { geometry, quantity, target, aspect: Aspect::Luminance, constraint, weight })
    })
}

fn add(stage: &Stage<Inputs, Output>, goal: StoredGoal) -> Result<()> {
    check_range("weight", goal.weight, 0.0, MAX_WEIGHT)?;
    stage.change(|inputs| {
        let (scene, _) = need(&inputs.emission, "luxfer_lamps_set_scene")?;
        let meshes = scene.snapshot().meshes.len();
        if let StoredGeometry::Mesh(mesh) = goal.geometry
            && mesh as usize >= meshes
        {
            return Err(missing("mesh", mesh, meshes));
        }
        inputs.goals.push(goal);
        Ok(())
    })
}

/// Makes a goal a lower or upper limit; constraint holds a LUXFER_CONSTRAINT_ value for each channel: red, green, blue.
/// For a goal in lux, the three values must be equal. The parameter goal is the number of the goal: goals are numbered
/// from 0 in the order in which they were added. Without this call a goal has LUXFER_CONSTRAINT_EQUAL. Any thread.
/// LUXFER_NOT_FOUND if there is no such goal; LUXFER_INVALID_ARGUMENT if the values for a goal in lux differ.
/// cbindgen:ptrs-as-arrays=[[constraint; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_set_constraint(
    lamps: *mut luxfer_lamps,
    goal: u32,
    constraint: *const luxfer_constraint,
) -> luxfer_status {
    enter(lamps, |stage| {
        let constraints = read_constraints(constraint)?;
        stage.change(|inputs| {
            let count = inputs.goals.len();
            let stored = inputs.goals.get_mut(goal as usize).ok_or_else(|| missing("goal", goal, count))?;
            if stored.aspect == Aspect::Luminance && constraints != [constraints[0]; 3] {
                return Err(Error::argument(format!(
                    "goal {goal} is in lux; its channels must have equal constraints"
                )));
            }
            stored.constraint = constraints;
            Ok(())
        })
    })
}

/// Sets the dimming levels of the lamps' drivers. The array levels holds count factors for the emission, each finite
/// and >= 0, in any order; at most 4096 factors are allowed. The solution then gives each group one of these levels,
/// chosen for all groups together so that the goals are met best. The difference between the level and the power that a
/// stepless driver would have is added to the half-width of the power. If count is 0, the drivers have no steps. Any
/// thread.
/// LUXFER_INVALID_ARGUMENT if a level is negative or not finite, or if there are too many levels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_set_levels(
    lamps: *mut luxfer_lamps,
    levels: *const f64,
    count: usize,
) -> luxfer_status {
    enter(lamps, |stage| {
        if count > MAX_LEVELS {
            return Err(Error::argument(format!("count is {count}; it must be at most {MAX_LEVELS}")));
        }
        let levels = if count == 0 { Vec::new() } else { list(levels, count, "levels")? };
        for (i, level) in levels.iter().enumerate() {
            if !(*level >= 0.0 && level.is_finite()) {
                return Err(Error::argument(format!("level {i} is {level}; it must be finite and not negative")));
            }
        }
        stage.change(|inputs| {
            inputs.levels = levels;
            Ok(())
        })
    })
}

/// Removes all goals. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_clear_goals(lamps: *mut luxfer_lamps) -> luxfer_status {
    enter(lamps, |stage| {
        stage.change(|inputs| {
            inputs.goals.clear();
            Ok(())
        })
    })
}
