#include "importers/sandbox/system_calls.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "files/system_error.hpp"

namespace scancast::sandbox {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
constexpr std::uint32_t firstForeignCall = 0x40000000;  // those of x32, which count anew
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
constexpr std::uint32_t firstForeignCall = 0xffffffff;
#else
#error "system_calls.cpp: say which architecture's numbers these are"
#endif

// The leak sanitizer looks at a program's threads with a process that traces them.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool lookedAtBySanitizer = true;
#else
constexpr bool lookedAtBySanitizer = false;
#endif

// Younger than Debian 12's headers, or left out of them; the numbers are the same on every architecture.
constexpr long fchmodat2 = 452, mountSetattr = 442, statmount = 457, listmount = 458, setxattrat = 463,
               openTreeAttr = 467;
static_assert(mountSetattr == SYS_mount_setattr);

constexpr std::uint32_t refused = SECCOMP_RET_ERRNO | EPERM;
constexpr std::uint32_t unknown = SECCOMP_RET_ERRNO | ENOSYS;

/// Libraries may try these and go on without.
constexpr long refusedCalls[] = {
    // The network, and sockets of any kind; rings, by which all of it could be asked past this filter.
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_io_uring_setup,
    SYS_io_uring_enter,
    SYS_io_uring_register,
    // Other processes, and groups in which it would not be found.
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_process_madvise,
    SYS_kcmp,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_tkill,
    SYS_setsid,
    SYS_setpgid,
    SYS_execveat,
    SYS_setpriority,
    SYS_ioprio_set,
    SYS_sched_setaffinity,
    SYS_sched_setscheduler,
    SYS_sched_setparam,
    SYS_sched_setattr,
    SYS_migrate_pages,
    SYS_move_pages,
    // Memory that is a file, which could be executed.
    SYS_memfd_create,
    SYS_memfd_secret,
    SYS_userfaultfd,
    // Another view of the files, or of the machine.
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_unshare,
    SYS_setns,
    SYS_open_tree,
    SYS_move_mount,
    SYS_fsopen,
    SYS_fsconfig,
    SYS_fsmount,
    SYS_fspick,
    SYS_mount_setattr,
    SYS_name_to_handle_at,
    SYS_open_by_handle_at,
    SYS_fanotify_init,
    SYS_quotactl,
    SYS_quotactl_fd,
    openTreeAttr,
    statmount,
    listmount,
    // Keys.
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    // Whose files are.
    SYS_fchown,
    SYS_fchownat,
    SYS_fchmod,
    SYS_fchmodat,
    fchmodat2,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    setxattrat,
    SYS_utimensat,
    // Who it is.
    SYS_setuid,
    SYS_setgid,
    SYS_setreuid,
    SYS_setregid,
    SYS_setresuid,
    SYS_setresgid,
    SYS_setgroups,
    SYS_setfsuid,
    SYS_setfsgid,
    SYS_capset,
    // Queues and memory by names that others know, too.
    SYS_mq_open,
    SYS_mq_unlink,
    SYS_msgget,
    SYS_semget,
    SYS_shmget,
    // The machine.
    SYS_acct,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_clock_adjtime,
    SYS_adjtimex,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_syslog,
    SYS_swapon,
    SYS_swapoff,
    SYS_vhangup,
    SYS_perf_event_open,
#if defined(__x86_64__)
    SYS_chown,
    SYS_lchown,
    SYS_chmod,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
#endif
};

/// Nothing of these happens by mistake.
constexpr long deadlyCalls[] = {
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_bpf,
    SYS_reboot,
#if defined(SYS_kexec_file_load)
    SYS_kexec_file_load,
#endif
#if defined(__x86_64__)
    SYS_iopl,
    SYS_ioperm,
#endif
};

class Filter {
  public:
    Filter() {
        load(offsetof(seccomp_data, arch));
        unless(BPF_JEQ, architecture, SECCOMP_RET_KILL_PROCESS);
        load(offsetof(seccomp_data, nr));
        when(BPF_JGE, firstForeignCall, SECCOMP_RET_KILL_PROCESS);
    }
    void answer(long call, std::uint32_t action) { when(BPF_JEQ, std::uint32_t(call), action); }
    /// Refused unless the low half of argument `n` is `value`.
    void onlyWith(long call, int n, std::uint32_t value) {
        check(call, n, [&] { unless(BPF_JEQ, value, refused); });
    }
    void neverWith(long call, int n, std::uint32_t value) {
        check(call, n, [&] { when(BPF_JEQ, value, refused); });
    }
    void onlyWithBits(long call, int n, std::uint32_t bits) {
        check(call, n, [&] { unless(BPF_JSET, bits, refused); });
    }
    void neverWithBits(long call, int n, std::uint32_t bits) {
        check(call, n, [&] { when(BPF_JSET, bits, refused); });
    }
    std::vector<sock_filter> finish() {
        add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
        return std::move(program_);
    }

