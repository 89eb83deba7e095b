// Any folder as a set of EPT that is shown as it is: an error that says something, or a cloud whose nodes can all be asked for. The bytes are
// the folder, as fuzz_octree has it: a byte, then files - the length of a name, the name, 16 bits of length, the content. Tiles are decoded
// by the importer's code, here.
#include <cstdlib>

#include "tests/unit/native/ept_bytes.hpp"

namespace {

using namespace scancast;

constexpr std::size_t longestSet = 16384, mostFilesOfSet = 24, mostNodesAsked = 64;
// What a few bytes can be unpacked to, nobody wants to wait for.
constexpr std::uint64_t mostPointsOfTile = 5000;

class FewPoints final : public ChunkDecoders {
  public:
    Expected<test::Bytes> decode(const ChunkShape& shape, std::uint64_t points,
                                 std::span<const std::byte> chunk) override {
        if (points > mostPointsOfTile) return fail(ErrorCode::ResourceLimit, "it is too large");
        return decoders_.decode(shape, points, chunk);
    }

  private:
    test::TileDecoders decoders_;
};

std::shared_ptr<test::MemoryFolder> setOf(std::span<const std::uint8_t> bytes) {
    auto folder = std::make_shared<test::MemoryFolder>();
    while (bytes.size() > 3 && folder->files.size() < mostFilesOfSet) {
        const auto name = std::min<std::size_t>(bytes[0], bytes.size() - 3);
        const std::string called(reinterpret_cast<const char*>(bytes.data() + 1), name);
        bytes = bytes.subspan(1 + name);
        const auto length = std::min<std::size_t>(bytes[0] | bytes[1] << 8, bytes.size() - 2);
        const auto* begin = reinterpret_cast<const std::byte*>(bytes.data() + 2);
        folder->files[called].assign(begin, begin + length);
        bytes = bytes.subspan(2 + length);
    }
    return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2 || size > longestSet) return 0;
    const auto file =
        openEpt(setOf({data + 1, size - 1}), std::make_shared<FewPoints>(),
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
