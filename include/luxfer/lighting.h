/* luxfer: lighting design: illuminance, powers, places and bodies of lamps, photometry.
 *
 * tests/abi_header.rs generates this file from src/ffi.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_LIGHTING_H
#define LUXFER_LIGHTING_H

#include "stages.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==================================================================================================================
 * Illuminance
 *
 * Computes the illuminance in lux at the points of a calculation grid, or at texels of a mesh. The results are an
 * image of the illuminances, an image of their standard errors, and a report with the mean, the minimum and the
 * maximum.
 * ================================================================================================================== */

/** A calculation of illuminance. See luxfer_illuminance_create. */
typedef struct luxfer_illuminance luxfer_illuminance;

/**
 * A calculation grid: a parallelogram of columns x rows cells, with a point at the centre of each cell. Fill it with
 * luxfer_illuminance_grid_init. The default is a square metre at the origin that faces up.
 */
typedef struct luxfer_illuminance_grid {
    /** sizeof(luxfer_illuminance_grid), set by luxfer_illuminance_grid_init. */
    uint32_t struct_size;
    /** Corner of the grid, in metres; default (0, 0, 0). */
    float origin[3];
    /** First edge of the grid, a vector from origin in metres; it is divided into columns. Default (1, 0, 0). */
    float across[3];
    /** Second edge of the grid, a vector from origin in metres; it is divided into rows. Default (0, 0, 1). */
    float down[3];
    /** Normal of the side that receives the light; any length but 0; default (0, 1, 0). */
    float normal[3];
    /** Must be 0. */
    uint32_t reserved;
} luxfer_illuminance_grid;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_illuminance_grid_init(luxfer_illuminance_grid *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_ILLUMINANCE_GRID, place, size);
}

/** Settings of an illuminance calculation. Fill them with luxfer_illuminance_params_init. */
typedef struct luxfer_illuminance_params {
    /** sizeof(luxfer_illuminance_params), set by luxfer_illuminance_params_init. */
    uint32_t struct_size;
    /** Number of points along the first edge of a grid, or along u of a mesh, in [1, 65536]; default 32. */
    uint32_t columns;
    /** Number of points along the second edge of a grid, or along v of a mesh, in [1, 65536]; default 32. */
    uint32_t rows;
    /** Paths per point, in [16, 16777216], rounded up to a multiple of 16; default 1024. */
    uint32_t samples;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_illuminance_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_illuminance_params_init(luxfer_illuminance_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_ILLUMINANCE_PARAMS, place, size);
}

/** An image of an illuminance calculation: a LUXFER_ILLUMINANCE_ value. */
typedef int32_t luxfer_illuminance_image;

/** Summary of the illuminance, in lux. */
typedef struct luxfer_illuminance_report {
    /** sizeof(luxfer_illuminance_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Number of points with a value: on a mesh, the number of texels that the mesh covers. If it is 0, the other
     * values are 0.
     */
    uint32_t points;
    /** Smallest illuminance. The uniformity U0 is minimum / mean. */
    double minimum;
    /** Mean illuminance. */
    double mean;
    /** Largest illuminance. */
    double maximum;
    /** Standard error of the mean. */
    double mean_error;
} luxfer_illuminance_report;

/** Illuminance in lux; 1 channel; NaN in texels that the mesh does not cover. */
#define LUXFER_ILLUMINANCE_LUX 0

/** Standard error of each illuminance, in lux; 1 channel; NaN in texels that the mesh does not cover. */
#define LUXFER_ILLUMINANCE_ERROR 1

/** Creates an object that computes illuminance. It has no inputs yet. The caller releases *illuminance. Any thread. */
luxfer_status luxfer_illuminance_create(luxfer_context *context,
                                        luxfer_illuminance **illuminance);

/** Sets the scene; each job uses the scene as it is when the job starts. Any thread. */
luxfer_status luxfer_illuminance_set_scene(luxfer_illuminance *illuminance, luxfer_scene *scene);

/**
 * Starts a job that computes the illuminance on a grid. grid and params may be NULL for their defaults. The caller
 * releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running. The job may end with
 * LUXFER_INVALID_ARGUMENT if the scene is not valid, the normal of the grid is 0, or a setting is out of range.
 */
luxfer_status luxfer_illuminance_start_grid(luxfer_illuminance *illuminance,
                                            const luxfer_illuminance_grid *grid,
                                            const luxfer_illuminance_params *params,
                                            luxfer_job **job);

/**
 * Starts a job that computes the illuminance on a mesh. The first set of texture coordinates maps the mesh to an image
 * of columns x rows texels: columns divide u, rows divide v. Each texel gets the illuminance at the surface point of
 * its centre. back is 0 for the front side of the triangles, from which they wind counter-clockwise, and 1 for the
 * back side. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running. The job may end with
 * LUXFER_INVALID_ARGUMENT if the scene is not valid or has no such mesh, if the mesh has no texture coordinates, or if
 * a setting is out of range.
 */
luxfer_status luxfer_illuminance_start_mesh(luxfer_illuminance *illuminance,
                                            uint32_t mesh,
                                            uint32_t back,
                                            const luxfer_illuminance_params *params,
                                            luxfer_job **job);

/**
 * Gets the image that a LUXFER_ILLUMINANCE_ value selects: the illuminances or their errors. The caller releases
 * *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_illuminance_get_image(luxfer_illuminance *illuminance,
                                           luxfer_illuminance_image kind,
                                           luxfer_image **image);

/**
 * Gets the summary of the illuminance. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_illuminance_get_report(luxfer_illuminance *illuminance,
                                            luxfer_illuminance_report *report,
                                            size_t size);

/* ==================================================================================================================
 * Lamps
 *
 * Finds the powers of the lamps of an emission with which a scene comes nearest to several goals. The power of a lamp
 * is a factor for its emission, within bounds. A goal is a surface or a calculation grid that should receive a given
 * light. One set of paths per goal measures the light from all lamps at once, even from thousands.
 * ================================================================================================================== */

/** A solver for the powers of lamps. See luxfer_lamps_create. */
typedef struct luxfer_lamps luxfer_lamps;

/**
 * Groups of lamps that share one power: a LUXFER_GROUP_ value. A lamp is a connected region of the emission texture; a
 * connected piece of the meshes if the emission has no texture; or a punctual light if the material is LUXFER_NONE.
 */
typedef int32_t luxfer_group;

