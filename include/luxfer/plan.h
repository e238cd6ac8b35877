/* luxfer: settings for a given error or time.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_PLAN_H
#define LUXFER_PLAN_H

#include "transfer.h"
#include "stages.h"
#include "render.h"
#include "stylize.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Planning
 *
 * Chooses the settings of relighting and rendering, or of a stylisation, for a given error or a given time, before
 * anything is rendered. A plan also predicts the time and the error of each stage. The cost of a path and the noise
 * depend on the scene, so a plan measures them on a small part of the actual work; this takes a few tenths of a
 * second, besides the preparation of the scene. A plan assumes that other programs keep the machine as busy as they
 * do now.
 *
 * The error of a picture is the root mean square error over its pixels, divided by its mean. It includes the noise
 * and the error in brightness that comes from the solution of the emission. luxfer_plan_start_stylize defines the
 * error of a stylisation.
 * ================================================================================================================== */

/** A plan: the settings with which work reaches a given error, or ends within a given time. See luxfer_plan_create. */
typedef struct luxfer_plan luxfer_plan;

/**
 * Goal of a plan, a time or an error: set exactly one of time_budget_ms and target_error. Fill it with
 * luxfer_plan_params_init.
 */
typedef struct luxfer_plan_params {
    /** sizeof(luxfer_plan_params), set by luxfer_plan_params_init. */
    uint32_t struct_size;
    /** Time for all planned work in milliseconds, in [1, 1e9]; 0 (the default) if the goal is target_error. */
    uint32_t time_budget_ms;
    /** Error of the picture, or of the stylisation, in [1e-5, 1]; 0 (the default) if the goal is time_budget_ms. */
    float target_error;
    /** Must be 0. */
    uint32_t reserved;
} luxfer_plan_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_plan_params_init(luxfer_plan_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_PLAN_PARAMS, place, size);
}

/** Times and errors that a plan predicts. */
typedef struct luxfer_plan_report {
    /** sizeof(luxfer_plan_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** 1 for a plan of a transfer, which includes relighting; 0 for a plan of a rendering or a stylisation. */
    uint32_t relights;
    /** Predicted seconds for all planned work. */
    double seconds;
    /** Predicted error of the picture or of the stylisation. */
    double error;
    /** Predicted seconds for relighting, including the preparation of the scene; 0 unless the plan is of a transfer. */
    double relight_seconds;
    /** Predicted value of luxfer_relight_report.error; 0 unless the plan is of a transfer. */
    double relight_error;
    /**
     * Predicted seconds for rendering. In a plan of a transfer, they include the preparation of the scene; in a plan
     * of a rendering they do not, because the plan has already prepared it. 0 in a plan of a stylisation.
     */
    double render_seconds;
    /** Predicted value of luxfer_render_report.error; 0 in a plan of a stylisation. */
    double render_error;
} luxfer_plan_report;

/** Creates a plan without a result. The caller releases *plan. Any thread. */
luxfer_status luxfer_plan_create(luxfer_context *context, luxfer_plan **plan);

/**
 * Starts a job that plans a rendering with the scene and the camera of render. settings gives the size of the picture
 * and the other settings that do not affect quality; NULL stands for the defaults. params gives the goal. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
 * and the scene has no camera.
 */
luxfer_status luxfer_plan_start_render(luxfer_plan *plan,
                                       luxfer_render *render,
                                       const luxfer_render_params *settings,
                                       const luxfer_plan_params *params,
                                       luxfer_job **job);

/**
 * Starts a job that plans the stages RELIGHT and RENDER of a transfer, with the lamps that its stage EMISSION has
 * made. settings is the struct with which the transfer will be started; NULL stands for the defaults. params gives
 * the goal. The caller releases *job. Any thread.
 *
 * After the job, get the planned settings by luxfer_plan_get_relight_params and luxfer_plan_get_render_params, and
 * let the fields relight and render of settings point to them.
 * LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
 * LUXFER_INVALID_OPERATION before the stage EMISSION has a result, or if a job is already running. The job may end
 * with LUXFER_UNREACHABLE if no light of the lamps is reflected back to their surface.
 */
luxfer_status luxfer_plan_start_transfer(luxfer_plan *plan,
                                         luxfer_transfer *transfer,
                                         const luxfer_transfer_params *settings,
                                         const luxfer_plan_params *params,
                                         luxfer_job **job);

/**
 * Gets the predictions of the plan. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_plan_get_report(luxfer_plan *plan,
                                     luxfer_plan_report *report,
                                     size_t size);

/**
 * Gets the settings to render with: the settings given at the start, except the settings of quality, which the plan
 * has chosen. size is sizeof *params. Any thread.
 *
 * If the goal is an error, rendering stops when it reaches the error; if few paths suffice, the plan sets a fixed
 * number of paths instead. If the goal is a time, the plan sets the number of paths, so that repeated renderings give
 * equal pictures. It also sets time_budget_ms to 1.25 times the predicted time. This limit ends a rendering early only
 * if the machine becomes slower.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of a stylisation.
 */
luxfer_status luxfer_plan_get_render_params(luxfer_plan *plan,
                                            luxfer_render_params *params,
                                            size_t size);

/**
 * Gets the settings to relight with: the settings given at the start, except the settings of quality, which the
 * plan has chosen. size is sizeof *params. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a transfer.
 */
luxfer_status luxfer_plan_get_relight_params(luxfer_plan *plan,
                                             luxfer_relight_params *params,
                                             size_t size);

/* ==================================================================================================================
 * Planning of stylisations
 *
 * Chooses the settings of a stylisation for a given time or error. A plan tries settings from fast to slow on the
 * actual input at reduced resolution. These trials take a small share of the time of a stylisation with
 * LUXFER_STYLIZE_FULL; the share falls with the size of the target.
 * ================================================================================================================== */

/**
 * Starts a job that plans a stylisation of the whole target with the current artwork, guides and masks of stylize.
 * The plan chooses only the numbers of rounds and search iterations (the fields iterations, coarse_iterations,
 * finest_iterations, polish and search_iterations). The resolution and all other values come from settings, where NULL
 * stands for the defaults. params gives the goal, a time or an error. If no settings reach the goal, the plan gives
 * the settings that come nearest to it. The caller releases *job. Any thread.
 *
 * The error is the square root of luxfer_stylize_report.energy: the root mean square difference of matched patches in
 * colours and guides, whose values are in [0, 1].
 * LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
 * LUXFER_INVALID_OPERATION if artwork or guides are missing or a job is already running. The job may end with any
 * status with which a job of luxfer_stylize_start may end.
 */
luxfer_status luxfer_plan_start_stylize(luxfer_plan *plan,
                                        luxfer_stylize *stylize,
                                        const luxfer_stylize_params *settings,
                                        const luxfer_plan_params *params,
                                        luxfer_job **job);

/**
 * Gets the settings to stylise with: the settings given at the start, except the numbers of rounds and search
 * iterations, which the plan has chosen. size is sizeof *params. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a stylisation.
 */
luxfer_status luxfer_plan_get_stylize_params(luxfer_plan *plan, luxfer_stylize_params *params, size_t size);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_PLAN_H */
