// Any folder at all as an octree of EPT or Potree: an error, or a stream that its reader takes. The bytes are the folder: one
// that says which file describes it, then files - the length of a name, the name, 16 bits of length, the content.
#include <cstdlib>

#include "tests/unit/octree/memory_files.hpp"

namespace {

using namespace scancast;

constexpr std::size_t longestFolder = 8192;
constexpr std::size_t mostFiles = 24;
// What a few bytes can be unpacked to, nobody wants to wait for.
constexpr std::size_t longestStream = std::size_t(1) << 20;

test::MemoryFiles folderOf(std::span<const std::uint8_t> bytes) {
    test::MemoryFiles folder;
    while (bytes.size() > 3 && folder.files.size() < mostFiles) {
        const auto name = std::min<std::size_t>(bytes[0], bytes.size() - 3);
        const std::string called(reinterpret_cast<const char*>(bytes.data() + 1), name);
        bytes = bytes.subspan(1 + name);
        const auto length = std::min<std::size_t>(bytes[0] | bytes[1] << 8, bytes.size() - 2);
        const auto* begin = reinterpret_cast<const std::byte*>(bytes.data() + 2);
        folder.files[called].assign(begin, begin + length);
        bytes = bytes.subspan(2 + length);
    }
    return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2 || size > longestFolder) return 0;
    const auto folder = folderOf({data + 1, size - 1});
    const bool keepAttributes = (data[0] & 4) != 0;
    const auto octree =
        import_octree::openOctree(folder, import_octree::descriptions[data[0] % 3], keepAttributes);
    if (!octree) {
        if (octree.error().message.empty()) std::abort();
        return 0;
    }
    test::Bytes stream;
    PointStreamWriter writer([&](std::span<const std::byte> bytes) {
        stream.insert(stream.end(), bytes.begin(), bytes.end());
        return stream.size() <= longestStream;
    });
    if (const auto done = import_octree::writeOctree(**octree, writer, 1); !done) {
        if (done.error().message.empty()) std::abort();
        return 0;
    }
    const auto scan = test::readStream(stream);
    if (!scan || scan->points.size() != writer.points()) std::abort();
    return 0;
}
