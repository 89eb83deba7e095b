// Any bytes at all, as an OBJ in a file and on a pipe: an error or points, never a crash, never an endless loop.
#include "renderer/cloud/import/text/obj_source.hpp"
#include "tests/fuzz/scans/read_source.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    constexpr std::size_t leastBytes = 7;  // "v 0 0 0"
    (void)looksLikeObj({reinterpret_cast<const char*>(data), size}, size % 2 == 0);
    for (const bool seekable : {true, false})
        test::readSource(std::as_bytes(std::span(data, size)), seekable, leastBytes,
                         [](auto bytes) { return ObjSource::create(std::move(bytes), "fuzz.obj"); });
    return 0;
}
