// Memory that clients take, over real sockets: it is counted, has an end, and comes back.
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

class MemoryTest : public ServerTest {
  protected:
    static constexpr std::uint64_t MB = 1'000'000;

    void limitTo(std::uint64_t bytes) {
        options.scheduler.memory = TransientMemory(bytes);
        options.scheduler.maxFrameBytes = options.scheduler.memory.forFrames();
    }
    /// The depth of a picture, as it goes out: four bytes a pixel, so its size is known.
    static std::string depthOf(int width, int height, int eye) {
        const nlohmann::json body{
            {"width", width}, {"height", height}, {"camera", {{"eye", {eye, -50, 30}}}}};
        const std::string text = body.dump();
        return "POST /api/v1/clouds/one/snapshot HTTP/1.1\r\nHost: localhost\r\nAccept: "
               "application/octet-stream\r\n" +
               sendsJson + "\r\nContent-Length: " + std::to_string(text.size()) + "\r\n\r\n" + text;
    }
    std::uint64_t held(const std::string& use) const {
        const std::string name = "scancast_transient_bytes{use=\"" + use + "\"}";
        const std::string line = metric(name);
        return line.empty() ? 0 : std::uint64_t(std::stod(line.substr(name.size())));
    }
};

TEST_F(MemoryTest, APictureThatThereIsNoMemoryForIsRefusedWithOneThatThereIs) {
    limitTo(40 * MB);
    start();
    const auto snapshot = [](int width, int height) {
        return "/api/v1/clouds/one/snapshot.png?width=" + std::to_string(width) +
               "&height=" + std::to_string(height);
    };
    const HttpReply refused = request(port(), snapshot(4000, 2000));
    ASSERT_EQ(refused.status, 413) << refused.body;
    const auto nearest = nlohmann::json::parse(refused.body).at("nearest");
    EXPECT_EQ(request(port(), snapshot(nearest.at("width"), nearest.at("height"))).status, 200)
        << refused.body;
    EXPECT_TRUE(eventually([&] { return held("frames") == 0 && held("answers") == 0; }));
}

TEST_F(MemoryTest, AStreamIsToldTheSame) {
    limitTo(20 * MB);
    start();
    StreamClient client(port());
    client.greet();
    client.say({{"type", "view"}, {"seq", 1}, {"width", 4000}, {"height", 2000}});
    const auto problem = client.control("problem");
    ASSERT_FALSE(problem.is_null());
    EXPECT_EQ(problem.at("problem").at("status"), 413);
    EXPECT_NE(problem.at("problem").at("detail").get<std::string>().find("would be drawn"), std::string::npos)
        << problem;
}

TEST_F(MemoryTest, WhoDoesNotReadGetsNoMoreUntilHeHas) {
    limitTo(64 * MB);  // 16 for answers, 8 for one client
    start();
    RawSocket deaf(port());
    deaf.send(depthOf(1400, 1400, 1));  // 7.8 MB, more than sockets buffer
    ASSERT_TRUE(eventually([&] { return held("answers") >= 7 * MB; }));
    RawSocket second(port());
    second.send(depthOf(700, 700, 2));
    const HttpReply refused = readReply(second);
    ASSERT_EQ(refused.status, 429) << refused.body;
    EXPECT_FALSE(refused.header("retry-after").empty());
    EXPECT_EQ(readReply(deaf).body.size(), 1400U * 1400 * 4);
    EXPECT_TRUE(eventually([&] {
        RawSocket again(port());
        again.send(depthOf(700, 700, 2));
        return readReply(again).status == 200;
    }));
    EXPECT_TRUE(eventually([&] { return held("answers") == 0; }));
}

TEST_F(MemoryTest, WhoSharesAPictureKeepsItWithoutAnotherCopy) {
    limitTo(64 * MB);
    start();
    painter.closeGate();
    RawSocket first(port()), second(port());
    first.send(depthOf(1400, 1400, 1));
    ASSERT_TRUE(painter.waitBegun(1));
    second.send(depthOf(1400, 1400, 1));
    ASSERT_TRUE(
        eventually([&] { return metric("scancast_pictures_awaited") == "scancast_pictures_awaited 2"; }));
    painter.openGate();
    ASSERT_TRUE(eventually([&] { return held("answers") > 0; }));
    EXPECT_LT(held("answers"), 8 * MB);
    EXPECT_EQ(readReply(first).body.size(), 1400U * 1400 * 4);
    EXPECT_GT(held("answers"), 7 * MB) << "the other has not read it";
    EXPECT_EQ(readReply(second).body.size(), 1400U * 1400 * 4);
    EXPECT_TRUE(eventually([&] { return held("answers") == 0; }));
}

TEST_F(MemoryTest, WhoReadsTooSlowlyIsCutOff) {
    options.limits.leastRate = {1 << 20, std::chrono::milliseconds(200)};
    start();
    RawSocket deaf(port());
    deaf.send(depthOf(2000, 2000, 1));
    ASSERT_TRUE(
        eventually([&] { return metric("scancast_slow_readers_total") == "scancast_slow_readers_total 1"; }));
    EXPECT_TRUE(eventually([&] { return held("answers") == 0; }));
    EXPECT_LT(readReply(deaf).body.size(), 2000U * 2000 * 4);
    EXPECT_EQ(request(port(), onePicture).status, 200) << "others are served";
}

TEST_F(MemoryTest, ConnectionsAndTextsAreCountedAndGiveBack) {
    start();
    {
        std::vector<std::unique_ptr<RawSocket>> many;
        for (int i = 0; i < 10; ++i) many.push_back(std::make_unique<RawSocket>(port()));
        EXPECT_TRUE(eventually([&] { return held("connections") >= 10 * bytesOfConnection; }));
        StreamClient stream(port());
        stream.greet();
        EXPECT_TRUE(eventually([&] { return held("connections") >= 11 * bytesOfConnection; }));
    }
    // The one that asks is connected, too.
    EXPECT_TRUE(eventually([&] { return held("connections") <= bytesOfConnection && held("streams") == 0; }));
    // What was answered before is given back when it has been written, perhaps after it has been read.
    EXPECT_TRUE(eventually([&] { return held("texts") == 0; }));
    EXPECT_NE(metric("scancast_transient_limit_bytes"), "");
    EXPECT_NE(metric("scancast_process_resident_bytes"), "");
}

}  // namespace
}  // namespace scancast::test
