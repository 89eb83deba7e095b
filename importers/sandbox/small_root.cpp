#include "importers/sandbox/small_root.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "files/system_error.hpp"
#include "files/unique_fd.hpp"

namespace scancast::sandbox {
namespace {

namespace fs = std::filesystem;

constexpr const char* where = "/tmp";  // there everywhere, and not needed any more
constexpr const char* scanName = "/scan";

Expected<void> notAllowed(const std::string& what) {
    return fail(ErrorCode::Unsupported, "this system does not allow " + what + ": " + systemReason(errno));
}

bool write(const char* file, const std::string& text) {
    std::ofstream out(file);
    return bool(out << text << std::flush);
}

/// As who he is, with no other user there.
Expected<void> separate() {
    constexpr int own = CLONE_NEWNS | CLONE_NEWNET | CLONE_NEWIPC;
    if (::unshare(own) == 0) return {};
    const auto user = ::geteuid();
    const auto group = ::getegid();
    if (::unshare(CLONE_NEWUSER | own) != 0) return notAllowed("namespaces");
    const auto itself = [](auto id) { return std::to_string(id) + " " + std::to_string(id) + " 1"; };
    if (!write("/proc/self/setgroups", "deny") || !write("/proc/self/uid_map", itself(user)) ||
        !write("/proc/self/gid_map", itself(group)))
        return notAllowed("a namespace of users");
    return {};
}

/// What a mount is already must stay: of another's, it is locked.
unsigned long flagsOf(const std::string& path) {
    struct statvfs info {};
    if (::statvfs(path.c_str(), &info) != 0) return 0;
    unsigned long flags = 0;
    for (const auto& [has, flag] :
         {std::pair(ST_NOSUID, MS_NOSUID), std::pair(ST_NODEV, MS_NODEV), std::pair(ST_NOEXEC, MS_NOEXEC),
          std::pair(ST_NOATIME, MS_NOATIME), std::pair(ST_NODIRATIME, MS_NODIRATIME),
          std::pair(ST_RELATIME, MS_RELATIME)})
        if (info.f_flag & has) flags |= flag;
    return flags;
}

/// `opened` at `target`, to be read only.
bool bind(int opened, const std::string& target) {
    struct stat info {};
    if (::fstat(opened, &info) != 0) return false;
    std::error_code error;
    if (S_ISDIR(info.st_mode)) {
        fs::create_directories(target, error);
    } else {
        fs::create_directories(fs::path(target).parent_path(), error);
        if (!fs::exists(target, error)) std::ofstream(target).flush();
    }
    const std::string source = "/proc/self/fd/" + std::to_string(opened);
    if (::mount(source.c_str(), target.c_str(), nullptr, MS_BIND | MS_REC, nullptr) != 0) return false;
    return ::mount(nullptr, target.c_str(), nullptr, MS_REMOUNT | MS_BIND | MS_RDONLY | flagsOf(target),
                   nullptr) == 0;
}

struct Opened {
    std::string path;
    UniqueFd fd;
};

/// Before anything is laid over them.
std::vector<Opened> openAll(const AllowedFiles& files) {
    std::vector<Opened> all;
    for (const auto* list : {&files.readable, &files.executable})
        for (const std::string& path : *list) {
            const bool ofProcesses = path.starts_with("/proc/");  // that comes as a whole
            UniqueFd fd(ofProcesses ? -1 : ::open(path.c_str(), O_PATH | O_CLOEXEC));
            if (fd) all.push_back({path, std::move(fd)});
        }
    all.push_back({"/proc", UniqueFd(::open("/proc", O_PATH | O_CLOEXEC))});
    return all;
}

/// The same by its name: what was opened outside cannot be laid into the small tree.
Expected<UniqueFd> openAgain(int scan) {
    std::error_code error;
    const fs::path path = fs::read_symlink("/proc/self/fd/" + std::to_string(scan), error);
    UniqueFd again(::open(path.c_str(), O_PATH | O_CLOEXEC | O_NOFOLLOW));
    struct stat one {
    }, other{};
    if (!again || ::fstat(again.get(), &one) != 0 || ::fstat(scan, &other) != 0 ||
        one.st_dev != other.st_dev || one.st_ino != other.st_ino)
        return fail(ErrorCode::Io, "the scan is not where it was any more");
    return again;
}

Expected<void> fill(const std::vector<Opened>& all, int scan) {
    for (const auto& [path, fd] : all)
        if (!bind(fd.get(), where + path)) return notAllowed("to mount " + path);
    if (scan >= 0 && !bind(scan, std::string(where) + scanName)) return notAllowed("to mount the scan");
    if (::mount(nullptr, where, nullptr, MS_REMOUNT | MS_BIND | MS_RDONLY | flagsOf(where), nullptr) != 0)
        return notAllowed("to mount for reading only");
    return {};
}

Expected<void> become(int scan) {
    if (::chdir(where) != 0 || ::syscall(SYS_pivot_root, ".", ".") != 0 || ::umount2(".", MNT_DETACH) != 0 ||
        ::chdir("/") != 0)
        return notAllowed("to leave the machine's files");
    if (scan < 0) return {};
    const UniqueFd inside(::open(scanName, O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    if (!inside || ::dup2(inside.get(), scan) < 0)
        return fail(ErrorCode::Io, "the scan cannot be opened: " + systemReason(errno));
    return {};
}

}  // namespace

Expected<void> enterSmallRoot(const AllowedFiles& files, int scan) {
    if (auto ok = separate(); !ok) return ok;
    if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return notAllowed("mounts");
    UniqueFd again;
    if (scan >= 0) {
        auto opened = openAgain(scan);
        if (!opened) return passOn(opened);
        again = std::move(*opened);
    }
    const auto all = openAll(files);
    if (::mount("tmpfs", where, "tmpfs", MS_NOSUID | MS_NODEV, "size=1m,mode=755") != 0)
        return notAllowed("mounts");
    if (auto filled = fill(all, again.get()); !filled) {
        ::umount2(where, MNT_DETACH);
        return filled;
    }
    return become(again ? scan : -1);
}

}  // namespace scancast::sandbox
