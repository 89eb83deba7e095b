#include "importers/sandbox/landlock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "files/system_error.hpp"
#include "files/unique_fd.hpp"

namespace scancast::sandbox {
namespace {

// Written out, because the headers of Debian 12 are older than the kernels that this runs on. The numbers are the
// same on every architecture.
constexpr long createRuleset = 444, addRule = 445, restrictSelf = 446;
constexpr unsigned askVersion = 1;
constexpr int pathBeneath = 1;

constexpr std::uint64_t execute = 1 << 0, writeFile = 1 << 1, readFile = 1 << 2, readFolder = 1 << 3;
constexpr std::uint64_t firstVersion = (1 << 13) - 1;  // the above, and removing and making of every kind
constexpr std::uint64_t refer = 1 << 13, truncate = 1 << 14, deviceControl = 1 << 15;
constexpr std::uint64_t bindTcp = 1 << 0, connectTcp = 1 << 1;
constexpr std::uint64_t abstractSockets = 1 << 0, signals = 1 << 1;

struct Ruleset {
    std::uint64_t files, network, scoped;
};
struct __attribute__((packed)) Rule {
    std::uint64_t allowed;
    std::int32_t parent;
};

/// What is not named here is not taken away: a kernel refuses what it does not know.
Ruleset everythingOf(int version) {
    Ruleset all{firstVersion, 0, 0};
    if (version >= 2) all.files |= refer;
    if (version >= 3) all.files |= truncate;
    if (version >= 4) all.network = bindTcp | connectTcp;
    if (version >= 5) all.files |= deviceControl;
    if (version >= 6) all.scoped = abstractSockets | signals;
    return all;
}

std::size_t sizeOf(int version) {
    return version >= 6 ? sizeof(Ruleset) : version >= 4 ? 16 : 8;
}

Expected<void> notGranted(const std::string& what) {
    return fail(ErrorCode::Io, "Landlock refuses " + what + ": " + systemReason(errno));
}

/// What is not there cannot be opened either.
Expected<void> allow(int rules, int opened, std::uint64_t rights) {
    struct stat info {};
    if (::fstat(opened, &info) != 0) return notGranted("a file");
    if (!S_ISDIR(info.st_mode)) rights &= ~readFolder;
    Rule rule{rights, opened};
    if (::syscall(addRule, rules, pathBeneath, &rule, 0) != 0) return notGranted("a rule");
    return {};
}

Expected<void> allow(int rules, const std::string& path, std::uint64_t rights) {
    const UniqueFd opened(::open(path.c_str(), O_PATH | O_CLOEXEC));
    if (!opened) return {};
    return allow(rules, opened.get(), rights);
}

}  // namespace

int landlockVersion() {
    const long version = ::syscall(createRuleset, nullptr, 0, askVersion);
    return version > 0 ? int(version) : 0;
}

Expected<void> shutByLandlock(const AllowedFiles& files, int scan) {
    const int version = landlockVersion();
    if (version == 0) return fail(ErrorCode::Unsupported, "this kernel has no Landlock");
    const Ruleset all = everythingOf(version);
    const UniqueFd rules(int(::syscall(createRuleset, &all, sizeOf(version), 0)));
    if (!rules) return notGranted("its rules");
    for (const std::string& path : files.readable)
        if (auto ok = allow(rules.get(), path, readFile | readFolder); !ok) return ok;
    for (const std::string& path : files.executable)
        if (auto ok = allow(rules.get(), path, readFile | execute); !ok) return ok;
    if (auto ok = allow(rules.get(), "/dev/null", readFile | writeFile); !ok) return ok;
    if (scan >= 0)
        if (auto ok = allow(rules.get(), scan, readFile | readFolder); !ok) return ok;
    if (::syscall(restrictSelf, rules.get(), 0) != 0) return notGranted("to shut");
    return {};
}

}  // namespace scancast::sandbox
