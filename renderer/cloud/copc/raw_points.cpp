#include "renderer/cloud/copc/raw_points.hpp"

#include <algorithm>
#include <tuple>

#include "renderer/cloud/build/morton.hpp"

namespace scancast {

namespace {

constexpr std::int64_t highestInSample = 65535;

}  // namespace

Expected<std::vector<RawPoint>> rawPointsOf(std::span<const std::byte> records, const LasHeader& las,
                                            LasColorDepth depth) {
    if (lasRecordLayout(las.pointFormat).color >= 0 && depth != LasColorDepth::SixteenBits &&
        colorDepth(records, las) == LasColorDepth::SixteenBits)
        return fail(ErrorCode::Malformed,
                    "its colours have 16 bits, and those of the upper levels 8; ingest it, and serve what "
                    "comes of that");
    PointBatch batch;
    decodeLasRecords(records, las, depth, batch);
    const auto steps = batch.position.asSteps();
    std::vector<RawPoint> points(steps.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].at = steps[i];
        points[i].intensity = batch.intensity[i];
        points[i].classification = batch.classification[i];
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
                        "points lie outside their voxel, or outside the bounds that the file gives; "
                        "ingest it, and serve what comes of that");
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
