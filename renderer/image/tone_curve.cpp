#include "renderer/image/tone_curve.hpp"

#include <cmath>

namespace scancast {
namespace {

/// Light from which on brightening is held back, so that white is reached by the brightest alone.
constexpr double shoulder = 0.5;

double linearOf(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double srgbOf(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// Light of 0 … gain → 0 … 1: unchanged up to the shoulder, then a hyperbola that leaves it with slope 1.
double heldBack(double light, double gain) {
    if (gain <= 1 || light <= shoulder) return light;
    const double over = light - shoulder;
    const double bend = 1 / (1 - shoulder) - 1 / (gain - shoulder);
    return shoulder + over / (1 + bend * over);
}

}  // namespace

std::array<std::uint8_t, 256> toneCurve(double stops) {
    const double gain = std::exp2(stops);
    std::array<std::uint8_t, 256> curve{};
    for (std::size_t i = 0; i < curve.size(); ++i) {
        const double light = heldBack(linearOf(double(i) / 255) * gain, gain);
        curve[i] = static_cast<std::uint8_t>(std::lround(srgbOf(light) * 255));
    }
    return curve;
}

}  // namespace scancast
