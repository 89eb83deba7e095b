#include "renderer/cloud/build/chunks/staging.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <future>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "renderer/cloud/sample.hpp"
#include "renderer/cloud/stations/station.hpp"

namespace scancast {

namespace {

/// `before`: points that came before these.
Expected<void> checkPositions(const Positions& positions, std::uint64_t before) {
    if (positions.areSteps() && positions.grid().reach() <= farthestCoordinate) return {};
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const glm::dvec3 p = positions[i];
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

Expected<void> checkBatch(const PointBatch& batch, const ScanHeader& header, std::uint64_t before) {
    const auto fits = [&](std::size_t column) { return column == 0 || column == batch.size(); };
    if (!fits(batch.color.size()) || !fits(batch.intensity.size()) || !fits(batch.classification.size()) ||
        !fits(batch.normal.size()) || !fits(batch.nearInfrared.size()) ||
        batch.rows.size() != batch.size() * rowBytes(header.columns))
        return fail(ErrorCode::Internal, "A reader delivered columns of different lengths.");
    return checkPositions(batch.position, before);
}

/// A batch while it is packed.
struct PackedBatch {
    PackedPositions positions;
    std::vector<std::byte> bytes;
};

/// The direction of a vector, if it has one.
std::uint16_t sightCode(const glm::dvec3& sight) {
    const auto unit = unitVector(sight);
    return unit ? encodeNormal(glm::vec3(*unit)) : noNormal;
}

/// The row of each point, then its near infrared, 0 where the scan it is from has none.
void packRows(const PointBatch& batch, const ScanHeader& header, std::byte* to) {
    if (!header.attributes.nearInfrared) {
        std::copy(batch.rows.begin(), batch.rows.end(), to);
        return;
    }
    const std::size_t row = rowBytes(header.columns), stride = stagedRowBytes(header);
    for (std::size_t i = 0; i < batch.size(); ++i, to += stride) {
        if (row > 0) std::memcpy(to, batch.rows.data() + i * row, row);
        const std::uint16_t infrared = batch.nearInfrared.empty() ? std::uint16_t(0) : batch.nearInfrared[i];
        std::memcpy(to + row, &infrared, sizeof infrared);
    }
}

void packRest(const PointBatch& batch, const ScanHeader& header, bool sights, PackedBatch& out) {
    auto* rest =
        reinterpret_cast<StagedBatch::Rest*>(out.bytes.data() + batch.size() * bytesOf(out.positions.kind));
    std::fill_n(rest, batch.size(), StagedBatch::Rest{});
    for (std::size_t i = 0; i < batch.color.size(); ++i) rest[i].color = batch.color[i];
    for (std::size_t i = 0; i < batch.intensity.size(); ++i) rest[i].intensity = batch.intensity[i];
    for (std::size_t i = 0; i < batch.classification.size(); ++i)
        rest[i].classification = batch.classification[i];
    for (std::size_t i = 0; i < batch.normal.size(); ++i) rest[i].normal = encodeNormal(batch.normal[i]);
    if (sights && batch.scanner)
        for (std::size_t i = 0; i < batch.size(); ++i)
            rest[i].normal = sightCode(*batch.scanner - batch.position[i]);
    packRows(batch, header, reinterpret_cast<std::byte*>(rest + batch.size()));
}

template <class T>
double numberAt(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

double numberAt(const std::byte* at, ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
            return numberAt<std::int8_t>(at);
        case ColumnType::Uint8:
            return numberAt<std::uint8_t>(at);
        case ColumnType::Int16:
            return numberAt<std::int16_t>(at);
        case ColumnType::Uint16:
            return numberAt<std::uint16_t>(at);
        case ColumnType::Int32:
            return numberAt<std::int32_t>(at);
        case ColumnType::Uint32:
            return numberAt<std::uint32_t>(at);
        case ColumnType::Int64:
            return numberAt<std::int64_t>(at);
        case ColumnType::Uint64:
            return numberAt<std::uint64_t>(at);
        case ColumnType::Float32:
            return numberAt<float>(at);
        case ColumnType::Float64:
            return numberAt<double>(at);
    }
    return 0;
}

void learnColumns(const PointBatch& batch, std::span<const Column> columns, StagedScan& scan) {
    const std::size_t stride = rowBytes(columns);
    std::size_t at = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        auto& [low, high] = scan.columnRanges[c];
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const double v =
                columns[c].offset +
                columns[c].scale * numberAt(batch.rows.data() + i * stride + at, columns[c].type);
            if (v < low) low = v;  // NaN is in no range
            if (v > high) high = v;
            scan.columnSketches[c].add(v);
        }
        at += bytesOf(columns[c].type);
    }
}

void learn(const PointBatch& batch, const std::optional<OwnRange>& own, StagedScan& scan) {
    const auto bounds = boundsOf(batch.position);
    scan.bounds = {glm::min(scan.bounds[0], bounds[0]), glm::max(scan.bounds[1], bounds[1])};
    for (const std::uint8_t c : batch.classification) ++scan.classCounts[c];
    scan.onOwnGrid = scan.onOwnGrid && own;
    for (std::size_t a = 0; a < 3 && scan.onOwnGrid; ++a) {
        const bool first = scan.points == 0;
        scan.ownLow[a] = first ? own->low[a] : std::min(scan.ownLow[a], own->low[a]);
        scan.ownHigh[a] = first ? own->high[a] : std::max(scan.ownHigh[a], own->high[a]);
    }
    scan.points += batch.size();
    if (batch.scanner) scan.sighted += batch.size();
}

Expected<void> stageBatch(const PointBatch& batch, const ScanHeader& header, bool sights,
                          Workspace& workspace, StagedScan& scan) {
    if (auto ok = checkBatch(batch, header, scan.points); !ok) return ok;
    thread_local PackedBatch packed;
    // One point beside it, and no other need be asked.
    const auto own = scan.onOwnGrid ? ownRangeOf(batch.position, header) : std::optional<OwnRange>();
    const std::size_t beside = sizeof(StagedBatch::Rest) + stagedRowBytes(header);
    packed.positions = packPositions(batch.position, header, own.has_value(), beside, packed.bytes);
    packRest(batch, header, sights, packed);
    learn(batch, own, scan);
    learnColumns(batch, header.columns, scan);
    auto buffer = workspace.allocate(packed.bytes.size());
    if (!buffer) return passOn(buffer);
    if (auto ok = buffer->write(0, packed.bytes); !ok) return ok;
    scan.batches.push_back({packed.positions, std::uint32_t(batch.size()), std::move(*buffer)});
    return {};
}

}  // namespace

