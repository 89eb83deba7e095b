#include "tests/support/system_faults.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdarg>
#include <ctime>
#include <filesystem>
#include <tuple>
#include <utility>

#include "tests/support/failing_allocation.hpp"

namespace scancast::test {
namespace {

constexpr std::size_t mostFaults = 8;

struct Armed {
    std::atomic<bool> on{false};
    std::atomic<bool> dead{false};  // nothing changes a file any more
    std::atomic<bool> othersOnly{false};
    std::atomic<pthread_t> owner{};
    std::array<Fault, mostFaults> faults{};
    std::size_t count = 0;
    std::array<std::atomic<std::uint64_t>, callKinds> calls{};
    std::array<std::atomic<bool>, mostFaults> done{};
    std::atomic<long long> secondsOff{0};
};
Armed armed;
std::optional<FailingAllocation>& allocation() {
    static std::optional<FailingAllocation> one;
    return one;
}

constexpr std::array<std::string_view, callKinds> kindNames{
    "open", "read", "write", "sync", "rename", "truncate", "lock", "status",  "duplicate",
    "map",  "pipe", "spawn", "poll", "accept", "receive",  "send", "allocate"};

constexpr std::array<std::pair<std::string_view, int>, 14> errorNames{{{"EIO", EIO},
                                                                       {"ENOSPC", ENOSPC},
                                                                       {"EMFILE", EMFILE},
                                                                       {"EINTR", EINTR},
                                                                       {"ENOENT", ENOENT},
                                                                       {"EACCES", EACCES},
                                                                       {"ENOMEM", ENOMEM},
                                                                       {"EAGAIN", EAGAIN},
                                                                       {"ECONNRESET", ECONNRESET},
                                                                       {"EPIPE", EPIPE},
                                                                       {"ENOBUFS", ENOBUFS},
                                                                       {"ECONNABORTED", ECONNABORTED},
                                                                       {"ENOLCK", ENOLCK},
                                                                       {"EDQUOT", EDQUOT}}};

/// What the call that is being made is to do.
struct Fate {
    int error = 0;  // 0 = it is made
    bool half = false;
    bool kills = false;  // while it is made
};

bool concerns() {
    return armed.on && !(armed.othersOnly && pthread_self() == armed.owner);
}

Fate fateOf(Call call) {
    if (!concerns()) return {};
    const std::uint64_t now = ++armed.calls[std::size_t(call)];
    Fate fate;
    for (std::size_t i = 0; i < armed.count; ++i) {
        const Fault& fault = armed.faults[i];
        if (fault.call != call || now < fault.nth) continue;
        const bool stays = fault.effect == Fault::Effect::Stays;
        if (now > fault.nth && !stays) continue;
        armed.done[i] = true;
        switch (fault.effect) {
            case Fault::Effect::Fails:
            case Fault::Effect::Stays:
                fate.error = fault.error;
                break;
            case Fault::Effect::Short:
                fate.half = true;
                break;
            case Fault::Effect::Kills:
                fate.kills = true;
                fate.error = call == Call::Rename ? EIO : 0;
                armed.dead = true;
                break;
            case Fault::Effect::Jumps:
                armed.secondsOff = static_cast<long long>(fault.error) * 86'400;
                break;
        }
    }
    return fate;
}

/// As fateOf(), of what changes a file: the dead do no more of that. Of the write that kills, half is made.
Fate fateOfChange(Call call) {
    if (concerns() && armed.dead) return {.error = EIO};
    return fateOf(call);
}

/// As much of a write as gets to the disk before the power goes: half, and whole sectors, which disks write whole.
std::size_t torn(std::size_t bytes, off_t at) {
    constexpr off_t sector = 512;
    const off_t end = (at + off_t(bytes) / 2) / sector * sector;
    return end > at ? std::size_t(end - at) : 0;
}

std::size_t some(std::size_t bytes, const Fate& fate) {
    return fate.half && bytes > 1 ? bytes / 2 : bytes;
}

template <class Result>
Result refused(const Fate& fate) {
    errno = fate.error;
    return Result(-1);
}

}  // namespace

std::string nameOf(const std::vector<Fault>& faults) {
    std::string all;
    for (const Fault& fault : faults) {
        if (!all.empty()) all += ',';
        all += std::string(kindNames[std::size_t(fault.call)]) + ':' + std::to_string(fault.nth);
        if (fault.effect == Fault::Effect::Short) all += ":short";
        if (fault.effect == Fault::Effect::Kills) all += ":kill";
        if (fault.effect == Fault::Effect::Jumps) all += ":jump" + std::to_string(fault.error);
        const bool fails = fault.effect == Fault::Effect::Fails || fault.effect == Fault::Effect::Stays;
        if (!fails || fault.call == Call::Allocate) continue;
        const auto* name =
            std::ranges::find(errorNames, fault.error, &std::pair<std::string_view, int>::second);
        all += ':' + (name == errorNames.end() ? std::to_string(fault.error) : std::string(name->first));
        if (fault.effect == Fault::Effect::Stays) all += '+';
    }
    return all;
}

namespace {

template <class Number>
bool readNumber(std::string_view text, Number& value) {
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    return read.ec == std::errc() && read.ptr == text.data() + text.size();
}

std::optional<Fault> parseFault(std::string_view text) {
    const auto colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto* kind = std::ranges::find(kindNames, text.substr(0, colon));
    if (kind == kindNames.end()) return std::nullopt;
    Fault fault{.call = Call(kind - kindNames.begin())};
    text.remove_prefix(colon + 1);
    const auto end = std::min(text.find(':'), text.size());
    if (!readNumber(text.substr(0, end), fault.nth) || fault.nth == 0) return std::nullopt;
    if (fault.call == Call::Allocate) return end == text.size() ? std::optional(fault) : std::nullopt;
    if (end == text.size()) return std::nullopt;
    std::string_view effect = text.substr(end + 1);
    if (effect == "short") {
        fault.effect = Fault::Effect::Short;
        return fault;
    }
    if (effect == "kill") {
        fault.effect = Fault::Effect::Kills;
        return fault;
    }
    if (effect.starts_with("jump")) {
        fault.effect = Fault::Effect::Jumps;
        return readNumber(effect.substr(4), fault.error) ? std::optional(fault) : std::nullopt;
    }
    if (effect.ends_with('+')) {
        fault.effect = Fault::Effect::Stays;
        effect.remove_suffix(1);
    }
    const auto* error = std::ranges::find(errorNames, effect, &std::pair<std::string_view, int>::first);
    if (error == errorNames.end()) return std::nullopt;
    fault.error = error->second;
    return fault;
}

}  // namespace

std::optional<std::vector<Fault>> parseFaults(std::string_view text) {
    std::vector<Fault> faults;
    while (!text.empty()) {
        const auto end = std::min(text.find(','), text.size());
        const auto fault = parseFault(text.substr(0, end));
        if (!fault) return std::nullopt;
        faults.push_back(*fault);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return faults;
}

Faults::Faults(const std::vector<Fault>& faults, Whose whose, std::size_t leastAllocation) {
    armed.count = std::min(faults.size(), mostFaults);
    for (std::size_t i = 0; i < armed.count; ++i) armed.faults[i] = faults[i];
    for (auto& calls : armed.calls) calls = 0;
    for (auto& done : armed.done) done = false;
    armed.dead = false;
    armed.secondsOff = 0;
    armed.othersOnly = whose == Whose::OtherThreads;
    armed.owner = pthread_self();
    armed.on = true;
    std::uint64_t failing = 0;
    for (const Fault& fault : faults)
        if (fault.call == Call::Allocate) failing = fault.nth;
    allocation().emplace(failing, leastAllocation, whose == Whose::OtherThreads);
}

Faults::~Faults() {
    allocation().reset();
    armed.on = false;
    armed.secondsOff = 0;
}

int Faults::happened() const {
    int sum = allocation()->happened() ? 1 : 0;
    for (std::size_t i = 0; i < armed.count; ++i) sum += armed.done[i] ? 1 : 0;
    return sum;
}

std::uint64_t Faults::calls(Call call) const {
    return call == Call::Allocate ? allocation()->calls() : armed.calls[std::size_t(call)].load();
}

std::size_t openDescriptors() {
    return std::size_t(std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {})) - 1;
}

/// Only who may make a file gives a mode (open(2)). O_TMPFILE has the bit of O_DIRECTORY, so all of its bits are asked for.
mode_t modeOf(int flags, va_list arguments) {
    const bool given = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
    return given ? mode_t(va_arg(arguments, int)) : 0;
}

}  // namespace scancast::test

