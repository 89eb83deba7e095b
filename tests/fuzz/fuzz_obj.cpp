// Any bytes at all, as an OBJ in a file and on a pipe: an error or points, never a crash, never an endless loop.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/text/obj_source.hpp"

namespace {

void read(std::span<const std::byte> bytes, bool seekable) {
    using namespace scancast;
    auto source = ObjSource::create(std::make_unique<MemoryByteSource>(bytes, seekable), "fuzz.obj");
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
        if (batch.size() * 7 > bytes.size() + 1) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    (void)scancast::looksLikeObj({reinterpret_cast<const char*>(data), size}, size % 2 == 0);
    read(bytes, true);
    read(bytes, false);
    return 0;
}
