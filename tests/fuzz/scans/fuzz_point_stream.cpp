// Any bytes at all from an importer: an error or points that keep the promises of PointSource, never a crash.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/stream/point_stream_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto bytes = std::as_bytes(std::span(data, size));
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false),
                                            {.mostPoints = 1000000, .keepAttributes = size % 4 < 2});
    if (!reader) {
        if (reader.error().message.empty()) std::abort();
        return 0;
    }
    const auto has = (*reader)->header().attributes;
    PointBatch batch;
    if (size % 2 == 0)
        if (const auto glance = (*reader)->glance(); glance && glance->size() > 65536) std::abort();
    for (;;) {
        const auto more = (*reader)->read(batch);
        if (!more || !*more) return 0;
        const auto n = batch.size();
        if (n == 0 || n > PointSource::batchPoints || batch.color.size() != (has.color ? n : 0) ||
            batch.intensity.size() != (has.intensity ? n : 0) ||
            batch.normal.size() != (has.normal ? n : 0) ||
            batch.classification.size() != (has.classification ? n : 0))
            std::abort();
        if (batch.rows.size() != n * rowBytes((*reader)->header().columns)) std::abort();
        for (const auto& p : batch.position)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
    }
}
