#include "remote/piece_folder.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

std::vector<std::byte> filled(std::size_t bytes, int with) {
    return std::vector<std::byte>(bytes, std::byte(with));
}

std::uint64_t bytesIn(const std::filesystem::path& folder) {
    std::uint64_t all = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder))
        if (file.is_regular_file()) all += file.file_size();
    return all;
}

TEST(PieceFolderTest, keysTellObjectsAndStatesApart) {
    const ObjectState state{10, "\"a\"", "Thu"};
    const std::string key = pieceKey("https://a/b", state);
    EXPECT_EQ(key.size(), 32u);
    EXPECT_EQ(key, pieceKey("https://a/b", state));
    EXPECT_NE(key, pieceKey("https://a/c", state));
    EXPECT_NE(key, pieceKey("https://a/b", {11, "\"a\"", "Thu"}));
    EXPECT_NE(key, pieceKey("https://a/b", {10, "\"b\"", "Thu"}));
    EXPECT_NE(key, pieceKey("https://a/b", {10, "\"a\"", "Fri"}));
    EXPECT_EQ(pieceKey("https://a/b", {10, "", ""}), "") << "nobody would notice that it has changed";
}

TEST(PieceFolderTest, aPieceIsItselfAtItsPlaceAlone) {
    const auto bytes = filled(1000, 7);
    auto packed = packPiece("key", 3, bytes);
    EXPECT_EQ(unpackPiece("key", 3, packed), bytes);
    EXPECT_FALSE(unpackPiece("key", 4, packed));
    EXPECT_FALSE(unpackPiece("other", 3, packed));
    EXPECT_FALSE(unpackPiece("key", 3, std::span(packed).first(packed.size() - 1)));
    for (std::size_t at = 0; at < packed.size(); at += 13) {
        packed[at] ^= std::byte(1);
        EXPECT_FALSE(unpackPiece("key", 3, packed)) << at;
        packed[at] ^= std::byte(1);
    }
}

TEST(PieceFolderTest, whatWasNotUsedForLongestMakesRoom) {
    const test::TemporaryFolder folder;
    constexpr std::uint64_t limit = 400'000;
    auto pieces = PieceFolder::open(folder, limit);
    ASSERT_TRUE(pieces);
    while (!(*pieces)->counted()) std::this_thread::yield();
    for (std::uint64_t piece = 0; piece < 20; ++piece) {
        (*pieces)->save("key", piece, filled(50'000, int(piece)));
        // Times of access differ by more than a clock's step.
        const timespec times[2] = {{.tv_sec = 1000 + time_t(piece), .tv_nsec = 0},
                                   {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
        if (piece < 5) ::utimensat(AT_FDCWD, (folder / "key" / std::to_string(piece)).c_str(), times, 0);
        (void)(*pieces)->load("key", 0);
        EXPECT_LE(bytesIn(folder), limit + 50'100);
    }
    EXPECT_LE((*pieces)->bytes(), limit);
    EXPECT_EQ((*pieces)->load("key", 0), filled(50'000, 0)) << "it was used all the time";
    EXPECT_FALSE((*pieces)->load("key", 1));
}

TEST(PieceFolderTest, severalShareAFolder) {
    const test::TemporaryFolder folder;
    auto one = *PieceFolder::open(folder, 1 << 20), other = *PieceFolder::open(folder, 1 << 20);
    one->save("key", 1, filled(100, 1));
    other->save("key", 1, filled(100, 1));
    EXPECT_EQ(other->load("key", 1), filled(100, 1));
    other->remove("key", 1);
    EXPECT_FALSE(one->has("key", 1));
    EXPECT_FALSE(one->load("key", 1));
    EXPECT_EQ(one->broken(), 0u);
}

}  // namespace
}  // namespace scancast
