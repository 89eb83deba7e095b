// A stream over a network that is not there: a link with a bandwidth that changes and a latency, a renderer
// whose cost is a formula, frames whose bytes are one, and a window of two unacknowledged frames, which sessions begin with
// (shaped_session.hpp has the session itself, and its window).
// Time is simulated, in steps of a millisecond; nothing waits.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "server/stream/quality_controller.hpp"

namespace scancast::test {

struct LinkTrace {
    std::function<double(double seconds)> bandwidth;  ///< bytes/s
    std::function<double(double seconds)> roundTrip;  ///< s, of nothing
};

inline std::function<double(double)> always(double value) {
    return [value](double) { return value; };
}

struct SimulatedFrame {
    double ordered = 0, sent = 0, acknowledged = 0;  ///< s
    MovingQuality quality;
    std::size_t bytes = 0;
};

class SimulatedStream {
  public:
    View view;
    MovingLimits limits;
    double fullRenderMs = 4, encodeMs = 2;
    double bytesPerPixel = 0.15;  ///< of the moving frame at quality 90, 4:2:0
    std::function<bool(double seconds)> moves = [](double) { return true; };

    explicit SimulatedStream(LinkTrace link) : link_(std::move(link)) {}

    /// Everything that is acknowledged within that time.
    std::vector<SimulatedFrame> run(double seconds) {
        const auto end = std::int64_t(seconds * 1000);
        for (; ms_ < end; ++ms_) step(double(ms_) / 1000);
        return done_;
    }
    const QualityController& controller() const { return controller_; }

  private:
    static LinkEstimate::Time at(double seconds) {
        return LinkEstimate::Time(std::chrono::microseconds(std::int64_t(seconds * 1e6)));
    }

    void step(double now) {
        transmit(now);
        while (!flying_.empty() && flying_.front().acknowledged <= now) {
            controller_.acknowledged(firstId_++, limits, at(now));
            done_.push_back(flying_.front());
            flying_.pop_front();
        }
        if (drawing_ && drawnAt_ <= now) send(now);
        const std::size_t busy = flying_.size() + queue_.size() + (drawing_ ? 1 : 0);
        const std::size_t window = controller_.link().wantsQuiet(at(now)) ? 1 : 2;
        if (!drawing_ && busy < window && moves(now)) order(now);
    }

    void order(double now) {
        drawing_ = SimulatedFrame{};
        drawing_->ordered = now;
        drawing_->quality = controller_.choose(view, 1, limits);
        renderMs_ = fullRenderMs * costOf(drawing_->quality, 1);
        drawnAt_ = now + (renderMs_ + encodeMs) / 1000;
    }

    void send(double now) {
        const View drawn = movingView(view, drawing_->quality);
        drawing_->sent = now;
        drawing_->bytes = bytesOf(drawn);
        controller_.drawn(drawing_->quality, {renderMs_, encodeMs, 0}, 1, limits);
        controller_.sent(++lastId_, drawn, drawing_->bytes, at(now));
        left_ = queue_.empty() ? double(drawing_->bytes) : left_;
        queue_.push_back(*drawing_);
        drawing_.reset();
    }

    // What leaves the line comes back as an acknowledgement a round trip later, never before the one before.
    void transmit(double now) {
        double room = link_.bandwidth(now) / 1000;
        while (!queue_.empty() && room > 0) {
            const double part = std::min(room, left_);
            room -= part;
            left_ -= part;
            if (left_ > 0.5) break;
            SimulatedFrame frame = queue_.front();
            queue_.pop_front();
            const double earliest = flying_.empty() ? 0 : flying_.back().acknowledged;
            frame.acknowledged = std::max(now + link_.roundTrip(now), earliest);
            flying_.push_back(frame);
            if (!queue_.empty()) left_ = double(queue_.front().bytes);
        }
    }

    // Not the controller's model: bytes fall less with quality, more with size, and every picture is another.
    std::size_t bytesOf(const View& drawn) {
        const double q = drawn.quality.jpegQuality;
        const double scale = q < 50 ? 50 / q : 2 - q / 50;
        const double pixels = double(drawn.width) * drawn.height;
        const double side = pixels / (double(view.width) * view.height);
        const double chroma = drawn.quality.subsampling == Subsampling::S420 ? 1 : 1.3;
        const double content = std::uniform_real_distribution(0.9, 1.1)(random_);
        return 700 + std::size_t(bytesPerPixel * pixels * std::pow(side, -0.1) *
                                 std::pow(std::max(scale, 0.02) / 0.2, -0.6) * chroma * content);
    }

    LinkTrace link_;
    QualityController controller_;
    std::int64_t ms_ = 0;
    std::optional<SimulatedFrame> drawing_;
    double drawnAt_ = 0, renderMs_ = 0, left_ = 0;
    std::uint64_t lastId_ = 0, firstId_ = 1;
    std::deque<SimulatedFrame> queue_, flying_;
    std::vector<SimulatedFrame> done_;
    std::mt19937 random_{7};
};

}  // namespace scancast::test
