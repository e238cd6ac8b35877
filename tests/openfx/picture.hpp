// Pixels in the memory of a host: of any depth, with or without alpha, with rows in either order and bytes between
// them.
#pragma once

#include <ofxImageEffect.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

struct Depth {
    const char *name;
    int sample; // a LUXFER_SAMPLE_ value
    std::size_t bytes;
};

// How a host stores a picture.
struct Layout {
    Depth depth;
    std::size_t channels; // 3 or 4
    bool is_top_down;     // the bytes from one row to the next are negative
    OfxPointI origin;     // the pixel at the lower left
    std::size_t padding;  // bytes after each row
};

class Picture {
public:
    enum : unsigned char { untouched = 0x5b };

    Picture(const Layout &layout_, std::uint32_t width_, std::uint32_t height_)
        : layout(layout_), width(width_), height(height_),
          row_bytes(int(width * layout.channels * layout.depth.bytes + layout.padding)),
          memory(std::size_t(row_bytes) * height, untouched) {}

    OfxRectI bounds() const {
        return {layout.origin.x, layout.origin.y, layout.origin.x + int(width), layout.origin.y + int(height)};
    }

    // The region of definition: without the border.
    OfxRectI defined() const {
        const OfxRectI b = bounds();
        return {b.x1 + border, b.y1 + border, b.x2 - border, b.y2 - border};
    }

    // The address of the pixel at column x and row y, counted from the top left.
    unsigned char *at(std::uint32_t x, std::uint32_t y) {
        const std::uint32_t row = layout.is_top_down ? y : height - 1 - y;
        return memory.data() + std::size_t(row) * std::size_t(row_bytes) + x * layout.channels * layout.depth.bytes;
    }

    // Copies packed samples of `count` channels from the top left into the channels from `first` on, or out of them.
    void set(const std::vector<unsigned char> &packed, std::size_t first, std::size_t count) {
        const std::size_t bytes = count * layout.depth.bytes;
        for_each(first, bytes, [&](unsigned char *pixel, std::size_t i) { std::memcpy(pixel, &packed[i], bytes); });
    }
    std::vector<unsigned char> get(std::size_t first, std::size_t count) {
        const std::size_t bytes = count * layout.depth.bytes;
        std::vector<unsigned char> packed(std::size_t(width) * height * bytes);
        for_each(first, bytes, [&](unsigned char *pixel, std::size_t i) { std::memcpy(&packed[i], pixel, bytes); });
        return packed;
    }

    // Whether no byte has been written since the construction; and whether the bytes between rows are as constructed.
    bool is_untouched() const { return memory == std::vector<unsigned char>(memory.size(), untouched); }
    bool is_padding_untouched() const {
        for (std::size_t end = std::size_t(row_bytes); end <= memory.size(); end += std::size_t(row_bytes))
            for (std::size_t i = end - layout.padding; i < end; i++)
                if (memory[i] != untouched)
                    return false;
        return true;
    }

    Layout layout;
    std::uint32_t width, height;
    int row_bytes;
    int border = 0; // pixels in memory beyond the region of definition, on each side
    std::vector<unsigned char> memory;

private:
    // Calls a function with the address of a channel of each pixel, from the top left, and with 0, step, 2 step, ...
    template <class Function>
    void for_each(std::size_t channel, std::size_t step, const Function &function) {
        std::size_t i = 0;
        for (std::uint32_t y = 0; y < height; y++)
            for (std::uint32_t x = 0; x < width; x++, i += step)
                function(at(x, y) + channel * layout.depth.bytes, i);
    }
};
