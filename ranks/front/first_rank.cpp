#include "ranks/front/first_rank.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <utility>

#include "ranks/draw/packed_drawing.hpp"
#include "ranks/mpi/session.hpp"
#include "renderer/device/cpu/cpu_device.hpp"

namespace scancast {
namespace {

/// mpirun ends the others when one has gone without a word to MPI.
[[noreturn]] void leaveJob(int exitCode) {
    std::fflush(stderr);
    std::_Exit(exitCode);
}

[[noreturn]] void giveUpJob(std::string_view why) {
    MpiSession::abortAll(fmt::format("Ranks cannot go on drawing together: rank 0 failed: {}", why));
}

}  // namespace

void FirstRank::tell(const Expected<void>& sent) {
    if (!sent) leaveJob(1);
}

Expected<void> FirstRank::serveFront(int threads) {
    std::unique_ptr<cpu::PassReduction> reduction;
    if (ranks_.size() > 1)
        reduction = std::make_unique<RankReduction>(ranks_, traffic_, [this] {
            RankBytes nothing;  // the others go on with what they were at
            if (auto ok = ranks_.broadcast(nothing); !ok) giveUpJob(ok.error().message);
        });
    auto made = createCpuDevice(threads, std::move(reduction));
    if (!made) return passOn(made);
    device_ = std::move(*made);
    std::jthread listener([this] { listen(); });
    std::jthread opener([this](const std::stop_token& done) { openClouds(done); });
    for (;;) drawNext();
}

// ---- what the front says

void FirstRank::listen() try {
    for (;;) {
        const auto head = front_.receiveHead();
        if (!head) leaveJob(1);  // it has ended, or this rank is to
        auto body = front_.receiveBody(*head);
        if (!body) leaveJob(1);
        const Monitor::Lock lock(monitor_);
        if (head->word == JobWord::Draw) {
            waiting_.push_back({head->id, std::move(*body), {}});
        } else if (head->word == JobWord::Open) {
            toOpen_.emplace_back(head->id, std::move(*body));
        } else if (head->word == JobWord::Cancel) {
            for (auto* const list : {&waiting_, &drawn_})
                for (Asked& asked : *list)
                    if (asked.id == head->id) asked.stop.request_stop();
        }
    }
} catch (const std::exception& e) {
    giveUpJob(e.what());
}

void FirstRank::openClouds(const std::stop_token& done) try {
    for (;;) {
        std::pair<std::uint64_t, RankBytes> next;
        {
            Monitor::Lock lock(monitor_);
            if (!monitor_.wait(lock, done, [this] { return !toOpen_.empty(); })) return;
            next = std::move(toOpen_.front());
            toOpen_.pop_front();
        }
        JobOpened answer;
        if (const auto capacity = clouds_.openOnAll(next.second))
            answer.capacity = *capacity;
        else
            answer.whyNot = capacity.error().message;
        tell(front_.send(JobWord::Opened, next.first, pack(answer)));
    }
} catch (const std::exception& e) {
    giveUpJob(e.what());
}

// ---- pictures

void FirstRank::drawNext() {
    Taken taken;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return !waiting_.empty(); });
        taken = waiting_.begin();
        drawn_.splice(drawn_.end(), waiting_, taken);
    }
    draw(*taken);
    const Monitor::Lock lock(monitor_);
    drawn_.erase(taken);
}

/// In a pause of the picture that is being drawn: what the front asks for within it.
void FirstRank::drawWaiting() {
    const auto isWaiting = [this] {
        const Monitor::Look look(monitor_);
        return !waiting_.empty();
    };
    while (isWaiting()) drawNext();
}

void FirstRank::draw(Asked& asked) {
    const auto refuse = [&](const Error& error) {
        tell(front_.send(JobWord::Failed, asked.id, pack(error)));
    };
    const auto stop = asked.stop.get_token();
    if (stop.stop_requested())
        return refuse({ErrorCode::Cancelled, "The picture is not wanted any more.", {}});
    const auto drawing = unpackJobDrawing(asked.bytes);
    if (!drawing) return refuse(drawing.error());
    auto frame = drawTogether(*drawing, stop);
    if (!frame) return refuse(frame.error());
    sendPicture(asked.id, *frame);
}

Expected<Frame> FirstRank::drawTogether(const JobDrawing& asked, const std::stop_token& stop) {
    try {
        RankBytes message(asked.drawing.begin(), asked.drawing.end());
        if (auto ok = ranks_.broadcast(message); !ok) giveUpJob(ok.error().message);
        const auto drawing = ranks_.agree(clouds_.unpack(asked.drawing));
        if (!drawing) return passOn(drawing);
        (*drawing)->drawing.pause = asked.pauses ? &pause_ : nullptr;
        return device_->draw((*drawing)->drawing, stop);
    } catch (const std::exception& e) {
        giveUpJob(e.what());
    }
}

void FirstRank::sendPicture(std::uint64_t id, const Frame& frame) {
    JobPicture picture{frame.width, frame.height, !frame.depth.empty(), frame.stats.stages};
    const RankBytes head = pack(picture);
    const auto length = std::uint32_t(head.size());
    const std::array<std::span<const std::byte>, 4> parts{
        std::as_bytes(std::span(&length, 1)), std::span(head),
        std::as_bytes(std::span(frame.rgba.data(), frame.rgba.size())),
        std::as_bytes(std::span(frame.depth.data(), frame.depth.size()))};
    tell(front_.send(JobWord::Picture, id, parts));
}

}  // namespace scancast
