// Any bytes as a COPC file: an error that says something, or a cloud whose nodes can all be asked for. Chunks are taken for records as they
// are: what a decoder makes of them is fuzz_laz'. And any bytes as what is said between Scancast and a decoder.
#include <cstdlib>

#include "renderer/cloud/import/stream/chunk_messages.hpp"
#include "tests/unit/native/copc_bytes.hpp"

namespace {

using namespace scancast;

constexpr std::size_t mostNodesAsked = 64;

void readMessages(std::span<const std::byte> bytes) {
    using namespace chunk_messages;
    if (bytes.size() < requestHeadBytes + answerHeadBytes) return;
    const auto request = parseRequest(bytes.first<requestHeadBytes>());
    if (!request) return;
    if (encode(*request) != encode(*parseRequest(encode(*request)))) std::abort();
    std::ignore = parseAnswer(bytes.subspan(requestHeadBytes).first<answerHeadBytes>(), *request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    readMessages(bytes);
    const auto file =
        openCopc(readerOf(bytes), std::make_shared<test::RawChunks>(),
                 {.name = "it", .title = "it", .identity = {}, .surfels = false, .upperPoints = 2});
    if (!file) {
        if (file.error().message.empty()) std::abort();
        return 0;
    }
    const std::size_t nodes = std::min((*file)->nodes().size(), mostNodesAsked);
    for (std::uint32_t node = 0; node < nodes; ++node)
        if (const auto samples = (*file)->samples(node); !samples && samples.error().message.empty())
            std::abort();
    return 0;
}
