#include "files/owned_folder.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>

#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "scancast-spill-";

UniqueFd openFolder(const fs::path& path) {
    return UniqueFd(
        uninterrupted([&] { return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC); }));
}

bool isOurs(int fd) {
    struct stat info {};
    return ::fstat(fd, &info) == 0 && info.st_uid == ::geteuid();
}

}  // namespace

Expected<OwnedFolder> OwnedFolder::make(const fs::path& parent) {
    constexpr int attempts = 64;
    for (int i = 0; i < attempts; ++i) {
        std::string name = (parent / (std::string(prefix) + "XXXXXX")).string();
        if (::mkdtemp(name.data()) == nullptr) break;
        OwnedFolder folder(name, openFolder(name));
        if (!folder.lock_ && errno == ENOENT) continue;  // a sweep has been faster
        if (!folder.lock_) break;
        // Whom a sweep has locked it will remove, if it has not yet. Where there are no locks, nothing is swept.
        if (lockNow(folder.lock_.get()) != EWOULDBLOCK && isStillNamed(folder.lock_.get(), folder.path_))
            return folder;
    }
    const int error = errno;
    return fail(isFull(error) ? ErrorCode::ResourceLimit : ErrorCode::Io,
                "No temporary folder can be made in " + parent.string() + ": " + systemReason(error) +
                    "; another one can be named by the environment variable TMPDIR.");
}

OwnedFolder::~OwnedFolder() {
    if (path_.empty()) return;
    std::error_code error;
    fs::remove_all(path_, error);
}

std::size_t sweepOwnedFolders(const fs::path& parent) {
    std::size_t swept = 0;
    std::error_code error;
    for (fs::directory_iterator i(parent, error), end; !error && i != end; i.increment(error)) {
        if (!i->path().filename().string().starts_with(prefix)) continue;
        const UniqueFd fd = openFolder(i->path());
        if (!fd || !isOurs(fd.get()) || lockNow(fd.get()) != 0 || !isStillNamed(fd.get(), i->path()))
            continue;
        std::error_code left;
        fs::remove_all(i->path(), left);
        if (!left) ++swept;
    }
    return swept;
}

}  // namespace scancast
