#include "renderer/cloud/native/raw_points.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "renderer/cloud/build/morton.hpp"

namespace scancast {

namespace {

constexpr std::int64_t highestInSample = 65535;
constexpr double lastOfSteps = 0x1p31 - 1;

Expected<void> toGrid(const Positions& positions, const StepGrid& grid, std::span<RawPoint> points) {
    if (positions.areSteps() && positions.grid() == grid) {
        const auto steps = positions.asSteps();
        for (std::size_t i = 0; i < points.size(); ++i) points[i].at = steps[i];
        return {};
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 at = (positions[i] - grid.origin) / grid.step;
        for (int a = 0; a < 3; ++a) {
            if (!(std::abs(at[a]) <= lastOfSteps))
                return fail(ErrorCode::Malformed,
                            std::string("its points lie far outside of its octree") + ingestInstead);
            points[i].at[std::size_t(a)] = std::int32_t(std::llround(at[a]));
        }
    }
    return {};
}

}  // namespace

Expected<std::vector<RawPoint>> rawPointsOf(std::span<const std::byte> records,
                                            const import_octree::RecordDecoder& decoder, LasColorDepth depth,
                                            const StepGrid& grid) {
    if (depth != LasColorDepth::SixteenBits && decoder.colorDepth(records) == LasColorDepth::SixteenBits)
        return fail(ErrorCode::Malformed,
                    std::string("its colours have 16 bits, and those of the upper levels 8") + ingestInstead);
    import_octree::DecodedPoints decoded;
    decoder.decode(records, depth, decoded);
    const PointBatch& batch = decoded.batch;
    if (decoded.dropped > 0)
        return fail(ErrorCode::Malformed,
                    std::string("some of its points have no finite coordinates") + ingestInstead);
    std::vector<RawPoint> points(batch.size());
    if (auto ok = toGrid(batch.position, grid, points); !ok) return passOn(ok);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!batch.intensity.empty()) points[i].intensity = batch.intensity[i];
        if (!batch.classification.empty()) points[i].classification = batch.classification[i];
        if (!batch.color.empty()) points[i].color = batch.color[i];
    }
    return points;
}

std::optional<std::array<std::uint16_t, 3>> onLattice(const RawPoint& point, const NodeLattice& lattice) {
    std::array<std::uint16_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t from = point.at[a] - lattice.low[a];
        const std::int64_t half = lattice.shift[a] > 0 ? std::int64_t(1) << (lattice.shift[a] - 1) : 0;
        const std::int64_t sample = (from + half) >> lattice.shift[a];
        if (from < 0 || sample > highestInSample) return std::nullopt;
        at[a] = std::uint16_t(sample);
    }
    return at;
}

Expected<std::vector<Sample>> samplesOf(std::span<const RawPoint> points, const NodeLattice& lattice) {
    struct Keyed {
        std::uint64_t key;
        Sample sample;
    };
    std::vector<Keyed> keyed;
    keyed.reserve(points.size());
    for (const RawPoint& point : points) {
        const auto at = onLattice(point, lattice);
        if (!at)
            return fail(ErrorCode::Malformed,
                        std::string("points lie outside their voxel, or outside the bounds that are given") +
                            ingestInstead);
        const auto& [x, y, z] = *at;
        keyed.push_back({mortonKey(x, y, z),
                         {x, y, z, point.intensity, point.color[0], point.color[1], point.color[2],
                          point.classification, noNormal, 0, 0}});
    }
    std::ranges::sort(keyed, [](const Keyed& a, const Keyed& b) {
        if (a.key != b.key) return a.key < b.key;
        const auto rest = [](const Sample& s) {
            return std::tuple(s.intensity, s.r, s.g, s.b, s.classification);
        };
        return rest(a.sample) < rest(b.sample);
    });
    std::vector<Sample> samples;
    samples.reserve(keyed.size());
    for (const Keyed& k : keyed) samples.push_back(k.sample);
    return samples;
}

}  // namespace scancast
