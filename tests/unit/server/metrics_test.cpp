#include "server/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scancast {
namespace {

using ::testing::HasSubstr;

TEST(Metrics, NamesAndUnitsOfTheProtocol) {
    Metrics metrics("9.8.7");
    metrics.frameRendered("cone", 0.02);
    metrics.frameEncoded(0.003, 50000);
    metrics.frameSent(0.05);
    metrics.frameDropped(DropReason::Overwritten);
    metrics.sessionOpened();
    metrics.setPointsResident(1234);
    metrics.httpRequest("/api/v1/clouds/{id}", 404);
    const std::string text = metrics.text();
    for (const char* line : {
             "scancast_frame_render_seconds_count{method=\"cone\"} 1",
             "scancast_frame_encode_seconds_count 1",
             "scancast_frame_bytes_sum 50000",
             "scancast_frames_sent_total 1",
             "scancast_frames_dropped_total{reason=\"overwritten\"} 1",
             "scancast_frames_dropped_total{reason=\"deadline\"} 0",
             "scancast_view_to_frame_seconds_count 1",
             "scancast_sessions 1",
             "scancast_points_resident 1234",
             "scancast_http_requests_total{code=\"404\",route=\"/api/v1/clouds/{id}\"} 1",
             "scancast_build_info{version=\"9.8.7\"} 1",
             "# TYPE scancast_frames_sent_total counter",
         }) {
        EXPECT_THAT(text, HasSubstr(line));
    }
}

TEST(Metrics, SessionsComeAndGo) {
    Metrics metrics("1");
    metrics.sessionOpened();
    metrics.sessionOpened();
    metrics.sessionClosed();
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_sessions 1\n"));
}

}  // namespace
}  // namespace scancast
