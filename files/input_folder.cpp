#include "files/input_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "files/beneath.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

Expected<Input> judged(UniqueFd fd, const fs::path& name) {
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return failedToOpen(name, errno);
    if (S_ISDIR(info.st_mode))
        return InputFolder::adopt(std::move(fd), name).map([](InputFolder&& f) {
            return Input(std::move(f));
        });
    return InputFile::adopt(std::move(fd), name).map([](InputFile&& f) { return Input(std::move(f)); });
}

Expected<UniqueFd> openedBeneath(const InputFolder& folder, const fs::path& name) {
    auto fd = openBeneath(folder.descriptor(), name);
    if (fd) return std::move(*fd);
    if (fd.error() == EXDEV)
        return fail(ErrorCode::InvalidArgument,
                    (folder.name() / name).string() + " leads out of the folder " + folder.name().string());
    return failedToOpen(folder.name() / name, fd.error());
}

UniqueFd openPath(const fs::path& path, int flags) {
    for (;;) {
        UniqueFd fd(::open(path.c_str(), flags));
        if (fd || errno != EINTR) return fd;
    }
}

}  // namespace

Expected<InputFolder> InputFolder::open(const fs::path& path) {
    auto fd = openPath(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (!fd) return failedToOpen(path, errno);
    return adopt(std::move(fd), path);
}

Expected<InputFolder> InputFolder::adopt(UniqueFd fd, fs::path name) {
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return failedToOpen(name, errno);
    if (!S_ISDIR(info.st_mode)) return fail(ErrorCode::Unsupported, name.string() + " is no folder");
    return InputFolder(std::move(fd), std::move(name));
}

Expected<Input> InputFolder::at(const fs::path& name) const {
    auto fd = openedBeneath(*this, name);
    if (!fd) return passOn(fd);
    return judged(std::move(*fd), name_ / name);
}

Expected<InputFile> InputFolder::file(const fs::path& name) const {
    auto fd = openedBeneath(*this, name);
    if (!fd) return passOn(fd);
    return InputFile::adopt(std::move(*fd), name_ / name);
}

std::uint64_t InputFolder::bytes() const {
    std::error_code error;
    std::uint64_t bytes = 0;
    // By the descriptor: what has the folder's name by now does not matter.
    const fs::path opened = "/proc/self/fd/" + std::to_string(fd_.get()) + "/.";
    fs::recursive_directory_iterator at(opened, fs::directory_options::skip_permission_denied, error);
    for (const fs::recursive_directory_iterator end; !error && at != end; at.increment(error)) {
        std::error_code ignored;
        if (!at->is_regular_file(ignored)) continue;
        const auto size = at->file_size(ignored);
        if (!ignored) bytes += size;
    }
    return bytes;
}

Expected<Input> openInput(const fs::path& path) {
    auto fd = openPath(path, inputFlags);
    if (!fd) return failedToOpen(path, errno);
    return judged(std::move(fd), path);
}

}  // namespace scancast
