#include "server/terminal/service_manager.hpp"

#include <gmock/gmock.h>

#include "tests/support/environment_variable.hpp"
#include "tests/support/serving/notify_socket.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::EnvironmentVariable;
using test::NotifySocket;
using ::testing::HasSubstr;

Expected<ServiceManager> managerOf(const std::string& address, const char* watchdog = nullptr,
                                   const char* process = nullptr) {
    const EnvironmentVariable socket("NOTIFY_SOCKET", address.c_str());
    const EnvironmentVariable time("WATCHDOG_USEC", watchdog), pid("WATCHDOG_PID", process);
    auto manager = ServiceManager::fromEnvironment();
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"})
        EXPECT_EQ(std::getenv(name), nullptr) << name << " would be inherited by importers";
    return manager;
}

TEST(ServiceManager, IsToldByAPathAndByAnAbstractName) {
    const test::TemporaryFolder folder;
    for (const std::string& name : {folder.file("notify"), "@scancast-test-" + std::to_string(::getpid())}) {
        const NotifySocket listening(name);
        const auto manager = managerOf(name);
        ASSERT_TRUE(manager) << manager.error().message;
        EXPECT_TRUE(manager->listens());
        EXPECT_EQ(manager->watchdog(), std::nullopt);
        ASSERT_TRUE(manager->tell("READY=1\nSTATUS=grüße\n"));
        EXPECT_EQ(listening.next(), "READY=1\nSTATUS=grüße\n") << name;
    }
}

TEST(ServiceManager, NobodyListensWithoutAnAddress) {
    const auto manager = managerOf("");
    ASSERT_TRUE(manager);
    EXPECT_FALSE(manager->listens());
    EXPECT_TRUE(manager->tell("READY=1\n")) << "there is nobody whom it could fail to reach";
}

TEST(ServiceManager, ItsWatchdogIsOursUnlessItNamesAnotherProcess) {
    const std::string self = std::to_string(::getpid()), other = std::to_string(::getppid());
    using std::chrono::microseconds;
    EXPECT_EQ(managerOf("/run/x", "3000000")->watchdog(), microseconds(3000000));
    EXPECT_EQ(managerOf("/run/x", "3000000", self.c_str())->watchdog(), microseconds(3000000));
    EXPECT_EQ(managerOf("/run/x", "3000000", other.c_str())->watchdog(), std::nullopt);
}

TEST(ServiceManager, NonsenseInTheEnvironmentIsNamed) {
    for (const std::string& name :
         {std::string("relative"), std::string("/"), std::string("vsock:2:1"), "/" + std::string(200, 'x')}) {
        const auto manager = managerOf(name);
        ASSERT_FALSE(manager) << name;
        EXPECT_EQ(manager.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(manager.error().message, HasSubstr("NOTIFY_SOCKET=\"" + name + "\""));
    }
    for (const char* time : {"0", "-5", "3s", "99999999999999999999"}) {
        const auto manager = managerOf("/run/x", time);
        ASSERT_FALSE(manager) << time;
        EXPECT_THAT(manager.error().message, HasSubstr(std::string("WATCHDOG_USEC=\"") + time));
    }
}

TEST(ServiceManager, WhatDoesNotArriveIsAnError) {
    const test::TemporaryFolder folder;
    const auto manager = managerOf(folder.file("nobody"));
    ASSERT_TRUE(manager);
    const auto told = manager->tell("READY=1\n");
    ASSERT_FALSE(told);
    EXPECT_EQ(told.error().code, ErrorCode::Io);
    EXPECT_THAT(told.error().message, HasSubstr("NOTIFY_SOCKET"));
}

// A manager that does not read must not hold up the one who serves.
TEST(ServiceManager, TellingNeverWaits) {
    const test::TemporaryFolder folder;
    const NotifySocket full(folder.file("notify"));
    const auto manager = managerOf(full.name());
    ASSERT_TRUE(manager);
    int told = 0;
    while (told < 1'000'000 && manager->tell("WATCHDOG=1\n")) ++told;
    EXPECT_GT(told, 0);
    EXPECT_LT(told, 1'000'000) << "its queue is bounded, so one of them did not arrive, and that was said";
}

}  // namespace
}  // namespace scancast
