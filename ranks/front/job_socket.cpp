#include "ranks/front/job_socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {
namespace {

/// A picture's row of pixels and more at once.
constexpr int socketBuffer = 4 << 20;

Expected<sockaddr_un> addressOf(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string text = path.string();
    if (text.size() >= sizeof address.sun_path)
        return fail(ErrorCode::InvalidArgument,
                    text + " is too long a name for a socket; a shorter folder in TMPDIR helps.");
    std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
    return address;
}

Expected<UniqueFd> newSocket() {
    UniqueFd socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (!socket) return fail(ErrorCode::Io, "no socket: " + systemReason(errno));
    return socket;
}

void setBuffers(int socket) {
    // As much as the system lets; what is less only takes longer.
    ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &socketBuffer, sizeof socketBuffer);
    ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &socketBuffer, sizeof socketBuffer);
}

bool isOfThisUser(int socket) {
    ucred peer{};
    socklen_t size = sizeof peer;
    return ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == ::geteuid();
}

timeval timeOf(std::chrono::milliseconds time) {
    return {time.count() / 1000, (time.count() % 1000) * 1000};
}

tl::unexpected<Error> gone(const std::string& why) {
    return fail(ErrorCode::Unavailable, why);
}

}  // namespace

Expected<std::unique_ptr<JobSocket>> JobSocket::connect(const std::filesystem::path& door) {
    const auto address = addressOf(door);
    if (!address) return passOn(address);
    auto socket = newSocket();
    if (!socket) return passOn(socket);
    const int done = uninterrupted([&] {
        return ::connect(socket->get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address);
    });
    if (done != 0)
        return fail(ErrorCode::Unavailable,
                    "The first rank does not reach the program that started it (" + door.string() + ": " +
                        systemReason(errno) +
                        "). It has to run on the same machine: name that one first in mpirun's --host or "
                        "--hostfile.");
    if (!isOfThisUser(socket->get())) return fail(ErrorCode::Io, door.string() + " is another user's.");
    setBuffers(socket->get());
    return std::make_unique<JobSocket>(std::move(*socket));
}

void JobSocket::setPatience(std::chrono::milliseconds silence, std::chrono::milliseconds standstill) {
    const timeval receives = timeOf(silence), sends = timeOf(standstill);
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &receives, sizeof receives);
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_SNDTIMEO, &sends, sizeof sends);
}

Expected<void> JobSocket::sendAll(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t sent =
            uninterrupted([&] { return ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL); });
        if (sent < 0)
            return gone(errno == EAGAIN || errno == EWOULDBLOCK ? "the other end takes nothing"
                                                                : systemReason(errno));
        bytes = bytes.subspan(std::size_t(sent));
    }
    return {};
}

Expected<void> JobSocket::send(JobWord word, std::uint64_t id,
                               std::span<const std::span<const std::byte>> parts) {
    JobHead head{word, id, 0};
    for (const auto& part : parts) head.bytes += part.size();
    const JobHeadBytes packed = packHead(head);
    const std::scoped_lock lock(sends_);
    if (auto ok = sendAll(packed); !ok) return ok;
    for (const auto& part : parts)
        if (auto ok = sendAll(part); !ok) return ok;
    return {};
}

Expected<void> JobSocket::receive(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t got =
            uninterrupted([&] { return ::recv(socket_.get(), bytes.data(), bytes.size(), 0); });
        if (got == 0) return gone("the connection has ended");
        if (got < 0)
            return gone(errno == EAGAIN || errno == EWOULDBLOCK ? "the other end says nothing"
                                                                : systemReason(errno));
        bytes = bytes.subspan(std::size_t(got));
    }
    return {};
}

Expected<JobHead> JobSocket::receiveHead() {
    JobHeadBytes bytes;
    if (auto ok = receive(bytes); !ok) return passOn(ok);
    return unpackHead(bytes);
}

Expected<RankBytes> JobSocket::receiveBody(const JobHead& head) {
    RankBytes body(head.bytes);
    if (auto ok = receive(body); !ok) return passOn(ok);
    return body;
}

void JobSocket::close() {
    ::shutdown(socket_.get(), SHUT_RDWR);
}

Expected<JobDoor> JobDoor::open() {
    std::error_code unknown;
    const auto parent = std::filesystem::temp_directory_path(unknown);
    if (unknown) return fail(ErrorCode::Io, "There is no folder for temporary files: " + unknown.message());
    sweepOwnedFolders(parent);
    auto folder = OwnedFolder::make(parent);
    if (!folder) return passOn(folder);
    auto socket = newSocket();
    if (!socket) return passOn(socket);
    JobDoor door(std::move(*folder), std::move(*socket));
    const auto address = addressOf(door.path_);
    if (!address) return passOn(address);
    const int fd = door.socket_.get();
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0 ||
        ::listen(fd, 1) != 0)
        return fail(ErrorCode::Io, door.path_.string() + ": " + systemReason(errno));
    return door;
}

Expected<std::unique_ptr<JobSocket>> JobDoor::accept(const std::function<bool()>& isOver) {
    constexpr int every = 20;  // ms
    while (!isOver()) {
        pollfd waiting{socket_.get(), POLLIN, 0};
        if (::poll(&waiting, 1, every) <= 0) continue;
        UniqueFd socket(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
        if (!socket || !isOfThisUser(socket.get())) continue;
        setBuffers(socket.get());
        return std::make_unique<JobSocket>(std::move(socket));
    }
    return fail(ErrorCode::Unavailable, "nobody came");
}

}  // namespace scancast
