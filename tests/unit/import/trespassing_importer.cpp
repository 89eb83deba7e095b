// An importer that tries what importers must not do, as its file says: a word, and what it is about. Where it is kept from it, it sends a sound scan; where
// it is not, it ends with exit status 20.
#include <dirent.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace {

using Attempt = std::function<bool(const std::string& about)>;  ///< whether it could

bool opens(const std::string& path, int how) {
    return ::open(path.c_str(), how | O_NONBLOCK, 0600) >= 0;
}
pid_t number(const std::string& text) {
    return pid_t(std::stol(text));
}

const std::map<std::string, Attempt> attempts{
    {"read", [](const std::string& path) { return opens(path, O_RDONLY); }},
    {"list", [](const std::string& path) { return ::opendir(path.c_str()) != nullptr; }},
    {"write", [](const std::string& path) { return opens(path, O_WRONLY | O_CREAT); }},
    {"overwrite-scan", [](const std::string&) { return opens("/proc/self/fd/3", O_WRONLY); }},
    {"empty-scan", [](const std::string&) { return opens("/proc/self/fd/3", O_RDWR | O_TRUNC); }},
    {"remove", [](const std::string& path) { return ::unlink(path.c_str()) == 0; }},
    {"leave-folder", [](const std::string& path) { return opens("/proc/self/fd/3/" + path, O_RDONLY); }},
    {"socket",
     [](const std::string&) {
         int pair[2];
         return ::socket(AF_UNIX, SOCK_STREAM, 0) >= 0 || ::socket(AF_INET, SOCK_STREAM, 0) >= 0 ||
                ::socket(AF_INET6, SOCK_DGRAM, 0) >= 0 || ::socket(AF_NETLINK, SOCK_RAW, 0) >= 0 ||
                ::socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0;
     }},
    {"become",
     [](const std::string& program) {
         ::execl(program.c_str(), program.c_str(), "-c", "exit 20", nullptr);
         return false;
     }},
    {"start",
     [](const std::string&) {
         const pid_t child = ::fork();
         if (child == 0) ::_exit(0);
         return child > 0;
     }},
    {"trace", [](const std::string&) { return ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0; }},
    {"signal", [](const std::string& pid) { return ::kill(number(pid), 0) == 0; }},
    {"limit",
     [](const std::string& pid) {
         rlimit limit{};
         return ::prlimit(number(pid), RLIMIT_NOFILE, nullptr, &limit) == 0;
     }},
    {"outlive", [](const std::string&) { return ::prctl(PR_SET_PDEATHSIG, 0) == 0; }},
    {"leave-group", [](const std::string&) { return ::setsid() >= 0 || ::setpgid(0, 1) == 0; }},
    {"unshare", [](const std::string&) { return ::unshare(CLONE_NEWUSER) == 0; }},
    {"key",
     [](const std::string&) {
         return ::syscall(SYS_keyctl, 0 /* KEYCTL_GET_KEYRING_ID */, -4 /* the user's */, 0) >= 0;
     }},
    {"program-in-memory", [](const std::string&) { return ::syscall(SYS_memfd_create, "x", 0) >= 0; }},
    {"ring", [](const std::string&) { return ::syscall(SYS_io_uring_setup, 1, nullptr) >= 0; }},
    {"privilege",
     [](const std::string&) {
         std::ifstream status("/proc/self/status");
         for (std::string line; std::getline(status, line);)
             if (line.starts_with("NoNewPrivs:")) return !line.ends_with('1');
         return true;
     }},
    {"module", [](const std::string&) { return ::syscall(SYS_delete_module, "no such module", 0) != -2; }},
    // What it may do: exit status 20 would say that it could not.
    {"thread",
     [](const std::string&) {
         bool ran = false;
         std::thread([&] { ran = true; }).join();
         return !ran;
     }},
    {"read-twice", [](const std::string&) { return !opens("/proc/self/fd/3", O_RDONLY); }},
    {"die", [](const std::string&) { return ::raise(SIGTERM) != 0; }},
};

}  // namespace

int main(int argc, char** argv) {
    std::ifstream file(argc > 1 ? argv[1] : "");
    std::string word, about;
    if (!(file >> word)) return 2;
    std::getline(file >> std::ws, about);
    const auto attempt = attempts.find(word);
    if (attempt == attempts.end()) return 2;
    if (attempt->second(about)) {
        std::fprintf(stderr, "it could %s %s\n", word.c_str(), about.c_str());
        ::_exit(20);  // whatever it left behind
    }
    using scancast::PointStreamWriter;
    PointStreamWriter writer(PointStreamWriter::toDescriptor(STDOUT_FILENO));
    scancast::PointBatch points;
    points.position.doubles().assign(10, {1, 2, 3});
    if (!writer.writeHeader({}) || !writer.writeChunk(points) || !writer.finish(0)) return 3;
    return 0;
}
