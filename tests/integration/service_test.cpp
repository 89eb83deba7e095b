// A server and the service manager that started it: what it is told while the server starts, draws, is stuck, and
// ends.
#include <gmock/gmock.h>

#include "server/commands/service_reports.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/environment_variable.hpp"
#include "tests/support/serving/notify_socket.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServiceTest : public ServerTest {
  protected:
    Service service(const char* watchdog) const {
        const EnvironmentVariable address("NOTIFY_SOCKET", manager.name().c_str());
        const EnvironmentVariable time("WATCHDOG_USEC", watchdog), process("WATCHDOG_PID", nullptr);
        auto found = ServiceManager::fromEnvironment();
        EXPECT_TRUE(found);
        return Service(std::move(*found));
    }
    /// Reports as the command does, until that has been told.
    bool reportsUntil(Service& service, const std::string& line) const {
        return eventually([&] {
            service.report(*server, false);
            return manager.all().find(line) != std::string::npos;
        });
    }
    const TemporaryFolder folder;
    const NotifySocket manager{folder.file("notify")};
};

TEST_F(ServiceTest, HearsThatTheServerIsReadyAndWhatItShows) {
    start();
    Service told = service(nullptr);
    told.report(*server, false);
    EXPECT_EQ(manager.all(),
              "READY=1\nSTATUS=" + server->url() + ", 2 of 2 clouds ready, drawing with fake\n");
    server->catalog().add("three");
    told.report(*server, false);
    EXPECT_THAT(manager.all(), HasSubstr("2 of 3 clouds"));
    told.report(*server, true);
    EXPECT_THAT(manager.all(), HasSubstr("STOPPING=1\n"));
}

// The gate stands for a driver that hangs.
TEST_F(ServiceTest, HearsNoSignOfLifeWhileTheRenderThreadIsStuck) {
    start();
    Service told = service("400000");
    ASSERT_TRUE(reportsUntil(told, "WATCHDOG=1\n"));
    painter.closeGate();
    std::thread client([this] { request(port(), onePicture); });
    ASSERT_TRUE(painter.waitBegun(1));
    const bool noticed = eventually([this] { return server->silence() > std::chrono::milliseconds(200); });
    manager.all();
    for (int i = 0; i < 10; ++i) told.report(*server, false);
    EXPECT_THAT(manager.all(), Not(HasSubstr("WATCHDOG=1")));
    painter.openGate();
    client.join();
    EXPECT_TRUE(noticed);
    EXPECT_TRUE(reportsUntil(told, "WATCHDOG=1\n")) << "it came back";
}

}  // namespace
}  // namespace scancast::test
