// A stream session, as it is, at the end of a line that is not there: a client that moves its camera, a device that draws one picture
// after the other, a router whose buffer takes everything and keeps its order, the way there and back, a decoder, acknowledgements.
// Time is simulated, in steps of a millisecond; nothing waits, and the same line gives the same frames.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <random>
#include <vector>

#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {

struct ShapedLine {
    std::function<double(double seconds)> bandwidth;                           ///< bytes/s
    double way = 0.01;                                                         ///< s, each way, of nothing
    std::function<double(double seconds)> later = [](double) { return 0.0; };  ///< s more there: jitter
    double decodeMs = 0;  ///< of a frame, one after the other, before it is acknowledged
};

struct ArrivedFrame {
    double viewed = 0;  ///< s: when the view that it shows was sent by the client
    double sent = 0, begun = 0, arrived = 0, acknowledged = 0;
    bool moving = false;
    std::size_t bytes = 0;
    std::size_t unacknowledged = 0;                 ///< with it, when it was sent
    double waited() const { return begun - sent; }  ///< for the line, behind those before it
};

/// What was seen of frames that arrived within a time.
struct LineSummary {
    double framesPerSecond = 0;     ///< moving
    double wait = 0, mostWait = 0;  ///< s: median, most
    double answer = 0;              ///< s from the view to its frame, median
    std::size_t mostUnacknowledged = 0;
};

class ShapedSession final : public StreamPort {
  public:
    double drawMs = 15;           ///< a moving frame, encoding included
    double stillMs = 60;          ///< any other
    double bytesPerPixel = 0.15;  ///< of a moving frame at quality 90, 4:2:0
    int width = 640, height = 360;
    double fps = 30;
    double viewMs = 16;
    std::function<bool(double seconds)> moves = [](double) { return true; };

    explicit ShapedSession(ShapedLine line, std::optional<std::size_t> window = {}) : line_(std::move(line)) {
        SessionOptions options;
        options.id = "s1";
        options.maxPixels = 4'000'000;
        options.window = window;
        session_.emplace(options, world_, *this, metrics_, time());
    }

    const std::vector<ArrivedFrame>& run(double seconds) {
        const auto end = std::int64_t(seconds * 1000);
        if (ms_ == 0) say({{"type", "hello"}, {"width", width}, {"height", height}, {"fps", fps}});
        for (; ms_ < end; ++ms_) step();
        return arrived_;
    }

    static LineSummary between(const std::vector<ArrivedFrame>& frames, double from, double to) {
        LineSummary sum;
        std::vector<double> waits, answers;
        for (const ArrivedFrame& frame : frames) {
            if (frame.arrived < from || frame.arrived >= to || !frame.moving) continue;
            waits.push_back(frame.waited());
            answers.push_back(frame.arrived - frame.viewed);
            sum.mostUnacknowledged = std::max(sum.mostUnacknowledged, frame.unacknowledged);
        }
        sum.framesPerSecond = double(waits.size()) / (to - from);
        if (waits.empty()) return sum;
        for (auto* values : {&waits, &answers}) std::ranges::sort(*values);
        sum.wait = waits[waits.size() / 2];
        sum.mostWait = waits.back();
        sum.answer = answers[answers.size() / 2];
        return sum;
    }

    // ---- StreamPort

