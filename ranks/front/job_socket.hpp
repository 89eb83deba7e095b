// The connection between a front and the first rank of its job: a Unix socket in a folder that nobody else can read, between two
// processes of one user. Both ends send whole messages from any thread; one thread of each reads. Place: front → **socket** → first
// rank.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "files/owned_folder.hpp"
#include "files/unique_fd.hpp"
#include "protocol/error.hpp"
#include "ranks/front/job_messages.hpp"

namespace scancast {

class JobSocket {
  public:
    explicit JobSocket(UniqueFd socket) : socket_(std::move(socket)) {}

    /// To a front's door. Unavailable: it is not there, which is another machine than the front's; Io.
    static Expected<std::unique_ptr<JobSocket>> connect(const std::filesystem::path& door);

    /// Who says nothing for so long, or takes nothing, is as good as gone.
    void setPatience(std::chrono::milliseconds silence, std::chrono::milliseconds standstill);
    /// The head, and all parts as one body. After an error nothing else may be sent: close().
    Expected<void> send(JobWord word, std::uint64_t id, std::span<const std::span<const std::byte>> parts);
    Expected<void> send(JobWord word, std::uint64_t id = 0, std::span<const std::byte> body = {}) {
        return send(word, id, std::span(&body, 1));
    }
    Expected<JobHead> receiveHead();
    Expected<void> receive(std::span<std::byte> bytes);
    Expected<RankBytes> receiveBody(const JobHead& head);
    /// For both ends at once; whoever reads or sends gets an error. Any thread.
    void close();

  private:
    Expected<void> sendAll(std::span<const std::byte> bytes);

    const UniqueFd socket_;
    std::mutex sends_;
};

/// Where the front waits for a job's first rank. Gone with the object.
class JobDoor {
  public:
    static Expected<JobDoor> open();
    const std::filesystem::path& path() const { return path_; }
    /// Unavailable: nobody came before `isOver`, which is asked every few milliseconds. Who is another user's is not let in.
    Expected<std::unique_ptr<JobSocket>> accept(const std::function<bool()>& isOver);

  private:
    JobDoor(OwnedFolder folder, UniqueFd socket)
        : folder_(std::move(folder)), path_(folder_.path() / name), socket_(std::move(socket)) {}

    static constexpr const char* name = "job";
    OwnedFolder folder_;
    std::filesystem::path path_;
    UniqueFd socket_;
};

}  // namespace scancast
