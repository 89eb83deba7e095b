#include "ranks/front/heartbeat.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "ranks/mpi/session.hpp"

namespace scancast {
namespace {

constexpr auto beatsEvery = std::chrono::milliseconds(500);
constexpr auto looksEvery = std::chrono::milliseconds(20);
/// On a machine that is busy beyond measure a thread may have to wait for a second or two.
constexpr auto isThereWithin = std::chrono::seconds(5);

}  // namespace

Heartbeat::Heartbeat(const Communicator& ranks, std::function<void()> onBeat)
    : ranks_(ranks),
      onBeat_(std::move(onBeat)),
      thread_([this](const std::stop_token& done) { beat(done); }) {}

void Heartbeat::beat(const std::stop_token& done) {
    using Clock = std::chrono::steady_clock;
    while (!done.stop_requested()) {
        MPI_Request request;
        if (MPI_Ibarrier(ranks_.handle(), &request) != MPI_SUCCESS)
            MpiSession::abortAll("Ranks cannot tell whether they are all there.");
        const auto giveUp = Clock::now() + isThereWithin;
        for (int isDone = 0; !isDone;) {
            if (MPI_Test(&request, &isDone, MPI_STATUS_IGNORE) != MPI_SUCCESS || Clock::now() > giveUp)
                MpiSession::abortAll(
                    fmt::format("Rank {} has not heard of another one for {} s; all are ended.",
                                ranks_.rank(), isThereWithin.count()));
            if (!isDone) std::this_thread::sleep_for(looksEvery);
        }
        onBeat_();
        std::this_thread::sleep_for(beatsEvery);
    }
}

}  // namespace scancast
