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
// The C header says what everything does, its units, ranges, ownership and threads; its constants are used here too. What is
// different:
// - Each C handle X has a class with create(), and luxfer_X_verb is its method verb (get_report is report). Copies share the
//   object and moves are free; objects may be destroyed in any order.
// - Structs XParams are the C structs luxfer_X_params, filled with the defaults.
// - Where C takes a pointer and a count there is a Span; where it copies text into a buffer there is a std::string; where it
//   wants NULL for "none" there is an empty object.
// - Failures are exceptions: luxfer::Error, with a status and the library's message. If LUXFER_NO_EXCEPTIONS is defined,
//   functions return luxfer::Result<T> instead, which holds a T or an Error; see luxfer/result.hpp.
// - Progress functions may throw: the job is cancelled, and the exception goes on to whoever waits.
//
// Header only, on top of the C functions: a method is the C call, and reads the message if that fails. A handle is two
// pointers, for it keeps its context for the messages. Threads are as in C: const here means no more than that the handle
// stays the same, and any object may be used from any thread.
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