    void sendText(std::string) override {}
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                   std::shared_ptr<const Bytes>) override {
        ArrivedFrame frame;
        frame.viewed = viewSent_.at(header.seq);
        frame.sent = now();
        frame.moving = header.moving;
        frame.bytes = picture->size();
        frame.unacknowledged = ++unacknowledged_;
        if (queue_.empty()) left_ = double(frame.bytes);
        queue_.push_back(frame);
    }
    void order(std::uint64_t number, PictureOrder order) override {
        orders_.push_back({number, std::move(order)});
    }
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override {
        if (orders_.size() < 2) return false;  // the first one is being drawn
        orders_.back() = {number, std::move(order)};
        return true;
    }
    void pick(std::uint64_t, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>, double,
              double) override {}
    void abandon() override {
        std::erase_if(orders_, [](const auto& one) { return one.order.interruptible; });
        if (orders_.empty()) drawnAt_.reset();
    }
    void close(CloseCode, std::string) override { ADD_FAILURE() << "the session ended"; }
    std::function<void()> onTaken() override {
        return [] {};
    }

  private:
    struct Ordered {
        std::uint64_t number = 0;
        PictureOrder order;
    };

    double now() const { return double(ms_) / 1000; }
    StreamSession::Time time() const {
        return StreamSession::Time(std::chrono::hours(1) + milliseconds(ms_));
    }
    void say(const json& message) { session_->text(message.dump(), time()); }

    void step() {
        transmit();
        while (!acks_.empty() && acks_.front().acknowledged <= now()) {
            --unacknowledged_;
            say({{"type", "ack"}, {"frame", ++acked_}});
            acks_.pop_front();
        }
        draw();
        if (now() >= nextView_) {
            nextView_ = now() + viewMs / 1000;
            if (moves(now())) {
                viewSent_.push_back(now() - line_.way);
                say({{"type", "view"},
                     {"seq", viewSent_.size() - 1},
                     {"camera", {{"eye", {now(), -50, 30}}, {"target", {5, 5, 0}}}}});
            }
        }
        if (const auto wake = session_->wakeAt(); wake && *wake <= time()) session_->tick(time());
    }

    void draw() {
        if (orders_.empty()) return;
        if (!drawnAt_) drawnAt_ = now() + (orders_.front().order.interruptible ? stillMs : drawMs) / 1000;
        if (*drawnAt_ > now()) return;
        const Ordered done = std::move(orders_.front());
        orders_.pop_front();
        drawnAt_.reset();
        EncodedPicture picture;
        picture.width = done.order.view.width;
        picture.height = done.order.view.height;
        picture.renderMs = 0.7 * drawMs;
        picture.encodeMs = 0.3 * drawMs;
        picture.bytes = std::make_shared<const Bytes>(bytesOf(done.order.view));
        session_->pictureDone(done.number, std::move(picture), time());
    }

    // As in SimulatedStream: not what the controller thinks that bytes follow.
    std::size_t bytesOf(const View& drawn) {
        const double q = drawn.quality.jpegQuality;
        const double scale = q < 50 ? 50 / q : 2 - q / 50;
        const double pixels = double(drawn.width) * drawn.height;
        const double side = pixels / (double(width) * height);
        const double content = std::uniform_real_distribution(0.9, 1.1)(random_);
        return 700 + std::size_t(bytesPerPixel * pixels * std::pow(side, -0.1) *
                                 std::pow(std::max(scale, 0.02) / 0.2, -0.6) * content);
    }

    void transmit() {
        double room = line_.bandwidth(now()) / 1000;
        while (!queue_.empty() && room > 0) {
            ArrivedFrame& frame = queue_.front();
            if (frame.begun == 0) frame.begun = now();
            const double part = std::min(room, left_);
            room -= part;
            left_ -= part;
            if (left_ > 0.5) break;
            const auto after = [](const std::deque<ArrivedFrame>& before, double time, auto member) {
                return before.empty() ? time : std::max(time, before.back().*member);
            };
            frame.arrived = after(acks_, now() + line_.way + line_.later(now()), &ArrivedFrame::arrived);
            decoded_ = std::max(decoded_, frame.arrived) + line_.decodeMs / 1000;
            frame.acknowledged = decoded_ + line_.way;
            acks_.push_back(frame);
            arrived_.push_back(frame);
            queue_.pop_front();
            if (!queue_.empty()) left_ = double(queue_.front().bytes);
        }
    }

    ShapedLine line_;
    TwoClouds world_;
    Metrics metrics_{"test"};
    std::optional<StreamSession> session_;
    std::int64_t ms_ = 0;
    double nextView_ = 0.3, left_ = 0, decoded_ = 0;
    std::optional<double> drawnAt_;
    std::deque<Ordered> orders_;  // the first one is being drawn
    std::deque<ArrivedFrame> queue_, acks_;
    std::vector<ArrivedFrame> arrived_;
    std::vector<double> viewSent_{0};  // by seq
    std::size_t unacknowledged_ = 0;
    std::uint64_t acked_ = 0;
    std::mt19937 random_{7};
};

}  // namespace scancast::test
