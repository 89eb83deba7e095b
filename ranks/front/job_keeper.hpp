// Keeps a job of ranks behind a front: starts it, starts it again when it ends or answers no more, tells whoever listens, and has
// pictures drawn by it. Owned by the front's command; a thread of its own waits for the job and reads what it says.
//
// *Thread safety*: every function may be called from any thread but draw(), which is the render thread's.
// Place: front's device and clouds → **keeper** → first rank.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "protocol/error.hpp"
#include "ranks/front/job_process.hpp"
#include "ranks/front/job_socket.hpp"
#include "renderer/device/device.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// Called on the keeper's thread.
class JobListener {
  public:
    virtual ~JobListener() = default;
    /// The ranks are there: clouds may be opened.
    virtual void jobIsUp() = 0;
    /// Of the cloud of this number.
    virtual void jobOpened(std::uint64_t number, const JobOpened& opened) = 0;
    /// The ranks are gone: what was asked of them is answered with Unavailable after this has returned.
    virtual void jobIsLost() = 0;
};

struct JobStatus {
    bool isUp = false;
    bool isFirstStart = true;  ///< and it is neither up nor known to have failed
    std::uint32_t ranks = 0;   ///< of the latest that was up
    std::uint64_t restarts = 0;
};

class JobKeeper {
  public:
    /// `start`: the words that start ranks; `draw`: of the command that each of them is, to which where to report is added.
    JobKeeper(std::vector<std::string> start, std::vector<std::string> draw)
        : start_(std::move(start)), draw_(std::move(draw)) {}
    /// Ends the job.
    ~JobKeeper();
    JobKeeper(const JobKeeper&) = delete;
    JobKeeper& operator=(const JobKeeper&) = delete;

    /// Once.
    void begin(std::shared_ptr<JobListener> listener);
    JobStatus status() const;
    /// Until the first start has come to something.
    void waitForFirstStart(std::chrono::milliseconds patience) const;

    /// Asks the job to open a cloud; where there is none, nothing happens.
    void open(std::uint64_t number, const RankBytes& words);
    /// `drawing`: packDrawing()'s. Its pause is called every few milliseconds. Errors: the device's; Unavailable, where the ranks
    /// were lost.
    Expected<Frame> draw(const RankBytes& drawing, const Drawing& of, const std::stop_token& stop);

  private:
    using Clock = std::chrono::steady_clock;
    using Lock = Monitor::Lock;

    /// A picture that is asked for.
    struct Awaited {
        int width = 0, height = 0;
        bool depth = false;
        std::optional<Expected<Frame>> answer;
    };

    void run();
    std::string runOnce();
    std::string talk(const std::shared_ptr<JobSocket>& socket);
    Expected<void> greet(const std::shared_ptr<JobSocket>& socket);
    Expected<void> take(JobSocket& socket, const JobHead& head);
    Expected<void> takePicture(JobSocket& socket, const JobHead& head);
    void answer(std::uint64_t id, Expected<Frame> frame);
    void setUp(std::shared_ptr<JobSocket> socket, const JobHello& hello);
    void setLost();
    void setProcess(JobProcess* process);
    bool waitBeforeNext(std::chrono::milliseconds pause);

    const std::vector<std::string> start_, draw_;
    std::shared_ptr<JobListener> listener_;
    mutable Monitor monitor_;  // guards what follows
    JobStatus status_;
    std::shared_ptr<JobSocket> socket_;  // while it is up
    JobProcess* process_ = nullptr;      // while it is talked to
    std::map<std::uint64_t, Awaited> awaited_;
    std::uint64_t lastId_ = 0;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace scancast
