// Reasons to doubt the result of a job that has succeeded, or a scene that was loaded.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "core.hpp"

namespace luxfer {

/// The warnings of a stage, of a whole transfer or of a scene, as they were when they were asked for. See luxfer_warnings.
class Warnings : public Handle<luxfer_warnings> {
public:
    using Handle::Handle;

    Result<std::uint32_t> count() const { return value<std::uint32_t>(luxfer_warnings_get_count); }

    /// Code, stage, figure, limit, place, defect and remedy. Its strings live as long as the list.
    Result<luxfer_warning> warning(std::uint32_t index) const {
        return value<luxfer_warning>(luxfer_warnings_get, index);
    }

    /// The name of a code, such as "LUXFER_WARNING_UNSEEN".
    static const char *name(luxfer_warning_code code) noexcept { return luxfer_warning_get_name(code); }
};

} // namespace luxfer
