#include "server/net/log/request_log.hpp"

#include <fcntl.h>

#include "tests/support/serving/log_file.hpp"

namespace scancast {
namespace {

using namespace std::chrono_literals;

RequestRecord recordOf(int status, std::string_view route = "/api/v1/clouds") {
    RequestRecord record;
    record.client = "192.0.2.7";
    record.method = "GET";
    record.target = "/api/v1/clouds";
    record.route = route;
    record.status = status;
    record.ids.request = "abc";
    return record;
}

class RequestLogTest : public ::testing::Test {
  protected:
    bool counted(const std::string& line) const {
        return metrics.text().find("\n" + line + "\n") != std::string::npos;
    }

    test::LogFile file;
    Metrics metrics{"1"};
};

TEST_F(RequestLogTest, ARequestIsALineWithAllThatIsKnown) {
    RequestLog log({file.writer()}, metrics);
    RequestRecord record = recordOf(200);
    record.begun = RequestLog::Clock::now();
    record.bytes = 512;
    record.price = 0.25;
    record.token = "ci";
    record.ids = RequestIds::of("abc", "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01");
    log.add(record, record.begun + 1500us);
    const auto line = file.events().at(0);
    const nlohmann::json wanted{{"event", "request"},
                                {"client", "192.0.2.7"},
                                {"method", "GET"},
                                {"path", "/api/v1/clouds"},
                                {"route", "/api/v1/clouds"},
                                {"status", 200},
                                {"bytes", 512},
                                {"ms", 1.5},
                                {"price", 0.25},
                                {"token", "ci"},
                                {"request", "abc"},
                                {"trace", "0af7651916cd43dd8448eb211c80319c"},
                                {"parent", "b7ad6b7169203331"},
                                {"span", record.ids.span},
                                {"sampled", true},
                                {"level", "info"}};
    for (const auto& [key, value] : wanted.items()) EXPECT_EQ(line.at(key), value) << key;
    EXPECT_EQ(line.at("message"),
              "GET /api/v1/clouds 200, 512 bytes in 1.5 ms, price 0.250 s, for 192.0.2.7, token ci, request "
              "abc, trace "
              "0af7651916cd43dd8448eb211c80319c span " +
                  record.ids.span + " of b7ad6b7169203331");
    EXPECT_TRUE(counted("scancast_request_log_lines_total{outcome=\"written\"} 1")) << metrics.text();
}

TEST_F(RequestLogTest, ProbesAreSaidWhenTheyAreNotAnsweredWell) {
    RequestLog log({file.writer()}, metrics);
    for (const char* probe : {"/healthz", "/readyz", "/metrics"}) log.add(recordOf(200, probe));
    EXPECT_EQ(file.text(), "");
    log.add(recordOf(503, "/readyz"));
    EXPECT_EQ(file.events().at(0).at("status"), 503);
    test::LogFile all;
    RequestLog loud({all.writer("debug")}, metrics);
    loud.add(recordOf(200, "/healthz"));
    EXPECT_EQ(all.events().at(0).at("level"), "debug");
}

TEST_F(RequestLogTest, AFloodIsAFewLinesAndACount) {
    const auto start = RequestLog::Clock::now();
    {
        RequestLog log({file.writer()}, metrics);
        for (int i = 0; i < 10'000; ++i) log.add(recordOf(404), start);
        EXPECT_EQ(file.events().size(), 5u);
        log.passTime(start + 59s);
        EXPECT_EQ(file.events().size(), 5u);
        log.passTime(start + 61s);
        ASSERT_EQ(file.events().size(), 6u);
        const auto told = file.events().back();
        EXPECT_EQ(told.at("event"), "repeated");
        EXPECT_EQ(told.at("times"), 9995);
        EXPECT_EQ(told.at("status"), 404);
        EXPECT_EQ(told.at("client"), "192.0.2.7");
        EXPECT_TRUE(counted("scancast_request_log_lines_total{outcome=\"repeated\"} 9995"));
        for (int i = 0; i < 7; ++i) log.add(recordOf(404), start + 62s);
    }
    EXPECT_EQ(file.events().back().at("times"), 2) << "the end says what was left out";
}

TEST_F(RequestLogTest, RequestsAreInFlightUntilTheyAreAnsweredOrLeft) {
    RequestLog log({file.writer()}, metrics);
    {
        RequestLog::Request one = log.begin(recordOf(200)), two = log.begin(recordOf(0)),
                            three = log.begin(recordOf(101));
        EXPECT_TRUE(counted("scancast_http_requests_in_flight 3"));
        one.answered(10);
        one.answered(20);
        EXPECT_EQ(three.handOver().status, 101);
        EXPECT_FALSE(three);
        EXPECT_TRUE(counted("scancast_http_requests_in_flight 1"));
        EXPECT_EQ(file.events().size(), 1u) << "once";
    }
    EXPECT_TRUE(counted("scancast_http_requests_in_flight 0"));
    ASSERT_EQ(file.events().size(), 2u);
    EXPECT_EQ(file.events()[0].at("bytes"), 10);
    EXPECT_EQ(file.events()[1].at("status"), 499);
    EXPECT_EQ(file.events()[1].at("note"), "left");
}

TEST_F(RequestLogTest, LinesThatNobodyReadAreCountedAndTold) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    {
        RequestLog log({*EventWriter::create("info", "text", ends[1]), std::nullopt}, metrics);
        for (int i = 0; i < 3000; ++i) log.add(recordOf(200));
        EXPECT_FALSE(counted("scancast_request_log_lines_total{outcome=\"lost\"} 0"));
        std::string read(1 << 20, ' ');
        EXPECT_GT(::read(ends[0], read.data(), read.size()), 0);
        log.add(recordOf(200));
        const ssize_t n = ::read(ends[0], read.data(), read.size());
        ASSERT_GT(n, 0);
        EXPECT_NE(read.substr(0, std::size_t(n)).find(" lines of the request log were lost"),
                  std::string::npos);
    }
    ::close(ends[0]);
    ::close(ends[1]);
}

TEST_F(RequestLogTest, WithoutAWriterThereIsNone) {
    RequestLog log({}, metrics);
    log.add(recordOf(200));
    log.passTime(RequestLog::Clock::now());
    EXPECT_TRUE(counted("scancast_request_log_lines_total{outcome=\"written\"} 0"));
}

}  // namespace
}  // namespace scancast