/** Settings of the solver for lamps. Fill them with luxfer_lamps_params_init. */
typedef struct luxfer_lamps_params {
    /** sizeof(luxfer_lamps_params), set by luxfer_lamps_params_init. */
    uint32_t struct_size;
    /** Lamps that share one power: a LUXFER_GROUP_ value; default LUXFER_GROUP_EACH. */
    luxfer_group group;
    /**
     * Largest gap between neighbouring lamps in one row, for LUXFER_GROUP_BY_X, _Y and _Z: the difference of the
     * coordinates by which the lamps are grouped, in metres or as a texture coordinate, >= 0; default 0.01. A larger
     * gap starts a new row.
     */
    float row_tolerance;
    /**
     * 1: solve for one power for each colour channel of a group. All goals must then come from luxfer_lamps_add_mesh,
     * because luxfer_lamps_add_grid states no channels. 0, the default: solve for one power for all channels of a
     * group, which keeps the colour.
     */
    uint32_t free_colour;
    /** Largest power of a group, that is, the largest factor for its emission, >= 0; default infinity. */
    double max_scale;
    /**
     * Weight of the regularisation, which pulls all powers towards the equal power that meets the goals best, in
     * [1e-9, 1e3]; default 1e-6. With a small weight the goals are met, with a large weight the powers are nearly
     * equal.
     */
    double regularisation;
    /**
     * Tolerance of the goals, in [1e-6, 1]; default 0.01. A goal counts as met if its light misses the target by at
     * most tolerance times the target's brightest channel, plus the half-width of the 95 % confidence interval of the
     * light.
     */
    double tolerance;
    /** Maximum number of paths for each goal, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop tracing when, for every goal, the light from all lamps together is known to this relative error, in [0, 1];
     * default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 % confidence interval
     * divided by the mean, in the worst channel.
     */
    float target_error;
    /** Stop tracing after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_lamps_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_lamps_params_init(luxfer_lamps_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_LAMPS_PARAMS, place, size);
}

/** All lamps form one group. */
#define LUXFER_GROUP_ALL 0

/** Each lamp is a group of its own. */
#define LUXFER_GROUP_EACH 1

/**
 * Each row of lamps is a group. The lamps are sorted by the x coordinates of their centres; a new row begins where two
 * successive lamps differ by more than row_tolerance. If the emission has a texture, the texture coordinate u replaces
 * x.
 */
#define LUXFER_GROUP_BY_X 2

/**
 * Each row of lamps is a group. The lamps are sorted by the y coordinates of their centres; a new row begins where two
 * successive lamps differ by more than row_tolerance. If the emission has a texture, the texture coordinate v replaces
 * y.
 */
#define LUXFER_GROUP_BY_Y 3

/**
 * Each row of lamps is a group. The lamps are sorted by the z coordinates of their centres; a new row begins where two
 * successive lamps differ by more than row_tolerance. If the emission has a texture, all lamps form one group.
 */
#define LUXFER_GROUP_BY_Z 4

/**
 * Lamps of about equal area form a group: in the order of their areas, a new group begins where the area grows by more
 * than 25 % from one lamp to the next. Among punctual lights, each kind (point, spot, directional) forms one group,
 * and all luminaires with one distribution form one group.
 */
#define LUXFER_GROUP_BY_TYPE 5

/** Creates a solver for the powers of lamps. It has no inputs yet. The caller releases *lamps. Any thread. */
luxfer_status luxfer_lamps_create(luxfer_context *context, luxfer_lamps **lamps);

/**
 * Sets the scene, and the material whose lamps are solved for. The solution is a factor for the emission that each
 * lamp has in the scene. If material is LUXFER_NONE, the lamps are the punctual lights of the scene, numbered by the
 * indices of luxfer_scene_add_light and luxfer_scene_add_luminaire. The call removes all goals. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material.
 */
luxfer_status luxfer_lamps_set_scene(luxfer_lamps *lamps,
                                     luxfer_scene *scene,
                                     uint32_t material);

/**
 * Starts a job that measures how much light each lamp sends to each goal, and solves for the powers. If the goals
 * cannot be met, the job succeeds with the powers that come nearest within the bounds. params may be NULL for the
 * defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene or a goal is missing or a job is already running. The job may end with
 * LUXFER_UNREACHABLE if no goal receives light from any lamp; LUXFER_DEGENERATE if the surface of a goal has no area;
 * LUXFER_INVALID_ARGUMENT if the scene is not valid, the emission has no lamp, there are more than 64 goals, goals
 * times lamps exceed 2^20, or a setting is out of range.
 */
luxfer_status luxfer_lamps_start(luxfer_lamps *lamps,
                                 const luxfer_lamps_params *params,
                                 luxfer_job **job);

/* ==================================================================================================================
 * Goals of lamps
 *
 * A goal is a surface or a calculation grid that should receive a given light, exactly or as a limit. The dimming
 * levels of the lamps' drivers are set here too.
 * ================================================================================================================== */

/**
 * Adds a goal: rgb is the mean radiance that a mesh should have, in cd/m² per channel, each in [0, 1e15]. quantity is
 * a LUXFER_QUANTITY_ value. weight, in [0, 1e12], is the weight of this goal relative to the other goals. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such mesh; LUXFER_INVALID_OPERATION before luxfer_lamps_set_scene;
 * LUXFER_INVALID_ARGUMENT if rgb or weight is out of range.
 */
luxfer_status luxfer_lamps_add_mesh(luxfer_lamps *lamps,
                                    uint32_t mesh,
                                    luxfer_quantity quantity,
                                    const float rgb[3],
                                    double weight);

/**
 * Adds a goal: the mean illuminance in lux that a calculation grid should have, from light of any colour. grid may be
 * NULL for its default. weight, in [0, 1e12], is the weight of this goal relative to the other goals. Any thread.
 * LUXFER_INVALID_ARGUMENT if lux is not in [0, 1e15] or weight is out of range; LUXFER_INVALID_OPERATION before
 * luxfer_lamps_set_scene.
 */
luxfer_status luxfer_lamps_add_grid(luxfer_lamps *lamps,
                                    const luxfer_illuminance_grid *grid,
                                    float lux,
                                    double weight);

/**
 * Makes a goal a lower or upper limit; constraint holds a LUXFER_CONSTRAINT_ value for each channel: red, green, blue.
 * For a goal in lux, the three values must be equal. The parameter goal is the number of the goal: goals are numbered
 * from 0 in the order in which they were added. Without this call a goal has LUXFER_CONSTRAINT_EQUAL. Any thread.
 * LUXFER_NOT_FOUND if there is no such goal; LUXFER_INVALID_ARGUMENT if the values for a goal in lux differ.
 */
luxfer_status luxfer_lamps_set_constraint(luxfer_lamps *lamps,
                                          uint32_t goal,
                                          const luxfer_constraint constraint[3]);

/**
 * Sets the dimming levels of the lamps' drivers. The array levels holds count factors for the emission, each finite
 * and >= 0, in any order; at most 4096 factors are allowed. The solution then gives each group one of these levels,
 * chosen for all groups together so that the goals are met best. The difference between the level and the power that a
 * stepless driver would have is added to the half-width of the power. If count is 0, the drivers have no steps. Any
 * thread.
 * LUXFER_INVALID_ARGUMENT if a level is negative or not finite, or if there are too many levels.
 */
luxfer_status luxfer_lamps_set_levels(luxfer_lamps *lamps,
                                      const double *levels,
                                      size_t count);

/** Removes all goals. Any thread. */
luxfer_status luxfer_lamps_clear_goals(luxfer_lamps *lamps);

/* ==================================================================================================================
 * Results of lamps
 *
 * The functions of this section return the powers that the solver has found, the light that each goal receives, and
 * the contribution of each lamp to each goal.
 * ================================================================================================================== */

/** Summary of the solution for lamps. */
typedef struct luxfer_lamps_report {
    /** sizeof(luxfer_lamps_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of lamps. */
    uint32_t lamps;
    /** Number of groups. */
    uint32_t groups;
    /** Number of goals. */
    uint32_t goals;
    /** Number of paths traced for each goal. */
    uint32_t paths;
    /** 1 if all goals of positive weight are met, else 0: luxfer_lamps_get_reason then gives the reason. */
    uint32_t all_goals_satisfied;
} luxfer_lamps_report;

/** The solution for one lamp. */
typedef struct luxfer_lamp {
    /** sizeof(luxfer_lamp), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of the group that the lamp belongs to. */
    uint32_t group;
    /**
     * Centre of the lamp: (u, v, 0) in texture coordinates if the emission has a texture, else the position in metres;
     * 0 for directional lights.
     */
    double centre[3];
    /** Factor for the lamp's emission, per channel, >= 0. */
    double scale[3];
    /** Half-widths of the 95 % confidence intervals of the field scale. */
    double half_width[3];
} luxfer_lamp;

/** The light that the surface or grid of one goal receives with the powers found. */
typedef struct luxfer_lamps_goal {
    /** sizeof(luxfer_lamps_goal), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Whether each channel meets its target: a LUXFER_OUTCOME_ value. */
    luxfer_outcome outcome[3];
    /**
     * Target: the mean radiance that the goal's surface should have, in cd/m² per channel. For a grid, it is the
     * wanted illuminance divided by pi.
     */
    double target[3];
    /** Mean radiance of the goal's surface with the powers found, in cd/m² per channel. */
    double achieved[3];
    /** Half-widths of the 95 % confidence intervals of the field achieved, in cd/m². */
    double half_width[3];
    /** Mean radiance of the goal's surface from all light but the lamps, in cd/m² per channel. */
    double background[3];
    /**
     * Target in lux: pi times the luminance of the field target. This field and the three fields below are set only
     * for goals of illuminance: grids, and meshes with LUXFER_QUANTITY_INCIDENT. They are 0 for other goals.
     */
    double target_lux;
    /** Illuminance with the powers found, in lux. */
    double achieved_lux;
    /**
     * Half-width of the 95 % confidence interval of achieved_lux, in lux. It is an upper bound, computed as if the
     * errors of all channels had the same sign.
     */
    double half_width_lux;
    /** Illuminance from all light but the lamps, in lux. */
    double background_lux;
} luxfer_lamps_goal;

/** The light that the surface or grid of one goal receives from one lamp. */
typedef struct luxfer_lamps_response {
    /** sizeof(luxfer_lamps_response), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Reserved; always 0. */
    uint32_t reserved;
    /** Mean radiance of the goal's surface from the lamp at scale 1, in cd/m² per channel. */
    double mean[3];
    /** Half-widths of the 95 % confidence intervals of the field mean, per channel, in cd/m². */
    double half_width[3];
} luxfer_lamps_response;

/**
 * Gets the summary of the result. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_report(luxfer_lamps *lamps, luxfer_lamps_report *report, size_t size);

/**
 * Gets the solution for one lamp; index starts at 0. size is sizeof *lamp. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such lamp.
 */
luxfer_status luxfer_lamps_get_lamp(luxfer_lamps *lamps,
                                    uint32_t index,
                                    luxfer_lamp *lamp,
                                    size_t size);

/**
 * Gets the light that the surface or grid of one goal receives; index starts at 0. size is sizeof *goal. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal.
 */
luxfer_status luxfer_lamps_get_goal(luxfer_lamps *lamps,
                                    uint32_t index,
                                    luxfer_lamps_goal *goal,
                                    size_t size);

/**
 * Gets the light that the surface or grid of a goal receives from one lamp, for hosts that mix the light of the lamps
 * themselves; the indices goal and lamp start at 0. size is sizeof *response. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if there is no such goal or lamp.
 */
luxfer_status luxfer_lamps_get_response(luxfer_lamps *lamps,
                                        uint32_t goal,
                                        uint32_t lamp,
                                        luxfer_lamps_response *response,
                                        size_t size);

/**
 * Copies the reason why goals are not met, in English, into buffer as zero-terminated UTF-8, truncated to capacity
 * bytes including the zero. buffer may be NULL if capacity is 0. The text is empty if all goals of positive weight are
 * met. *needed, unless NULL, receives the capacity that the whole text needs. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_lamps_get_reason(luxfer_lamps *lamps,
                                      char *buffer,
                                      size_t capacity,
                                      size_t *needed);

/**
 * Gets the emission texture of the solution: the texture of the material, in which every lamp is multiplied by its
 * factor luxfer_lamp.scale; linear RGB, in the unit of the old texture. Texels outside the lamps are unchanged. The
 * caller releases *texture. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_NOT_FOUND if the emission has no texture.
 */
luxfer_status luxfer_lamps_get_texture(luxfer_lamps *lamps,
                                       luxfer_image **texture);

/* ==================================================================================================================
 * Importance
 *
 * An importance map holds, for each point of an emitting surface, the light that the point would send to a target.
 * The map is traced once. From the map, the light that the target receives from any emissive texture on that surface,
 * at any scale, rotation and offset, is computed within milliseconds and with a confidence interval.
 * ================================================================================================================== */

/** An importance map of an emitting surface. See luxfer_importance_create. */
typedef struct luxfer_importance luxfer_importance;

/** Settings of an importance map. Fill them with luxfer_importance_params_init. */
typedef struct luxfer_importance_params {
    /** sizeof(luxfer_importance_params), set by luxfer_importance_params_init. */
    uint32_t struct_size;
    /** Number of cells of the map along the texture coordinate u of the surface, in [1, 512]; default 64. */
    uint32_t width;
    /** Number of cells of the map along the texture coordinate v of the surface, in [1, 512]; default 64. */
    uint32_t height;
    /** Quantity of the target that the map predicts: a LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING. */
    luxfer_quantity quantity;
    /** Maximum number of paths, in [1024, 2^30]; default 2^20. */
    uint32_t paths;
    /**
     * Stop when the light that the target would receive from a uniform emission is known to this relative error, in
     * [0, 1]; default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 % confidence
     * interval divided by the mean, in the worst channel.
     */
    float target_error;
    /** Stop after this number of milliseconds; default 0: no limit. */
    uint32_t time_budget_ms;
    /** Must be 0. */
    uint32_t reserved;
    /** Seed of the paths; default 1. */
    uint64_t seed;
} luxfer_importance_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_importance_params_init(luxfer_importance_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_IMPORTANCE_PARAMS, place, size);
}

