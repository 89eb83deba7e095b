// The first rank of a job behind a front: draws with the others what the front asks for, opens with them what the front has, and
// sends pictures. Owned by the draw command, on its thread; threads of its own read what the front says and open clouds. It ends
// the process, and with it the job, when the front is gone. Place: front's keeper → **first rank** → all ranks' devices.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "ranks/draw/rank_clouds.hpp"
#include "ranks/draw/rank_reduction.hpp"
#include "ranks/front/job_messages.hpp"
#include "ranks/front/job_socket.hpp"
#include "renderer/device/device.hpp"
#include "threads/monitor.hpp"

namespace scancast {

class FirstRank {
  public:
    /// `ranks` and `clouds`: as the others' drawWithFirst() takes them; all outlive this.
    FirstRank(const Communicator& ranks, OpenedClouds& clouds, JobSocket& front)
        : ranks_(ranks), clouds_(clouds), front_(front) {}

    /// Until the process ends.
    Expected<void> serveFront(int threads);
    /// All ranks are there.
    void tellBeat() { tell(front_.send(JobWord::Beat)); }

  private:
    struct Asked {
        std::uint64_t id = 0;
        RankBytes bytes;  ///< a JobDrawing
        std::stop_source stop;
    };
    using Taken = std::list<Asked>::iterator;

    void listen();
    void openClouds(const std::stop_token& done);
    void drawNext();
    void drawWaiting();
    void draw(Asked& asked);
    Expected<Frame> drawTogether(const JobDrawing& asked, const std::stop_token& stop);
    void sendPicture(std::uint64_t id, const Frame& frame);
    /// What cannot be said to the front ends all.
    static void tell(const Expected<void>& sent);

    const Communicator& ranks_;
    OpenedClouds& clouds_;
    JobSocket& front_;
    RankTraffic traffic_;
    std::unique_ptr<Device> device_;
    Pause pause_ = [this] { drawWaiting(); };
    Monitor monitor_;  // guards what follows
    std::list<Asked> waiting_, drawn_;
    std::list<std::pair<std::uint64_t, RankBytes>> toOpen_;
};

}  // namespace scancast
