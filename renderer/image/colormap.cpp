#include "renderer/image/colormap.hpp"

#include <algorithm>

namespace scancast {

namespace {

/// Ramps are stored as a few anchors of the well-known curve and interpolated by Catmull-Rom splines.
template <std::size_t N>
Ramp interpolate(const std::array<Rgb8, N>& anchors) {
    Ramp ramp{};
    for (int i = 0; i < 256; ++i) {
        const double t = i / 255.0 * (N - 1);
        const int k = std::min(static_cast<int>(t), static_cast<int>(N) - 2);
        const double u = t - k;
        // Beyond the ends the curve goes on straight.
        const auto anchor = [&](int j, std::size_t c) {
            return static_cast<double>(anchors[static_cast<std::size_t>(j)][c]);
        };
        const auto at = [&](int j, std::size_t c) {
            constexpr int last = static_cast<int>(N) - 1;
            if (j < 0) return 2 * anchor(0, c) - anchor(1, c);
            return j > last ? 2 * anchor(last, c) - anchor(last - 1, c) : anchor(j, c);
        };
        for (std::size_t c = 0; c < 3; ++c) {
            const double p0 = at(k - 1, c), p1 = at(k, c), p2 = at(k + 1, c), p3 = at(k + 2, c);
            const double value =
                p1 +
                0.5 * u * (p2 - p0 + u * (2 * p0 - 5 * p1 + 4 * p2 - p3 + u * (3 * (p1 - p2) + p3 - p0)));
            ramp[static_cast<std::size_t>(i)][c] =
                static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
        }
    }
    return ramp;
}

constexpr std::array<Rgb8, 9> viridisAnchors{{{68, 1, 84},
                                              {71, 44, 122},
                                              {59, 81, 139},
                                              {44, 113, 142},
                                              {33, 144, 141},
                                              {39, 173, 129},
                                              {92, 200, 99},
                                              {170, 220, 50},
                                              {253, 231, 37}}};

constexpr std::array<Rgb8, 17> turboAnchors{{{48, 18, 59},
                                             {73, 62, 174},
                                             {69, 105, 238},
                                             {50, 149, 247},
                                             {38, 188, 225},
                                             {41, 220, 188},
                                             {63, 243, 147},
                                             {101, 253, 110},
                                             {149, 251, 81},
                                             {197, 236, 60},
                                             {236, 209, 46},
                                             {255, 173, 36},
                                             {255, 130, 29},
                                             {240, 86, 22},
                                             {203, 47, 13},
                                             {163, 19, 2},
                                             {122, 4, 3}}};

/// Two hues of the same lightness, and what lies between them brighter.
constexpr std::array<Rgb8, 5> curvatureAnchors{
    {{46, 72, 190}, {126, 166, 240}, {222, 222, 218}, {242, 150, 112}, {186, 30, 42}}};

constexpr std::array<Rgb8, 2> greyAnchors{{{0, 0, 0}, {255, 255, 255}}};

}  // namespace

std::optional<Ramp> colormap(std::string_view name) {
    static const Ramp viridis = interpolate(viridisAnchors);
    static const Ramp turbo = interpolate(turboAnchors);
    static const Ramp grey = interpolate(greyAnchors);
    if (name == "viridis") return viridis;
    if (name == "turbo") return turbo;
    if (name == "grey") return grey;
    return std::nullopt;
}

const Ramp& classificationColors() {
    static const Ramp colors = [] {
        Ramp ramp;
        // Classes above those that ASPRS names: a hue by class, so that neighbours differ.
        for (std::size_t i = 0; i < ramp.size(); ++i) {
            ramp[i] = {static_cast<std::uint8_t>(90 + i * 53 % 150),
                       static_cast<std::uint8_t>(90 + i * 101 % 150),
                       static_cast<std::uint8_t>(90 + i * 197 % 150)};
        }
        constexpr std::array<Rgb8, 19> named{{{176, 176, 176},   // 0 never classified
                                              {200, 200, 200},   // 1 unclassified
                                              {161, 121, 78},    // 2 ground
                                              {164, 200, 90},    // 3 low vegetation
                                              {92, 168, 70},     // 4 medium vegetation
                                              {38, 120, 52},     // 5 high vegetation
                                              {203, 92, 74},     // 6 building
                                              {255, 0, 170},     // 7 low point (noise)
                                              {240, 220, 120},   // 8 model key-point
                                              {66, 135, 220},    // 9 water
                                              {120, 100, 160},   // 10 rail
                                              {108, 110, 118},   // 11 road surface
                                              {190, 170, 210},   // 12 overlap
                                              {245, 200, 60},    // 13 wire, guard
                                              {250, 170, 40},    // 14 wire, conductor
                                              {80, 200, 200},    // 15 transmission tower
                                              {40, 170, 170},    // 16 wire connector
                                              {222, 160, 130},   // 17 bridge deck
                                              {255, 60, 120}}};  // 18 high noise
        std::copy(named.begin(), named.end(), ramp.begin());
        return ramp;
    }();
    return colors;
}

const Ramp& curvatureColors() {
    static const Ramp colors = interpolate(curvatureAnchors);
    return colors;
}

const Ramp& levelColors() {
    static const Ramp colors = [] {
        constexpr std::array<Rgb8, levelCycle> cycle{{{230, 80, 70},
                                                      {240, 150, 60},
                                                      {240, 215, 80},
                                                      {140, 200, 80},
                                                      {70, 190, 160},
                                                      {70, 160, 225},
                                                      {95, 105, 215},
                                                      {165, 95, 205},
                                                      {225, 110, 175},
                                                      {200, 200, 200}}};
        Ramp ramp;
        for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = cycle[i % cycle.size()];
        return ramp;
    }();
    return colors;
}

}  // namespace scancast
