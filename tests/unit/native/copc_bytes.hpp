// COPC files made here: points of a wavy surface with colours, in voxels that take every fourth point and leave the others to those
// below. Chunks are the records as they are, for decoders in this process (RawChunks); real files have real ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "files/bytes.hpp"
#include "renderer/cloud/native/copc/copc_cloud.hpp"
#include "renderer/cloud/native/copc/copc_layout.hpp"

namespace scancast::test {

using Bytes = std::vector<std::byte>;

/// What of a point is in its sample.
using PointValue = std::tuple<std::int64_t, std::int64_t, std::int64_t, int, int, int, int, int>;

struct CopcPoint {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0, red = 0, green = 0, blue = 0;
    std::uint8_t classification = 0;

    PointValue value() const { return {x, y, z, intensity, red >> 8, green >> 8, blue >> 8, classification}; }
};

inline constexpr double copcScale = 0.01;
inline constexpr std::size_t copcRecordBytes = 36;
inline constexpr std::size_t copcPointsAt = 375 + 54 + 160 + 54 + 34;

struct CopcBytes {
    Bytes file;
    std::vector<CopcPoint> points;
    std::map<VoxelKey, std::vector<CopcPoint>> voxels;
    std::uint64_t pageAt = 0;  ///< the hierarchy's
    std::uint64_t entries = 0;
};

/// A surface of 50 x 50 units around (1000, 2000, 10), whose density differs from place to place.
inline std::vector<CopcPoint> wavyPoints(std::size_t count) {
    std::vector<CopcPoint> points(count);
    std::uint32_t state = 7;
    const auto random = [&] { return (state = state * 1664525U + 1013904223U) >> 8; };
    for (CopcPoint& p : points) {
        const double u = double(random() & 0xffff) / 65536, v = double(random() & 0xffff) / 65536;
        const double x = 50 * u * u, y = 50 * v;
        p.x = std::int32_t(x / copcScale);
        p.y = std::int32_t(y / copcScale);
        p.z = std::int32_t((10 + 2 * std::sin(x / 3) + std::cos(y / 2)) / copcScale);
        p.intensity = std::uint16_t(random() & 0xfff);
        p.red = std::uint16_t(random());
        p.green = std::uint16_t(p.x * 13);
        p.blue = std::uint16_t(p.y * 11);
        p.classification = std::uint8_t(2 + (random() & 3));
    }
    return points;
}

inline void putRecord(const CopcPoint& p, std::byte* to) {
    storeLe(to, p.x);
    storeLe(to + 4, p.y);
    storeLe(to + 8, p.z);
    storeLe(to + 12, p.intensity);
    to[14] = std::byte{0x11};
    storeLe(to + 16, p.classification);
    storeLe(to + 30, p.red);
    storeLe(to + 32, p.green);
    storeLe(to + 34, p.blue);
}

class CopcMaker {
  public:
    /// The cube: a corner at (1000, 2000, 0), 64 units a side; the grid begins there.
    static CopcBytes make(std::vector<CopcPoint> points, std::size_t leafPoints) {
        CopcBytes made;
        made.points = points;
        divide(made, {}, std::move(points), leafPoints);
        writeHead(made);
        Bytes page;
        for (const auto& [key, own] : made.voxels) {
            const std::uint64_t at = made.file.size();
            made.file.resize(at + own.size() * copcRecordBytes);
            for (std::size_t i = 0; i < own.size(); ++i)
                putRecord(own[i], made.file.data() + at + i * copcRecordBytes);
            putEntry(page, key, own.empty() ? 0 : at, std::int32_t(own.size() * copcRecordBytes),
                     std::int32_t(own.size()));
        }
        made.pageAt = made.file.size();
        made.entries = made.voxels.size();
        made.file.insert(made.file.end(), page.begin(), page.end());
        storeLe(made.file.data() + 429 + 40, made.pageAt);
        storeLe(made.file.data() + 429 + 48, std::uint64_t(page.size()));
        return made;
    }

    static void putEntry(Bytes& page, const VoxelKey& key, std::uint64_t offset, std::int32_t bytes,
                         std::int32_t points) {
        const std::size_t at = page.size();
        page.resize(at + copcEntryBytes);
        storeLe(page.data() + at, key.level);
        for (std::size_t a = 0; a < 3; ++a) storeLe(page.data() + at + 4 + 4 * a, key.at[a]);
        storeLe(page.data() + at + 16, offset);
        storeLe(page.data() + at + 24, bytes);
        storeLe(page.data() + at + 28, points);
    }

