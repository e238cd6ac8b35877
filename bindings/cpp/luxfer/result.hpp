// The result of a call: a value or an Error.
//
// By default, errors are thrown, and Result<T> is T itself. If LUXFER_NO_EXCEPTIONS is defined (in every file of a
// program), nothing is thrown: Result<T> holds a T or an Error, like std::expected of C++23. All functions of the
// wrapper return a Result, so both modes have the same functions.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include <luxfer.h>

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace luxfer {

/// The error of a call: what() is the library's message, which names the parameter, its value and its allowed range.
class Error : public std::runtime_error {
public:
    Error(luxfer_status status, const std::string &message) : std::runtime_error(message), status_(status) {}

    /// LUXFER_INVALID_ARGUMENT, LUXFER_CANCELLED, ...; never LUXFER_OK.
    luxfer_status status() const noexcept { return status_; }

    /// The name of the status, such as "LUXFER_FORMAT".
    const char *name() const noexcept { return luxfer_status_get_name(status_); }

private:
    luxfer_status status_;
};

#ifndef LUXFER_NO_EXCEPTIONS

/// The return type of a function: T itself. Errors are thrown.
template <class T = void>
using Result = T;

#else

/// The return type of a function: a T or an Error. `if (result)` tests for a value; then use *result, result->..., or
/// result.error().
template <class T = void>
class [[nodiscard]] Result {
public:
    Result(T value) : either_(std::move(value)) {}
    Result(Error error) : either_(std::move(error)) {}

    bool has_value() const noexcept { return either_.index() == 0; }
    explicit operator bool() const noexcept { return has_value(); }

    /// The value; the result must have one.
    T &operator*() & noexcept { return *operator->(); }
    const T &operator*() const & noexcept { return *operator->(); }
    T &&operator*() && noexcept { return std::move(*operator->()); }
    T *operator->() noexcept { return assert(has_value()), std::get_if<0>(&either_); }
    const T *operator->() const noexcept { return assert(has_value()), std::get_if<0>(&either_); }

    /// The error; the result must have one.
    const Error &error() const noexcept { return assert(!has_value()), *std::get_if<1>(&either_); }

private:
    std::variant<T, Error> either_;
};

/// The result of a function without a value: success, or an Error.
template <>
class [[nodiscard]] Result<void> : private Result<std::monostate> {
    using Base = Result<std::monostate>;

public:
    Result() : Base(std::monostate()) {}
    Result(Error error) : Base(std::move(error)) {}

    using Base::error;
    using Base::has_value;
    using Base::operator bool;
};

#endif

namespace detail {

/// The Error of a failed call, with the message of this thread's latest failure. Without a context, only the status is
/// known.
inline Error error_of(luxfer_context *context, luxfer_status status) {
    if (context == nullptr)
        return Error(status, std::string(luxfer_status_get_name(status)) + ": the object, or the context, is empty");
    std::size_t needed = 1;
    luxfer_context_get_last_error(context, nullptr, 0, &needed);
    std::string text(needed, '\0');
    luxfer_context_get_last_error(context, text.data(), needed, nullptr);
    text.pop_back();
    return Error(status, text);
}

#ifndef LUXFER_NO_EXCEPTIONS

template <class T>
[[noreturn]] T fail(Error error) {
    throw error;
}

/// Converts the status of a call, and its value, to a Result: throws unless the status is LUXFER_OK.
inline void to_result(luxfer_context *context, luxfer_status status) {
    if (status != LUXFER_OK)
        throw error_of(context, status);
}

template <class T>
T to_result(luxfer_context *context, luxfer_status status, T value) {
    to_result(context, status);
    return value;
}

/// Runs a function of the caller inside a callback from C. No exception may cross C code, so this object keeps it.
class Caught {
public:
    /// The result for the C callback: 0 (continue) if the function returns true.
    template <class Function>
    std::int32_t run(const Function &function) noexcept {
        try {
            return function() ? 0 : 1;
        } catch (...) {
            exception_ = std::current_exception();
            return 1;
        }
    }

    /// Rethrows the exception; call it after C has returned.
    void rethrow() {
        if (exception_)
            std::rethrow_exception(std::exchange(exception_, nullptr));
    }

private:
    std::exception_ptr exception_;
};

/// Runs a function of the caller on a thread of the library; returns the status for the exception that it throws, if
/// any.
template <class Function>
luxfer_status status_of(const Function &function) noexcept {
    try {
        function();
        return LUXFER_OK;
    } catch (const Error &error) {
        return error.status();
    } catch (...) {
        return LUXFER_UNKNOWN;
    }
}

#else

template <class T>
Result<T> fail(Error error) {
    return error;
}

/// Converts the status of a call, and its value, to a Result: an error unless the status is LUXFER_OK.
inline Result<> to_result(luxfer_context *context, luxfer_status status) {
    return status == LUXFER_OK ? Result<>() : Result<>(error_of(context, status));
}

template <class T>
Result<T> to_result(luxfer_context *context, luxfer_status status, T value) {
    return status == LUXFER_OK ? Result<T>(std::move(value)) : Result<T>(error_of(context, status));
}

/// Runs a function of the caller inside a callback from C. It must not throw, which would end the program.
class Caught {
public:
    template <class Function>
    std::int32_t run(const Function &function) noexcept {
        return function() ? 0 : 1;
    }
    void rethrow() {}
};

/// Runs a function of the caller on a thread of the library; returns the status of its Result.
template <class Function>
luxfer_status status_of(const Function &function) noexcept {
    const Result<> result = function();
    return result ? LUXFER_OK : result.error().status();
}

#endif

} // namespace detail
} // namespace luxfer
