// Pictures full of accidents for the passes of docs/spec/pyramid.md §1: odd sizes, borders, isolated pixels,
// all levels, both projections.
#pragma once

#include "tests/support/pictures/point_screen.hpp"

namespace scancast::test {

/// Points at random, in a few layers, with holes: `cover` of the pixels have one.
inline PointScreen accidents(int width, int height, bool perspective, double cover, std::uint64_t seed) {
    PointScreen s(width, height, perspective, perspective ? 200.0 : 25.0);
    Numbers numbers(seed);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (numbers.uniform() > cover) continue;
            // A disc of background stays empty; right of it a near layer begins.
            if (std::hypot(x - 0.35 * width, y - 0.4 * height) < 0.2 * height) continue;
            const bool near = x + y > 0.8 * width;
            const std::size_t i = s.at(x, y);
            const double layer = numbers.uniform() < 0.6 ? 4 : 9;
            s.depth[i] = static_cast<float>((near ? 2.5 : layer) + numbers.uniform(0, 0.4));
            s.rgba[i] = static_cast<std::uint32_t>(numbers.next()) | 0xff000000u;
            s.surface[i] = 0;
        }
    }
    return s;
}

struct AccidentCase {
    int width, height;
    bool perspective;
    double cover;
    float spacing, detail;
};

inline constexpr AccidentCase accidentCases[] = {
    {150, 101, true, 0.3, 0.06f, 0},   {150, 101, false, 0.3, 0.06f, 0}, {97, 130, true, 0.05, 0.2f, 0},
    {97, 130, false, 0.05, 0.3f, 0},   {64, 48, true, 0.9, 0.01f, 0.5f}, {131, 77, true, 0.15, 0, 1.5f},
    {131, 77, false, 0.15, 0, 1.5f},   {33, 17, true, 0.5, 0.1f, 0},     {5, 3, true, 0.7, 0.1f, 0},
    {1, 1, true, 1, 0.1f, 0},          {16, 1, false, 0.5, 0.1f, 0},     {200, 150, true, 0.02, 0.9f, 0},
    {70, 70, true, 0.4, 0.0001f, 0.2f}};

inline HiddenPointsPass hiding(const AccidentCase& c, float threshold = 0.1f) {
    HiddenPointsPass pass;
    pass.spacing = c.spacing;
    pass.detail = c.detail;
    pass.minGap = 0.11f;
    pass.threshold = threshold;
    return pass;
}

}  // namespace scancast::test
