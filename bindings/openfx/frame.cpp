// Frames of clips.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#include "frame.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace openfx {

namespace {

struct Depth {
    const char *name;
    luxfer_sample sample;
    std::size_t bytes;
};

constexpr Depth depths[] = {{kOfxBitDepthByte, LUXFER_SAMPLE_U8, 1},
                            {kOfxBitDepthShort, LUXFER_SAMPLE_U16, 2},
                            {kOfxBitDepthHalf, LUXFER_SAMPLE_F16, 2},
                            {kOfxBitDepthFloat, LUXFER_SAMPLE_F32, 4}};

bool is_empty(const OfxRectI &area) {
    return area.x1 >= area.x2 || area.y1 >= area.y2;
}

std::size_t width_of(const OfxRectI &area) {
    return std::size_t(area.x2 - area.x1);
}

std::size_t height_of(const OfxRectI &area) {
    return std::size_t(area.y2 - area.y1);
}

} // namespace

OfxRectI shared(const OfxRectI &a, const OfxRectI &b) {
    return {std::max(a.x1, b.x1), std::max(a.y1, b.y1), std::min(a.x2, b.x2), std::min(a.y2, b.y2)};
}

std::string in_words(const OfxRectI &area) {
    return std::to_string(width_of(area)) + " x " + std::to_string(height_of(area)) + " pixels at (" +
           std::to_string(area.x1) + ", " + std::to_string(area.y1) + ")";
}

std::optional<Frame> Frame::fetch(OfxImageEffectHandle effect, const char *clip, double time) {
    OfxImageClipHandle handle = nullptr;
    OfxPropertySetHandle properties = nullptr, image = nullptr;
    const bool is_output = std::string(clip) == kOfxImageEffectOutputClipName; // connected if another effect uses it
    if (suites().effect->clipGetHandle(effect, clip, &handle, &properties) != kOfxStatOK ||
        (!is_output && Properties(properties).integer(kOfxImageClipPropConnected) == 0))
        return std::nullopt;
    if (suites().effect->clipGetImage(handle, time, nullptr, &image) != kOfxStatOK || image == nullptr)
        throw std::runtime_error(std::string(clip) + " has no picture at this time");
    return Frame(image, clip);
}

Frame::Frame(OfxPropertySetHandle image, const char *clip) : image_(image), clip_(clip) {
    const Properties properties(image);
    const auto fail = [&](const std::string &reason) { throw std::runtime_error(std::string(clip) + " " + reason); };

    const std::string name = properties.text(kOfxImageEffectPropPixelDepth);
    const std::string components = properties.text(kOfxImageEffectPropComponents);
    const auto is_named = [&](const Depth &depth) { return name == depth.name; };
    const auto depth = std::find_if(std::begin(depths), std::end(depths), is_named);
    const bool is_rgba = components == kOfxImageComponentRGBA;
    if (depth == std::end(depths) || (!is_rgba && components != kOfxImageComponentRGB))
        fail("has pixels of the kind " + components + ", " + name + ", which the effect does not support");
    sample_ = depth->sample;
    sample_bytes_ = depth->bytes;
    pixel_bytes_ = (is_rgba ? 4 : 3) * sample_bytes_;

    data_ = static_cast<std::byte *>(properties.pointer(kOfxImagePropData));
    row_bytes_ = properties.integer(kOfxImagePropRowBytes);
    bounds_ = properties.rectangle(kOfxImagePropBounds);
    const OfxRectI defined = properties.rectangle(kOfxImagePropRegionOfDefinition);
    area_ = is_empty(defined) ? bounds_ : shared(bounds_, defined);
    if (data_ == nullptr || is_empty(area_))
        fail("has no pixels");
    if (std::size_t(std::abs(row_bytes_)) < width_of(bounds_) * pixel_bytes_)
        fail("has rows of " + std::to_string(row_bytes_) + " bytes, which are too few for its width");
}

