/* luxfer: lighting from one photo onto a 3D scene.
 *
 * tests/abi_header.rs generates this file and its parts from src/ffi. They need C99 or C++11 and only the standard
 * headers. Include this file for everything, or the parts that you use.
 *
 * In short: create a context, create objects in it, start a stage (this returns a job), wait for the job (optionally
 * with progress), read the results, and release everything in any order.
 *
 *     luxfer_context *context = NULL;
 *     luxfer_image *photo = NULL;
 *     if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;
 *     if (luxfer_image_load(context, "photo.jpg", LUXFER_COLOUR_SRGB, &photo) != LUXFER_OK) {
 *         char message[512];
 *         luxfer_context_get_last_error(context, message, sizeof message, NULL);
 *         fprintf(stderr, "%s\n", message);
 *     }
 *     luxfer_release(photo);
 *     luxfer_release(context);
 *
 * Units: metres, radians, right-handed, Y up. Colours are scene-linear Rec.709; luminance is in cd/m², illuminance in
 * lux, luminous flux in lumens.
 *
 * A colour, or an amount of light per channel, is an array of three numbers: red, green, blue. The numbers are floats.
 * They are doubles in the estimates of solvers and in calculations with such estimates or with the colours of LEDs.
 *
 * The length of an array of the caller is a size_t. Other numbers of things are uint32_t; numbers of triangles, and of
 * the vertices of a mesh that is read back, are uint64_t.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef LUXFER_H
#define LUXFER_H

#include "luxfer/core.h"
#include "luxfer/scene.h"
#include "luxfer/render.h"
#include "luxfer/stages.h"
#include "luxfer/transfer.h"
#include "luxfer/lighting.h"
#include "luxfer/stylize.h"
#include "luxfer/plan.h"
#include "luxfer/farm.h"
#include "luxfer/demo.h"

#endif /* LUXFER_H */
