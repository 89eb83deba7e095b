// Any bytes at all as an E57 file, as its importer reads it: an error with a reason, or a point stream that the server takes.
// Checksums, which keep nearly every change out, are set right first, unless the last byte is odd. Each is read once more to be recovered,
// with a page that is damaged: what the importer counts before it reads, it has to read.
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "importers/e57/e57_import.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "tests/support/e57/e57_writer.hpp"

namespace {

using namespace scancast;

constexpr std::size_t mostStreamBytes = 16 << 20;

void import(const std::string& file, const import_e57::Choices& choices) {
    std::vector<std::byte> stream;
    PointStreamWriter writer([&](std::span<const std::byte> more) {
        if (stream.size() + more.size() > mostStreamBytes)
            return false;  // a thousand points a byte are allowed
        stream.insert(stream.end(), more.begin(), more.end());
        return true;
    });
    auto bytes = std::make_unique<MemoryByteSource>(std::as_bytes(std::span<const char>(file)));
    if (const auto done = import_e57::importE57(std::move(bytes), choices, writer); !done) {
        if (done.error().message.empty()) std::abort();
        return;
    }
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(stream),
                                            {.photos = std::filesystem::temp_directory_path()});
    PointBatch batch;
    for (;;) {
        const auto more = reader ? (*reader)->read(batch) : Expected<bool>(passOn(reader));
        if (!more && more.error().code != ErrorCode::Empty) std::abort();  // all of its points are none
        if (!more || !*more) return;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t atFileBytes = 16;
    std::string file(reinterpret_cast<const char*>(data), size);
    if (size > 0 && data[size - 1] % 2 == 0) {
        file.resize((size + 1023) / 1024 * 1024);
        const std::uint64_t bytes = file.size();
        std::memcpy(file.data() + atFileBytes, &bytes, sizeof bytes);
        test::sealPages(file);
    }
    import(file, {.keepAttributes = size % 2 == 0});
    if (size == 0) return 0;
    file[(data[size / 2] * std::size_t(1024) + data[size / 3]) % file.size()] ^= 1;
    import(file, {.keepAttributes = size % 2 == 0, .recover = true});
    return 0;
}
