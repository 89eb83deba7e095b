#include "renderer/cloud/surfels/shape_operator.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfels/two.hpp"

namespace scancast {

namespace {

/// Normals farther apart than 60° are those of two surfaces.
constexpr double leastCosine = 0.5;
constexpr int leastWitnesses = 6;
/// The operator's, which is symmetric; and of slopes that are linear in the way, the two that the means take away.
constexpr int turnTerms = 3, turnConstants = 2;
/// Operators are shrunk by so many times what noise explains of them, on the average: neighbours share theirs, so that
/// residuals tell of a part only. Measured: docs/spec/surfels.md §12.
constexpr double noiseExplains = 12;
/// Of a pivot, in units of the ways' squares: less, and all stand on a line.
constexpr double leastTurnPivot = 1e-3;

/// Sums over the witnesses and the point itself, around their means: ways (u, v) in the surface, slopes (s, t) along u
/// and v; the first and the second axis' beside each other.
struct TurnMoments {
    double count = 1;
    Two way{}, slope{};
    Two uuVv{}, suTv{}, svTu{};
    double uv = 0, slopes = 0;

    void add(const Two& w, const Two& s) {
        ++count;
        way += w;
        slope += s;
        uuVv += w * w;
        suTv += s * w;
        svTu += s * Two{w[1], w[0]};
        uv += w[0] * w[1];
        const Two squares = s * s;
        slopes += squares[0] + squares[1];
    }
    void center() {
        uuVv -= way * way / count;
        suTv -= slope * way / count;
        svTu -= slope * Two{way[1], way[0]} / count;
        uv -= way[0] * way[1] / count;
        slopes -= (slope[0] * slope[0] + slope[1] * slope[1]) / count;
    }
};

/// The symmetric B for which slopes are nearest to B · way, shrunk by what noise explains of it.
glm::dvec3 fitOperator(const TurnMoments& m) {
    // Normal equations of a, b, c: those of b are both slopes'.
    const double uu = m.uuVv[0], vv = m.uuVv[1];
    const double trace = uu + vv, right[turnTerms] = {m.suTv[0], m.svTu[0] + m.svTu[1], m.suTv[1]};
    if (!(uu > leastTurnPivot * trace)) return glm::dvec3(0);
    const double l = m.uv / uu, second = trace - l * m.uv;
    if (!(second > leastTurnPivot * trace)) return glm::dvec3(0);
    const double k = m.uv / second, third = vv - k * m.uv;
    if (!(third > leastTurnPivot * trace)) return glm::dvec3(0);
    const double y2 = right[1] - l * right[0], y3 = right[2] - k * y2;
    const double c = y3 / third, b = y2 / second - k * c, a = right[0] / uu - l * b;
    const double explained = right[0] * a + right[1] * b + right[2] * c;
    const double freedom = 2 * m.count - turnConstants - turnTerms;
    const double noise = std::max(m.slopes - explained, 0.0) / freedom;
    if (!(explained > 0)) return glm::dvec3(0);
    return std::max(0.0, 1 - noiseExplains * turnTerms * noise / explained) * glm::dvec3(a, b, c);
}

bool isSurface(const Surfel& surfel) {
    return surfel.normal != glm::vec3(0) &&
           (surfel.density == Density::Surface || surfel.density == Density::Edge);
}

glm::dvec3 bendAt(std::uint32_t p, const NeighbourIndex& index, const Evidence& evidence,
                  const Surfel& surfel) {
    const glm::dvec3 n = surfel.normal, first = surfel.majorAxis, second = glm::cross(n, first);
    const auto middleOf = [&](std::uint32_t i) {
        return glm::dvec3(index.position(i)) + glm::dvec3(evidence.middle(i));
    };
    const glm::dvec3 at = middleOf(p);
    const Two axes[3] = {{first.x, second.x}, {first.y, second.y}, {first.z, second.z}};
    const auto alongAxes = [&](const glm::dvec3& v) { return v.x * axes[0] + v.y * axes[1] + v.z * axes[2]; };
    TurnMoments m;
    for (const std::uint32_t w : evidence.witnesses(p)) {
        const glm::dvec3 normal = evidence.normal(w);
        const double cosine = glm::dot(normal, n);
        if (!(std::abs(cosine) > leastCosine)) continue;
        m.add(alongAxes(middleOf(w) - at), alongAxes(normal) / cosine);
    }
    if (m.count <= leastWitnesses) return glm::dvec3(0);
    m.center();
    return fitOperator(m);
}

}  // namespace

void estimateBends(std::uint32_t begin, std::uint32_t end, const NeighbourIndex& index,
                   const Evidence& evidence, std::span<Surfel> surfels) {
    for (std::uint32_t p = begin; p < end; ++p) {
        const auto here = index.pointsAt(p);
        const auto wanted = std::ranges::find_if(here, [&](std::uint32_t i) { return i < surfels.size(); });
        if (wanted == here.end() || !isSurface(surfels[*wanted])) continue;
        const glm::vec3 bend(bendAt(p, index, evidence, surfels[*wanted]));
        for (const std::uint32_t i : here)
            if (i < surfels.size()) surfels[i].bend = bend;
    }
}

}  // namespace scancast