  private:
    void add(std::uint16_t code, std::uint32_t k, std::uint8_t yes = 0, std::uint8_t no = 0) {
        program_.push_back({code, yes, no, k});
    }
    void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, std::uint32_t(offset)); }
    void when(std::uint16_t test, std::uint32_t value, std::uint32_t action) {
        add(std::uint16_t(BPF_JMP | test | BPF_K), value, 0, 1);
        add(BPF_RET | BPF_K, action);
    }
    void unless(std::uint16_t test, std::uint32_t value, std::uint32_t action) {
        add(std::uint16_t(BPF_JMP | test | BPF_K), value, 1, 0);
        add(BPF_RET | BPF_K, action);
    }
    template <class Checks>
    void check(long call, int n, const Checks& checks) {
        const std::size_t jump = program_.size();
        add(BPF_JMP | BPF_JEQ | BPF_K, std::uint32_t(call));
        load(offsetof(seccomp_data, args) +
             std::size_t(n) * sizeof(std::uint64_t));  // little-endian: the low half
        checks();
        load(offsetof(seccomp_data, nr));
        program_[jump].jf = std::uint8_t(program_.size() - jump - 1);
    }

    std::vector<sock_filter> program_;
};

std::vector<sock_filter> filter() {
    Filter filter;
    for (const long call : refusedCalls) filter.answer(call, refused);
    for (const long call : deadlyCalls) filter.answer(call, SECCOMP_RET_KILL_PROCESS);
    // Itself only. The number stays when this process becomes the importer.
    const auto self = std::uint32_t(::getpid());
    for (const long call : {SYS_kill, SYS_tgkill, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo})
        filter.onlyWith(call, 0, self);
    filter.onlyWith(SYS_prlimit64, 0, 0);  // 0 is itself, too
    filter.answer(SYS_clone3,
                  unknown);  // says what it wants in memory, which no filter sees; libraries then use clone
    if (!lookedAtBySanitizer) {
        filter.answer(SYS_ptrace, refused);
        filter.onlyWithBits(SYS_clone, 0, CLONE_THREAD);  // threads, and no process
#if defined(__x86_64__)
        filter.answer(SYS_fork, refused);
        filter.answer(SYS_vfork, refused);
#endif
    }
    filter.neverWithBits(SYS_clone, 0,
                         std::uint32_t(CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC |
                                       CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET));
    filter.neverWith(SYS_prctl, 0, PR_SET_PDEATHSIG);  // it dies with the server
    filter.neverWith(SYS_ioctl, 1, TIOCSTI);           // no words into a terminal
    return filter.finish();
}

}  // namespace

bool filtersSystemCalls() {
    const std::uint32_t action = SECCOMP_RET_KILL_PROCESS;
    return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

Expected<void> refuseSystemCalls() {
    if (!filtersSystemCalls())
        return fail(ErrorCode::Unsupported, "this kernel has no filter of system calls (seccomp)");
    auto instructions = filter();
    const sock_fprog program{static_cast<unsigned short>(instructions.size()), instructions.data()};
    if (::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) != 0)
        return fail(ErrorCode::Io, "the kernel refuses the filter of system calls: " + systemReason(errno));
    return {};
}

}  // namespace scancast::sandbox
