#include "renderer/cloud/surfels/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "renderer/cloud/surfels/two.hpp"

namespace scancast {

namespace {

/// λ3/λ2 below which a neighbourhood is flat. Eleven points of a volume have 0.45, and one in twenty less than
/// this.
constexpr double flatRatio = 1.0 / 8;
/// Normals agree within 26°: what noise and the curvature of what is worth a disc leave.
constexpr float agreeingCosine = 0.9f;
/// Radii are alike within this factor.
constexpr float alikeFactor = 3;
/// Nobody is bounded by radii of more than so much of his own.
constexpr float muchSmaller = 0.8f;
/// A square grid's radius is 1.2 of its spacing, and 1.65 at its border.
constexpr float largeSpacings = 1.75f;
/// Of two rings of neighbours: λ3/λ2 + λ3/λ1 of a plane is less, and λ2/λ1 is more.
constexpr double flatFartherRatio = 0.17, wideFartherRatio = 0.08;
/// The same of a rough surface: stone, bark, the noise of photogrammetry. Most places of a volume have more.
/// Beams and rails are narrower.
constexpr double roughRatio = 0.3, wideRoughRatio = 0.16;
/// The mean of the witnesses' ways, as a part of their mean distance: less in the middle of a surface, more at its border.
constexpr float middleOffset = 0.35f, borderOffset = 0.6f;
/// Their variance in squared radii: 1.8 on a plane, 1 at its border, 0.6 of eleven points that have only each other.
constexpr double goesOn = 0.9;

double traceOf(const glm::dmat3& c) {
    return c[0][0] + c[1][1] + c[2][2];
}

/// Of the eigenvalues of a symmetric matrix, without the roots of a cubic: λ3/λ2 + λ3/λ1 where λ3 is small (1/3
/// of a ball), and λ2/λ1 where that is small (1/4 of a plane's).
bool isPlane(const glm::dmat3& c, double mostRatio, double leastWidth) {
    const double trace = traceOf(c);
    const double minors = c[0][0] * c[1][1] - c[0][1] * c[0][1] + c[0][0] * c[2][2] - c[0][2] * c[0][2] +
                          c[1][1] * c[2][2] - c[1][2] * c[1][2];
    const double determinant = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[1][2]) -
                               c[0][1] * (c[0][1] * c[2][2] - c[1][2] * c[0][2]) +
                               c[0][2] * (c[0][1] * c[1][2] - c[1][1] * c[0][2]);
    return minors > leastWidth * (trace * trace) && trace * determinant < mostRatio * (minors * minors);
}

}  // namespace

Evidence::Evidence(const NeighbourIndex& index)
    : index_(index), facts_(index.size()), witnesses_(index.size()) {}

void Evidence::add(const surfel::Solved& s) {
    facts_[s.point] = {.radius = s.radius,
                       .nearby = s.nearby,
                       .normal = glm::vec3(s.normal[0], s.normal[1], s.normal[2]),
                       .middle = glm::vec3(s.middle[0], s.middle[1], s.middle[2]),
                       .witnesses = std::uint8_t(s.witnesses),
                       .flat = s.flat < flatRatio,
                       .extended = s.extended,
                       .line = s.line};
    std::copy_n(s.witness, s.witnesses, witnesses_[s.point].begin());
}

float Evidence::usualRadius(std::uint32_t p) const {
    const auto who = witnesses(p);
    const float own = facts_[p].radius;
    if (std::ranges::none_of(who, [&](std::uint32_t w) { return facts_[w].radius < muchSmaller * own; }))
        return own;
    std::array<float, surfel::mostWitnesses> radii{};
    for (std::size_t i = 0; i < who.size(); ++i) radii[i] = facts_[who[i]].radius;
    const auto middle = radii.begin() + std::ptrdiff_t(who.size() - 1) / 2;
    std::nth_element(radii.begin(), middle, radii.begin() + std::ptrdiff_t(who.size()));
    return *middle;
}

Density Evidence::density(std::uint32_t p, float spacing) const {
    const Facts& own = facts_[p];
    if (own.line) return Density::Wire;
    const auto who = witnesses(p);
    std::size_t flat = 0, agreeing = 0, alike = 0;
    for (const std::uint32_t w : who) {
        const Facts& other = facts_[w];
        const bool isAlike =
            other.radius < alikeFactor * own.radius && own.radius < alikeFactor * other.radius;
        const bool agrees = other.flat && std::abs(glm::dot(other.normal, own.normal)) > agreeingCosine;
        flat += other.flat;
        alike += isAlike;
        agreeing += own.extended ? agrees && isAlike : agrees;
    }
    // A few points over a dense plane share their neighbours, and so agree, whatever they are: where a disc is
    // large, those around the neighbours are asked as well.
    const bool large = own.radius > largeSpacings * spacing;
    // The nearest say nothing of what is beside their line: who does has to agree with few exceptions.
    if (own.extended) {
        if (own.flat && !who.empty() && 4 * agreeing >= 3 * who.size() &&
            (!large || flatFarther(p, flatFartherRatio, wideFartherRatio)))
            return Density::Surface;
        return 2 * flat > who.size() && 2 * alike > who.size() ? Density::Edge : Density::Wire;
    }
    if (own.flat && 2 * agreeing > who.size() && !large) return Density::Surface;
    if (2 * alike <= who.size()) return Density::Foliage;
    const bool mostlyFlat = 8 * flat >= 3 * who.size();
    if (((own.flat && 2 * agreeing > who.size()) || !mostlyFlat) &&
        flatFarther(p, flatFartherRatio, wideFartherRatio))
        return Density::Surface;
    return mostlyFlat ? Density::Edge : Density::Foliage;
}

float Evidence::rough(std::uint32_t p) const {
    const auto who = witnesses(p);
    const float mean = facts_[p].nearby * float(who.size());
    if (!(mean > 0) || !flatFarther(p, roughRatio, wideRoughRatio)) return 0;
    glm::vec3 sum(0);
    for (const std::uint32_t w : who) sum += index_.position(w) - index_.position(p);
    return std::clamp((borderOffset - glm::length(sum) / mean) / (borderOffset - middleOffset), 0.0f, 1.0f);
}

bool Evidence::flatFarther(std::uint32_t p, double mostRatio, double leastWidth) const {
    const glm::vec3 at = index_.position(p);
    // Of d = (x, y, z): sums, squares and products, two at a time.
    Two sumXy{}, xxYy{}, xyXz{}, sumZzz{};
    double yz = 0, count = 1;
    for (const std::uint32_t w : witnesses(p))
        for (const std::uint32_t v : witnesses(w)) {
            const glm::dvec3 d = glm::dvec3(index_.position(v) - at);
            const Two xy{d.x, d.y}, oneZ{1, d.z};
            sumXy += xy;
            xxYy += xy * xy;
            xyXz += Two{d.x, d.x} * Two{d.y, d.z};
            sumZzz += oneZ * Two{d.z, d.z};
            yz += d.y * d.z;
            ++count;
        }
    const glm::dvec3 sum(sumXy[0], sumXy[1], sumZzz[0]);
    glm::dmat3 squares(0);
    squares[0] = {xxYy[0], xyXz[0], xyXz[1]};
    squares[1] = {0, xxYy[1], yz};
    squares[2] = {0, 0, sumZzz[1]};
    glm::dmat3 variance(0);
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b)
            variance[a][b] = squares[a][b] / count - sum[a] * sum[b] / (count * count);
    const double radius = facts_[p].radius;
    return traceOf(variance) > goesOn * (radius * radius) && isPlane(variance, mostRatio, leastWidth);
}

}  // namespace scancast
