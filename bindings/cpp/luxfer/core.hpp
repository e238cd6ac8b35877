// The context, images and jobs, and the base class of all objects.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "result.hpp"
#include "view.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace luxfer {

/// Whether the library of version `library` is compatible with a program that was built with the header of version
/// `header`. Before 1.0, the minor versions must be equal. From 1.0 on, the major versions must be equal and the
/// library must not be older than the header.
constexpr bool is_compatible(std::uint32_t library, std::uint32_t header) noexcept {
    return header >= 10000 ? library / 10000 == header / 10000 && library >= header : library / 100 == header / 100;
}

namespace detail {

/// Owns one reference to a C object, or is empty: copying retains the object, and the destructor releases it.
template <class C>
class Reference {
public:
    Reference() noexcept = default;
    explicit Reference(C *adopted) noexcept : object_(adopted) {}
    Reference(const Reference &other) noexcept : object_(other.object_) {
        if (object_ != nullptr)
            luxfer_retain(object_);
    }
    Reference(Reference &&other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
    Reference &operator=(Reference other) noexcept {
        std::swap(object_, other.object_);
        return *this;
    }
    ~Reference() { luxfer_release(object_); }

    C *get() const noexcept { return object_; }

private:
    C *object_ = nullptr;
};

template <class T, class = void>
struct IsVersioned : std::false_type {};
template <class T>
struct IsVersioned<T, std::void_t<decltype(T::struct_size)>> : std::true_type {};

/// Calls a C function that fills a plain value, or a versioned struct followed by its size; returns the value or
/// struct.
template <class T, class... Parameters, class... Arguments>
Result<T> get_value(luxfer_context *context, luxfer_status (*function)(Parameters...), Arguments... arguments) {
    T value = T();
    luxfer_status status = LUXFER_OK;
    if constexpr (IsVersioned<T>::value)
        status = function(arguments..., &value, sizeof value);
    else
        status = function(arguments..., &value);
    return to_result(context, status, value);
}

/// Calls a C function that copies a text; its last parameters are a buffer, its capacity and the capacity needed.
/// Returns the text.
template <class... Parameters, class... Arguments>
Result<std::string> get_text(luxfer_context *context, luxfer_status (*function)(Parameters...), Arguments... arguments) {
    std::size_t needed = 0;
    luxfer_status status = function(arguments..., nullptr, 0, &needed);
    std::string text(needed, '\0');
    if (status == LUXFER_OK)
        status = function(arguments..., text.data(), needed, nullptr);
    text.resize(std::strlen(text.c_str()));
    return to_result(context, status, std::move(text));
}

} // namespace detail

using MergeParams = Params<luxfer_merge_params, LUXFER_STRUCT_MERGE_PARAMS>;
using ContextParams = Params<luxfer_context_params, LUXFER_STRUCT_CONTEXT_PARAMS>;

/// Owns the worker threads, a memory budget and the error messages; all other objects are created in it. See
/// luxfer_context.
class Context {
public:
    /// An empty context: every call on it, or with it, gives LUXFER_INVALID_ARGUMENT.
    Context() noexcept = default;

    /// Creates a context. LUXFER_UNSUPPORTED if the loaded library is not compatible with the header of the program.
    static Result<Context> create(const luxfer_context_params &params = ContextParams()) {
        if (!is_compatible(luxfer_get_version(), LUXFER_VERSION))
            return detail::fail<Context>(Error(LUXFER_UNSUPPORTED, mismatch()));
        luxfer_context *made = nullptr;
        const luxfer_status status = luxfer_context_create(&params, &made);
        if (status != LUXFER_OK)
            return detail::fail<Context>(
                Error(status, std::string("luxfer_context_create: ") + luxfer_status_get_name(status)));
        return Context(made);
    }

    /// Takes over a reference to a context that the caller owns, such as one from another part of the program.
    static Context adopt(luxfer_context *context) noexcept { return Context(context); }

    /// The C handle, for the C functions; still owned by this object.
    luxfer_context *get() const noexcept { return reference_.get(); }
    explicit operator bool() const noexcept { return get() != nullptr; }