/** The light that the target receives from a texture: the result of luxfer_importance_respond. */
typedef struct luxfer_importance_report {
    /** sizeof(luxfer_importance_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of paths that were traced for the map. */
    uint32_t paths;
    /** Mean radiance of the target from the texture alone, in cd/m² per channel. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of the field response, in cd/m². */
    double half_width[3];
    /**
     * The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per channel.
     * About a third of this difference is the error of response that comes from the size of the cells. The difference
     * also contains noise.
     */
    double resolution_difference[3];
} luxfer_importance_report;

/** Creates an importance map. It has no inputs yet. The caller releases *importance. Any thread. */
luxfer_status luxfer_importance_create(luxfer_context *context, luxfer_importance **importance);

/**
 * Sets the scene, the material of the surfaces that will emit, and the mesh that is the target. The surfaces need
 * texture coordinates. The current emission of the material is ignored. Any thread.
 * LUXFER_NOT_FOUND if the scene has no such material or mesh.
 */
luxfer_status luxfer_importance_set_scene(luxfer_importance *importance,
                                          luxfer_scene *scene,
                                          uint32_t material,
                                          uint32_t mesh);

/**
 * Starts a job that traces the map. The new map replaces the earlier map and the placement that was found with it.
 * params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_INVALID_ARGUMENT if a setting
 * is out of range. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or the surfaces have no
 * texture coordinates; LUXFER_DEGENERATE if the target has no area.
 */
luxfer_status luxfer_importance_start(luxfer_importance *importance,
                                      const luxfer_importance_params *params,
                                      luxfer_job **job);

/**
 * Gets the map as an image of 3 channels. Each cell holds the mean radiance of the target, per channel, if only this
 * cell emitted light, with a radiance of 1 cd/m². The caller releases *image. Any thread.
 * LUXFER_NOT_READY before a job has succeeded.
 */
luxfer_status luxfer_importance_get_image(luxfer_importance *importance,
                                          luxfer_image **image);

/**
 * Computes the light that the target receives from a texture. The texture is linear, in cd/m², and repeats. placement
 * is a 3 x 3 matrix M, row by row, with the last row 0 0 1. The surface shows at its texture coordinates (u, v) the
 * point (s, t) of the texture, where (s, t, 1) = M (u, v, 1); s and t are in widths and heights of the texture. NULL
 * is the identity. The call takes a few milliseconds. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded, LUXFER_INVALID_ARGUMENT if placement is not finite.
 */
luxfer_status luxfer_importance_respond(luxfer_importance *importance,
                                        luxfer_image *texture,
                                        const double *placement,
                                        luxfer_importance_report *report,
                                        size_t size);

/**
 * Solves for the factor, per channel, by which to multiply a texture so that the mean radiance of the target becomes
 * rgb in cd/m², each channel in [0, 1e15]. *report receives the solution, with an outcome for each channel. This call
 * uses the map; luxfer_relight solves this problem by tracing new paths. texture and placement are as for
 * luxfer_importance_respond. size is sizeof *report. Any thread.
 * LUXFER_NOT_READY before a job has succeeded; LUXFER_UNREACHABLE if no channel has a solution: no light of the
 * channel reaches the target from the texture, or the other lights alone exceed rgb; LUXFER_INVALID_ARGUMENT if
 * placement is not finite or rgb is out of range.
 */
luxfer_status luxfer_importance_solve(luxfer_importance *importance,
                                      luxfer_image *texture,
                                      const double *placement,
                                      const float rgb[3],
                                      luxfer_relight_report *report,
                                      size_t size);

/* ==================================================================================================================
 * Placement
 *
 * Finds where to place a texture on an emitting surface so that a target receives the most light, the least light, or
 * a given radiance. The search is a gradient descent on the map that a luxfer_importance has traced; it traces no
 * paths itself.
 * ================================================================================================================== */

/** Objective of a placement: a LUXFER_AIM_ value. */
typedef int32_t luxfer_aim;

/**
 * Objective and bounds of a placement. A placement scales the texture coordinates of the surface about their centre
 * (0.5, 0.5), then rotates them about this centre, and then shifts them. Fill it with luxfer_placement_params_init.
 */
typedef struct luxfer_placement_params {
    /** sizeof(luxfer_placement_params), set by luxfer_placement_params_init. */
    uint32_t struct_size;
    /** Objective: a LUXFER_AIM_ value; default LUXFER_AIM_MAX_LUMINANCE. */
    luxfer_aim aim;
    /**
     * Wanted mean radiance of the target for LUXFER_AIM_RADIANCE, in cd/m² per channel, each finite and >= 0; default
     * 0.
     */
    float radiance[3];
    /**
     * Number of placements that are tried first, in [1, 4096]; default 64. The search then descends from the best of
     * these placements.
     */
    uint32_t starts;
    /** Smallest offset along u and v of the texture, in periods of the texture, in [-16, 16]; default -0.5. */
    double min_offset[2];
    /**
     * Largest offset along u and v, in periods, in [-16, 16]; default 0.5. A range of one period, such as the default,
     * allows every offset. If min_offset and max_offset are equal, the offset is fixed; in the same way, equal bounds
     * fix the scale and the rotation.
     */
    double max_offset[2];
    /** Smallest number of repetitions of the texture along the surface's u and v, in [1/64, 64]; default 1. */
    double min_scale[2];
    /** Largest number of repetitions along u and v, in [1/64, 64]; default 1. */
    double max_scale[2];
    /** Smallest rotation of the texture coordinates from u towards v in radians, in [-2 pi, 2 pi]; default 0. */
    double min_rotation;
    /** Largest rotation in radians, in [-2 pi, 2 pi]; default 0. */
    double max_rotation;
    /** Seed of the starting placements; default 1. */
    uint64_t seed;
} luxfer_placement_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_placement_params_init(luxfer_placement_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_PLACEMENT_PARAMS, place, size);
}

/** The best placement, and the light that the target then receives. */
typedef struct luxfer_placement {
    /** sizeof(luxfer_placement), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * The placement of the texture on the surface: a 3 x 3 matrix, row by row, like the argument placement of
     * luxfer_importance_respond.
     */
    double placement[9];
    /** Offset of the placement along u and v of the texture, in periods. */
    double offset[2];
    /** Number of repetitions of the texture along u and v of the surface. */
    double scale[2];
    /** Rotation of the placement in radians, from u towards v. */
    double rotation;
    /** Mean radiance of the target from the texture alone, in cd/m² per channel. */
    double response[3];
    /** Half-widths of the 95 % confidence intervals of the field response, in cd/m². */
    double half_width[3];
    /**
     * The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per channel.
     * About a third of this difference is the error of response that comes from the size of the cells. The difference
     * also contains noise.
     */
    double resolution_difference[3];
} luxfer_placement;

