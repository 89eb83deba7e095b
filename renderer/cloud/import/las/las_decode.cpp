#include "renderer/cloud/import/las/las_decode.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/bytes.hpp"

namespace scancast {

namespace {

// Records that are decoded column after column while they are in the first-level cache.
constexpr std::size_t blockRecords = 256;
constexpr std::size_t atIntensity = 12;

void decodePositions(const std::byte* record, std::size_t stride, std::size_t count, GridSteps* out) {
    for (std::size_t i = 0; i < count; ++i, record += stride)
        out[i] = {loadLe<std::int32_t>(record), loadLe<std::int32_t>(record + 4),
                  loadLe<std::int32_t>(record + 8)};
}

void decodeColors(const std::byte* record, std::size_t stride, std::size_t count, LasColorDepth depth,
                  std::array<std::uint8_t, 3>* out) {
    const std::size_t byte = depth == LasColorDepth::SixteenBits ? 1 : 0;
    for (std::size_t i = 0; i < count; ++i, record += stride)
        out[i] = {loadLe<std::uint8_t>(record + byte), loadLe<std::uint8_t>(record + 2 + byte),
                  loadLe<std::uint8_t>(record + 4 + byte)};
}

template <class Column>
void keep(Column& column, const std::vector<std::uint8_t>& good) {
    if (column.empty()) return;
    std::size_t to = 0;
    for (std::size_t from = 0; from < good.size(); ++from)
        if (good[from]) column[to++] = column[from];
    column.resize(to);
}

void keepRows(std::vector<std::byte>& rows, const std::vector<std::uint8_t>& good) {
    if (rows.empty()) return;
    const auto bytes = rows.size() / good.size();
    std::size_t to = 0;
    for (std::size_t from = 0; from < good.size(); ++from) {
        if (!good[from]) continue;
        std::memmove(rows.data() + to, rows.data() + from * bytes, bytes);
        to += bytes;
    }
    rows.resize(to);
}

}  // namespace

void decodeLasRecords(std::span<const std::byte> records, const LasHeader& header, LasColorDepth depth,
                      PointBatch& batch) {
    const std::size_t stride = header.recordBytes;
    const std::size_t count = records.size() / stride;
    const auto& layout = lasRecordLayout(header.pointFormat);
    // Resizing to the size it already has costs nothing; clearing first would write every column twice.
    auto& steps = batch.position.steps(header.grid());
    steps.resize(count);
    batch.intensity.resize(count);
    batch.classification.resize(count);
    batch.color.resize(layout.color >= 0 ? count : 0);
    batch.nearInfrared.resize(layout.infrared >= 0 ? count : 0);
    batch.normal.clear();
    batch.rows.clear();
    for (std::size_t first = 0; first < count; first += blockRecords) {
        const auto n = std::min(blockRecords, count - first);
        const auto* record = records.data() + first * stride;
        decodePositions(record, stride, n, steps.data() + first);
        for (std::size_t i = 0; i < n; ++i)
            batch.intensity[first + i] = loadLe<std::uint16_t>(record + i * stride + atIntensity);
        const auto* classes = record + layout.classification;
        for (std::size_t i = 0; i < n; ++i)
            batch.classification[first + i] =
                static_cast<std::uint8_t>(loadLe<std::uint8_t>(classes + i * stride) & layout.classMask);
        if (layout.color >= 0)
            decodeColors(record + layout.color, stride, n, depth, batch.color.data() + first);
        if (layout.infrared < 0) continue;
        for (std::size_t i = 0; i < n; ++i)
            batch.nearInfrared[first + i] = loadLe<std::uint16_t>(record + i * stride + layout.infrared);
    }
}

LasColorDepth colorDepth(std::span<const std::byte> records, const LasHeader& header) {
    const auto at = lasRecordLayout(header.pointFormat).color;
    const std::size_t stride = header.recordBytes;
    const std::size_t count = records.size() / stride;
    unsigned any = 0;
    for (std::size_t first = 0; first < count; first += blockRecords) {
        const auto* color = records.data() + first * stride + at;
        const auto n = std::min(blockRecords, count - first);
        for (std::size_t i = 0; i < n; ++i, color += stride)
            any |= loadLe<std::uint32_t>(color) | loadLe<std::uint16_t>(color + 4);
        if ((any & 0xff00ff00u) != 0) return LasColorDepth::SixteenBits;
    }
    return any == 0 ? LasColorDepth::Unknown : LasColorDepth::EightBits;
}

std::uint64_t dropNonFinite(PointBatch& batch) {
    std::vector<std::uint8_t> good(batch.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const glm::dvec3 p = batch.position[i];
        good[i] = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        kept += good[i];
    }
    if (kept == good.size()) return 0;
    if (batch.position.areSteps())
        keep(batch.position.steps(batch.position.grid()), good);
    else
        keep(batch.position.doubles(), good);
    keep(batch.color, good);
    keep(batch.intensity, good);
    keep(batch.classification, good);
    keep(batch.normal, good);
    keep(batch.nearInfrared, good);
    keepRows(batch.rows, good);
    return good.size() - kept;
}

}  // namespace scancast
