#include "remote/piece_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "files/bytes.hpp"
#include "files/input_file.hpp"
#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

// "SCPIECE1", bytes of the piece, checksum of everything else.
constexpr std::array<char, 8> magic{'S', 'C', 'P', 'I', 'E', 'C', 'E', '1'};
constexpr std::size_t headBytes = 24, lengthAt = 8, checksumAt = 16;
constexpr std::string_view temporaryEnd = ".partial";
// What a program that was killed had begun.
constexpr std::int64_t abandonedSeconds = 600;

std::uint64_t checksum(std::string_view key, std::uint64_t piece, std::span<const std::byte> bytes) {
    const std::string place = fmt::format("{} {} {}", key, piece, bytes.size());
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), XXH3_64bits(place.data(), place.size()));
}

struct Kept {
    fs::path path;
    std::uint64_t bytes;
    std::int64_t used;  // nanoseconds since 1970
};

}  // namespace

std::string pieceKey(std::string_view identity, const ObjectState& state) {
    if (!state.isKnown()) return {};
    const std::string all =
        fmt::format("{}\n{}\n{}\n{}", identity, state.bytes, state.etag, state.lastModified);
    const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::vector<std::byte> packPiece(std::string_view key, std::uint64_t piece,
                                 std::span<const std::byte> bytes) {
    std::vector<std::byte> packed(headBytes + bytes.size());
    std::ranges::copy(std::as_bytes(std::span(magic)), packed.begin());
    storeLe(packed.data() + lengthAt, std::uint64_t(bytes.size()));
    storeLe(packed.data() + checksumAt, checksum(key, piece, bytes));
    std::ranges::copy(bytes, packed.begin() + headBytes);
    return packed;
}

std::optional<std::vector<std::byte>> unpackPiece(std::string_view key, std::uint64_t piece,
                                                  std::span<const std::byte> packed) {
    if (packed.size() < headBytes || packed.size() > headBytes + PieceFolder::longestPiece)
        return std::nullopt;
    const auto bytes = packed.subspan(headBytes);
    if (!std::ranges::equal(packed.first(magic.size()), std::as_bytes(std::span(magic))) ||
        loadLe<std::uint64_t>(packed.data() + lengthAt) != bytes.size() ||
        loadLe<std::uint64_t>(packed.data() + checksumAt) != checksum(key, piece, bytes))
        return std::nullopt;
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Expected<std::unique_ptr<PieceFolder>> PieceFolder::open(const fs::path& folder, std::uint64_t limit) {
    std::error_code error;
    const bool isNew = fs::create_directories(folder, error);
    if (error) return fail(ErrorCode::Io, folder.string() + ": cannot be made: " + error.message());
    if (isNew) fs::permissions(folder, fs::perms::owner_all, error);
    std::unique_ptr<PieceFolder> opened(new PieceFolder(folder, limit));
    // A large folder takes its time, on a network drive above all: nobody waits for it.
    try {
        opened->counter_ =
            std::jthread([self = opened.get()](const std::stop_token& stop) { self->count(stop); });
    } catch (const std::system_error&) {
        opened->count();
    }
    return opened;
}

fs::path PieceFolder::pathOf(const std::string& key, std::uint64_t piece) const {
    return folder_ / key / fmt::format("{:x}", piece);
}

bool PieceFolder::has(const std::string& key, std::uint64_t piece) const {
    return !key.empty() && ::access(pathOf(key, piece).c_str(), R_OK) == 0;
}

std::optional<std::vector<std::byte>> PieceFolder::load(const std::string& key, std::uint64_t piece) {
    if (key.empty()) return std::nullopt;
    const auto file = InputFile::open(pathOf(key, piece));
    if (!file) return std::nullopt;
    std::optional<std::vector<std::byte>> bytes;
    if (file->bytes() <= headBytes + longestPiece) {
        std::vector<std::byte> packed(file->bytes());
        const auto got = file->readAt(0, packed);
        if (got && *got == packed.size()) bytes = unpackPiece(key, piece, packed);
    }
    if (!bytes) {
        ++broken_;
        remove(key, piece);
        return bytes;
    }
    const timespec now[2] = {{.tv_sec = 0, .tv_nsec = UTIME_NOW}, {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
    (void)::futimens(file->descriptor(), now);  // refused, it goes earlier than it should: no harm
    return bytes;
}

void PieceFolder::save(const std::string& key, std::uint64_t piece, std::span<const std::byte> bytes) {
    if (key.empty() || bytes.size() > longestPiece || bytes.size() > limit_) return;
    const auto packed = packPiece(key, piece, bytes);
    const fs::path path = pathOf(key, piece);
    const fs::path temporary =
        path.string() + fmt::format(".{}-{}", ::getpid(), ++names_) + std::string(temporaryEnd);
    const auto create = [&] {
        return UniqueFd(uninterrupted([&] {
            return ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
                          S_IRUSR | S_IWUSR);
        }));
    };
    UniqueFd fd = create();
    if (!fd && errno == ENOENT) {
        std::error_code error;
        fs::create_directory(path.parent_path(), error);
        fd = create();
    }
    if (!fd) return;
    // Not synced: what a power cut leaves half written is found out by its checksum.
    const bool written = writeFullyAt(fd.get(), 0, packed) == 0;
    fd.reset();
    if (!written || ::rename(temporary.c_str(), path.c_str()) != 0) {
        (void)::unlink(temporary.c_str());
        return;
    }
    bytes_ += packed.size();
    written_ += packed.size();
    // Others who share the folder write, too.
    if (bytes_ > limit_ || written_ > limit_ / 8) count();
}

void PieceFolder::remove(const std::string& key, std::uint64_t piece) {
    if (!key.empty()) (void)::unlink(pathOf(key, piece).c_str());
}

void PieceFolder::count(const std::stop_token& stop) {
    const std::unique_lock lock(counting_, std::try_to_lock);
    if (!lock) return;
    constexpr std::int64_t nanoseconds = 1'000'000'000;
    std::vector<Kept> files;
    std::uint64_t all = 0;
    std::error_code error;
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    for (fs::directory_iterator folder(folder_, error), end; !error && folder != end;
         folder.increment(error)) {
        std::error_code inner;
        for (fs::directory_iterator i(folder->path(), inner); !inner && i != fs::directory_iterator();
             i.increment(inner)) {
            if (stop.stop_requested()) return;
            struct stat info {};
            if (::lstat(i->path().c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;
            if (i->path().native().ends_with(temporaryEnd) &&
                info.st_mtim.tv_sec + abandonedSeconds < now.tv_sec) {
                (void)::unlink(i->path().c_str());
                continue;
            }
            all += std::uint64_t(info.st_size);
            files.push_back({i->path(), std::uint64_t(info.st_size),
                             info.st_atim.tv_sec * nanoseconds + info.st_atim.tv_nsec});
        }
    }
    if (all > limit_) {
        std::ranges::sort(files, {}, &Kept::used);
        for (const Kept& kept : files) {
            if (all <= limit_ / 10 * 9 || stop.stop_requested()) break;
            if (::unlink(kept.path.c_str()) != 0) continue;
            all -= kept.bytes;
            (void)::rmdir(kept.path.parent_path().c_str());  // goes when it is empty
        }
    }
    bytes_ = all;
    written_ = 0;
    counted_ = true;
}

}  // namespace scancast
