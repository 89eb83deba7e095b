#include "server/catalog/kept_clouds.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>
#include <vector>

#include "files/raw_writes.hpp"
#include "files/unfinished_file.hpp"
#include "files/uninterrupted.hpp"
#include "server/base/byte_size.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view extension = ".scan";
constexpr std::size_t digestDigits = 16;

/// Of whoever has the file open (F_RDLCK), or removes it (F_WRLCK). A lock of the open file, not of the process: it lasts
/// as long as any handle of it, and two servers, or two parts of one, see each other's. It is beside the flock() of who
/// changes the file. False where somebody has the other one.
bool lockFor(int fd, short kind) {
    struct flock whole {};
    whole.l_type = kind;
    whole.l_whence = SEEK_SET;
    return uninterrupted([&] { return ::fcntl(fd, F_OFD_SETLK, &whole); }) == 0;
}

}  // namespace

std::uint64_t tenthOfTheDisk(const fs::path& folder) {
    struct statvfs disk {};
    if (::statvfs(folder.c_str(), &disk) != 0) return std::uint64_t(32) << 30;
    return std::uint64_t(disk.f_blocks) * disk.f_frsize / 10;
}

bool isKeptName(std::string_view name) {
    if (!name.ends_with(extension)) return false;
    name.remove_suffix(extension.size());
    if (name.size() < digestDigits + 2 || name[name.size() - digestDigits - 1] != '-') return false;
    return name.substr(name.size() - digestDigits).find_first_not_of("0123456789abcdef") ==
           std::string_view::npos;
}

struct KeptClouds::Kept {
    fs::path path;
    std::uint64_t bytes = 0;
    std::int64_t used = 0;  // nanoseconds since 1970
};

KeptClouds::KeptClouds(KeptCloudsOptions options)
    : options_(std::move(options)),
      limit_(options_.limit > 0 ? options_.limit : tenthOfTheDisk(options_.folder)) {
    sweepUnfinished(options_.folder, [](std::string_view name) {
        return isKeptName(name.substr(0, name.size() - unfinishedEnd.size()));
    });
    const std::lock_guard lock(mutex_);
    evict(0);
}

fs::path KeptClouds::pathOf(std::string_view stem, std::uint64_t digest) const {
    return options_.folder / fmt::format("{}-{:016x}{}", stem, digest, extension);
}

Expected<InputFile> KeptClouds::open(const fs::path& path) {
    auto file = InputFile::open(path);
    if (!file) return file;
    const bool locked = lockFor(file->descriptor(), F_RDLCK);
    const bool isBeingRemoved = !locked && (errno == EAGAIN || errno == EACCES);
    if (isBeingRemoved || !isStillNamed(file->descriptor(), path))
        return fail(ErrorCode::NotFound, path.string() + " is being removed");
    const timespec now[2] = {{.tv_sec = 0, .tv_nsec = UTIME_NOW}, {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
    (void)::futimens(file->descriptor(), now);  // refused, it goes earlier than it should: no harm
    return file;
}

KeptClouds::Room::~Room() {
    const std::lock_guard lock(kept_.mutex_);
    kept_.reserved_ -= bytes_;
    kept_.evict(0);
}

Expected<std::unique_ptr<KeptClouds::Room>> KeptClouds::makeRoom(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto refuse = [&](const std::string& why) {
        return fail(ErrorCode::ResourceLimit, fmt::format("its cloud file of about {} {}; --cache-size is {}",
                                                          byteSizeText(bytes), why, byteSizeText(limit_)));
    };
    if (bytes > limit_) return refuse("is larger than all that may be kept");
    const std::uint64_t there = evict(bytes);
    if (there + reserved_ + bytes > limit_)
        return refuse(fmt::format("has no room beside {} that are in use", byteSizeText(there + reserved_)));
    auto room = std::make_unique<Room>(*this, bytes);
    reserved_ += bytes;
    return room;
}

// Best effort where files cannot be looked at: they are then nobody's to remove.
std::uint64_t KeptClouds::evict(std::uint64_t more) {
    constexpr std::int64_t nanoseconds = 1'000'000'000;
    std::vector<Kept> files;
    std::uint64_t all = programBytes();
    std::error_code error;
    for (fs::directory_iterator i(options_.folder, error), end; !error && i != end; i.increment(error)) {
        struct stat info {};
        if (!isKeptName(i->path().filename().string()) || ::lstat(i->path().c_str(), &info) != 0 ||
            !S_ISREG(info.st_mode))
            continue;
        all += std::uint64_t(info.st_size);
        files.push_back({i->path(), std::uint64_t(info.st_size),
                         info.st_atim.tv_sec * nanoseconds + info.st_atim.tv_nsec});
    }
    std::ranges::sort(files, {}, &Kept::used);
    for (const Kept& kept : files) {
        if (all + reserved_ + more <= limit_) break;
        if (!remove(kept)) continue;
        all -= kept.bytes;
        ++evicted_;
        note(fmt::format(
            "{} ({}), which had not been used for longest, is removed from the kept clouds to make room.",
            kept.path.filename().string(), byteSizeText(kept.bytes)));
    }
    bytes_ = all;
    return all;
}

bool KeptClouds::remove(const Kept& kept) {
    const UniqueFd fd(uninterrupted(
        [&] { return ::open(kept.path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY); }));
    // What was replaced meanwhile is another file, which has just been built.
    return fd && lockFor(fd.get(), F_WRLCK) && isStillNamed(fd.get(), kept.path) &&
           ::unlink(kept.path.c_str()) == 0;
}

std::uint64_t KeptClouds::programBytes() const {
    std::uint64_t all = 0;
    std::error_code error;
    for (fs::directory_iterator i(options_.folder / "programs", error), end; !error && i != end;
         i.increment(error)) {
        std::error_code gone;
        const std::uintmax_t bytes = i->file_size(gone);
        if (!gone) all += bytes;
    }
    return all;
}

KeptCloudsStats KeptClouds::stats() const {
    return {.limit = limit_, .bytes = bytes_, .evicted = evicted_};
}

void KeptClouds::note(const std::string& text) const {
    if (options_.onNote) options_.onNote(text);
}

}  // namespace scancast
