// Any bytes at all from a live source: frames that keep their promises, errors, or the end - and always the end of it.
#include <cstdlib>
#include <memory>

#include "renderer/cloud/import/stream/frame_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto bytes = std::as_bytes(std::span(data, size));
    FrameReader reader(std::make_unique<MemoryByteSource>(bytes, false), 100'000);
    for (std::size_t frames = 0; frames <= size; ++frames) {
        const auto frame = reader.next();
        if (!frame && frame.error().message.empty()) std::abort();
        if (!frame && reader.mayGoOn()) continue;
        if (!frame || !*frame) return 0;
        const std::size_t n = (*frame)->points.size();
        const auto has = (*frame)->header.attributes;
        if (n == 0 || n > 100'000 || (*frame)->points.color.size() != (has.color ? n : 0)) std::abort();
    }
    std::abort();  // every frame takes bytes
}
