#include "importers/sandbox/privileges.hpp"

#include <grp.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "files/system_error.hpp"

namespace scancast::sandbox {
namespace {

constexpr int mostCapabilities = 64;
constexpr uid_t nobody = 65534;
constexpr rlim_t mostDescriptors = 1024;
constexpr rlim_t secondsToDie = 5;  // between SIGXCPU, which says why, and SIGKILL

/// `grace`: so much later the kernel does not ask any more.
void limitTo(decltype(RLIMIT_CPU) what, rlim_t most, rlim_t grace = 0) {
    rlimit limit{};
    rlim_t hardest = most + grace;
    if (::getrlimit(what, &limit) == 0 && limit.rlim_max != RLIM_INFINITY)
        hardest = std::min(hardest, limit.rlim_max);
    limit = {std::min(most, hardest), hardest};
    ::setrlimit(what, &limit);
}

}  // namespace

Expected<void> dieWith(pid_t parent) {
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        return fail(ErrorCode::Io, "the kernel refuses to end it with the server: " + systemReason(errno));
    // It may have ended before: then nobody would ever tell.
    if (::getppid() != parent) return fail(ErrorCode::Cancelled, "who started it is gone");
    return {};
}

Expected<void> renouncePrivileges() {
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
        return fail(ErrorCode::Io, "the kernel refuses to keep privileges from it: " + systemReason(errno));
    return {};
}

// Who has none to begin with is refused, and has none in the end.
void dropCapabilities(bool readsAll) {
    readsAll = readsAll && ::geteuid() == 0;
    for (int one = 0; one < mostCapabilities; ++one)
        if (!(readsAll && one == CAP_DAC_READ_SEARCH)) ::prctl(PR_CAPBSET_DROP, one, 0, 0, 0);
    ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> kept{};
    if (readsAll) kept[0].permitted = kept[0].effective = 1U << CAP_DAC_READ_SEARCH;
    if (::syscall(SYS_capset, &header, kept.data()) != 0 && readsAll) {
        kept = {};
        ::syscall(SYS_capset, &header, kept.data());
    }
}

Expected<void> becomeNobody() {
    if (::geteuid() != 0)
        return fail(ErrorCode::Unsupported, "only the superuser could make it another user's");
    if (::setgroups(0, nullptr) != 0 || ::setresgid(nobody, nobody, nobody) != 0 ||
        ::setresuid(nobody, nobody, nobody) != 0)
        return fail(ErrorCode::Io, "the kernel refuses to make it another user's: " + systemReason(errno));
    // Whose it becomes has changed, which takes this away.
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        return fail(ErrorCode::Io, "the kernel refuses to end it with the server: " + systemReason(errno));
    return {};
}

void setLimits(const Limits& limits) {
    limitTo(RLIMIT_CORE, 0);
    if (limits.processorSeconds > 0) limitTo(RLIMIT_CPU, limits.processorSeconds, secondsToDie);
    if (limits.writesNothing) {
        limitTo(RLIMIT_FSIZE, 0);
        limitTo(RLIMIT_NOFILE, mostDescriptors);
    }
    if (limits.addressKib > 0) limitTo(RLIMIT_AS, limits.addressKib * 1024);
}

}  // namespace scancast::sandbox