    /// The message of this thread's latest failure; Error::what() contains it too.
    Result<std::string> last_error() const { return detail::get_text(get(), luxfer_context_get_last_error, get()); }

private:
    explicit Context(luxfer_context *adopted) noexcept : reference_(adopted) {}

    static std::string mismatch() {
        const std::uint32_t header = LUXFER_VERSION;
        return "the program was built for luxfer " + std::to_string(header / 10000) + "." +
               std::to_string(header / 100 % 100) + "." + std::to_string(header % 100) + " and has loaded luxfer " +
               luxfer_get_version_string() + "; install a library that is compatible, or rebuild the program";
    }

    detail::Reference<luxfer_context> reference_;
};

/// The base class of images, scenes, jobs and stages: a reference to a C object, and one to its context, which has the
/// error messages. Copies share the object. A moved-from or default-constructed object is empty: it means NULL where a
/// function accepts NULL, and gives LUXFER_INVALID_ARGUMENT elsewhere. Objects may be destroyed in any order, also
/// after the context.
template <class C>
class Handle {
public:
    /// The type of the C object.
    using Object = C;

    Handle() noexcept = default;

    /// Takes over a reference to a C object that the caller owns; `context` is the context of that object.
    Handle(const Context &context, C *adopted) noexcept
        : context_(adopted != nullptr ? context : Context()), reference_(adopted) {}

    /// The C handle, for the C functions; still owned by this object.
    C *get() const noexcept { return reference_.get(); }
    explicit operator bool() const noexcept { return get() != nullptr; }

    /// The context of the object.
    const Context &context() const noexcept { return context_; }

protected:
    /// Calls a C function on the object.
    template <class... Parameters, class... Arguments>
    Result<> call(luxfer_status (*function)(C *, Parameters...), Arguments... arguments) const {
        return detail::to_result(context_.get(), function(get(), arguments...));
    }

    /// Calls a C function on the object whose last parameter becomes a new object of class T.
    template <class T, class Any, class... Parameters, class... Arguments>
    Result<T> make(luxfer_status (*function)(Any *, Parameters...), Arguments... arguments) const {
        typename T::Object *made = nullptr;
        const luxfer_status status = function(get(), arguments..., &made);
        return detail::to_result(context_.get(), status, T(context_, made));
    }

    /// Calls a C function on the context whose last parameter becomes a new object of class T.
    template <class T, class... Parameters, class... Arguments>
    static Result<T> make_in(const Context &context, luxfer_status (*function)(luxfer_context *, Parameters...),
                             Arguments... arguments) {
        typename T::Object *made = nullptr;
        const luxfer_status status = function(context.get(), arguments..., &made);
        return detail::to_result(context.get(), status, T(context, made));
    }

    /// Calls a C function on the object whose last parameter becomes a plain value or a struct.
    template <class T, class... Parameters, class... Arguments>
    Result<T> value(luxfer_status (*function)(C *, Parameters...), Arguments... arguments) const {
        return detail::get_value<T>(context_.get(), function, get(), arguments...);
    }

    /// Calls a C function on the object that copies a text; returns the text.
    template <class... Parameters, class... Arguments>
    Result<std::string> text(luxfer_status (*function)(C *, Parameters...), Arguments... arguments) const {
        return detail::get_text(context_.get(), function, get(), arguments...);
    }

private:
    Context context_;
    detail::Reference<C> reference_;
};

/// Width and height in pixels, and the number of channels.
struct ImageSize {
    std::uint32_t width = 0, height = 0, channels = 0;

    /// Number of samples: width x height x channels.
    std::size_t samples() const noexcept { return std::size_t(width) * height * channels; }
};

/// An image, which never changes. See luxfer_image.
class Image : public Handle<luxfer_image> {
public:
    using Handle::Handle;

    /// Creates an image from a copy of the caller's pixels.
    static Result<Image> create(const Context &context, const ConstImageView &view) {
        return make_in<Image>(context, luxfer_image_create, &view);
    }

