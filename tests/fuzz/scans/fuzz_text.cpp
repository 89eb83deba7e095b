// Any bytes at all, as a text of points, as PTS and on a pipe: an error or points, never a crash, never an
// endless loop.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/scan_format.hpp"
#include "renderer/cloud/import/text/text_source.hpp"

namespace {

void read(std::span<const std::byte> bytes, const scancast::TextOptions& options, bool seekable) {
    using namespace scancast;
    auto source =
        TextSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "fuzz.xyz", options);
    if (!source) {
        if (source.error().message.empty()) std::abort();
        return;
    }
    const auto row = (*source)->header().columns.size() * sizeof(double);
    PointBatch batch;
    std::uint64_t points = 0;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more && more.error().message.empty()) std::abort();
        if (!more || !*more) break;
        if (batch.size() == 0 || batch.size() > PointSource::batchPoints) std::abort();
        if (batch.rows.size() != row * batch.size()) std::abort();
        for (const auto& p : batch.position)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
        points += batch.size();
        // Three digits and what stands between them.
        if (points * 5 > bytes.size() + 1) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    (void)scancast::identifyScan(bytes.first(std::min(size, scancast::identifyBytes)), ".xyz");
    read(bytes, {.pts = false, .keepAttributes = true}, true);
    read(bytes, {.pts = true, .keepAttributes = false}, false);
    return 0;
}
