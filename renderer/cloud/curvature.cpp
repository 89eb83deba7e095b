#include "renderer/cloud/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <utility>

#include "renderer/cloud/surfel_codec.hpp"

namespace scancast {

namespace {

// 12 octaves of 8 steps: half a step is 4.4 %.
constexpr int lastStep = 97;
constexpr double eighthOfOctave = 1.0905077326652577;

// Made of exact constants and multiplications, not of a library's functions: files are the same bytes wherever
// they are made.
constexpr auto curvatureTable = [] {
    std::array<float, 256> table{};
    double value = 1.0 / 1024;
    for (int step = 1; step < 128; ++step) {
        table[step] = float(value);
        table[256 - step] = -float(value);
        if (step < lastStep) value *= eighthOfOctave;
    }
    table[128] = -float(value);
    return table;
}();

/// Radians from a splat's centre to its border: half a degree, which nobody sees.
constexpr float leastTurn = 1.0f / 128;

/// The byte whose curvature is nearest in ratio; 0 for what is less than half a step below the least.
std::uint32_t stepOf(float curvature) {
    const float size = std::abs(curvature);
    const auto begin = curvatureTable.begin() + 1, end = curvatureTable.begin() + lastStep + 1;
    const auto above = std::lower_bound(begin, end, size);
    int step = int(above - curvatureTable.begin());
    if (above == end)
        step = lastStep;
    else if (above == begin)
        step = size * float(eighthOfOctave) * size > *begin * *begin ? 1 : 0;
    else if (size * size < *(above - 1) * *above)
        --step;
    return std::uint32_t(curvature < 0 && step > 0 ? 256 - step : step);
}

glm::vec3 directionOf(CurvatureCode code, const glm::vec3& normal) {
    return axisAtAngle(std::uint8_t(code >> 16), normal);
}

}  // namespace

const std::array<float, 256>& curvatureSteps() {
    return curvatureTable;
}

Curvature curvatureOf(const Surfel& surfel) {
    if (surfel.bend == glm::vec3(0)) return {};
    const double a = surfel.bend.x, b = surfel.bend.y, c = surfel.bend.z;
    const double mean = 0.5 * (a + c), half = 0.5 * (a - c), apart = std::sqrt(half * half + b * b);
    // The direction of mean + apart, by half the angle whose cosine is half / apart.
    const double cosine = apart > 0 ? std::sqrt(std::max(0.0, 0.5 * (1 + half / apart))) : 1;
    const double sine = apart > 0 ? std::sqrt(std::max(0.0, 0.5 * (1 - half / apart))) : 0;
    glm::dvec2 along(cosine, b < 0 ? -sine : sine);
    double k1 = mean + apart, k2 = mean - apart;
    if (std::abs(k2) > std::abs(k1)) {
        std::swap(k1, k2);
        along = {-along.y, along.x};
    }
    const glm::dvec3 first = surfel.majorAxis, second = glm::cross(glm::dvec3(surfel.normal), first);
    return {float(k1), float(k2), glm::vec3(first * along.x + second * along.y)};
}

CurvatureCode encodeCurvature(const Curvature& curvature, const glm::vec3& estimated,
                              const glm::vec3& decoded, float radius, float radiusUnit) {
    if (decoded == glm::vec3(0) || !(radius > 0)) return 0;
    if (std::abs(curvature.k1) * radius < leastTurn) return 0;
    const float sign = glm::dot(estimated, decoded) < 0 ? -1.0f : 1.0f, most = radiusUnit / radius;
    const auto step = [&](float k) { return stepOf(std::clamp(sign * k * radiusUnit, -most, most)); };
    const std::uint32_t k1 = step(curvature.k1), k2 = step(curvature.k2);
    if (k1 == 0 && k2 == 0) return 0;
    // What is bent alike in all directions has none.
    return k1 | k2 << 8 | (k1 == k2 ? 0 : std::uint32_t(axisAngleOf(curvature.direction, decoded)) << 16);
}

CurvatureCode curvatureCodeOf(const Surfel& surfel, const Sample& sample, float radiusUnit) {
    if (surfel.density != Density::Surface && surfel.density != Density::Edge) return 0;
    return encodeCurvature(curvatureOf(surfel), surfel.normal, decodeNormal(sample.normal),
                           decodeSurfel(sample, radiusUnit).radius, radiusUnit);
}

Curvature decodeCurvature(CurvatureCode code, const glm::vec3& decoded, float radiusUnit) {
    const float k1 = curvatureTable[code & 255] / radiusUnit,
                k2 = curvatureTable[(code >> 8) & 255] / radiusUnit;
    if (k1 == 0 && k2 == 0) return {};
    return {k1, k2, directionOf(code, decoded)};
}

CurvatureCode turnedOver(CurvatureCode code, const glm::vec3& decoded, const glm::vec3& other) {
    if (code == 0) return 0;
    const auto negative = [](std::uint32_t step) { return (256 - step) & 255; };
    const std::uint32_t k1 = code & 255, k2 = (code >> 8) & 255;
    const std::uint32_t angle = k1 == k2 ? 0 : std::uint32_t(axisAngleOf(directionOf(code, decoded), other));
    return negative(k1) | negative(k2) << 8 | angle << 16;
}

}  // namespace scancast