    /// Loads a JPEG, PNG, WebP, TIFF, BMP, GIF, Radiance HDR or OpenEXR file, upright.
    static Result<Image> load(const Context &context, Text path, luxfer_colour_space colour_space = LUXFER_COLOUR_SRGB) {
        return make_in<Image>(context, luxfer_image_load, path.get(), colour_space);
    }

    /// Loads an image file from memory: any container of bytes.
    template <class Bytes>
    static Result<Image> load_memory(const Context &context, const Bytes &file,
                                     luxfer_colour_space colour_space = LUXFER_COLOUR_SRGB) {
        static_assert(sizeof *std::data(file) == 1, "a file consists of bytes");
        const void *data = std::data(file);
        return make_in<Image>(context, luxfer_image_load_memory, data, std::size(file), colour_space);
    }

    /// Saves the image as .png, multiplied by exposure, or as .exr.
    Result<> save(Text path, float exposure = 1.0f) const { return call(luxfer_image_save, path.get(), exposure); }

    Result<ImageSize> size() const {
        ImageSize size;
        const luxfer_status status = luxfer_image_get_size(get(), &size.width, &size.height, &size.channels);
        return detail::to_result(context().get(), status, size);
    }

    /// The camera's metadata in the file of a loaded photo; 0 means unknown.
    Result<luxfer_photo_metadata> metadata() const {
        return value<luxfer_photo_metadata>(luxfer_image_get_metadata);
    }

    /// The merged image of several exposures, and the report of the merge.
    struct Merged;

    /// Merges photos of one view with different exposures into one image; see luxfer_image_merge_exposures.
    static Result<Merged> merge_exposures(const Context &context, Span<const Image> photos,
                                          const luxfer_merge_params &params = MergeParams());

    /// Writes the image into the caller's pixels.
    Result<> read(const ImageView &view, std::uint32_t first_channel = 0) const {
        return call(luxfer_image_read, first_channel, &view);
    }

    /// All samples, packed: rows from top to bottom, pixels from left to right, channels. At most four channels; for
    /// images with more, use read().
    Result<std::vector<float>> samples() const {
        ImageSize size;
        luxfer_status status = luxfer_image_get_size(get(), &size.width, &size.height, &size.channels);
        std::vector<float> samples(size.samples());
        const ImageView view(samples, size.width, size.height, size.channels);
        if (status == LUXFER_OK)
            status = luxfer_image_read(get(), 0, &view);
        return detail::to_result(context().get(), status, std::move(samples));
    }

    /// Creates an image whose pixel at p is the pixel of this image at to_source(p).
    Result<Image> warp(Numbers<9> to_source, std::uint32_t width, std::uint32_t height) const {
        return make<Image>(luxfer_image_warp, to_source.data(), width, height);
    }
};

struct Image::Merged {
    Image image;
    luxfer_merge_report report;
};

inline Result<Image::Merged> Image::merge_exposures(const Context &context, Span<const Image> photos,
                                                    const luxfer_merge_params &params) {
    std::vector<luxfer_image *> handles;
    for (const Image &photo : photos)
        handles.push_back(photo.get());
    luxfer_image *made = nullptr;
    luxfer_merge_report report = {};
    const luxfer_status status = luxfer_image_merge_exposures(context.get(), handles.data(), handles.size(), &params,
                                                              &made, &report, sizeof report);
    return detail::to_result(context.get(), status, Merged{Image(context, made), report});
}

/// Computes the homography that maps four points to four points; the arrays hold x and y of each point. Returns its
/// matrix row by row.
inline Result<std::array<double, 9>> homography_from_corners(const Context &context, Numbers<8> from, Numbers<8> to) {
    std::array<double, 9> map = {};
    const luxfer_status status = luxfer_homography_from_corners(context.get(), from.data(), to.data(), map.data());
    return detail::to_result(context.get(), status, map);
}

/// Receives the progress of a job, from 0 to 1, on the waiting thread; returns false to cancel the job. It may throw:
/// this cancels the job, and wait() rethrows the exception (with LUXFER_NO_EXCEPTIONS it must not throw).
using Progress = std::function<bool(double fraction)>;

/// The progress of a job, and the status with which it has ended; LUXFER_NOT_READY while it runs.
struct JobState {
    double fraction = 0;
    luxfer_status outcome = LUXFER_NOT_READY;

