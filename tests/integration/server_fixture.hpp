// A real server in this process, on a free port, with a fake device: everything between the socket and the
// scheduler is what ships.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "protocol/frame_header.hpp"
#include "protocol/json_text.hpp"
#include "server/server.hpp"
#include "tests/integration/raw_client.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast::test {

inline const std::string sendsJson = "Content-Type: application/json";
/// A small picture of the first of the server's clouds.
inline constexpr const char* onePicture = "/api/v1/clouds/one/snapshot.jpg?width=32&height=16";

/// A stream session as a client sees it.
class StreamClient {
  public:
    explicit StreamClient(std::uint16_t port, const std::string& protocols = "scancast.v1")
        : socket(port, protocols) {}

    bool say(const nlohmann::json& message) { return socket.text(message.dump()); }
    /// Says hello and takes the welcome.
    nlohmann::json greet(nlohmann::json hello = {}) {
        hello["type"] = "hello";
        if (!hello.contains("width")) hello["width"] = 64;
        if (!hello.contains("height")) hello["height"] = 48;
        say(hello);
        return control("welcome");
    }
    bool view(std::uint64_t seq, double x) {
        return say(
            {{"type", "view"}, {"seq", seq}, {"camera", {{"eye", {x, -50, 30}}, {"target", {5, 5, 0}}}}});
    }
    bool ack(const FrameHeader& header) { return say({{"type", "ack"}, {"frame", header.frameId}}); }

    /// The next control message of that type; null when the connection ends first.
    nlohmann::json control(const std::string& type) {
        while (true) {
            const WsMessage message = socket.receiveKind(WsMessage::Kind::Text);
            if (message.kind != WsMessage::Kind::Text) return nullptr;
            auto json = nlohmann::json::parse(message.payload);
            if (json["type"] == type) return json;
        }
    }

    struct Frame {
        FrameHeader header;
        Bytes picture;
        Bytes packedDepth{};
    };
    /// The next frame, acknowledged; nullopt when none comes in time.
    std::optional<Frame> frame(std::chrono::milliseconds patience = netPatience) {
        const WsMessage message = socket.receiveKind(WsMessage::Kind::Binary, patience);
        if (message.kind != WsMessage::Kind::Binary) return std::nullopt;
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.payload.data());
        const auto parsed = parseFrame({bytes, message.payload.size()});
        if (!parsed) return std::nullopt;
        ack(parsed->header);
        return Frame{parsed->header, Bytes(parsed->picture.begin(), parsed->picture.end()),
                     Bytes(parsed->packedDepth.begin(), parsed->packedDepth.end())};
    }
    /// The final still of that view.
    std::optional<Frame> finalFrame(std::uint64_t seq) {
        while (auto next = frame()) {
            if (next->header.final && next->header.seq == seq) return next;
        }
        return std::nullopt;
    }
    int closeCode() { return socket.receiveKind(WsMessage::Kind::Close).closeCode(); }

    RawWebSocket socket;
};

class ServerTest : public ::testing::Test {
  protected:
    ServerTest() {
        options.port = 0;
        options.limits.requestTimeout = std::chrono::milliseconds(2000);
        options.limits.quiet = std::chrono::milliseconds(50);
    }
    void start() {
        auto created = ScancastServer::create(options, painter.open());
        ASSERT_TRUE(created) << created.error().message;
        server = std::move(*created);
        server->catalog().setReady(server->catalog().add("one"), one);
        server->catalog().setReady(server->catalog().add("two"), two);
        server->scheduler().waitForDevice(netPatience);
    }
    std::uint16_t port() const { return server->port(); }
    std::string metric(const std::string& start) const {
        const std::string text = request(port(), "/metrics").body;
        const auto at = text.find("\n" + start);
        return at == std::string::npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    }
    /// Polls, because what follows a disconnect happens on the server's threads.
    bool eventually(const std::function<bool()>& condition) const {
        const auto end = std::chrono::steady_clock::now() + netPatience;
        while (!condition()) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return true;
    }

    ServerOptions options;
    FakePainter painter;  // outlives the server
    std::shared_ptr<const Cloud> one = tinyCloud(100), two = tinyCloud(200);
    std::unique_ptr<ScancastServer> server;
};

}  // namespace scancast::test