/** Make the luminance of the target as large as possible. */
#define LUXFER_AIM_MAX_LUMINANCE 0

/** Make the luminance of the target as small as possible. */
#define LUXFER_AIM_MIN_LUMINANCE 1

/**
 * Bring the mean radiance of the target, under the texture and all other light, as near as possible to
 * luxfer_placement_params.radiance.
 */
#define LUXFER_AIM_RADIANCE 2

/**
 * Starts a job that finds the best placement of a texture for the target. The texture is linear, in cd/m², and
 * repeats. params may be NULL for the defaults. The caller releases *job. Any thread.
 * LUXFER_NOT_READY before a map has been traced, LUXFER_INVALID_OPERATION if a job is already running. The job may
 * end with LUXFER_INVALID_ARGUMENT if a setting is out of range.
 */
luxfer_status luxfer_importance_start_placement(luxfer_importance *importance,
                                                luxfer_image *texture,
                                                const luxfer_placement_params *params,
                                                luxfer_job **job);

/**
 * Gets the placement that was found. size is sizeof *placement. Any thread.
 * LUXFER_NOT_READY before a job of luxfer_importance_start_placement has succeeded with the current map.
 */
luxfer_status luxfer_importance_get_placement(luxfer_importance *importance,
                                              luxfer_placement *placement,
                                              size_t size);

/* ==================================================================================================================
 * Photometry
 *
 * Photometric quantities of lighting design: the correlated colour temperature of a light, and the glare of a view.
 * These calls are synchronous: they do their work before they return.
 * ================================================================================================================== */

/** The glare of a view: the result of luxfer_image_get_glare. */
typedef struct luxfer_glare_report {
    /** sizeof(luxfer_glare_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of glare sources. */
    uint32_t sources;
    /**
     * Unified glare rating (CIE 117): below 10 the glare causes no discomfort; 19 is the limit for offices; -infinity
     * without sources.
     */
    double ugr;
    /**
     * Background luminance of the rating in cd/m²: the mean over the pixels that are not glare sources, weighted by
     * their contribution to the illuminance at the eye.
     */
    double background;
    /** The threshold that was used: pixels of at least this luminance in cd/m² counted as glare sources. */
    double threshold;
    /** Solid angle of all sources in steradians. */
    double solid_angle;
    /**
     * Number of lights of the rendered scene that shine from points: point lights, spot lights, and luminaires without
     * luminous opening. They are invisible in the image, and ugr leaves them out. Known only for images of
     * luxfer_render_get_image and luxfer_render_get_layer; 0 for other images. If these lights include luminaires, the
     * scene has LUXFER_WARNING_NOT_IN_PICTURE.
     */
    uint32_t unseen_lights;
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * Daylight glare probability (Wienold and Christoffersen 2006), at most 1: 5.87e-5 E + 0.0918 log10(1 + sum of
     * L² w / (E^1.87 p²)) + 0.16, with the vertical illuminance E in lux and the luminance L, solid angle w and
     * position index p of each source. Below 0.35 glare is imperceptible; above 0.45 it is intolerable. The formula
     * was found for values from 0.2 to 0.8 and E of at least 380 lux.
     */
    double dgp;
    /**
     * Illuminance in lux at the eye, on a plane across the line of sight, from which dgp was computed: the setting
     * vertical_illuminance of luxfer_glare_params or, if that is 0, the illuminance from all pixels of the image. The
     * latter is too low, and dgp wrong, if the image does not show the whole half-space ahead.
     */
    double vertical_illuminance;
    /**
     * The field dgp corrected for low light, as versions 1 and 2 of evalglare do: below 1000 lux, it is multiplied by
     * 1 / (1 + exp(4 - 0.024 E)).
     */
    double dgp_low_light;
} luxfer_glare_report;

/** The projection of an image: a LUXFER_PROJECTION_ value. */
typedef int32_t luxfer_projection;

/** Settings of the glare rating of an image. Fill them with luxfer_glare_params_init. */
typedef struct luxfer_glare_params {
    /** sizeof(luxfer_glare_params), set by luxfer_glare_params_init. */
    uint32_t struct_size;
    /** Projection of the image: a LUXFER_PROJECTION_ value; default LUXFER_PROJECTION_PERSPECTIVE. */
    luxfer_projection projection;
    /**
     * Vertical angle of view of the image in radians, in [0.001, pi - 0.001]; with LUXFER_PROJECTION_ANGULAR in
     * [0.001, 2 pi]; default pi / 2. Pixels that are a right angle or more away from the line of sight do not count.
     */
    double fov_y;
    /**
     * Luminance in cd/m² from which on a pixel belongs to a glare source, in [0, 1e12]; 0, the default: five times the
     * mean luminance of the image.
     */
    double threshold;
    /**
     * Illuminance in lux at the eye on a plane across the line of sight, in [0, 1e12], for an image that does not show
     * the whole half-space ahead; 0, the default: the illuminance from all pixels of the image.
     */
    double vertical_illuminance;
} luxfer_glare_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_glare_params_init(luxfer_glare_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_GLARE_PARAMS, place, size);
}

/** Perspective: the image of a pinhole camera. */
#define LUXFER_PROJECTION_PERSPECTIVE 0

/**
 * Angular (equidistant) fisheye: the distance of a pixel from the centre of the image is proportional to the angle
 * between its direction and the line of sight, as in Radiance's views of type a.
 */
#define LUXFER_PROJECTION_ANGULAR 1

/**
 * Gets the correlated colour temperature of rgb, a linear colour. *kelvin receives the temperature of the nearest
 * blackbody, in [1000, 20000]; *duv receives the signed distance from this blackbody in the CIE 1960 diagram, positive
 * for greenish and negative for pinkish colours. Any thread.
 * LUXFER_DEGENERATE if the colour is black or not finite.
 */
luxfer_status luxfer_colour_to_temperature(luxfer_context *context,
                                           const double rgb[3],
                                           double *kelvin,
                                           double *duv);

/**
 * Computes the linear colour, with luminance 1, of a colour temperature; rgb receives the colour. kelvin is in [1000,
 * 20000]. duv, in [-0.05, 0.05], is the signed distance from the blackbody locus in the CIE 1960 diagram, positive
 * towards green. A channel of rgb is negative if the colour is out of gamut. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range.
 */
luxfer_status luxfer_temperature_to_colour(luxfer_context *context,
                                           double kelvin,
                                           double duv,
                                           double rgb[3]);

/**
 * Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB), as luxfer_image_rate_glare
 * does. The image is the view of a level camera whose vertical angle of view is fov_y in radians, in [0.001, pi -
 * 0.001]. Glare sources are the connected regions of pixels with a luminance of at least threshold, in cd/m², in
 * [0, 1e12]. If threshold is 0, five times the mean luminance of the image is used. A wider angle of view gives a
 * better estimate of the background luminance. size is sizeof *report. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
 */
luxfer_status luxfer_image_get_glare(luxfer_image *image,
                                     double fov_y,
                                     double threshold,
                                     luxfer_glare_report *report,
                                     size_t size);

/**
 * Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB): the unified glare rating and
 * the daylight glare probability. The image is the view of a level camera. Glare sources are the connected regions of
 * pixels with a luminance of at least the threshold. For a daylight glare probability, give an angular image of the
 * half-space ahead, or the vertical illuminance. params NULL: the defaults. size is sizeof *report. Any thread.
 * LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
 */
luxfer_status luxfer_image_rate_glare(luxfer_image *image,
                                      const luxfer_glare_params *params,
                                      luxfer_glare_report *report,
                                      size_t size);

/* ==================================================================================================================
 * Glare of observers
 *
 * Computes the unified glare rating (CIE 117) for observers in a scene. The glare sources are the luminaires of the
 * scene and its emissive meshes. The luminance of a luminaire is its intensity towards the eye, divided by the area of
 * its luminous opening as seen from the eye. Luminaires whose file states no luminous opening, and luminaires whose
 * opening the eye sees edge-on, have no such area and are not rated.
 *
 * Each connected part of a mesh that emits is a source, as are the single lamps of an emission texture. The luminance
 * of such a source is the mean over its visible part. Points darker than a tenth of the largest luminance of their
 * material, such as the glow around lamps in a texture, are not rated.
 * ================================================================================================================== */

/**
 * An observer: an eye that looks in a direction. Callers pass arrays of this struct, so its size and fields never
 * change in later versions.
 */
typedef struct luxfer_observer {
    /** Position of the eye, in metres. */
    float position[3];
    /**
     * Line of sight; any length but 0. It must not be vertical: its horizontal part must be at least 2 % of its
     * length.
     */
    float direction[3];
} luxfer_observer;

/**
 * The glare that an observer experiences. Callers pass arrays of this struct, so its size and fields never change in
 * later versions.
 */
