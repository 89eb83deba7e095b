// What pictures cost, over a real socket: who asks for too much is told what he would get, and work for who has gone
// ends.
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

class CostTest : public ServerTest {
  protected:
    static std::string snapshot(const std::string& query) {
        return "/api/v1/clouds/one/snapshot.jpg?method=paraboloid&" + query;
    }
};

TEST_F(CostTest, TooMuchIsRefusedAtOnceAndTheNearestIsDrawn) {
    start();
    const HttpReply refused = request(port(), snapshot("width=16384&height=3906&samples=64&detail=0.01"));
    ASSERT_EQ(refused.status, 413) << refused.body;
    EXPECT_TRUE(painter.begun().empty());
    const auto problem = nlohmann::json::parse(refused.body);
    EXPECT_GT(problem.at("price"), problem.at("limit"));
    EXPECT_EQ(problem.at("limit"), 20000);
    ASSERT_TRUE(problem.at("nearest").contains("samples")) << refused.body;
    const std::string samples = std::to_string(problem.at("nearest").at("samples").get<int>());
    EXPECT_NE(problem.at("detail").get<std::string>().find("samples=" + samples), std::string::npos);
    const HttpReply nearest =
        request(port(), snapshot("width=16384&height=3906&detail=0.01&samples=" + samples), {}, "HEAD");
    EXPECT_EQ(nearest.status, 200);
    EXPECT_EQ(metric("scancast_pictures_refused_total{by=\"picture\"}"),
              "scancast_pictures_refused_total{by=\"picture\"} 1");
}

TEST_F(CostTest, AScreenOfSixteenSamplesIsDrawnAndTellsItsPrice) {
    start();
    const HttpReply reply = request(port(), snapshot("width=3840&height=2160&samples=16"));
    EXPECT_EQ(reply.status, 200);
    EXPECT_GT(std::stod(reply.header("scancast-price")), 500);
    EXPECT_LT(std::stod(reply.header("scancast-price")), 20000);
}

TEST_F(CostTest, WhoWaitsForMuchIsToldToComeAgain) {
    options.costs = {.picture = 1000, .client = 1500, .total = 100'000};
    start();
    painter.closeGate();
    RawSocket waiting(port());
    const std::string large = "width=3840&height=2160&samples=16";
    waiting.send("GET " + snapshot(large) + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(painter.waitBegun(1));
    const HttpReply again = request(port(), snapshot(large + "&quality=50"));
    ASSERT_EQ(again.status, 429) << again.body;
    EXPECT_EQ(again.header("retry-after"), "1");
    EXPECT_EQ(nlohmann::json::parse(again.body).at("limit"), 1500);
    EXPECT_EQ(metric("scancast_pictures_refused_total{by=\"client\"}"),
              "scancast_pictures_refused_total{by=\"client\"} 1");
    painter.openGate();
    EXPECT_EQ(readReply(waiting).status, 200);
    EXPECT_EQ(request(port(), snapshot(large + "&quality=50")).status, 200)
        << "what has come is not waited for";
}

TEST_F(CostTest, APictureThatIsUnderWayCostsNothing) {
    options.costs = {.picture = 1000, .client = 1500, .total = 100'000};
    start();
    painter.closeGate();
    RawSocket first(port()), second(port());
    const std::string asked =
        "GET " + snapshot("width=3840&height=2160&samples=16") + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    first.send(asked);
    ASSERT_TRUE(painter.waitBegun(1));
    second.send(asked);
    ASSERT_TRUE(
        eventually([&] { return metric("scancast_pictures_awaited") == "scancast_pictures_awaited 2"; }));
    painter.openGate();
    EXPECT_EQ(readReply(first).status, 200);
    EXPECT_EQ(readReply(second).status, 200);
}

TEST_F(CostTest, AStreamIsToldTheSame) {
    options.costs.picture = 100;
    start();
    StreamClient client(port());
    client.greet();
    client.say({{"type", "view"},
                {"seq", 1},
                {"width", 3840},
                {"height", 2160},
                {"samples", 64},
                {"method", "paraboloid"}});
    const auto problem = client.control("problem");
    ASSERT_FALSE(problem.is_null());
    EXPECT_EQ(problem.at("problem").at("status"), 413);
    EXPECT_NE(problem.at("problem").at("detail").get<std::string>().find("samples="), std::string::npos)
        << problem;
}

TEST_F(CostTest, WorkForWhoHasGoneEnds) {
    start();
    painter.closeGate();
    for (const bool reset : {false, true}) {
        const int before = painter.cancelled();
        {
            RawSocket client(port());
            client.send("GET " + snapshot("width=64&height=64&quality=" + std::to_string(40 + reset)) +
                        " HTTP/1.1\r\nHost: localhost\r\n\r\n");
            ASSERT_TRUE(painter.waitBegun(1 + std::size_t(reset)));
            if (reset) client.abort();
        }
        EXPECT_TRUE(eventually([&] { return painter.cancelled() == before + 1; })) << reset;
    }
    EXPECT_TRUE(
        eventually([&] { return metric("scancast_pictures_awaited") == "scancast_pictures_awaited 0"; }));
    {
        StreamClient viewer(port());
        viewer.greet();
        viewer.view(1, 1);
        ASSERT_TRUE(painter.waitBegun(3));
    }
    EXPECT_TRUE(eventually([&] { return painter.cancelled() == 3; })) << "of a stream, even a moving frame";
}

}  // namespace
}  // namespace scancast::test
