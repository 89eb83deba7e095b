#include "renderer/jitter.hpp"

namespace scancast {
namespace {

/// The digits of i, mirrored at the point.
double radicalInverse(int i, int base) {
    double value = 0, digit = 1.0 / base;
    for (; i > 0; i /= base, digit /= base) value += digit * (i % base);
    return value;
}

}  // namespace

std::vector<glm::dvec2> jitterSequence(int frames) {
    std::vector<glm::dvec2> jitter;
    glm::dvec2 mean(0);
    for (int i = 1; i <= frames; ++i) {
        jitter.emplace_back(radicalInverse(i, 2), radicalInverse(i, 3));
        mean += jitter.back();
    }
    for (auto& shift : jitter) shift -= mean / static_cast<double>(frames);
    return jitter;
}

}  // namespace scancast
