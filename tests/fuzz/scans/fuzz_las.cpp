// Any bytes at all, as a LAS file and as LAS on a pipe: an error or points, never a crash, never an endless
// loop.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/las/las_source.hpp"
#include "renderer/cloud/import/scan_format.hpp"

namespace {

void read(std::span<const std::byte> bytes, bool seekable, bool keepAttributes) {
    using namespace scancast;
    auto source =
        LasSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "fuzz.las", keepAttributes);
    if (!source) {
        if (source.error().message.empty()) std::abort();
        return;
    }
    PointBatch batch;
    std::uint64_t points = 0;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more || !*more) break;
        if (batch.size() == 0 || batch.size() > PointSource::batchPoints) std::abort();
        for (const auto& p : batch.position)
            if (!std::isfinite(p.x + p.y + p.z) &&
                !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
                std::abort();
        if (batch.rows.size() % batch.size() != 0) std::abort();
        if (batch.rows.size() < batch.size() * (*source)->header().columns.size()) std::abort();
        points += batch.size();
        // A record has at least 20 bytes: more points than that cannot be in there.
        if (points * 20 > bytes.size()) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    (void)scancast::identifyScan(bytes.first(std::min(size, scancast::identifyBytes)), ".las");
    read(bytes, true, true);
    read(bytes, false, false);
    return 0;
}