typedef struct luxfer_observer_glare {
    /**
     * Unified glare rating: 8 log10(0.25 / background * sum of L² w / p²) over the sources in view, with their
     * luminance L in cd/m², solid angle w in steradians and position index p. Below 10, glare is imperceptible; 19 is
     * the limit for offices. -infinity if no source is in view; infinity if a source is in view and the background is
     * black.
     */
    double ugr;
    /** Luminance of the background in cd/m²: the indirect illuminance at the eye, divided by pi. */
    double background;
    /** Standard error of the field background, in cd/m². */
    double background_error;
    /**
     * Direct illuminance at the eye, in lux, from all light that the rating leaves out: of luminaires without a
     * luminous opening, of point, spot and directional lights, of the environment, and the glow of emissive meshes.
     */
    double unrated_lux;
    /** Solid angle of the visible parts of all sources in view, in steradians. */
    double solid_angle;
    /** Number of sources in view: rated luminaires, and luminous parts of emissive meshes. */
    uint32_t sources;
    /**
     * Number of sources in view whose solid angle is outside [0.0003, 0.1] steradians, the range for which CIE 117 is
     * valid; they count in ugr too. Lamps in an emission texture that are narrower than 0.32 degrees may be missed.
     */
    uint32_t outside_range;
} luxfer_observer_glare;

/**
 * Computes the glare ratings of count observers in a scene; the array ratings receives count elements. The parameter
 * samples is the number of paths per observer for the background, in [16, 16777216], rounded up to a multiple of 16;
 * 4096 paths suit most rooms. seed is the seed of the paths, and of the rays that find luminous meshes. The call is
 * synchronous; its time is proportional to count times samples, and longer in a scene with emissive meshes.
 * observer_stride and rating_stride are the distances between elements in bytes; 0: sizeof(luxfer_observer),
 * sizeof(luxfer_observer_glare). The first call after a scene is loaded or changed also prepares the scene for
 * tracing. Any thread.
 * LUXFER_INVALID_ARGUMENT if the scene is not valid, a value is out of range, or an observer is not finite, looks
 * straight up or down, or is inside a luminaire (the message names the observer). In these cases no rating is written.
 */
luxfer_status luxfer_scene_get_glare(luxfer_scene *scene,
                                     const luxfer_observer *observers,
                                     size_t count,
                                     size_t observer_stride,
                                     uint32_t samples,
                                     uint64_t seed,
                                     luxfer_observer_glare *ratings,
                                     size_t rating_stride);

/* ==================================================================================================================
 * Distributions of bodies
 *
 * A goniophotometer for the meshes of a scene: computes the luminous intensity that emissive bodies have in all
 * directions, far away from them, as a distribution that can be saved as a luminaire file.
 * ================================================================================================================== */

/**
 * Settings of luxfer_scene_get_distribution: the directions, the paths and the axes of the luminaire. Fill them with
 * luxfer_gonio_params_init.
 */
typedef struct luxfer_gonio_params {
    /** sizeof(luxfer_gonio_params), set by luxfer_gonio_params_init. */
    uint32_t struct_size;
    /**
     * Number of C planes, in [1, 360], at equal angles around the axis; default 24. A single plane, C = 0, holds for
     * all directions around the axis.
     */
    uint32_t planes;
    /**
     * Number of vertical angles gamma in each C plane, in [2, 361], at equal angles from 0 to 180 degrees; default 73.
     */
    uint32_t angles;
    /** Paths per direction, in [16, 16777216], rounded up to a multiple of 16; default 1024. */
    uint32_t samples;
    /** Seed of the paths; default 1. */
    uint64_t seed;
    /** Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): down. */
    float axis[3];
    /**
     * Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular to
     * axis counts. Default (1, 0, 0). For an axis that points down, C grows anticlockwise as seen from above.
     */
    float c0[3];
} luxfer_gonio_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_gonio_params_init(luxfer_gonio_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_GONIO_PARAMS, place, size);
}

/** Errors of a distribution that luxfer_scene_get_distribution has measured, and the place of its luminaire. */
typedef struct luxfer_gonio_report {
    /** sizeof(luxfer_gonio_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * Centre of the luminous opening in metres, in the coordinates of the scene: a luminaire with this position, and
     * with the axis and c0 of the settings, takes the place of the meshes.
     */
    float position[3];
    /** Luminous flux in lumens. */
    double flux;
    /** Standard error of the flux, in lumens. */
    double flux_error;
    /** Largest standard error of an intensity, in candela. */
    double intensity_error;
} luxfer_gonio_report;

/**
 * Measures the distribution of count meshes of a scene, whose indices are in the array meshes. If count is 0, the call
 * measures all meshes of the scene, and meshes may be NULL. The intensities account for the light that the meshes
 * block, reflect and transmit. Other meshes, lights, luminaires and the environment count as absent. params may be
 * NULL for the defaults.
 *
 * The new distribution has absolute photometry, states no power and no colour, and has the name of the first mesh that
 * has a name. Its luminous opening is the box, the cylinder along the axis or the ellipsoid that agrees best with the
 * parts that emit. If the light leaves through a translucent shade or from a reflector, this opening is too small: the
 * intensities, which hold far from the luminaire, are right, but its glare, its pictures and the light close to it are
 * wrong.
 *
 * Intensities between the angles are interpolated linearly; the stated errors contain the noise of the paths only. The
 * caller releases *distribution. report may be NULL; size is sizeof *report. The call is synchronous; its time is
 * proportional to planes times angles times samples, and is a few seconds with the defaults. luxfer_job_start runs it
 * as a job. Any thread.
 * LUXFER_DEGENERATE if no mesh emits light, or if no light leaves the meshes, as from a closed room;
 * LUXFER_INVALID_ARGUMENT if a mesh does not exist, a setting is out of range, or the scene is not valid.
 */
luxfer_status luxfer_scene_get_distribution(luxfer_scene *scene,
                                            const uint32_t *meshes,
                                            size_t count,
                                            const luxfer_gonio_params *params,
                                            luxfer_distribution **distribution,
                                            luxfer_gonio_report *report,
                                            size_t size);

/* ==================================================================================================================
 * False colour
 *
 * Shows a luminance or illuminance image in false colours, with a scale bar. The colours become lighter as the value
 * rises.
 * ================================================================================================================== */

/** The scale that maps values to colours: a LUXFER_SCALE_ value. */
typedef int32_t luxfer_scale;

/** The quantity of an image's values: a LUXFER_UNIT_ value. */
typedef int32_t luxfer_unit;

/** Settings of a false colour image. Fill them with luxfer_false_colour_params_init. */
typedef struct luxfer_false_colour_params {
    /** sizeof(luxfer_false_colour_params), set by luxfer_false_colour_params_init. */
    uint32_t struct_size;
    /** Scale that maps values to colours: a LUXFER_SCALE_ value; default LUXFER_SCALE_LINEAR. */
    luxfer_scale scale;
    /**
     * Quantity of the values, whose unit is written above the bar: a LUXFER_UNIT_ value; default
     * LUXFER_UNIT_LUMINANCE.
     */
    luxfer_unit unit;
    /** 1, the default: draw a scale bar beside the image, which makes it wider; 0: no bar. */
    uint32_t bar;
    /**
     * Value that gets the darkest colour, >= 0; default 0. On a logarithmic scale, 0 stands for a thousandth of the
     * value that gets the lightest colour.
     */
    double minimum;
    /**
     * Value that gets the lightest colour, greater than minimum; 0, the default: the largest finite value of the
     * image.
     */
    double maximum;
} luxfer_false_colour_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_false_colour_params_init(luxfer_false_colour_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_FALSE_COLOUR_PARAMS, place, size);
}

/** Linear: equal differences of the value take equal lengths of the scale bar. */
#define LUXFER_SCALE_LINEAR 0

/** Logarithmic: each factor of ten takes an equal length of the scale bar. */
#define LUXFER_SCALE_LOGARITHMIC 1

/** Luminance in cd/m². */
#define LUXFER_UNIT_LUMINANCE 0

/** Illuminance in lux. */
#define LUXFER_UNIT_ILLUMINANCE 1

/**
 * Shows image in false colours: *shown receives a linear RGB image. An image of 1 channel is shown by its values, a
 * linear RGB image by its luminance. Values below minimum get the darkest colour, values above maximum the lightest;
 * NaN becomes grey. params may be NULL for the defaults. The call takes a few milliseconds per megapixel. The caller
 * releases *shown. Any thread.
 * LUXFER_INVALID_ARGUMENT if the range is empty: maximum is not greater than minimum, or maximum is 0 and the image is
 * black; LUXFER_OUT_OF_MEMORY beyond the memory budget.
 */
luxfer_status luxfer_image_false_colour(luxfer_image *image,
                                        const luxfer_false_colour_params *params,
                                        luxfer_image **shown);

/* ==================================================================================================================
 * Daylight
 *
 * The sun's position, and skies as the environment of a scene: the standard skies of CIE S 011 and the all-weather sky
 * of Perez et al. These calls are synchronous: they do their work before they return.
 * ================================================================================================================== */