// What the linker calls instead: `__wrap_NAME`, with the real one as `__real_NAME`.
// NOLINTBEGIN(bugprone-reserved-identifier): the names are the linker's
using scancast::test::Call;
using scancast::test::Fate;
using scancast::test::fateOf;
using scancast::test::fateOfChange;
using scancast::test::modeOf;
using scancast::test::refused;
using scancast::test::some;
using scancast::test::torn;

extern "C" {

int __real_open(const char* path, int flags, ...);
int __wrap_open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = modeOf(flags, arguments);
    va_end(arguments);
    const Fate fate = (flags & (O_CREAT | O_TRUNC)) != 0 ? fateOfChange(Call::Open) : fateOf(Call::Open);
    return fate.error != 0 ? refused<int>(fate) : __real_open(path, flags, mode);
}

int __real_openat(int folder, const char* path, int flags, ...);
int __wrap_openat(int folder, const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = modeOf(flags, arguments);
    va_end(arguments);
    const Fate fate = (flags & O_CREAT) != 0 ? fateOfChange(Call::Open) : fateOf(Call::Open);
    return fate.error != 0 ? refused<int>(fate) : __real_openat(folder, path, flags, mode);
}

int __real_mkostemp(char* pattern, int flags);
int __wrap_mkostemp(char* pattern, int flags) {
    const Fate fate = fateOfChange(Call::Open);
    return fate.error != 0 ? refused<int>(fate) : __real_mkostemp(pattern, flags);
}

