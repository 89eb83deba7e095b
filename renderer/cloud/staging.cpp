#include "renderer/cloud/staging.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <glm/common.hpp>

#include "renderer/cloud/sample.hpp"

namespace scancast {

namespace {

bool hasGrid(const ScanHeader& header) {
    for (int a = 0; a < 3; ++a)
        if (!(header.gridStep[a] > 0) || !std::isfinite(header.gridStep[a]) ||
            !std::isfinite(header.gridOrigin[a]))
            return false;
    return true;
}

Expected<void> checkBatch(const PointBatch& batch, std::uint64_t before) {
    const auto fits = [&](std::size_t column) { return column == 0 || column == batch.size(); };
    if (!fits(batch.color.size()) || !fits(batch.intensity.size()) || !fits(batch.classification.size()) ||
        !fits(batch.normal.size()))
        return fail(ErrorCode::Internal, "A reader delivered columns of different lengths.");
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const glm::dvec3& p = batch.position[i];
        for (int a = 0; a < 3; ++a)
            if (!(std::abs(p[a]) <= farthestCoordinate))
                return fail(
                    ErrorCode::Malformed,
                    fmt::format(
                        "Point {} lies at ({:g}, {:g}, {:g}); coordinates beyond {:g} are taken for damage.",
                        before + i, p.x, p.y, p.z, farthestCoordinate));
    }
    return {};
}

/// The batch as integers of the scan's own grid; false if some point does not lie on it (header and points
/// then contradict each other, and the points are right).
bool toOwnGrid(const std::vector<glm::dvec3>& positions, const ScanHeader& header, StagedBatch& out) {
    out.own.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        for (int a = 0; a < 3; ++a) {
            const double p = positions[i][a];
            const double q = std::nearbyint((p - header.gridOrigin[a]) / header.gridStep[a]);
            const double off = std::abs(header.gridOrigin[a] + q * header.gridStep[a] - p);
            const double tolerance =
                1e-3 * header.gridStep[a] + 1e-15 * (std::abs(p) + std::abs(header.gridOrigin[a]));
            if (!(std::abs(q) <= 2147483647.0 || q == -2147483648.0) || !(off <= tolerance)) {
                out.own = {};
                return false;
            }
            out.own[i][a] = static_cast<std::int32_t>(q);
        }
    }
    return true;
}

bool isSinglePrecision(const std::vector<glm::dvec3>& positions) {
    return std::all_of(positions.begin(), positions.end(),
                       [](const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)) == p; });
}

void packPositions(const PointBatch& batch, const ScanHeader& header, bool grid, StagedBatch& out) {
    if (grid && toOwnGrid(batch.position, header, out)) return;
    if (isSinglePrecision(batch.position))
        out.single.assign(batch.position.begin(), batch.position.end());
    else
        out.full = batch.position;
}

void packRest(const PointBatch& batch, StagedBatch& out) {
    out.rest.resize(batch.size());
    for (std::size_t i = 0; i < batch.color.size(); ++i) out.rest[i].color = batch.color[i];
    for (std::size_t i = 0; i < batch.intensity.size(); ++i) out.rest[i].intensity = batch.intensity[i];
    for (std::size_t i = 0; i < batch.classification.size(); ++i)
        out.rest[i].classification = batch.classification[i];
    for (std::size_t i = 0; i < batch.normal.size(); ++i) out.rest[i].normal = encodeNormal(batch.normal[i]);
}

void learn(const PointBatch& batch, const StagedBatch& packed, StagedScan& scan) {
    for (const glm::dvec3& p : batch.position) {
        scan.bounds[0] = glm::min(scan.bounds[0], p);
        scan.bounds[1] = glm::max(scan.bounds[1], p);
    }
    for (const std::uint16_t i : batch.intensity) {
        scan.intensityRange[0] = std::min(scan.intensityRange[0], i);
        scan.intensityRange[1] = std::max(scan.intensityRange[1], i);
    }
    for (const std::uint8_t c : batch.classification) ++scan.classCounts[c];
    if (packed.own.empty()) scan.onOwnGrid = false;
    if (scan.points == 0 && scan.onOwnGrid)
        for (int a = 0; a < 3; ++a) scan.ownLow[a] = scan.ownHigh[a] = packed.own[0][a];
    for (const auto& q : packed.own)
        for (int a = 0; a < 3; ++a) {
            scan.ownLow[a] = std::min<std::int64_t>(scan.ownLow[a], q[a]);
            scan.ownHigh[a] = std::max<std::int64_t>(scan.ownHigh[a], q[a]);
        }
    scan.points += batch.size();
}

}  // namespace

