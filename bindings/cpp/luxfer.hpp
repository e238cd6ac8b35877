// luxfer in C++17: the functions of luxfer.h as methods of objects that release themselves.
//
//     luxfer::Context context = luxfer::Context::create();
//     luxfer::Scene scene = luxfer::Scene::load(context, "room.glb");
//     luxfer::Render render = luxfer::Render::create(context);
//     render.set_scene(scene);
//     luxfer::RenderParams params;              // the library's defaults
//     params.samples = 256;
//     render.start(params).wait([](double fraction) { return tell(fraction); });
//     render.image().save("room.png", 0.01f);
//
// The C header describes every function, with units, ranges, ownership and threads; C++ programs use its constants
// too. The differences from C:
// - Each C handle X has a class with create(), and luxfer_X_verb is its method verb (get_report is report). Copies
//   share the object and moves cost nothing; objects may be destroyed in any order.
// - Structs XParams are the C structs luxfer_X_params, filled with the defaults.
// - A pointer and a count in C are a Span; text that C copies into a buffer is a std::string; NULL for "none" is an
//   empty object.
// - Failures are exceptions: luxfer::Error, with a status and the library's message. If LUXFER_NO_EXCEPTIONS is
//   defined, functions return luxfer::Result<T> instead, which holds a T or an Error; see luxfer/result.hpp.
// - Progress functions may throw: this cancels the job, and wait() rethrows the exception.
//
// The wrapper is header only: a method calls the C function and reads the message if that fails. An object holds two
// pointers, the C handle and its context, which has the messages. Threads are as in C: any thread may use any object;
// const means only that the handle does not change.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "luxfer/core.hpp"
#include "luxfer/lighting.hpp"
#include "luxfer/photo.hpp"
#include "luxfer/plan.hpp"
#include "luxfer/render.hpp"
#include "luxfer/result.hpp"
#include "luxfer/scene.hpp"
#include "luxfer/stylize.hpp"
#include "luxfer/transfer.hpp"
#include "luxfer/view.hpp"
#include "luxfer/warning.hpp"