ssize_t __real_read(int fd, void* into, std::size_t bytes);
ssize_t __wrap_read(int fd, void* into, std::size_t bytes) {
    const Fate fate = fateOf(Call::Read);
    return fate.error != 0 ? refused<ssize_t>(fate) : __real_read(fd, into, some(bytes, fate));
}

ssize_t __real_pread(int fd, void* into, std::size_t bytes, off_t at);
ssize_t __wrap_pread(int fd, void* into, std::size_t bytes, off_t at) {
    const Fate fate = fateOf(Call::Read);
    return fate.error != 0 ? refused<ssize_t>(fate) : __real_pread(fd, into, some(bytes, fate), at);
}

ssize_t __real_write(int fd, const void* from, std::size_t bytes);
ssize_t __wrap_write(int fd, const void* from, std::size_t bytes) {
    const Fate fate = fateOfChange(Call::Write);
    if (fate.error != 0) return refused<ssize_t>(fate);
    if (!fate.kills) return __real_write(fd, from, some(bytes, fate));
    std::ignore = __real_write(fd, from, torn(bytes, ::lseek(fd, 0, SEEK_CUR)));
    return refused<ssize_t>({.error = EIO});
}

ssize_t __real_pwrite(int fd, const void* from, std::size_t bytes, off_t at);
ssize_t __wrap_pwrite(int fd, const void* from, std::size_t bytes, off_t at) {
    const Fate fate = fateOfChange(Call::Write);
    if (fate.error != 0) return refused<ssize_t>(fate);
    if (!fate.kills) return __real_pwrite(fd, from, some(bytes, fate), at);
    std::ignore = __real_pwrite(fd, from, torn(bytes, at), at);
    return refused<ssize_t>({.error = EIO});
}

int __wrap_fsync(int) {
    const Fate fate = fateOfChange(Call::Sync);
    // Nothing here loses its power: a file that is really synced only takes its time.
    return fate.error != 0 ? refused<int>(fate) : 0;
}

int __real_rename(const char* from, const char* to);
int __wrap_rename(const char* from, const char* to) {
    const Fate fate = fateOfChange(Call::Rename);
    return fate.error != 0 ? refused<int>(fate) : __real_rename(from, to);
}

// Only the dead do not remove files: what cannot be removed has to stay.
int __real_unlink(const char* path);
int __wrap_unlink(const char* path) {
    if (scancast::test::concerns() && scancast::test::armed.dead) return refused<int>({.error = EIO});
    return __real_unlink(path);
}

int __real_ftruncate(int fd, off_t bytes);
int __wrap_ftruncate(int fd, off_t bytes) {
    const Fate fate = fateOfChange(Call::Truncate);
    return fate.error != 0 ? refused<int>(fate) : __real_ftruncate(fd, bytes);
}

int __real_flock(int fd, int operation);
int __wrap_flock(int fd, int operation) {
    const Fate fate = fateOf(Call::Lock);
    return fate.error != 0 ? refused<int>(fate) : __real_flock(fd, operation);
}

int __real_fstat(int fd, struct stat* into);
int __wrap_fstat(int fd, struct stat* into) {
    const Fate fate = fateOf(Call::Status);
    return fate.error != 0 ? refused<int>(fate) : __real_fstat(fd, into);
}

int __real_stat(const char* path, struct stat* into);
int __wrap_stat(const char* path, struct stat* into) {
    const Fate fate = fateOf(Call::Status);
    return fate.error != 0 ? refused<int>(fate) : __real_stat(path, into);
}

int __real_fcntl(int fd, int command, ...);
int __wrap_fcntl(int fd, int command, ...) {
    va_list arguments;
    va_start(arguments, command);
    void* const argument = va_arg(arguments, void*);
    va_end(arguments);
    const Fate fate = command == F_DUPFD_CLOEXEC ? fateOf(Call::Duplicate) : Fate{};
    return fate.error != 0 ? refused<int>(fate) : __real_fcntl(fd, command, argument);
}