/** A place on the Earth and a time. Fill it with luxfer_sun_params_init. */
typedef struct luxfer_sun_params {
    /** sizeof(luxfer_sun_params), set by luxfer_sun_params_init. */
    uint32_t struct_size;
    /** Year in the Gregorian calendar, in [1600, 2500]; default 2000. */
    int32_t year;
    /** Month, in [1, 12]; default 1. */
    uint32_t month;
    /** Day of the month, from 1 to the number of its days; default 1. */
    uint32_t day;
    /**
     * Hours of universal time (UTC) since the midnight with which the date begins, in [-24, 48]; default 12. For a
     * local time it is the local hour minus the zone, such as 14.5 - 2 for half past two in a zone two hours ahead.
     */
    double hour;
    /** Latitude in degrees, in [-90, 90], positive to the north; default 0. */
    double latitude;
    /** Longitude in degrees, in [-180, 180], positive to the east; default 0. */
    double longitude;
} luxfer_sun_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_sun_params_init(luxfer_sun_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_SUN_PARAMS, place, size);
}

/** The position of the sun. */
typedef struct luxfer_sun_position {
    /** sizeof(luxfer_sun_position), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Reserved; always 0. */
    uint32_t reserved;
    /** Angle of the sun's centre above the horizon in radians, in [-pi / 2, pi / 2], without refraction. */
    double altitude;
    /** Angle in radians from north over east, in [0, 2 pi). */
    double azimuth;
    /** Distance of the sun in astronomical units. */
    double distance;
} luxfer_sun_position;

/** A model of the sky's relative luminance: a LUXFER_SKY_ value. */
typedef int32_t luxfer_sky_model;

/** The unit of the light of sun and sky: a LUXFER_DAYLIGHT_ value. */
typedef int32_t luxfer_daylight_unit;

/**
 * A state of sun and sky. Fill it with luxfer_sky_params_init. The default is the overcast sky of type 1 with 10,000
 * lx: 100 lx indoors are then a daylight factor of 1 %.
 */
typedef struct luxfer_sky_params {
    /** sizeof(luxfer_sky_params), set by luxfer_sky_params_init. */
    uint32_t struct_size;
    /** Model of the sky: a LUXFER_SKY_ value; default LUXFER_SKY_CIE. */
    luxfer_sky_model model;
    /**
     * Type of a standard sky: 1 to 15 as in CIE S 011 (1 overcast, 5 uniform, 12 clear), or 16 for the traditional
     * overcast sky, whose zenith is three times as bright as its horizon; default 1.
     */
    uint32_t cie_type;
    /** Unit of direct_normal and diffuse_horizontal: a LUXFER_DAYLIGHT_ value; default LUXFER_DAYLIGHT_LUX. */
    luxfer_daylight_unit unit;
    /**
     * Altitude of the sun in radians, in [-pi / 2, pi / 2], such as luxfer_sun_get_position gives it; default pi / 4.
     * A sun at 0 or below gives no light, and the sky has the shape that it has with the sun at 0.
     */
    double sun_altitude;
    /** Azimuth of the sun in radians, from north over east, in [-2 pi, 2 pi]; default pi, the south. */
    double sun_azimuth;
    /**
     * Distance of the sun in astronomical units, in [0.9, 1.1]; default 1. It counts for the Perez sky, for
     * irradiances and for the size of the sun's disc.
     */
    double sun_distance;
    /** Light of the sun on a plane that faces it, in [0, 1e6] lx or [0, 2000] W/m²; default 0. */
    double direct_normal;
    /** Light of the sky, without the sun, on a level plane, in [0, 1e6] lx or [0, 2000] W/m²; default 10000. */
    double diffuse_horizontal;
    /**
     * Luminance of the zenith in cd/m², in [0, 1e6]. If it is not 0, it replaces diffuse_horizontal. It must be 0 for
     * the Perez sky. Default 0.
     */
    double zenith_luminance;
    /**
     * Dew point at the ground in degrees Celsius, in [-90, 60], from which the efficacies of irradiances estimate the
     * water in the air; default 11, which stands for 2.0 cm of water.
     */
    double dew_point;
    /**
     * Reflectance of the ground, in [0, 1]; default 0.2. Below the horizon the environment has the uniform luminance
     * of a diffuse ground with this reflectance under the unobstructed sun and sky.
     */
    double ground_reflectance;
    /** Colour temperature of the sky in kelvin, in [1000, 20000]; 0, the default: neutral white. */
    double sky_kelvin;
    /** Colour temperature of the sun in kelvin, in [1000, 20000]; 0, the default: neutral white. */
    double sun_kelvin;
    /**
     * Direction of north in the scene, of which only the part perpendicular to y counts; default (0, 0, -1), so that
     * east is +x.
     */
    float north[3];
    /**
     * Rows of the environment image, an even number in [16, 4096]; default 256. The image has twice as many columns.
     */
    uint32_t rows;
} luxfer_sky_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_sky_params_init(luxfer_sky_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_SKY_PARAMS, place, size);
}

/** The light of a sky. */
typedef struct luxfer_sky_report {
    /** sizeof(luxfer_sky_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Index of the sun among the punctual lights of the scene; LUXFER_NONE if the scene has no sun. */
    uint32_t sun;
    /** Illuminance in lux of a plane that faces the sun, by the sun alone; 0 if the sun is not above the horizon. */
    double direct_normal;
    /** Illuminance in lux of a level plane by the sky alone. */
    double diffuse_horizontal;
    /** Luminance of the zenith in cd/m². */
    double zenith_luminance;
    /** Luminance of the ground in cd/m². */
    double ground_luminance;
    /** Clearness epsilon of Perez et al., from 1, an overcast sky, to 12, a clear one. */
    double clearness;
    /** Brightness delta of Perez et al., in [0.01, 0.6]. */
    double brightness;
} luxfer_sky_report;

/** A standard sky of CIE S 011 / ISO 15469. */
#define LUXFER_SKY_CIE 0

/** The all-weather sky of Perez et al. (1993). */
#define LUXFER_SKY_PEREZ 1

/** Illuminance in lux. */
#define LUXFER_DAYLIGHT_LUX 0

/** Irradiance in W/m², converted to lux by the luminous efficacies of Perez et al. (1990). */
#define LUXFER_DAYLIGHT_WATTS 1

/**
 * Computes the position of the sun, to within 0.01 degrees. size is sizeof *position. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range, or the month does not have the day.
 */
luxfer_status luxfer_sun_get_position(luxfer_context *context,
                                      const luxfer_sun_params *params,
                                      luxfer_sun_position *position,
                                      size_t size);

/**
 * Sets the sky and the sun of a scene. The sky and the ground become the environment of the scene, an image that
 * replaces an earlier environment. The sun becomes a directional light with an angular diameter of 0.533 degrees at a
 * distance of 1: it casts soft shadows, and pictures and mirrors show it. A later call changes this light; if it gives
 * no sun, the light stays, with an illuminance of 0, so that the other lights keep their indices.
 * luxfer_scene_set_environment replaces the sky, but not the sun. Files of luxfer_scene_export contain the sun as a
 * light without a size, and no sky. params may be NULL for the defaults.
 * report may be NULL; size is sizeof *report. Any thread.
 * LUXFER_INVALID_ARGUMENT if a value is out of range, or a setting does not suit the model; LUXFER_OUT_OF_MEMORY
 * beyond the memory budget.
 */
luxfer_status luxfer_scene_set_sky(luxfer_scene *scene,
                                   const luxfer_sky_params *params,
                                   luxfer_sky_report *report,
                                   size_t size);

/* ==================================================================================================================
 * Weather files
 *
 * Reads the weather files of EnergyPlus (EPW): a place, and the light of sun and sky in each hour of a year. The call
 * is synchronous: it does its work before it returns.
 * ================================================================================================================== */

/**
 * The weather of an hour; values that the file does not have are NaN. Callers pass arrays of this struct, so its size
 * and fields never change in later versions.
 */
typedef struct luxfer_weather_hour {
    /** Year; in files of typical years, months may have different years. */
    int32_t year;
    /** Month, in [1, 12]. */
    uint32_t month;
    /** Day of the month, in [1, 31], in the time zone of the file. */
    uint32_t day;
    /** Reserved; always 0. */
    uint32_t reserved;
    /**
     * Middle of the hour in universal time, in hours since the midnight with which year, month and day begin; negative
     * or above 24 if universal time has another date. It suits luxfer_sun_params.
     */
    double hour;
    /** Dew point in degrees Celsius. */
    double dew_point;
    /** Direct normal irradiance in W/m², the mean of the hour. */
    double direct_normal;
    /** Diffuse horizontal irradiance in W/m², the mean of the hour. */
    double diffuse_horizontal;
    /** Direct normal illuminance in lux, the mean of the hour. */
    double direct_normal_illuminance;
    /** Diffuse horizontal illuminance in lux, the mean of the hour. */
    double diffuse_horizontal_illuminance;
} luxfer_weather_hour;

/** The place of a weather file. */
typedef struct luxfer_weather_report {
    /** sizeof(luxfer_weather_report), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of hours in the file. */
    uint32_t hours;
    /** Latitude in degrees, positive to the north. */
    double latitude;
    /** Longitude in degrees, positive to the east. */
    double longitude;
    /** Hours by which the file's time is ahead of universal time. */
    double time_zone;
    /** Height above the sea in metres. */
    double elevation;
} luxfer_weather_report;

