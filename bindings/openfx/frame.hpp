// Frames of clips: pixels in the host's memory, and their way into and out of the library.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#pragma once

#include "host.hpp"
#include "inputs.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace openfx {

/// The part that two rectangles share; empty (x1 >= x2 or y1 >= y2) if they share none.
OfxRectI shared(const OfxRectI &a, const OfxRectI &b);

/// A rectangle in words: "320 x 240 pixels at (0, 0)".
std::string in_words(const OfxRectI &area);

/// A frame of a clip. The host keeps its pixels as long as this object lives. In memory, the rows of a picture may run
/// from the bottom to the top or, if the bytes from one row to the next are negative, from the top to the bottom.
class Frame {
public:
    /// Fetches a frame; nothing if the clip is not connected. Throws std::runtime_error if the clip has no picture at
    /// this time, or the plug-in cannot read its pixels.
    static std::optional<Frame> fetch(OfxImageEffectHandle effect, const char *clip, double time);

    /// The clip's name, for messages.
    const char *clip() const { return clip_; }

    /// The pixels of the picture: those in memory, without a border beyond the region of definition.
    const OfxRectI &area() const { return area_; }

    /// The red, green and blue of the picture, decoded to linear values.
    luxfer::Image colour(const luxfer::Context &context, Encoding encoding) const;

    /// The alpha of the picture; 1 if the clip has none.
    luxfer::Image alpha(const luxfer::Context &context) const;

    /// Writes a picture that covers `area` into the pixels of `window`. Pixels of the window outside the area become
    /// black and transparent.
    void write(const luxfer::Image &colour, const luxfer::Image &alpha, Encoding encoding, const OfxRectI &area,
               const OfxRectI &window) const;

private:
    struct Release {
        void operator()(OfxPropertySetHandle image) const { suites().effect->clipReleaseImage(image); }
    };

    Frame(OfxPropertySetHandle image, const char *clip);

    std::byte *at(int x, int y) const;
    bool has_alpha() const { return pixel_bytes_ == 4 * sample_bytes_; }
    luxfer_colour_space colour_space(Encoding encoding) const;

    /// A view of packed rows or of the host's rows of pixels of this frame's kind, without its colour space.
    luxfer::ImageView view(std::byte *lowest, const OfxRectI &area, std::size_t row_bytes, std::size_t first_channel,
                           std::uint32_t channels) const;

    /// A view of some channels of the picture.
    luxfer::ImageView view(std::size_t first_channel, std::uint32_t channels) const;

    std::unique_ptr<OfxPropertySetStruct, Release> image_;
    const char *clip_;
    luxfer_sample sample_ = LUXFER_SAMPLE_F32;
    std::size_t sample_bytes_ = 0, pixel_bytes_ = 0;
    std::byte *data_ = nullptr; // the pixel at the lower left of bounds_
    std::ptrdiff_t row_bytes_ = 0;
    OfxRectI bounds_ = {}, area_ = {};
};

} // namespace openfx
