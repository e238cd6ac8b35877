// Reasons to doubt the result of a job that has succeeded, or a scene that was loaded.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "core.hpp"

namespace luxfer {

/// The warnings of a stage, a whole transfer or a scene at the time when the list was created. See luxfer_warnings.
class Warnings : public Handle<luxfer_warnings> {
public:
    using Handle::Handle;

    Result<std::uint32_t> count() const { return value<std::uint32_t>(luxfer_warnings_get_count); }

    /// Gets a warning: code, stage, severity and its limit, place, message and advice. Its strings live as long as the
    /// list.
    Result<luxfer_warning> warning(std::uint32_t index) const {
        return value<luxfer_warning>(luxfer_warnings_get, index);
    }

    /// The name of a code, such as "LUXFER_WARNING_UNSEEN".
    static const char *name(luxfer_warning_code code) noexcept { return luxfer_warning_get_name(code); }
};

} // namespace luxfer
