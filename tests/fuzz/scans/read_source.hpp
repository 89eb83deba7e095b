// What every reader of points has to keep, whatever bytes it gets: an error with a reason, or batches of finite points, of which there
// are not more than the bytes can spell. For fuzz targets, in files and on pipes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

/// `open`: makes the source, of bytes; `leastBytes`: of the shortest point.
template <class Open>
void readSource(std::span<const std::byte> bytes, bool seekable, std::size_t leastBytes, const Open& open) {
    auto source = open(std::make_unique<MemoryByteSource>(bytes, seekable));
    if (!source) {
        if (source.error().message.empty()) std::abort();
        return;
    }
    PointBatch batch;
    std::size_t points = 0;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more && more.error().message.empty()) std::abort();
        if (!more || !*more) break;
        if (batch.size() == 0 || batch.size() > PointSource::batchPoints) std::abort();
        for (const auto& p : batch.position)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
        points += batch.size();
        if (points * leastBytes > bytes.size() + 1) std::abort();
    }
}

}  // namespace scancast::test