/**
 * Reads a weather file of EnergyPlus (.epw) with one row per hour; path is UTF-8. The array hours receives count
 * hours, in the order of the file, from the hour of index first on; hour_stride is the distance between its elements
 * in bytes; 0: sizeof(luxfer_weather_hour). With a count of 0, hours may be NULL and only *report is filled. size is
 * sizeof *report. A file has at most 8784 hours. Any thread.
 * LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is malformed, lacks an hour or ends early (the message
 * names the line); LUXFER_UNSUPPORTED if it has several rows per hour; LUXFER_NOT_FOUND if the file ends before the
 * last of the hours; LUXFER_INVALID_ARGUMENT if the stride is too small.
 */
luxfer_status luxfer_weather_read(luxfer_context *context,
                                  const char *path,
                                  size_t first,
                                  size_t count,
                                  luxfer_weather_hour *hours,
                                  size_t hour_stride,
                                  luxfer_weather_report *report,
                                  size_t size);

/* ==================================================================================================================
 * Lighting design
 *
 * Helps to realise a computed light with real luminaires. The functions find the drive levels at which LEDs mix a
 * given colour, and the blackbody light that brings a target nearest to a wanted radiance. They also list requirements
 * of the standard EN 12464-1. These calls are synchronous: they do their work before they return.
 * ================================================================================================================== */

/** A colour mixed from LED primaries: the result of luxfer_mix_primaries. */
typedef struct luxfer_mixture {
    /** sizeof(luxfer_mixture), set by the function that fills the struct. */
    uint32_t struct_size;
    /**
     * 1 if the mixture equals the requested colour; 0 if the primaries cannot reach it and this is the nearest
     * mixture.
     */
    uint32_t in_gamut;
    /** Linear RGB colour of the mixture, in the unit of the primaries. */
    double colour[3];
    /**
     * CIEDE2000 difference from the requested colour, at the exposure that shows the requested colour as middle grey.
     */
    double delta_e;
} luxfer_mixture;

/** The blackbody light that fits a target best: the result of luxfer_fit_temperature. */
typedef struct luxfer_temperature_fit {
    /** sizeof(luxfer_temperature_fit), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Reserved; always 0. */
    uint32_t reserved;
    /** Correlated colour temperature, in [1000, 20000] kelvin. */
    double kelvin;
    /**
     * Luminance of the emission, >= 0. It is in cd/m² if the array response of luxfer_fit_temperature was measured
     * for a white emission of 1 cd/m².
     */
    double luminance;
    /** Mean radiance of the target from this light and all other lights together, in cd/m² per channel. */
    double achieved[3];
    /**
     * CIEDE2000 difference between the field achieved and the wanted radiance, at the exposure that shows the wanted
     * radiance as middle grey.
     */
    double delta_e;
} luxfer_temperature_fit;

/**
 * Requirements of EN 12464-1 for one kind of room, as manufacturers of luminaires quote them. Only the standard
 * itself is binding.
 */
typedef struct luxfer_preset {
    /** sizeof(luxfer_preset), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Year of the edition of the standard. */
    uint32_t edition;
    /** Minimum mean illuminance of the task area (maintained illuminance), in lux. */
    double illuminance;
    /** Maximum unified glare rating. */
    double glare;
    /** Minimum uniformity U0 (minimum / mean illuminance) of the task area. */
    double uniformity;
    /** Minimum general colour rendering index Ra. */
    double rendering;
    /** Minimum mean illuminance of the walls, in lux; 0 if there is no requirement. */
    double walls;
    /** Minimum mean illuminance of the ceiling, in lux; 0 if there is no requirement. */
    double ceiling;
    /** The name, such as "office: filing, copying", in UTF-8; valid as long as the library is loaded. */
    const char *name;
} luxfer_preset;

/**
 * Mixes rgb, a linear colour with channels that are finite and >= 0, from the LEDs of a luminaire. The array primaries
 * holds three numbers for each of count LEDs: the linear RGB of the LED at drive level 1. These numbers may be
 * negative, because the colours of most LEDs lie outside the gamut of Rec.709. count is in [1, 64].
 *
 * The array drives receives the drive levels of the count LEDs, each in [0, max_drive]; max_drive is >= 0 and may be
 * infinite. If no mixture has the colour, the result is the mixture with the smallest squared difference in linear
 * RGB. If several mixtures have the colour, the result is the mixture with the smallest sum of squared drive levels.
 * size is sizeof *mixture. Any thread.
 * LUXFER_DEGENERATE if all primaries are black, LUXFER_INVALID_ARGUMENT if a number is out of range.
 */
luxfer_status luxfer_mix_primaries(luxfer_context *context,
                                   const double *primaries,
                                   size_t count,
                                   double max_drive,
                                   const double rgb[3],
                                   double *drives,
                                   luxfer_mixture *mixture,
                                   size_t size);

/**
 * Finds the temperature and luminance of the blackbody light with which the mean radiance of a target comes nearest to
 * a wanted radiance, by least squares over the channels. Each array is a linear colour in cd/m² per channel. response
 * is the mean radiance of the target from a white emission of 1 cd/m², as in the field response of
 * luxfer_relight_report or luxfer_importance_report if the emission there is white and has 1 cd/m². background is the
 * mean radiance of the target from all other lights; target is the wanted radiance. size is sizeof *fit. Any thread.
 * LUXFER_UNREACHABLE if no channel of response is greater than 0, LUXFER_INVALID_ARGUMENT if a number is not finite.
 */
luxfer_status luxfer_fit_temperature(luxfer_context *context,
                                     const double response[3],
                                     const double background[3],
                                     const double target[3],
                                     luxfer_temperature_fit *fit,
                                     size_t size);

/** Gets the number of presets. A preset holds the lighting requirements for one kind of room. Any thread. */
luxfer_status luxfer_preset_get_count(luxfer_context *context, uint32_t *count);

/**
 * Gets the requirements for one kind of room; index starts at 0. size is sizeof *preset. Any thread.
 * LUXFER_NOT_FOUND if index is beyond the last preset.
 */
luxfer_status luxfer_preset_get(luxfer_context *context,
                                uint32_t index,
                                luxfer_preset *preset,
                                size_t size);

/* ==================================================================================================================
 * Pendants
 *
 * Finds the bodies of hanging lamps (pendants) in a photo. A lamp is taken as a body of revolution about a vertical
 * axis: a globe, a drum, a cone, or any other profile. The shape of the body is computed from the camera and the
 * outline of the lamp in a mask. Its size cannot be computed from them, because a lamp of twice the size at twice the
 * distance has the same outline. The size follows from a known diameter, or from the known distance between two lamps.
 * It also follows from the height of the ceiling together with the drop of a lamp below the ceiling, or with the point
 * of the photo where the suspension (the cable or rod on which the lamp hangs) meets the ceiling.
 * ================================================================================================================== */

/**
 * The size is unknown: no length determines it, or its standard deviation exceeds half of it. The fields drop,
 * diameter and height then hold only bounds.
 */
#define LUXFER_DOUBT_SIZE 1

/** The probability of the kind is below 0.9. */
#define LUXFER_DOUBT_KIND 2

/**
 * The photo clips more than a tenth of the lamp's pixels (see luxfer_pendant.clipped): the lamp may be brighter than
 * it appears, and its glare may enlarge the outline.
 */
#define LUXFER_DOUBT_CLIPPED 4

/** The border of the photo cuts off a part of the outline. */
#define LUXFER_DOUBT_CUT 8

/** The body hides a part of its own profile. At least one value of luxfer_pendant.profile_error exceeds 0.05. */
#define LUXFER_DOUBT_HIDDEN 16

/** Largest number of lamps, and of suspensions, that luxfer_pendants_find accepts. */
#define LUXFER_MAX_PENDANTS 16

/** The length that determines the size of the lamps: a LUXFER_KNOWN_ value. */
typedef int32_t luxfer_known;

