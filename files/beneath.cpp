#include "files/beneath.hpp"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <deque>
#include <string>
#include <vector>

#include "files/input_file.hpp"

namespace scancast {

namespace {

constexpr int mostLinks = 40;  // as many as the kernel follows
constexpr int mostAttempts = 64;

UniqueFd openAt(int folder, const std::string& name, int flags) {
    for (;;) {
        UniqueFd fd(::openat(folder, name.c_str(), flags | O_CLOEXEC | O_NOFOLLOW));
        if (fd || errno != EINTR) return fd;
    }
}

/// The way down from the folder, one component after the other.
class Descent {
  public:
    Descent(int folder, const std::filesystem::path& name) : folder_(folder) { putBefore(name); }

    OpenedBeneath open() {
        while (!ahead_.empty()) {
            const std::string name = std::move(ahead_.front());
            ahead_.pop_front();
            if (name.empty() || name == ".") continue;  // what stands before them was opened as a folder
            if (name == "..") {
                if (path_.empty()) return tl::unexpected(EXDEV);
                path_.pop_back();
                continue;
            }
            if (const int error = followLink(name); error == 0)
                continue;
            else if (error != EINVAL)
                return tl::unexpected(error);
            if (ahead_.empty()) return opened(name, inputFlags);
            auto next = opened(name, O_PATH | O_DIRECTORY);
            if (!next) return next;
            path_.push_back(std::move(*next));
        }
        return opened(".", inputFlags);
    }

  private:
    int here() const { return path_.empty() ? folder_ : path_.back().get(); }

    void putBefore(const std::filesystem::path& name) {
        std::vector<std::string> components;
        for (const auto& component : name) components.push_back(component.string());
        ahead_.insert(ahead_.begin(), components.begin(), components.end());
    }

    /// 0 when `name` is a link, whose components are ahead now; EINVAL when it is none.
    int followLink(const std::string& name) {
        std::array<char, PATH_MAX> target{};
        const auto length = ::readlinkat(here(), name.c_str(), target.data(), target.size());
        if (length < 0) return errno;
        if (++links_ > mostLinks) return ELOOP;
        const std::filesystem::path leads(std::string(target.data(), static_cast<std::size_t>(length)));
        if (leads.empty()) return ENOENT;
        if (leads.is_absolute()) return EXDEV;
        putBefore(leads);
        return 0;
    }

    OpenedBeneath opened(const std::string& name, int flags) const {
        auto fd = openAt(here(), name, flags);
        if (!fd) return tl::unexpected(errno);
        return fd;
    }

    const int folder_;
    std::vector<UniqueFd> path_;  ///< the folders on the way from folder_ down to here
    std::deque<std::string> ahead_;
    int links_ = 0;
};

/// 0, or why the name can be none.
int faultOf(const std::filesystem::path& name) {
    const std::string& text = name.native();
    if (text.empty() || text.find('\0') != std::string::npos) return ENOENT;
    return name.is_absolute() ? EXDEV : 0;
}

}  // namespace

OpenedBeneath openBeneathByKernel(int folder, const std::filesystem::path& name) {
    if (const int fault = faultOf(name); fault != 0) return tl::unexpected(fault);
    open_how how{};
    how.flags = static_cast<std::uint64_t>(inputFlags);
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
    for (int attempt = 0;; ++attempt) {
        // The C library has no wrapper for it.
        UniqueFd fd(static_cast<int>(::syscall(SYS_openat2, folder, name.c_str(), &how, sizeof how)));
        if (fd) return fd;
        // EAGAIN: something was renamed just now, and it cannot tell any more whether ".." stays beneath.
        const bool again = errno == EINTR || (errno == EAGAIN && attempt < mostAttempts);
        if (!again) return tl::unexpected(errno);
    }
}

OpenedBeneath openBeneathByHand(int folder, const std::filesystem::path& name) {
    if (const int fault = faultOf(name); fault != 0) return tl::unexpected(fault);
    return Descent(folder, name).open();
}

OpenedBeneath openBeneath(int folder, const std::filesystem::path& name) {
    auto opened = openBeneathByKernel(folder, name);
    const bool unknown = !opened && (opened.error() == ENOSYS || opened.error() == EPERM);
    return unknown ? openBeneathByHand(folder, name) : std::move(opened);
}

}  // namespace scancast