    /// Whether the job has ended, with or without success.
    bool is_finished() const noexcept { return outcome != LUXFER_NOT_READY; }
};

/// Work in progress. The destructor of the last copy cancels the job and waits until it has ended. See luxfer_job.
class Job : public Handle<luxfer_job> {
public:
    using Handle::Handle;

    /// Runs a function of the caller as a job on a thread of its own. When the job is cancelled, the library calls
    /// that the function makes in this context end early. The function reports a failure by an Error, returned or
    /// thrown; any other exception makes the job fail with LUXFER_UNKNOWN.
    static Result<Job> start(const Context &context, std::function<Result<>()> work) {
        auto kept = std::make_unique<std::function<Result<>()>>(std::move(work));
        luxfer_job *made = nullptr;
        const luxfer_status status = luxfer_job_start(context.get(), &run_and_delete, kept.get(), &made);
        if (status == LUXFER_OK)
            static_cast<void>(kept.release());
        return detail::to_result(context.get(), status, Job(context, made));
    }

    /// Waits until the job has ended; if it fails, this call fails with its error.
    Result<> wait(const Progress &progress = {}) const {
        const Waited waited = wait_c(get(), -1, progress);
        return detail::to_result(context().get(), waited.error());
    }

    /// Waits at most for the given time. Returns true if the job has succeeded, false if it still runs; fails with the
    /// job's error.
    Result<bool> wait_for(std::chrono::milliseconds time, const Progress &progress = {}) const {
        constexpr std::int64_t longest = std::numeric_limits<std::int32_t>::max();
        const auto limit = std::int32_t(std::min(std::max<std::int64_t>(time.count(), 0), longest));
        const Waited waited = wait_c(get(), limit, progress);
        if (waited.status == LUXFER_OK && waited.outcome == LUXFER_NOT_READY)
            return false;
        return detail::to_result(context().get(), waited.error(), true);
    }

    /// Gets the progress and the outcome without waiting; does not fail with the job's error.
    Result<JobState> poll() const {
        JobState state;
        luxfer_status status = luxfer_job_get_progress(get(), &state.fraction);
        if (status == LUXFER_OK)
            status = luxfer_job_wait(get(), 0, nullptr, nullptr, &state.outcome);
        if (state.outcome == LUXFER_OK)
            state.fraction = 1; // it may have succeeded since the first call
        return detail::to_result(context().get(), status, state);
    }

    /// Asks the job to end early, from any thread; returns at once.
    Result<> cancel() const { return call(luxfer_job_cancel); }

private:
    // The status of luxfer_job_wait, and the outcome of the job that it gives.
    struct Waited {
        luxfer_status status = LUXFER_OK, outcome = LUXFER_NOT_READY;

        luxfer_status error() const noexcept { return status != LUXFER_OK ? status : outcome; }
    };

    struct Listener {
        const Progress &progress;
        detail::Caught caught;
    };

    static std::int32_t tell(void *user, double fraction) {
        Listener &listener = *static_cast<Listener *>(user);
        return listener.caught.run([&] { return listener.progress(fraction); });
    }

    static luxfer_status run_and_delete(void *user) {
        const std::unique_ptr<std::function<Result<>()>> work(static_cast<std::function<Result<>()> *>(user));
        return detail::status_of(*work);
    }

    // Calls luxfer_job_wait with a C++ progress function.
    static Waited wait_c(luxfer_job *job, std::int32_t timeout_ms, const Progress &progress) {
        Waited waited;
        Listener listener = {progress, {}};
        waited.status = luxfer_job_wait(job, timeout_ms, progress ? tell : nullptr, &listener, &waited.outcome);
        listener.caught.rethrow();
        return waited;
    }
};

} // namespace luxfer
