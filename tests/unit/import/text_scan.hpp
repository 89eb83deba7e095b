// Text in memory, read as a scan; for tests.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/point_batch.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

inline std::unique_ptr<ByteSource> bytesOf(const std::string& text, bool seekable = true) {
    return std::make_unique<MemoryByteSource>(std::as_bytes(std::span(text)), seekable);
}

/// All points in one batch.
inline Expected<PointBatch> readAll(PointSource& source) {
    PointBatch all, batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) return all;
        const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        add(all.position, batch.position);
        add(all.color, batch.color);
        add(all.intensity, batch.intensity);
        add(all.classification, batch.classification);
        add(all.normal, batch.normal);
        add(all.rows, batch.rows);
    }
}

}  // namespace scancast::test