    /// Half a side, in steps.
    static double middle(std::int32_t at, int level) { return (at + 0.5) * 6400 / double(1 << level); }

  private:
    static void divide(CopcBytes& made, const VoxelKey& key, std::vector<CopcPoint> points,
                       std::size_t leafPoints) {
        auto& own = made.voxels[key];
        if (points.size() <= leafPoints) {
            own = std::move(points);
            return;
        }
        std::array<std::vector<CopcPoint>, 8> below;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const CopcPoint& p = points[i];
            if (i % 4 == 0) {
                own.push_back(p);
                continue;
            }
            const int octant = int(p.x >= middle(key.at[0], key.level)) |
                               int(p.y >= middle(key.at[1], key.level)) << 1 |
                               int(p.z >= middle(key.at[2], key.level)) << 2;
            below[std::size_t(octant)].push_back(p);
        }
        for (int octant = 0; octant < 8; ++octant)
            if (!below[std::size_t(octant)].empty())
                divide(made, key.child(octant), std::move(below[std::size_t(octant)]), leafPoints);
    }

    static void writeHead(CopcBytes& made) {
        made.file.resize(copcPointsAt);
        std::byte* const at = made.file.data();
        std::memcpy(at, "LASF", 4);
        at[24] = std::byte{1};
        at[25] = std::byte{4};
        storeLe(at + 94, std::uint16_t(375));
        storeLe(at + 96, std::uint32_t(copcPointsAt));
        storeLe(at + 100, std::uint32_t(2));
        at[104] = std::byte{0x80 | 7};
        storeLe(at + 105, std::uint16_t(copcRecordBytes));
        for (int a = 0; a < 3; ++a) storeLe(at + 131 + 8 * a, copcScale);
        storeLe(at + 155, 1000.0);
        storeLe(at + 163, 2000.0);
        storeLe(at + 171, 0.0);
        std::int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
        for (const CopcPoint& p : made.points)
            for (int a = 0; a < 3; ++a) {
                const std::int32_t v = a == 0 ? p.x : a == 1 ? p.y : p.z;
                low[a] = std::min(low[a], v), high[a] = std::max(high[a], v);
            }
        const double origin[3] = {1000, 2000, 0};
        for (int a = 0; a < 3; ++a) {
            storeLe(at + 179 + 16 * a, origin[a] + copcScale * high[a]);
            storeLe(at + 187 + 16 * a, origin[a] + copcScale * low[a]);
        }
        storeLe(at + 247, std::uint64_t(made.points.size()));
        std::memcpy(at + 375 + 2, "copc", 4);
        storeLe(at + 375 + 18, std::uint16_t(1));
        storeLe(at + 375 + 20, std::uint16_t(160));
        storeLe(at + 429, 1032.0);
        storeLe(at + 437, 2032.0);
        storeLe(at + 445, 32.0);
        storeLe(at + 453, 32.0);
        storeLe(at + 461, 0.5);
        std::byte* const laszip = at + 429 + 160;
        std::memcpy(laszip + 2, "laszip encoded", 14);
        storeLe(laszip + 18, std::uint16_t(22204));
        storeLe(laszip + 20, std::uint16_t(34));
    }
};

/// Takes chunks for records. What has another length is malformed.
class RawChunks final : public ChunkDecoders {
  public:
    Expected<Bytes> decode(const ChunkShape& shape, std::uint64_t points,
                           std::span<const std::byte> chunk) override {
        if (chunk.size() != points * shape.recordBytes)
            return fail(ErrorCode::Malformed, "the chunk is damaged");
        return Bytes(chunk.begin(), chunk.end());
    }
};

/// What a node's samples are on the scan's grid: node.step is one step of it.
inline std::vector<PointValue> valuesOf(const CloudFile& file, std::uint32_t node,
                                        std::span<const Sample> samples) {
    const Node& n = file.nodes()[node].node;
    const CloudFacts& facts = file.facts();
    std::vector<PointValue> values;
    for (const Sample& s : samples) {
        const glm::dvec3 at = (position(n, s) + facts.origin - facts.grid->origin) / facts.grid->step;
        values.emplace_back(std::llround(at.x), std::llround(at.y), std::llround(at.z), s.intensity, s.r, s.g,
                            s.b, s.classification);
    }
    return values;
}

}  // namespace scancast::test
