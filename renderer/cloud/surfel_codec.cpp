#include "renderer/cloud/surfel_codec.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace scancast {

namespace {

// Codes 1 … 254 are 253 steps from 1/16 to 16 node spacings: 2^(8/253) each, half of which is 1.1 %.
constexpr int firstCode = 1, lastCode = 254;
constexpr double radiusStep = 1.0221596546204528;
constexpr int angles = 32;
constexpr int ratios = 8;
// Of the angle between two directions, 180° / 32.
constexpr double stepCosine = 0.9951847266721969, stepSine = 0.0980171403295606;

// Tables made of exact constants and multiplications, not of a library's functions: files are the same bytes
// wherever they are made.
constexpr auto radii = [] {
    std::array<float, 256> table{};
    double value = 1.0 / 16;
    for (int code = firstCode; code <= lastCode; ++code, value *= radiusStep) table[code] = float(value);
    table[outlierRadius] = table[firstCode];
    return table;
}();

typedef float Four __attribute__((vector_size(4 * sizeof(float))));
typedef int FourInts __attribute__((vector_size(4 * sizeof(int))));

struct Directions {
    std::array<float, angles> cosine{}, sine{};
};
constexpr auto directions = [] {
    Directions table;
    double c = 1, s = 0;
    for (int i = 0; i < angles; ++i) {
        table.cosine[i] = float(c);
        table.sine[i] = float(s);
        const double next = c * stepCosine - s * stepSine;
        s = s * stepCosine + c * stepSine;
        c = next;
    }
    return table;
}();

/// The code whose radius is nearest in ratio.
std::uint8_t radiusCode(float inSpacings) {
    const auto begin = radii.begin() + firstCode, end = radii.begin() + lastCode + 1;
    const auto above = std::lower_bound(begin, end, inSpacings);
    if (above == begin) return firstCode;
    if (above == end) return lastCode;
    const float below = *(above - 1);
    const bool up = inSpacings * inSpacings > below * *above;
    return std::uint8_t(above - radii.begin() - (up ? 0 : 1));
}

std::uint8_t ellipseCode(const Surfel& surfel, glm::vec3 decodedNormal) {
    if (!(surfel.major > 0) || decodedNormal == glm::vec3(0)) return 0;
    const float ratio = std::clamp(surfel.minor / surfel.major, leastSurfelRatio, 1.0f);
    const int step = int((1 - ratio) / (1 - leastSurfelRatio) * float(ratios - 1) + 0.5f);
    if (step == 0) return 0;
    return std::uint8_t(step << 5 | axisAngleOf(surfel.majorAxis, decodedNormal));
}

}  // namespace

const std::array<float, 256>& surfelRadii() {
    return radii;
}

// Frisvad's frame; 1 + z is taken from x and y where it would cancel.
TangentFrame tangentFrame(glm::vec3 n) {
    const float flat = n.x * n.x + n.y * n.y;
    if (n.z < 0 && flat == 0) return {{0, -1, 0}, {-1, 0, 0}};
    const float a = n.z < 0 ? (1 - n.z) / flat : 1 / (1 + n.z);
    const float b = -n.x * n.y * a;
    return {{1 - n.x * n.x * a, b, -n.x}, {b, 1 - n.y * n.y * a, -n.y}};
}

std::uint8_t axisAngleOf(const glm::vec3& axis, const glm::vec3& normal) {
    const TangentFrame frame = tangentFrame(normal);
    const float u = glm::dot(axis, frame.first), v = glm::dot(axis, frame.second);
    // The first of the largest; each of four lanes looks at every fourth angle.
    constexpr int lanes = 4;
    Four largest{-1, -1, -1, -1};
    FourInts at{};
    for (int i = 0; i < angles; i += lanes) {
        Four cosine, sine;
        std::memcpy(&cosine, &directions.cosine[i], sizeof cosine);
        std::memcpy(&sine, &directions.sine[i], sizeof sine);
        const Four signedAlong = u * cosine + v * sine;
        const Four along = signedAlong < 0 ? -signedAlong : signedAlong;
        const FourInts larger = along > largest;
        largest = larger ? along : largest;
        at = larger ? FourInts{i, i, i, i} : at;
    }
    int best = at[0];
    float most = largest[0];
    for (int l = 1; l < lanes; ++l) {
        const int angle = at[l] + l;
        if (largest[l] > most || (largest[l] == most && angle < best)) {
            most = largest[l];
            best = angle;
        }
    }
    return std::uint8_t(best);
}

glm::vec3 axisAtAngle(std::uint8_t angle, const glm::vec3& normal) {
    const TangentFrame frame = tangentFrame(normal);
    const int i = angle & (angles - 1);
    return frame.first * directions.cosine[i] + frame.second * directions.sine[i];
}

void encodeSurfel(const Surfel& surfel, float nodeSpacing, Sample& sample) {
    if (surfel.normal != glm::vec3(0)) sample.normal = encodeNormal(surfel.normal);
    sample.ellipse = 0;
    if (surfel.outlier) {
        sample.logRadius = outlierRadius;
    } else if (surfel.radius > 0 && nodeSpacing > 0) {
        sample.logRadius = radiusCode(surfel.radius / nodeSpacing);
        sample.ellipse = ellipseCode(surfel, decodeNormal(sample.normal));
    } else {
        sample.logRadius = noRadius;
    }
}

void makeTwoSided(Sample& sample) {
    if (sample.logRadius >= firstCode && sample.logRadius <= lastCode) {
        const float ratio = 1 - float(sample.ellipse >> 5) * ((1 - leastSurfelRatio) / float(ratios - 1));
        sample.logRadius = radiusCode(radii[sample.logRadius] * std::sqrt(ratio));
    }
    sample.ellipse = twoSidedCircle;
}

Surfel decodeSurfel(const Sample& sample, float nodeSpacing) {
    Surfel s;
    s.normal = decodeNormal(sample.normal);
    s.outlier = sample.logRadius == outlierRadius;
    const bool known = sample.logRadius != noRadius && !s.outlier;
    s.radius = sample.logRadius != noRadius ? radii[sample.logRadius] * nodeSpacing : nodeSpacing;
    s.major = known ? s.radius * majorPerRadius : s.radius;
    const float ratio = 1 - float(sample.ellipse >> 5) * ((1 - leastSurfelRatio) / float(ratios - 1));
    s.minor = s.major * ratio;
    s.majorAxis = axisAtAngle(sample.ellipse, s.normal);
    return s;
}

}  // namespace scancast
