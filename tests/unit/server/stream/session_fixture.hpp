// A stream session without sockets: what it says is written down, what it orders is finished by the test.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "renderer/render.hpp"
#include "server/stream/session.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast::test {

using nlohmann::json;
using std::chrono::milliseconds;

// Everything that the session says, written down.
class RecordingPort final : public StreamPort {
  public:
    struct Placed {
        std::uint64_t number;
        PictureOrder order;
    };

    void sendText(std::string text) override { texts.push_back(json::parse(text)); }
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes>,
                   std::shared_ptr<const Bytes> depth) override {
        frames.push_back(header);
        depths.push_back(std::move(depth));
        if (onFrame) onFrame(header);
    }
    void order(std::uint64_t number, PictureOrder order) override {
        orders.push_back({number, std::move(order)});
    }
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override {
        if (!canReplace) return false;
        ++replaced;
        orders.push_back({number, std::move(order)});
        return true;
    }
    void pick(std::uint64_t seq, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>, double x,
              double y) override {
        picks.emplace_back(seq, x, y);
    }
    void abandon() override { ++abandoned; }
    void close(CloseCode code, std::string) override { closed = code; }
    std::function<void()> onTaken() override {
        return [this] { ++takenOver; };
    }

    std::vector<json> texts;
    std::vector<FrameHeader> frames;
    std::vector<std::shared_ptr<const Bytes>> depths;  // of the frames; null where one has none
    std::function<void(const FrameHeader&)> onFrame;
    std::vector<Placed> orders;
    std::vector<std::tuple<std::uint64_t, double, double>> picks;
    bool canReplace = false;
    int replaced = 0, abandoned = 0, takenOver = 0;
    std::optional<CloseCode> closed;
};

class TwoClouds final : public StreamWorld {
  public:
    std::string defaultCloud() const override { return "first"; }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const override {
        if (removed) return tl::unexpected(problemOf(404, "no such cloud any more"));
        if (id == "first") return first;
        if (id == "second" && second) return second;
        return tl::unexpected(problemOf(404, "no such cloud"));
    }
    bool loading(std::string_view) const override { return isLoading; }
    bool live(std::string_view) const override { return isLive; }
    Expected<std::shared_ptr<const PlannedView>> plan(const Cloud&, const View& view) const override {
        if (view.style.method == "nonsense") return fail(ErrorCode::NotFound, "no such method", "method");
        return nullptr;
    }
    double ownDetail(const View&) const override { return 1; }
    std::vector<std::string> methodNames() const override { return {"paraboloid"}; }

    std::shared_ptr<const Cloud> first = tinyCloud(1), second = tinyCloud(2);
    bool isLoading = false, isLive = false, removed = false;
};

class SessionTest : public ::testing::Test {
  protected:
    SessionTest() {
        SessionOptions options;
        options.id = "s1";
        options.maxPixels = 4'000'000;
        session.emplace(options, world, port, metrics, now);
    }

    void say(const json& message) { session->text(message.dump(), now); }
    void hello() { say({{"type", "hello"}, {"width", 640}, {"height", 480}}); }
    /// A view; they come no faster than frames are wanted.
    void view(std::uint64_t seq, double x) {
        now += milliseconds(34);
        say({{"type", "view"}, {"seq", seq}, {"camera", {{"eye", {x, -50, 30}}, {"target", {5, 5, 0}}}}});
    }
    void ack(std::uint64_t frame) { say({{"type", "ack"}, {"frame", frame}}); }
    void pass(int ms) {
        now += milliseconds(ms);
        session->tick(now);
    }
    /// The scheduler finishes the order that was placed as the n-th.
    void finish(std::size_t n, double renderMs = 1, FrameStats stats = {}) {
        EncodedPicture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes{1, 2, 3});
        if (order(n).withDepth) picture.depth = std::make_shared<const Bytes>(Bytes{4, 5});
        picture.width = port.orders.at(n).order.view.width;
        picture.height = port.orders.at(n).order.view.height;
        picture.renderMs = renderMs;
        picture.stats = std::move(stats);
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
    }
    const PictureOrder& order(std::size_t n) const { return port.orders.at(n).order; }
    /// Hello, and its first still, out of the way.
    void greet() {
        hello();
        pass(150);
        finish(0);
        ack(1);
        port.orders.clear();
        port.frames.clear();
        port.depths.clear();
        port.texts.clear();
    }

    TwoClouds world;
    RecordingPort port;
    Metrics metrics{"test"};
    StreamSession::Time now{std::chrono::hours(1)};
    std::optional<StreamSession> session;
};

}  // namespace scancast::test
