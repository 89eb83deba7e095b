// Pictures become maps, pixel by pixel.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "renderer/map/map_picture.hpp"

namespace scancast {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

std::size_t indexOf(int x, int y, int width) {
    return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * 4;
}

/// Between the four pixels whose centres lie around it; beyond the picture there is `outside`.
Rgba sampled(const Frame& picture, const glm::dvec2& at, const Rgba& outside) {
    const double x = at.x - 0.5, y = at.y - 0.5;
    // Also what is no number at all.
    if (!(x > -1 && y > -1 && x < picture.width && y < picture.height)) return outside;
    const int left = int(std::floor(x)), top = int(std::floor(y));
    const double across = x - left, down = y - top;
    std::array<double, 4> sum{};
    for (int i = 0; i < 4; ++i) {
        const int column = left + (i & 1), row = top + (i >> 1);
        const double weight = ((i & 1) != 0 ? across : 1 - across) * ((i >> 1) != 0 ? down : 1 - down);
        const bool isInside = column >= 0 && row >= 0 && column < picture.width && row < picture.height;
        const std::uint8_t* const pixel =
            isInside ? picture.rgba.data() + indexOf(column, row, picture.width) : outside.data();
        const double alpha = weight * pixel[3];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += alpha * pixel[c];
        sum[3] += alpha;
    }
    if (sum[3] < 0.5) return {0, 0, 0, 0};
    Rgba result{};
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = std::uint8_t(std::lround(std::min(255.0, sum[c] / sum[3])));
    result[3] = std::uint8_t(std::lround(std::min(255.0, sum[3])));
    return result;
}

}  // namespace

Frame emptyMap(int width, int height, const std::optional<Rgb8>& background) {
    Frame map;
    map.width = width;
    map.height = height;
    auto& rgba = map.rgba.own();
    rgba.resize(std::size_t(width) * std::size_t(height) * 4);
    if (!background) return map;
    for (std::size_t i = 0; i < rgba.size(); i += 4) {
        std::ranges::copy(*background, rgba.begin() + std::ptrdiff_t(i));
        rgba[i + 3] = 255;
    }
    return map;
}

Expected<Frame> MapWarp::apply(const Frame& picture, const std::stop_token& stop) const {
    Frame map = emptyMap(width, height, opaque ? std::optional(outside) : std::nullopt);
    map.stats = picture.stats;
    auto& rgba = map.rgba.own();
    const Rgba around{outside[0], outside[1], outside[2], std::uint8_t(opaque ? 255 : 0)};
    for (int y = 0; y < size.y; ++y) {
        if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "nobody waits for this map any more");
        std::uint8_t* to = rgba.data() + indexOf(first.x, first.y + y, width);
        if (step == 0) {
            std::copy_n(picture.rgba.data() + indexOf(offset.x, offset.y + y, picture.width),
                        std::size_t(size.x) * 4, to);
            continue;
        }
        const double down = (y + 0.5) / step;
        const int row = std::min(int(down), rows - 2);
        const glm::dvec2* const above = nodes.data() + std::size_t(row) * std::size_t(columns);
        for (int x = 0; x < size.x; ++x, to += 4) {
            const double across = (x + 0.5) / step;
            const int column = std::min(int(across), columns - 2);
            const glm::dvec2* const corner = above + column;
            const glm::dvec2 upper = glm::mix(corner[0], corner[1], across - column);
            const glm::dvec2 lower = glm::mix(corner[columns], corner[columns + 1], across - column);
            std::ranges::copy(sampled(picture, glm::mix(upper, lower, down - row), around), to);
        }
    }
    return map;
}

}  // namespace scancast
