// Any bytes as a block: an error, or samples that encode and decode to themselves; never a crash. And any
// bytes as samples: they come back.
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "renderer/cloud/file/blocks/block_codec.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    if (size < 3) return 0;
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto block = bytes.subspan(3);
    const std::size_t count = data[0] | std::size_t(data[1]) << 8, rowBytes = 1 + data[2] % 64;

    std::vector<Sample> samples(count);
    if (decodeSamples(block, samples)) {
        std::vector<Sample> again(count);
        if (!decodeSamples(encodeSamples(samples), again)) std::abort();
        if (count > 0 && std::memcmp(samples.data(), again.data(), count * sizeof(Sample)) != 0) std::abort();
    }
    if (const auto rows = decodeRows(block, rowBytes, count))
        if (rows->size() != count * rowBytes) std::abort();

    std::vector<Sample> raw(block.size() / sizeof(Sample)), back(raw.size());
    if (raw.empty()) return 0;
    std::memcpy(raw.data(), block.data(), raw.size() * sizeof(Sample));
    if (!decodeSamples(encodeSamples(raw), back)) std::abort();
    if (std::memcmp(raw.data(), back.data(), raw.size() * sizeof(Sample)) != 0) std::abort();
    const auto rows = block.first(block.size() / rowBytes * rowBytes);
    const auto same = decodeRows(encodeRows(rows, rowBytes), rowBytes, rows.size() / rowBytes);
    if (!same || !std::equal(same->begin(), same->end(), rows.begin(), rows.end())) std::abort();
    return 0;
}
