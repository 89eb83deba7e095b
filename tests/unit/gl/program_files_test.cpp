#include "renderer/device/gl/programs/program_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/temporary_folder.hpp"

namespace scancast::gl {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

ProgramBinary binaryOf(std::size_t size, int seed = 1) {
    ProgramBinary binary{0x875F, {}};
    for (std::size_t i = 0; i < size; ++i)
        binary.bytes.push_back(static_cast<std::byte>(i * 7 + static_cast<std::size_t>(seed)));
    return binary;
}

const ProgramKey key = ProgramKey::of("void main() {}", "a driver\n4.5");

std::vector<std::byte> contentOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

void overwrite(const fs::path& path, std::span<const std::byte> bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::uint64_t bytesIn(const fs::path& folder) {
    std::uint64_t all = 0;
    for (const auto& entry : fs::directory_iterator(folder)) all += entry.file_size();
    return all;
}

TEST(ProgramFile, ComesBackAsItWas) {
    for (const std::size_t size : {0, 1, 1000, 100'000}) {
        const ProgramBinary binary = binaryOf(size);
        const auto back = parseProgramFile(printProgramFile(key, binary), key);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->format, binary.format);
        EXPECT_EQ(back->bytes, binary.bytes);
    }
}

TEST(ProgramFile, AKeyNamesSourceAndDriver) {
    EXPECT_EQ(key.digest.size(), 32u);
    EXPECT_EQ(ProgramKey::of("void main() {}", "a driver\n4.5").digest, key.digest);
    EXPECT_NE(ProgramKey::of("void main() { }", "a driver\n4.5").digest, key.digest);
    EXPECT_NE(ProgramKey::of("void main() {}", "a driver\n4.6").digest, key.digest);
    EXPECT_NE(ProgramKey::of("bc", "a").digest, ProgramKey::of("c", "ab").digest);
}

/// Every length and every byte: none of them is taken for the program.
TEST(ProgramFile, DamageIsSeen) {
    const auto file = printProgramFile(key, binaryOf(200));
    for (std::size_t size = 0; size < file.size(); ++size)
        EXPECT_FALSE(parseProgramFile(std::span(file).first(size), key)) << size;
    for (std::size_t at = 0; at < file.size(); ++at) {
        for (const int bit : {0, 3, 7}) {
            auto damaged = file;
            damaged[at] ^= static_cast<std::byte>(1 << bit);
            EXPECT_FALSE(parseProgramFile(damaged, key)) << "byte " << at << ", bit " << bit;
        }
    }
    auto longer = file;
    longer.push_back({});
    EXPECT_FALSE(parseProgramFile(longer, key));
}

TEST(ProgramFile, AnotherProgramsOrDriversIsNotTaken) {
    const auto file = printProgramFile(key, binaryOf(10));
    ProgramKey other = key;
    other.driver = "another driver";
    EXPECT_FALSE(parseProgramFile(file, other));
    other = key;
    other.digest.front() = other.digest.front() == '0' ? '1' : '0';
    const auto parsed = parseProgramFile(file, other);
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().code, ErrorCode::Unsupported);
}

TEST(ProgramFiles, KeepWhatIsWritten) {
    const TemporaryFolder folder;
    const ProgramFiles files(folder.path() / "made" / "when needed");
    EXPECT_FALSE(files.read(key));
    files.write(key, binaryOf(500));
    const auto back = files.read(key);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->bytes, binaryOf(500).bytes);
    files.write(key, binaryOf(300, 5));
    EXPECT_EQ(files.read(key)->bytes, binaryOf(300, 5).bytes) << "the newer one";
    for (const auto& entry : fs::directory_iterator(folder.path() / "made" / "when needed"))
        EXPECT_EQ(entry.path().filename(), key.digest + ".program") << "nothing unfinished stays";
}

TEST(ProgramFiles, ADamagedFileIsNoneAndIsWrittenAnew) {
    const TemporaryFolder folder;
    const ProgramFiles files(folder.path());
    files.write(key, binaryOf(500));
    const fs::path path = folder.path() / (key.digest + ".program");
    auto bytes = contentOf(path);
    bytes[bytes.size() / 2] ^= std::byte{1};
    overwrite(path, bytes);
    EXPECT_FALSE(files.read(key));
    overwrite(path, {});
    EXPECT_FALSE(files.read(key));
    files.write(key, binaryOf(500));
    EXPECT_TRUE(files.read(key));
}

TEST(ProgramFiles, AFolderThatCannotBeWrittenIsNoError) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a file", "no folder");
    const ProgramFiles files(file / "programs");
    files.write(key, binaryOf(500));
    EXPECT_FALSE(files.read(key));
    const ProgramFiles nowhere("/proc/scancast/programs");
    nowhere.write(key, binaryOf(500));
    EXPECT_FALSE(nowhere.read(key));
}

TEST(ProgramFiles, AFolderInPlaceOfAFileIsNoError) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / (key.digest + ".program"));
    const ProgramFiles files(folder.path());
    EXPECT_FALSE(files.read(key));
    files.write(key, binaryOf(500));
    EXPECT_FALSE(files.read(key));
}

TEST(ProgramFiles, TheOldestGoWhenThereAreTooMany) {
    const TemporaryFolder folder;
    constexpr std::uint64_t most = 10'000;
    const ProgramFiles files(folder.path(), most);
    folder.write("notes.txt", std::string(20'000, 'x'));
    folder.write("0123.program.4711", std::string(3'000, 'x'));  // of a process that was killed
    const auto start = fs::file_time_type::clock::now();
    fs::last_write_time(folder.path() / "0123.program.4711", start - std::chrono::hours(99));
    std::vector<ProgramKey> keys;
    for (int i = 0; i < 12; ++i) {
        keys.push_back(ProgramKey::of("program " + std::to_string(i), "driver"));
        files.write(keys.back(), binaryOf(1500, i));
        // File systems tell times apart by milliseconds at best; ages are said, not waited for.
        fs::last_write_time(folder.path() / (keys.back().digest + ".program"),
                            start - std::chrono::hours(50 - i));
        EXPECT_LE(bytesIn(folder.path()) - 20'000, most);
    }
    EXPECT_TRUE(fs::exists(folder.path() / "notes.txt")) << "what is none of ours stays";
    EXPECT_FALSE(fs::exists(folder.path() / "0123.program.4711"));
    EXPECT_FALSE(files.read(keys[0]));
    EXPECT_FALSE(files.read(keys[5]));
    for (std::size_t i = 6; i < keys.size(); ++i) EXPECT_TRUE(files.read(keys[i])) << i;
}

TEST(ProgramFiles, WhatIsTooLargeIsNotKept) {
    const TemporaryFolder folder;
    const ProgramFiles files(folder.path(), 1000);
    files.write(key, binaryOf(2000));
    EXPECT_FALSE(files.read(key));
    EXPECT_EQ(bytesIn(folder.path()), 0u);
}

}  // namespace
}  // namespace scancast::gl