std::size_t stagedRowBytes(const ScanHeader& header) {
    return rowBytes(header.columns) + (header.attributes.nearInfrared ? sizeof(std::uint16_t) : 0);
}

void StagedScan::join(const StagedScan& other) {
    bounds = {glm::min(bounds[0], other.bounds[0]), glm::max(bounds[1], other.bounds[1])};
    values.join(other.values);
    for (std::size_t c = 0; c < classCounts.size(); ++c) classCounts[c] += other.classCounts[c];
    for (std::size_t c = 0; c < columnRanges.size(); ++c) {
        columnRanges[c][0] = std::min(columnRanges[c][0], other.columnRanges[c][0]);
        columnRanges[c][1] = std::max(columnRanges[c][1], other.columnRanges[c][1]);
        columnSketches[c].join(other.columnSketches[c]);
    }
    sighted += other.sighted;
    onOwnGrid = onOwnGrid && other.onOwnGrid;
    for (std::size_t a = 0; a < 3 && other.points > 0; ++a) {
        ownLow[a] = points == 0 ? other.ownLow[a] : std::min(ownLow[a], other.ownLow[a]);
        ownHigh[a] = points == 0 ? other.ownHigh[a] : std::max(ownHigh[a], other.ownHigh[a]);
    }
    points += other.points;
}