std::byte *Frame::at(int x, int y) const {
    return data_ + (y - bounds_.y1) * row_bytes_ + (x - bounds_.x1) * std::ptrdiff_t(pixel_bytes_);
}

luxfer_colour_space Frame::colour_space(Encoding encoding) const {
    const bool is_integer = sample_ == LUXFER_SAMPLE_U8 || sample_ == LUXFER_SAMPLE_U16;
    const bool is_srgb = encoding == Encoding::srgb || (encoding == Encoding::by_depth && is_integer);
    return is_srgb ? LUXFER_COLOUR_SRGB : LUXFER_COLOUR_LINEAR;
}

luxfer::ImageView Frame::view(std::byte *lowest, const OfxRectI &area, std::size_t row_bytes, std::size_t first_channel,
                              std::uint32_t channels) const {
    luxfer::ImageView view;
    view.channels = channels;
    view.sample = sample_;
    view.width = std::uint32_t(width_of(area));
    view.height = std::uint32_t(height_of(area));
    view.pixel_stride = pixel_bytes_;
    view.row_stride = row_bytes;
    view.data = lowest + first_channel * sample_bytes_;
    view.byte_size = (height_of(area) - 1) * row_bytes + width_of(area) * pixel_bytes_ - first_channel * sample_bytes_;
    return view;
}

luxfer::ImageView Frame::view(std::size_t first_channel, std::uint32_t channels) const {
    const bool is_bottom_up = row_bytes_ > 0;
    std::byte *lowest = at(area_.x1, is_bottom_up ? area_.y1 : area_.y2 - 1);
    luxfer::ImageView all = view(lowest, area_, std::size_t(std::abs(row_bytes_)), first_channel, channels);
    all.flags = is_bottom_up ? LUXFER_VIEW_BOTTOM_UP : 0;
    return all;
}

luxfer::Image Frame::colour(const luxfer::Context &context, Encoding encoding) const {
    luxfer::ImageView rgb = view(0, 3);
    rgb.colour_space = colour_space(encoding);
    return luxfer::Image::create(context, rgb);
}

luxfer::Image Frame::alpha(const luxfer::Context &context) const {
    if (has_alpha())
        return luxfer::Image::create(context, view(3, 1));
    const std::vector<float> opaque(width_of(area_) * height_of(area_), 1.0f);
    const luxfer::ConstImageView ones(opaque, std::uint32_t(width_of(area_)), std::uint32_t(height_of(area_)), 1);
    return luxfer::Image::create(context, ones);
}

void Frame::write(const luxfer::Image &colour, const luxfer::Image &alpha, Encoding encoding, const OfxRectI &area,
                  const OfxRectI &window) const {
    // The library converts the picture into packed rows of the host's kind of pixels, from the bottom to the top.
    const std::size_t row = width_of(area) * pixel_bytes_;
    std::vector<std::byte> packed(row * height_of(area));
    luxfer::ImageView rgb = view(packed.data(), area, row, 0, 3);
    rgb.flags = LUXFER_VIEW_BOTTOM_UP;
    rgb.colour_space = colour_space(encoding);
    colour.read(rgb);
    if (has_alpha()) {
        luxfer::ImageView a = view(packed.data(), area, row, 3, 1);
        a.flags = LUXFER_VIEW_BOTTOM_UP;
        alpha.read(a);
    }

    const OfxRectI written = shared(window, bounds_), covered = shared(written, area);
    for (int y = written.y1; y < written.y2 && written.x1 < written.x2; y++)
        std::memset(at(written.x1, y), 0, width_of(written) * pixel_bytes_);
    for (int y = covered.y1; y < covered.y2 && covered.x1 < covered.x2; y++) {
        const std::size_t x = std::size_t(covered.x1 - area.x1);
        std::memcpy(at(covered.x1, y), &packed[std::size_t(y - area.y1) * row + x * pixel_bytes_],
                    width_of(covered) * pixel_bytes_);
    }
}

} // namespace openfx
