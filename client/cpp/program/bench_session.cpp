#include "client/cpp/program/bench_session.hpp"

#include <chrono>

#include "client/cpp/program/jpeg_facts.hpp"
#include "client/cpp/stream.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast::client {
namespace {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using namespace std::chrono_literals;

constexpr auto patience = 600s;  // for the first still of hundreds of sessions, and for the last one

double millisecondsSince(Time then) {
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

Clock::duration seconds(double value) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

class Session {
  public:
    Session(const BenchOptions& options, Behaviour behaviour, int number, BenchClock& clock)
        : options_(options), clock_(clock), number_(number) {
        result_.behaviour = behaviour;
        waking_ = behaviour == Behaviour::Idle && options.wake;
    }

    BenchResult run(const Server& server) {
        bool ready = false;
        const auto ended = play(server, ready);
        if (!ready) --clock_.notReady;
        if (waking_) --clock_.unanswered;
        if (!ended) result_.error = ended.error().message;
        return std::move(result_);
    }

  private:
    Expected<void> play(const Server& server, bool& ready) {
        messages::Hello hello;
        hello.cloud = options_.cloud;
        hello.width = options_.start.view.width;
        hello.height = options_.start.view.height;
        hello.fps = options_.fps;
        hello.codecs = options_.codecs;
        auto opened = Stream::open(server.url(), hello, server.timeouts(), server.credentials(),
                                   is(Behaviour::Slow) ? options_.slowBytesPerSecond : 0);
        if (!opened) return passOn(opened);
        stream_.emplace(std::move(*opened));
        return sendView(true).and_then([&] { return waitForStart(ready); }).and_then([&] {
            return is(Behaviour::Idle) ? idle() : move();
        });
    }

    bool is(Behaviour behaviour) const { return result_.behaviour == behaviour; }

    /// The whole view at first, then the camera alone, as viewers do.
    Expected<void> sendView(bool whole) {
        // Sessions start at places of their own: no two of them want the same picture.
        const double degrees =
            137.5 * number_ + options_.degreesPerSecond / options_.viewsPerSecond * double(seq_);
        result_.finalView = options_.start.at(degrees);
        auto changes = toJson(result_.finalView);
        if (!whole) changes = {{"camera", changes["camera"]}};
        ++seq_;
        sent_.push_back(Clock::now());
        return stream_->send(messages::ViewChange{seq_, std::nullopt, std::move(changes)});
    }

    /// Receives until `end`, or until `done()` after something came.
    template <class Done>
    Expected<void> receiveUntil(Time end, Done done) {
        while (!done()) {
            const auto now = Clock::now();
            if (now >= end) return {};
            const auto wait =
                std::chrono::ceil<std::chrono::milliseconds>(std::min<Clock::duration>(end - now, 250ms));
            auto event = stream_->receiveFor(wait);
            if (!event) return passOn(event);
            if (!*event) continue;
            if (auto* frame = std::get_if<ReceivedFrame>(&**event)) {
                if (auto ok = take(*frame); !ok) return ok;
            } else if (const auto* stats = std::get_if<messages::Stats>(&**event)) {
                if (measuring_) result_.details.push_back(stats->detail);
            } else if (const auto* report = std::get_if<messages::ProblemReport>(&**event)) {
                return tl::unexpected(errorOf(report->problem));
            }
        }
        return {};
    }

    Expected<void> take(ReceivedFrame& frame) {
        const auto& header = frame.header;
        last_ = header;
        ++received_;
        if (measuring_) measure(frame);
        if (header.final) result_.final = std::move(frame.jpeg);
        if (is(Behaviour::NeverAck)) return {};
        return stream_->ack(header);
    }

    void measure(const ReceivedFrame& frame) {
        const auto& header = frame.header;
        ++result_.frames;
        result_.bytes += frame.pictureBytes();
        if (!header.moving || header.seq == 0 || header.seq > seq_) return;
        result_.latencies.push_back(millisecondsSince(sent_[header.seq - 1]));
        result_.frameBytes.push_back(double(frame.pictureBytes()));
        result_.resolutions.push_back(double(header.width) / options_.start.view.width);
        if (header.codec != Codec::Jpeg) {
            ++result_.videoFrames;
        } else if (const auto facts = jpegFacts(frame.jpeg)) {
            result_.qualities.push_back(facts->quality);
            ++result_.subsamplings[facts->subsampling];
        }
    }

    bool hasFinal() const { return last_.final && last_.seq == seq_; }

    Expected<void> waitForStart(bool& ready) {
        const auto end = Clock::now() + patience;
        // Who never acknowledges sees two frames and no more.
        const auto shown = [&] { return hasFinal() || (is(Behaviour::NeverAck) && received_ >= 1); };
        if (auto ok = receiveUntil(end, shown); !ok) return ok;
        if (!shown()) return fail(ErrorCode::DeadlineExceeded, "no final still came in time");
        ready = true;
        --clock_.notReady;
        while (clock_.start == 0)
            if (auto ok = receiveUntil(Clock::now() + 250ms, [] { return false; }); !ok) return ok;
        start_ = Time(std::chrono::nanoseconds(clock_.start.load()));
        return receiveUntil(start_, [] { return false; });
    }

    Expected<void> move() {
        const auto interval = seconds(1 / options_.viewsPerSecond);
        const auto measured = start_ + seconds(options_.warmUp), end = measured + seconds(options_.seconds);
        // Spread over the interval, as viewers are that know nothing of each other.
        auto next = start_ + interval * (number_ % 8) / 8;
        for (; next < end; next += interval) {
            if (auto ok = receiveUntil(next, [] { return false; }); !ok) return ok;
            measuring_ = next >= measured;
            if (Clock::now() > next + interval) continue;  // late: viewers do not send the past
            if (auto ok = sendView(false); !ok) return ok;
        }
        if (auto ok = receiveUntil(end, [] { return false; }); !ok) return ok;
        measuring_ = false;
        if (is(Behaviour::NeverAck)) return {};
        if (auto ok = receiveUntil(Clock::now() + patience, [&] { return hasFinal(); }); !ok) return ok;
        if (!hasFinal()) return fail(ErrorCode::DeadlineExceeded, "no final still came in time");
        result_.finalMs = millisecondsSince(sent_.back());
        return {};
    }

    Expected<void> idle() {
        const int before = received_;
        const auto end = start_ + seconds(options_.wake.value_or(options_.warmUp + options_.seconds));
        if (auto ok = receiveUntil(end, [] { return false; }); !ok) return ok;
        result_.idleFrames = received_ - before;
        if (!options_.wake) return {};
        measuring_ = true;
        if (auto ok = sendView(false); !ok) return ok;
        const auto answered = [&] { return last_.seq == seq_; };
        if (auto ok = receiveUntil(Clock::now() + patience, answered); !ok) return ok;
        if (!answered()) return fail(ErrorCode::DeadlineExceeded, "the waking view was never answered");
        result_.answerMs = millisecondsSince(sent_.back());
        waking_ = false;
        --clock_.unanswered;
        const int first = received_;
        return receiveUntil(Clock::now() + patience, [&] {
            const bool others = clock_.unanswered > 0;
            if (others && received_ > first) result_.secondBeforeAll = true;
            return !others;
        });
    }

    const BenchOptions& options_;
    BenchClock& clock_;
    const int number_;
    std::optional<Stream> stream_;
    BenchResult result_;
    Time start_;
    std::vector<Time> sent_;  // of view seq, at seq - 1
    std::uint64_t seq_ = 0;
    FrameHeader last_;
    int received_ = 0;
    bool measuring_ = false;
    bool waking_ = false;  // counted among the unanswered
};

}  // namespace

std::string_view name(Behaviour behaviour) {
    switch (behaviour) {
        case Behaviour::Moving:
            return "moving";
        case Behaviour::Idle:
            return "idle";
        case Behaviour::Slow:
            return "slow";
        case Behaviour::NeverAck:
            return "never-ack";
    }
    return "";
}

BenchResult benchSession(const Server& server, const BenchOptions& options, Behaviour behaviour, int number,
                         BenchClock& clock) {
    return Session(options, behaviour, number, clock).run(server);
}

}  // namespace scancast::client
