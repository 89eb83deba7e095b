// Any bytes at all, as a LAZ file: an error or as many records as it promises, never a crash, never an endless loop, and the same in
// pieces of any size.
#include <cstdlib>
#include <memory>

#include "importers/laz/decoder/laz_file.hpp"

namespace {

using namespace scancast;
using namespace scancast::laz;

constexpr std::uint64_t mostPoints = 20'000;

std::uint64_t decode(const LazFile& file, Wanted wanted, std::size_t points) {
    LazDecoder decoder(file, wanted);
    std::vector<std::byte> records;
    std::uint64_t sum = 0;
    for (const Chunk& chunk : file.chunks()) {
        if (!decoder.start(chunk)) return 0;
        while (decoder.left() > 0) {
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points, decoder.left()));
            records.assign(count * file.shape().recordBytes, std::byte{0});
            const auto ok = decoder.read(records);
            if (!ok && ok.error().message.empty()) std::abort();
            if (!ok) return 0;
            for (const std::byte byte : records) sum = sum * 31 + static_cast<std::uint64_t>(byte);
        }
    }
    return sum;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto file = LazFile::open(std::make_shared<MemoryAccess>(bytes));
    if (!file) {
        if (file.error().message.empty()) std::abort();
        return 0;
    }
    std::uint64_t points = 0;
    for (const Chunk& chunk : file->chunks()) {
        if (chunk.first != points || chunk.at + chunk.bytes > size) std::abort();
        points += chunk.points;
    }
    if (points != file->shape().points) std::abort();
    if (points > mostPoints) return 0;
    const auto sum = decode(*file, Wanted::Everything, 1000);
    if (decode(*file, Wanted::Everything, 7) != sum) std::abort();
    decode(*file, Wanted::Colors, 1000);
    return 0;
}
