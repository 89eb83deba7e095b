#include "server/commands/doctor/listening_process.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <system_error>

namespace scancast {
namespace {

namespace fs = std::filesystem;

// Files of the kernel: regular ones, that end.
std::string contentOf(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

bool holdsOneOf(const fs::path& process, const std::set<std::string>& sockets) {
    std::error_code error;
    for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
         file.increment(error)) {
        std::error_code gone;
        const fs::path target = fs::read_symlink(file->path(), gone);
        if (!gone && sockets.count(target.string()) > 0) return true;
    }
    return false;
}

}  // namespace

std::vector<std::uint64_t> listeningInodes(const std::string& table, std::uint16_t port) {
    std::vector<std::uint64_t> inodes;
    std::istringstream lines(table);
    std::string line;
    std::getline(lines, line);  // what the columns are called
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string slot, local, remote, state, queues, timer, again, user, timeout;
        std::uint64_t inode = 0;
        if (!(words >> slot >> local >> remote >> state >> queues >> timer >> again >> user >> timeout >>
              inode))
            continue;
        const auto colon = local.rfind(':');
        unsigned at = 0;
        if (colon == std::string::npos ||
            std::from_chars(local.data() + colon + 1, local.data() + local.size(), at, 16).ec != std::errc())
            continue;
        if (state == "0A" && at == port) inodes.push_back(inode);  // TCP_LISTEN
    }
    return inodes;
}

std::optional<ListeningProcess> listeningProcess(std::uint16_t port) {
    std::set<std::string> sockets;
    for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"})
        for (const std::uint64_t inode : listeningInodes(contentOf(table), port))
            sockets.insert("socket:[" + std::to_string(inode) + "]");
    if (sockets.empty()) return std::nullopt;
    std::error_code error;
    for (fs::directory_iterator process("/proc", error), end; !error && process != end;
         process.increment(error)) {
        const std::string name = process->path().filename().string();
        if (!std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; })) continue;
        if (!holdsOneOf(process->path(), sockets)) continue;
        std::string called = contentOf(process->path() / "comm");
        while (!called.empty() && called.back() == '\n') called.pop_back();
        return ListeningProcess{pid_t(std::stol(name)), std::move(called)};
    }
    return std::nullopt;
}

}  // namespace scancast