Expected<StagedScan> stage(PointSource& source, ProgressMeter& progress) {
    StagedScan scan;
    const ScanHeader header = source.header();
    PointBatch current, next;
    const auto readNext = [&] { return source.read(next); };
    Expected<bool> more = readNext();
    while (more && *more) {
        std::swap(current, next);
        auto reading = std::async(std::launch::async, readNext);
        if (auto ok = checkBatch(current, scan.points); !ok) {
            reading.wait();
            return tl::unexpected(ok.error());
        }
        if (current.size() > 0) {
            StagedBatch& packed = scan.batches.emplace_back();
            packPositions(current, header, scan.onOwnGrid && hasGrid(header), packed);
            packRest(current, packed);
            learn(current, packed, scan);
            progress.add(current.size());
        }
        more = reading.get();
    }
    if (!more) return tl::unexpected(more.error());
    scan.droppedPoints = source.droppedPoints();
    if (scan.points == 0)
        return fail(ErrorCode::Empty,
                    fmt::format("The scan has no point to show ({} left out because a coordinate "
                                "is not a number).",
                                scan.droppedPoints));
    if (scan.intensityRange[0] > scan.intensityRange[1]) scan.intensityRange = {0, 65535};
    progress.finish();
    return scan;
}

Grid chooseGrid(const StagedScan& scan, const ScanHeader& header) {
    if (scan.onOwnGrid) return ownGrid(header.gridOrigin, header.gridStep, scan.ownLow, scan.ownHigh);
    return cubicGrid(scan.bounds[0], scan.bounds[1]);
}

namespace {

GridPosition onGrid(const glm::dvec3& p, const Grid& grid) {
    GridPosition q;
    for (int a = 0; a < 3; ++a)
        q[a] =
            static_cast<std::uint64_t>(std::max(0.0, std::nearbyint((p[a] - grid.corner[a]) / grid.step[a])));
    return q;
}

void unstageBatch(const StagedBatch& batch, const StagedScan& scan, const ScanHeader& header,
                  const Grid& grid, BuildPoint* out) {
    for (std::size_t i = 0; i < batch.rest.size(); ++i) {
        const StagedBatch::Rest& rest = batch.rest[i];
        BuildPoint& p = out[i];
        p.intensity = rest.intensity;
        p.color = rest.color;
        p.classification = rest.classification;
        p.normal = rest.normal;
        if (scan.onOwnGrid) {
            GridPosition q;
            for (int a = 0; a < 3; ++a)
                q[a] = static_cast<std::uint64_t>(batch.own[i][a] - scan.ownLow[a]) << grid.ownShift[a];
            p.setPosition(q);
        } else if (!batch.own.empty()) {
            const auto& q = batch.own[i];
            p.setPosition(onGrid(header.gridOrigin + header.gridStep * glm::dvec3(q[0], q[1], q[2]), grid));
        } else {
            p.setPosition(onGrid(batch.single.empty() ? batch.full[i] : glm::dvec3(batch.single[i]), grid));
        }
    }
}

}  // namespace

std::unique_ptr<BuildPoint[]> unstage(StagedScan& scan, const ScanHeader& header, const Grid& grid) {
    auto points = std::make_unique_for_overwrite<BuildPoint[]>(scan.points);
    std::vector<std::uint64_t> first(scan.batches.size());
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        first[i] = sum;
        sum += scan.batches[i].rest.size();
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first.size(), 4), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            unstageBatch(scan.batches[i], scan, header, grid, points.get() + first[i]);
            scan.batches[i] = {};
        }
    });
    scan.batches = {};
    return points;
}

}  // namespace scancast