/** Settings with which luxfer_pendants_find fits bodies to lamps. Fill them with luxfer_pendants_params_init. */
typedef struct luxfer_pendants_params {
    /** sizeof(luxfer_pendants_params), set by luxfer_pendants_params_init. */
    uint32_t struct_size;
    /** 1, the default: all lamps of the mask have bodies of one shape and size; 0: each lamp has a body of its own. */
    uint32_t alike;
    /** 1: all lamps hang at one height, which requires alike = 1; 0, the default: each lamp hangs at its own height. */
    uint32_t level;
    /**
     * 1, the default: each point of the mask's outline is moved to where the photo's luminance is the mean of the
     * luminances inside and outside the lamp. Points where the photo is clipped or has little contrast stay on the
     * outline of the mask. 0: all points stay on the outline of the mask.
     */
    uint32_t refine;
    /** Meaning of known_length: a LUXFER_KNOWN_ value; default LUXFER_KNOWN_NOTHING. */
    luxfer_known known;
    /** Must be 0. */
    uint32_t reserved;
    /**
     * The known length in metres: in [0, 1e4] for LUXFER_KNOWN_DROP, in [1e-4, 1e4] for a diameter or a spacing. Must
     * be 0, the default, with LUXFER_KNOWN_NOTHING.
     */
    double known_length;
    /**
     * Height of the ceiling above the camera in metres, in [0.01, 1000]; default 1. If the height is unknown, keep the
     * default: the library then takes and returns all lengths, known_length included, in units of the true height
     * instead of metres.
     */
    double ceiling;
    /**
     * Standard deviation in pixels of the x and of the y of each point in the array suspensions of
     * luxfer_pendants_find, in [0.05, 100]; default 1.
     */
    double suspension_error;
    /**
     * Focal length of the camera in pixels; required, and > 0, if no rectification is given; default 0. Not used with
     * a rectification. Without a rectification, the photo and the mask must be free of lens distortion.
     */
    double focal;
    /**
     * Standard deviation of the focal length in pixels, in [0, focal / 2]; default 0. With a rectification, 0 stands
     * for the standard deviation that the rectification has estimated, or focal / 2 if that is smaller. This estimate
     * is 0 only if the caller gave the rectification the focal length.
     */
    double focal_error;
    /**
     * Standard deviation in radians of the tilt of the vertical axis about each horizontal axis, in [0, 0.5]; default
     * 0. Not used with a rectification, which has its own value.
     */
    double axes_error;
    /** Principal point in pixels; NaN, the default: the photo's centre. Not used with a rectification. */
    double principal[2];
    /**
     * Room axes as unit vectors in camera space, as in luxfer_rectify_report.axes: axis 1 points down. Default: a
     * camera that looks horizontally, without roll. Not used with a rectification.
     */
    double axes[3][3];
} luxfer_pendants_params;

/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */
static inline luxfer_status luxfer_pendants_params_init(luxfer_pendants_params *place, size_t size) {
    return luxfer_init(LUXFER_STRUCT_PENDANTS_PARAMS, place, size);
}

/** The kind of a lamp's body: a LUXFER_BODY_ value. */
typedef int32_t luxfer_body;

/**
 * A hanging lamp: its body, its place and the doubts about them. Fields called an interval hold three numbers: the
 * value, and the lower and the upper end of its 95 % confidence interval. If the photo does not determine the value,
 * the ends are the known bounds of the value, which may be 0 and infinity. A value without an estimate is NaN.
 */
typedef struct luxfer_pendant {
    /** sizeof(luxfer_pendant), set by the function that fills the struct. */
    uint32_t struct_size;
    /** Number of vertices of the profile, in [2, 65]. */
    uint32_t profile_count;
    /** Kind of the body: a LUXFER_BODY_ value. */
    luxfer_body kind;
    /** Reasons to doubt the result: LUXFER_DOUBT_ flags. */
    uint32_t doubts;
    /** Probability of the kind among all kinds, in [0, 1]. */
    double probability;
    /** Interval of height / largest diameter. */
    double aspect[3];
    /** Interval of the largest diameter in metres. */
    double diameter[3];
    /** Interval of the height of the body in metres. */
    double height[3];
    /** Interval of the distance in metres of the body's top below the ceiling. */
    double drop[3];
    /**
     * Intervals of the position of the body's middle relative to the camera: along the horizontal room axes 0 and 2,
     * and upwards. The unit is the metre; with LUXFER_DOUBT_SIZE it is the distance of the first lamp's middle from
     * the camera.
     */
    double centre[3][3];
    /** Median distance in pixels between the outline of the lamp and the outline of the fitted body. */
    double residual;
    /** Share of the outline that the photo's border cuts off, in [0, 0.3]. */
    double cut;
    /**
     * Share of the lamp's pixels that the photo clips, in [0, 1]. A pixel counts as clipped if a channel is at least
     * 98 % of the photo's largest value.
     */
    double clipped;
    /**
     * Vertices of the profile from bottom to top: radius, and height above the bottom, in multiples of the largest
     * diameter. Elements from profile_count on are 0.
     */
    float profile[65][2];
    /**
     * Half-width of the 95 % confidence interval of each radius of the profile, in multiples of the largest diameter.
     * It is large where the body hides its own profile.
     */
    float profile_error[65];
    /**
     * Mean radiance of the lamp in 16 bands of equal height, from bottom to top: linear RGB in the units of the photo.
     * Where the photo is clipped, it is only a lower bound.
     */
    float radiance[16][3];
    /** Outline of the fitted body in the photo, a closed polygon: x and y in pixels. */
    float contour[180][2];
    /** Reserved; always 0. */
    uint32_t reserved;
} luxfer_pendant;

/** A sphere. */
#define LUXFER_BODY_GLOBE 0

/** An ellipsoid of revolution. */
#define LUXFER_BODY_SPHEROID 1

/** A cylinder. */
#define LUXFER_BODY_DRUM 2

/** A cylinder lower than a quarter of its diameter. */
#define LUXFER_BODY_DISC 3

/** A frustum of a cone. */
#define LUXFER_BODY_CONE 4

/** A part of a sphere below a horizontal plane. */
#define LUXFER_BODY_BOWL 5

/** A part of a sphere above a horizontal plane. */
#define LUXFER_BODY_DOME 6

/** Any other body of revolution, such as a bell. */
#define LUXFER_BODY_OTHER 7

/**
 * No length is known. The points where suspensions meet the ceiling then determine the size, together with the height
 * of the ceiling. Without such points, each lamp has LUXFER_DOUBT_SIZE.
 */
#define LUXFER_KNOWN_NOTHING 0

/** The distance of the first lamp's top below the ceiling; with alike = 0, of every lamp's top. */
#define LUXFER_KNOWN_DROP 1

/** The largest diameter of the body. All lamps then have this diameter, also with alike = 0. */
#define LUXFER_KNOWN_DIAMETER 2

/** The horizontal distance between the axes of the first two lamps; with alike = 0 it determines no size. */
#define LUXFER_KNOWN_SPACING 3

/**
 * Finds the bodies of hanging lamps. photo is linear RGB. mask has the photo's size and is above 0.5 on the bodies of
 * 1 to 16 lamps, without their suspensions. Each connected region of the mask is a lamp, except regions with less than
 * 2 % of the largest region's pixels, which are ignored. Lamps are numbered in the order of their topmost pixels. view
 * is a rectification of the photo whose job has succeeded; NULL: params gives the camera. params may be NULL for
 * the defaults.
 *
 * suspensions holds x and y in pixels of each of suspension_count points where a suspension meets the ceiling; NULL if
 * no suspension is marked. A point belongs to the lamp whose axis passes nearest to it in the photo; a lamp has at
 * most one point. pendants is an array of capacity structs; size is sizeof(luxfer_pendant). *count receives the number
 * of lamps, even if it exceeds capacity; only the first capacity lamps are written. The call takes about 0.2 seconds
 * for a lamp, and more for many lamps that are alike; luxfer_job_start runs it as a job. Any thread.
 * LUXFER_DEGENERATE if the mask is empty, a lamp is too small, the photo's border cuts off more than 30 % of its
 * outline, or its outline is not the outline of a body of revolution: the message says what to paint. LUXFER_NOT_READY
 * before the job of view has succeeded; LUXFER_INVALID_ARGUMENT if sizes differ, there are more than 16 lamps, or a
 * setting is out of range.
 */
luxfer_status luxfer_pendants_find(luxfer_context *context,
                                   luxfer_image *photo,
                                   luxfer_image *mask,
                                   luxfer_rectify *view,
                                   const double *suspensions,
                                   size_t suspension_count,
                                   const luxfer_pendants_params *params,
                                   luxfer_pendant *pendants,
                                   size_t size,
                                   size_t capacity,
                                   size_t *count);

/**
 * Adds count meshes, 1 to 1024, to a scene. All have the body of pendant, which luxfer_pendants_find has found. places
 * holds x, y and z in metres of count points; each point becomes the centre of the upper end of one body. diameter is
 * the largest diameter in metres, in [0.001, 1e4], or 0 for the diameter that pendant states. The meshes share a new
 * material. Its emission follows the colours of the photo along the height of the body. Where the photo clips the
 * lamp, this emission is too dark. luminance is the luminance in cd/m² of a surface that has the value 1 in the photo,
 * in [0, 1e9]. *first_mesh and *material receive the index of the first new mesh and the index of the material; each
 * pointer may be NULL. Any thread.
 * LUXFER_INVALID_ARGUMENT if diameter is 0 and the lamp has LUXFER_DOUBT_SIZE, or a value is out of range;
 * LUXFER_OUT_OF_MEMORY if the memory budget would be exceeded.
 */
luxfer_status luxfer_scene_add_pendants(luxfer_scene *scene,
                                        const luxfer_pendant *pendant,
                                        const double *places,
                                        size_t count,
                                        float diameter,
                                        float luminance,
                                        uint32_t *first_mesh,
                                        uint32_t *material);

#ifdef __cplusplus
}
#endif

#endif /* LUXFER_LIGHTING_H */
