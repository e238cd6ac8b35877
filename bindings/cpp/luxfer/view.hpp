// Views of the caller's memory: strings, arrays and pixels for the C functions. Views neither own nor copy memory.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include <luxfer.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

namespace luxfer {

/// A zero-terminated string in UTF-8: a literal or a std::string. nullptr means no string, where a function allows it.
class Text {
public:
    Text(const char *text) noexcept : text_(text) {}
    Text(const std::string &text) noexcept : text_(text.c_str()) {}
    const char *get() const noexcept { return text_; }

private:
    const char *text_;
};

/// A view of contiguous elements, like std::span of C++20: of an array, a std::vector, a std::array, or a pointer and
/// a count.
template <class T>
class Span {
public:
    constexpr Span() noexcept = default;
    constexpr Span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}

    template <class Elements, class = std::enable_if_t<std::is_convertible_v<
                                  std::remove_pointer_t<decltype(std::data(std::declval<Elements &>()))> (*)[], T (*)[]>>>
    constexpr Span(Elements &&elements) noexcept : data_(std::data(elements)), size_(std::size(elements)) {}

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }
    constexpr T &operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

/// Exactly N numbers, from an array or a std::array: 9 for a matrix row by row, 8 for four points.
template <std::size_t N, class T = double>
class Numbers {
public:
    constexpr Numbers(const T (&numbers)[N]) noexcept : data_(numbers) {}
    constexpr Numbers(const std::array<T, N> &numbers) noexcept : data_(numbers.data()) {}
    constexpr const T *data() const noexcept { return data_; }

private:
    const T *data_;
};

/// A colour, or an amount of light for each channel: red, green, blue.
using Rgb = std::array<float, 3>;

/// A versioned struct of the C header, filled with the library's defaults. It derives from the C struct: set the
/// fields, which the C header documents. (If the initialisation fails, the size stays 0, and calls refuse the struct.)
template <class C, luxfer_struct_type struct_type>
struct Params : C {
    Params() noexcept : C() { luxfer_init(struct_type, static_cast<C *>(this), sizeof(C)); }
};

namespace detail {

template <class T>
constexpr luxfer_sample sample_of() {
    if constexpr (std::is_same_v<T, std::uint8_t>)
        return LUXFER_SAMPLE_U8;
    else if constexpr (std::is_same_v<T, std::uint16_t>)
        return LUXFER_SAMPLE_U16;
    else {
        static_assert(std::is_same_v<T, float>, "samples are std::uint8_t, std::uint16_t or float");
        return LUXFER_SAMPLE_F32;
    }
}

} // namespace detail

/// Pixels to read from: `ConstImageView(pixels, width, height, channels)` for any container of packed samples. Set
/// strides, flags, colour space and half floats in the fields of its base, luxfer_image_view.
struct ConstImageView : Params<luxfer_image_view, LUXFER_STRUCT_IMAGE_VIEW> {
    ConstImageView() noexcept = default;

    template <class Pixels>
    ConstImageView(const Pixels &pixels, std::uint32_t width_, std::uint32_t height_, std::uint32_t channels_ = 3) noexcept {
        using Sample = std::remove_const_t<std::remove_pointer_t<decltype(std::data(pixels))>>;
        sample = detail::sample_of<Sample>();
        width = width_;
        height = height_;
        channels = channels_;
        byte_size = std::size(pixels) * sizeof(Sample);
        data = const_cast<Sample *>(std::data(pixels)); // The library only reads the pixels.
    }
};

/// Pixels to write to, otherwise as ConstImageView.
struct ImageView : ConstImageView {
    ImageView() noexcept = default;

    template <class Pixels>
    ImageView(Pixels &&pixels, std::uint32_t width_, std::uint32_t height_, std::uint32_t channels_ = 3) noexcept
        : ConstImageView(pixels, width_, height_, channels_) {
        static_assert(!std::is_const_v<std::remove_pointer_t<decltype(std::data(pixels))>>, "these pixels cannot be written");
    }
};

} // namespace luxfer
