#include "files/unfinished_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <system_error>

#include "files/input_file.hpp"
#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

constexpr int attempts = 16;

tl::unexpected<Error> cannotBeCreated(const fs::path& name, int error) {
    if (error == ENOENT)
        return fail(ErrorCode::NotFound, name.string() + ": the folder is not there; make it first");
    if (isFull(error))
        return fail(ErrorCode::ResourceLimit, name.string() + ": there is no room for it: " +
                                                  systemReason(error) + "; " + wayOutOfFull(error));
    return fail(ErrorCode::Io, name.string() + ": cannot be created: " + systemReason(error));
}

// Nobody else's link decides where the file is.
int openNew(const fs::path& name, int more, Readers readers) {
    const mode_t mode = readers == Readers::OwnerAlone ? 0600 : 0666;
    return uninterrupted([&] {
        return ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | more, mode);
    });
}

std::string randomDigits() {
    std::random_device random;
    return std::to_string(std::uint64_t(random()) << 32 | random());
}

}  // namespace

Expected<UnfinishedFile> takeUnfinished(const fs::path& path, Readers readers) {
    const fs::path name = path.string() + std::string(unfinishedEnd);
    for (int i = 0; i < attempts; ++i) {
        UnfinishedFile file;
        bool made = true;
        file.fd.reset(openNew(name, O_EXCL, readers));
        if (!file.fd && errno == EEXIST) {
            made = false;
            file.fd.reset(openNew(name, 0, readers));
        }
        if (!file.fd) return cannotBeCreated(name, errno);
        // What was made here goes again when this fails.
        if (made) file.name = UnfinishedName(name.string());
        if (const int refused = lockNow(file.fd.get())) {
            if (refused != EWOULDBLOCK)
                return fail(ErrorCode::Io, name.string() + ": cannot be locked: " + systemReason(refused));
            file.name.forget();  // whoever has the lock goes on with it
            return fail(
                ErrorCode::InvalidArgument,
                name.string() + ": another run is writing this file; wait for it, or give another name");
        }
        if (!isStillNamed(file.fd.get(), name)) {
            file.name.forget();
            continue;
        }
        if (!made) file.name = UnfinishedName(name.string());
        if (uninterrupted([&] { return ::ftruncate(file.fd.get(), 0); }) != 0)
            return fail(ErrorCode::Io, name.string() + ": cannot be written: " + systemReason(errno));
        return file;
    }
    return fail(ErrorCode::Io, name.string() + ": other runs keep taking this name away");
}

Expected<UnfinishedFile> makeUnfinished(const fs::path& path, Readers readers) {
    int error = 0;
    for (int i = 0; i < attempts; ++i) {
        const std::string name = path.string() + "." + randomDigits() + std::string(unfinishedEnd);
        UnfinishedFile file;
        file.fd.reset(openNew(name, O_EXCL, readers));
        error = errno;
        if (!file.fd && error == EEXIST) continue;
        if (!file.fd) break;
        file.name = UnfinishedName(name);
        // A sweep may have been faster; a file system without locks is none that is swept.
        if (lockNow(file.fd.get()) == EWOULDBLOCK || !isStillNamed(file.fd.get(), name)) continue;
        return file;
    }
    return cannotBeCreated(path, error);
}

std::size_t sweepUnfinished(const fs::path& folder,
                            const std::function<bool(std::string_view name)>& isOurs) {
    std::size_t swept = 0;
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const std::string name = i->path().filename().string();
        if (!name.ends_with(unfinishedEnd) || !isOurs(name)) continue;
        const UniqueFd fd(uninterrupted([&] { return ::open(i->path().c_str(), inputFlags | O_NOFOLLOW); }));
        std::error_code gone;
        if (!fd || !i->is_regular_file(gone) || lockNow(fd.get()) != 0 || !isStillNamed(fd.get(), i->path()))
            continue;
        if (::unlink(i->path().c_str()) == 0) ++swept;
    }
    return swept;
}

}  // namespace scancast
