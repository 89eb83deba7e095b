#include "server/base/metrics.hpp"

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
    metrics.setConnections(12);
    metrics.connectionRefused(ConnectionRefusal::Address);
    metrics.connectionDisplaced();
    metrics.loginFailed(LoginFailure::Unknown);
    metrics.setPointsResident(1234);
    metrics.setPicturesAwaited(3);
    metrics.httpRequest("/api/v1/clouds/{id}", 404);
    metrics.priceEnded(std::nullopt, 1.5);
    metrics.priceEnded(DropReason::Gone, 0.5);
    metrics.pictureWaited("snapshot", 0.04);
    metrics.setQueues({1, 2, 3, 4, 5});
    metrics.setMemory(TransientMemory(4000));
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
             "scancast_connections 12",
             "scancast_connections_refused_total{reason=\"address\"} 1",
             "scancast_connections_refused_total{reason=\"full\"} 0",
             "scancast_connections_displaced_total 1",
             "scancast_failed_logins_total{reason=\"unknown\"} 1",
             "scancast_failed_logins_total{reason=\"expired\"} 0",
             "scancast_points_resident 1234",
             "scancast_pictures_awaited 3",
             "scancast_price_ended_seconds_total{outcome=\"drawn\"} 1.5",
             "scancast_price_ended_seconds_total{outcome=\"gone\"} 0.5",
             "scancast_wait_seconds_bucket{kind=\"snapshot\",le=\"0.05\"} 1",
             "scancast_wait_seconds_bucket{kind=\"snapshot\",le=\"0.033\"} 0",
             "scancast_queue_length{queue=\"views\"} 1",
             "scancast_queue_length{queue=\"stills\"} 2",
             "scancast_queue_length{queue=\"snapshots\"} 3",
             "scancast_queue_length{queue=\"blocks\"} 4",
             "scancast_queue_length{queue=\"encodings\"} 5",
             "scancast_transient_part_bytes{use=\"frames\"} 2000",
             "scancast_transient_part_bytes{use=\"streams\"} 1000",
             "scancast_http_requests_total{code=\"404\",route=\"/api/v1/clouds/{id}\"} 1",
             "scancast_build_info{version=\"9.8.7\"} 1",
             "# TYPE scancast_frames_sent_total counter",
         }) {
        EXPECT_THAT(text, HasSubstr(line));
    }
}

TEST(Metrics, TellWhatDrawsAndHowOftenItWasLost) {
    Metrics metrics("1");
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_devices_lost_total 0"));
    metrics.setDevice("egl", "a GPU");
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_device_info{name=\"egl\",renderer=\"a GPU\"} 1"));
    metrics.deviceLost();
    metrics.setDevice("cpu", "x86-64-v3");
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_device_info{name=\"cpu\",renderer=\"x86-64-v3\"} 1"));
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_devices_lost_total 1"));
    EXPECT_THAT(metrics.text(), testing::Not(HasSubstr("name=\"egl\"")));
    metrics.setDevice("", "");
    EXPECT_THAT(metrics.text(), testing::Not(HasSubstr("scancast_device_info{")));
}

TEST(Metrics, ResidencyIsToldAsItIsAndCountersOnlyRise) {
    Metrics metrics("1");
    metrics.frameRendered("cone", 0.02, false);
    metrics.frameSent(0.05, true);
    metrics.frameSent(0.05);
    BlockCacheStats stats;
    stats.limit = 1000;
    stats.bytes = 900;
    stats.blocksLoaded = 7;
    stats.blocksEvicted = 3;
    stats.blocksDamaged = 1;
    metrics.setResidency(stats);
    stats.bytes = 400;
    stats.blocksLoaded = 9;
    metrics.setResidency(stats);
    const std::string text = metrics.text();
    for (const char* line : {"scancast_frames_incomplete_total 1\n", "scancast_frames_away_total 1\n",
                             "scancast_residency_limit_bytes 1000\n", "scancast_residency_bytes 400\n",
                             "scancast_blocks_loaded_total 9\n", "scancast_blocks_evicted_total 3\n",
                             "scancast_block_load_errors_total 1\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
}

TEST(Metrics, RemoteCloudsAreToldAsTheyAre) {
    Metrics metrics("1");
    RemoteStats stats;
    stats.brokenPieces = 2;
    stats.folderBytes = 900;
    stats.folderLimit = 1000;
    stats.away = 1;
    metrics.setRemote(stats);
    stats.brokenPieces = 3;
    stats.folderBytes = 100;
    metrics.setRemote(stats);
    for (const char* line : {"scancast_remote_broken_pieces_total 3\n", "scancast_remote_cache_bytes 100\n",
                             "scancast_remote_cache_limit_bytes 1000\n", "scancast_remote_clouds_away 1\n"})
        EXPECT_THAT(metrics.text(), HasSubstr(line));
}

TEST(Metrics, KeptCloudsAreToldAsTheyAre) {
    Metrics metrics("1");
    metrics.setKeptClouds(900, 1000, 3);
    metrics.setKeptClouds(400, 1000, 5);
    for (const char* line : {"scancast_kept_clouds_bytes 400\n", "scancast_kept_clouds_limit_bytes 1000\n",
                             "scancast_kept_clouds_evicted_total 5\n"})
        EXPECT_THAT(metrics.text(), HasSubstr(line));
}

TEST(Metrics, TheDevicesMemoryIsToldAsItIs) {
    Metrics metrics("1");
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_device_memory_bytes 0\n"));
    metrics.setDeviceMemory(5000);
    metrics.setDeviceMemory(3000);
    EXPECT_THAT(metrics.text(), HasSubstr("scancast_device_memory_bytes 3000\n"));
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
