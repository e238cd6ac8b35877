// Chooses settings for a given error or time before anything is rendered.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "render.hpp"
#include "stylize.hpp"
#include "transfer.hpp"

namespace luxfer {

/// The goal of a plan: set exactly one of its fields.
using PlanParams = Params<luxfer_plan_params, LUXFER_STRUCT_PLAN_PARAMS>;

/// Chooses settings for a given error or time, and predicts both. See luxfer_plan.
class Plan : public Handle<luxfer_plan> {
public:
    using Handle::Handle;

    static Result<Plan> create(const Context &context) { return make_in<Plan>(context, luxfer_plan_create); }

    Result<Job> start(const Render &render, const luxfer_plan_params &params,
                      const luxfer_render_params &settings = RenderParams()) const {
        return make<Job>(luxfer_plan_start_render, render.get(), &settings, &params);
    }

    /// Plans the stages RELIGHT and RENDER of a transfer whose stage EMISSION has run.
    Result<Job> start(const Transfer &transfer, const luxfer_plan_params &params,
                      const luxfer_transfer_params &settings = TransferParams()) const {
        return make<Job>(luxfer_plan_start_transfer, transfer.get(), &settings, &params);
    }

    /// Plans a stylisation of the whole target with its current inputs.
    Result<Job> start(const Stylize &stylize, const luxfer_plan_params &params,
                      const luxfer_stylize_params &settings = StylizeParams()) const {
        return make<Job>(luxfer_plan_start_stylize, stylize.get(), &settings, &params);
    }

    Result<luxfer_plan_report> report() const { return value<luxfer_plan_report>(luxfer_plan_get_report); }

    /// The chosen settings for rendering, relighting and stylisation.
    Result<luxfer_render_params> render_params() const {
        return value<luxfer_render_params>(luxfer_plan_get_render_params);
    }
    Result<luxfer_relight_params> relight_params() const {
        return value<luxfer_relight_params>(luxfer_plan_get_relight_params);
    }
    Result<luxfer_stylize_params> stylize_params() const {
        return value<luxfer_stylize_params>(luxfer_plan_get_stylize_params);
    }
};

} // namespace luxfer
