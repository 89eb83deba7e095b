// Any bytes at all, as PTX in a file and on a pipe: an error or points, never a crash, never an endless loop.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/text/ptx_source.hpp"
#include "renderer/cloud/import/text/text_head.hpp"

namespace {

void read(std::span<const std::byte> bytes, bool seekable) {
    using namespace scancast;
    auto source = PtxSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "fuzz.ptx");
    if (!source) {
        if (source.error().message.empty()) std::abort();
        return;
    }
    PointBatch batch;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more && more.error().message.empty()) std::abort();
        if (!more || !*more) break;
        if (batch.size() == 0 || batch.size() > PointSource::batchPoints) std::abort();
        for (const auto& p : batch.position)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
        if (batch.size() * 5 > bytes.size() + 1) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    (void)scancast::looksLikePtx({reinterpret_cast<const char*>(data), size});
    read(bytes, true);
    read(bytes, false);
    return 0;
}
