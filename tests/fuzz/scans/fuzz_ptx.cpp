// Any bytes at all, as PTX in a file and on a pipe: an error or points, never a crash, never an endless loop.
#include "renderer/cloud/import/text/ptx_source.hpp"
#include "renderer/cloud/import/text/text_head.hpp"
#include "tests/fuzz/scans/read_source.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    constexpr std::size_t leastBytes = 5;  // "0 0 0"
    (void)looksLikePtx({reinterpret_cast<const char*>(data), size});
    for (const bool seekable : {true, false})
        test::readSource(std::as_bytes(std::span(data, size)), seekable, leastBytes,
                         [](auto bytes) { return PtxSource::create(std::move(bytes), "fuzz.ptx"); });
    return 0;
}
