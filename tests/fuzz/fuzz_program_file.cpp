// Any bytes as a compiled program's file: an error, or a program that prints to the same file; never a crash.
// Damage that the checksum would catch is tried with a checksum that is right, too.
#include <xxhash.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "renderer/device/gl/programs/program_files.hpp"

namespace {

using namespace scancast::gl;

void parse(std::span<const std::byte> file) {
    static const ProgramKey key = ProgramKey::of("void main() {}", "a driver\n4.5");
    const auto binary = parseProgramFile(file, key);
    if (binary && !std::ranges::equal(printProgramFile(key, *binary), file)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    parse(bytes);
    constexpr std::size_t checksumAt = 12, contentAt = 20;
    if (size < contentAt) return 0;
    std::vector<std::byte> signedFile(bytes.begin(), bytes.end());
    const std::uint64_t checksum = XXH3_64bits(data + contentAt, size - contentAt);
    std::memcpy(&signedFile[checksumAt], &checksum, sizeof checksum);
    parse(signedFile);
    return 0;
}