Expected<StagedScan> stage(PointSource& source, Workspace& workspace, ProgressMeter& progress,
                           const std::stop_token& stop, bool sights) {
    auto scan = stagePart(source, workspace, progress, stop, sights);
    if (!scan) return scan;
    takeTold(source, *scan);
    if (auto ok = settleStaged(*scan); !ok) return passOn(ok);
    progress.finish();
    return scan;
}

void takeTold(const PointSource& source, StagedScan& scan) {
    scan.droppedPoints = source.droppedPoints();
    scan.notes = source.notes();
    scan.stations = source.stations();
    scan.photos = source.photos();
    std::erase_if(scan.photos, [](const Photo& photo) { return !photo.data; });
}

Expected<void> settleStaged(StagedScan& scan) {
    if (scan.points == 0)
        return fail(ErrorCode::Empty,
                    fmt::format("The scan has no point to show ({} left out because a coordinate "
                                "is not a number).",
                                scan.droppedPoints));
    for (auto& [low, high] : scan.columnRanges)
        if (!(low <= high)) low = high = 0;
    return {};
}

Expected<StagedScan> stagePart(PointSource& source, Workspace& workspace, ProgressMeter& progress,
                               const std::stop_token& stop, bool sights) {
    StagedScan scan;
    const ScanHeader header = source.header();
    scan.columnRanges.assign(header.columns.size(), {std::numeric_limits<double>::infinity(),
                                                     -std::numeric_limits<double>::infinity()});
    scan.columnSketches.resize(header.columns.size());
    PointBatch current, next;
    // Ranges of values are learnt where the next batch is read, which is less work than packing one.
    ValueRanges values;
    const auto readNext = [&] {
        auto batch = source.read(next);
        if (batch && *batch) {
            values.add(next);
            if (header.attributes.nearInfrared && next.nearInfrared.empty()) values.addWithoutNearInfrared();
        }
        return batch;
    };
    Expected<bool> more = readNext();
    while (more && *more) {
        std::swap(current, next);
        auto reading = std::async(std::launch::async, readNext);
        if (current.size() > 0) {
            if (auto staged = stageBatch(current, header, sights, workspace, scan); !staged) {
                reading.wait();
                return passOn(staged);
            }
            progress.add(current.size());
        }
        more = reading.get();
        if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
    }
    if (!more) return passOn(more);
    scan.values = std::move(values);
    return scan;
}

Grid chooseGrid(const StagedScan& scan, const ScanHeader& header) {
    if (scan.onOwnGrid) return ownGrid(header.gridOrigin, header.gridStep, scan.ownLow, scan.ownHigh);
    return cubicGrid(scan.bounds[0], scan.bounds[1]);
}

void placeOnGrid(const StagedBatch& batch, std::span<const std::byte> bytes, const StagedScan& scan,
                 const ScanHeader& header, const Grid& grid, std::span<BuildPoint> out) {
    const auto* rest = reinterpret_cast<const StagedBatch::Rest*>(
        bytes.data() + batch.points * bytesOf(batch.positions.kind));
    for (std::size_t i = 0; i < batch.points; ++i) {
        BuildPoint& p = out[i];
        p.intensity = rest[i].intensity;
        p.color = rest[i].color;
        p.classification = rest[i].classification;
        p.normal = rest[i].normal;
    }
    placePositions(batch.positions, bytes, header, scan.onOwnGrid ? &scan.ownLow : nullptr, grid, out);
}

std::span<const std::byte> rowsOf(const StagedBatch& batch, std::span<const std::byte> bytes) {
    return bytes.subspan(batch.points * (bytesOf(batch.positions.kind) + sizeof(StagedBatch::Rest)));
}

}  // namespace scancast