void* __real_mmap(void* at, std::size_t bytes, int protection, int flags, int fd, off_t offset);
void* __wrap_mmap(void* at, std::size_t bytes, int protection, int flags, int fd, off_t offset) {
    const Fate fate = fateOf(Call::Map);
    if (fate.error == 0) return __real_mmap(at, bytes, protection, flags, fd, offset);
    errno = fate.error;
    return MAP_FAILED;
}

int __real_pipe2(int* ends, int flags);
int __wrap_pipe2(int* ends, int flags) {
    const Fate fate = fateOf(Call::Pipe);
    return fate.error != 0 ? refused<int>(fate) : __real_pipe2(ends, flags);
}

int __real_posix_spawn(pid_t* pid, const char* path, const posix_spawn_file_actions_t* actions,
                       const posix_spawnattr_t* attributes, char* const* arguments, char* const* environment);
int __wrap_posix_spawn(pid_t* pid, const char* path, const posix_spawn_file_actions_t* actions,
                       const posix_spawnattr_t* attributes, char* const* arguments,
                       char* const* environment) {
    const Fate fate = fateOf(Call::Spawn);
    return fate.error != 0 ? fate.error
                           : __real_posix_spawn(pid, path, actions, attributes, arguments, environment);
}

int __real_poll(pollfd* ends, nfds_t count, int milliseconds);
int __wrap_poll(pollfd* ends, nfds_t count, int milliseconds) {
    const Fate fate = fateOf(Call::Poll);
    return fate.error != 0 ? refused<int>(fate) : __real_poll(ends, count, milliseconds);
}

int __real_accept(int fd, sockaddr* address, socklen_t* length);
int __wrap_accept(int fd, sockaddr* address, socklen_t* length) {
    const Fate fate = fateOf(Call::Accept);
    // Whoever gave up before he was let in is gone; all other refusals leave him waiting.
    if (fate.error == ECONNABORTED) {
        const int gone = __real_accept(fd, address, length);
        if (gone >= 0) ::close(gone);
        return refused<int>({.error = gone >= 0 ? ECONNABORTED : EAGAIN});
    }
    return fate.error != 0 ? refused<int>(fate) : __real_accept(fd, address, length);
}

/// A message with half of its bytes: of its first piece.
static msghdr firstHalf(const msghdr& message, iovec& piece) {
    msghdr part = message;
    piece = message.msg_iov[0];
    piece.iov_len = std::max<std::size_t>(1, piece.iov_len / 2);
    part.msg_iov = &piece;
    part.msg_iovlen = 1;
    return part;
}

ssize_t __real_recv(int fd, void* into, std::size_t bytes, int flags);
ssize_t __wrap_recv(int fd, void* into, std::size_t bytes, int flags) {
    const Fate fate = fateOf(Call::Receive);
    return fate.error != 0 ? refused<ssize_t>(fate) : __real_recv(fd, into, some(bytes, fate), flags);
}

ssize_t __real_recvmsg(int fd, msghdr* message, int flags);
ssize_t __wrap_recvmsg(int fd, msghdr* message, int flags) {
    const Fate fate = fateOf(Call::Receive);
    if (fate.error != 0) return refused<ssize_t>(fate);
    iovec piece{};
    if (!fate.half || message->msg_iovlen == 0) return __real_recvmsg(fd, message, flags);
    msghdr part = firstHalf(*message, piece);
    return __real_recvmsg(fd, &part, flags);
}

ssize_t __real_send(int fd, const void* from, std::size_t bytes, int flags);
ssize_t __wrap_send(int fd, const void* from, std::size_t bytes, int flags) {
    const Fate fate = fateOf(Call::Send);
    return fate.error != 0 ? refused<ssize_t>(fate) : __real_send(fd, from, some(bytes, fate), flags);
}

ssize_t __real_sendmsg(int fd, const msghdr* message, int flags);
ssize_t __wrap_sendmsg(int fd, const msghdr* message, int flags) {
    const Fate fate = fateOf(Call::Send);
    if (fate.error != 0) return refused<ssize_t>(fate);
    iovec piece{};
    if (!fate.half || message->msg_iovlen == 0) return __real_sendmsg(fd, message, flags);
    const msghdr part = firstHalf(*message, piece);
    return __real_sendmsg(fd, &part, flags);
}

/// std::chrono::system_clock::now(), as libstdc++ spells it: nanoseconds since 1970.
long long __real__ZNSt6chrono3_V212system_clock3nowEv();
long long __wrap__ZNSt6chrono3_V212system_clock3nowEv() {
    return __real__ZNSt6chrono3_V212system_clock3nowEv() + scancast::test::armed.secondsOff * 1'000'000'000LL;
}
}
// NOLINTEND(bugprone-reserved-identifier)
