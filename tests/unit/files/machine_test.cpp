// What control groups grant, of both versions, as containers and systemd lay them out.
#include "files/machine.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <latch>
#include <thread>

#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

class GroupLimitsTest : public ::testing::Test {
  protected:
    void put(const std::string& path, const std::string& text) {
        const auto file = folder.path() / path;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    GroupLimits limits(const std::string& membership) const { return groupLimits(folder.path(), membership); }

    TemporaryFolder folder;
};

TEST_F(GroupLimitsTest, OfVersion2AreTheTightestOnTheWayUp) {
    put("memory.max", "max\n");
    put("system.slice/memory.max", "2147483648\n");
    put("system.slice/cpu.max", "150000 100000\n");
    put("system.slice/scancast.service/memory.max", "4294967296\n");
    put("system.slice/scancast.service/cpu.max", "max 100000\n");
    const GroupLimits found = limits("0::/system.slice/scancast.service\n");
    EXPECT_EQ(found.memory, 2147483648u);
    EXPECT_EQ(found.cores, 1.5);
}

TEST_F(GroupLimitsTest, OfVersion1StandWithTheirControllers) {
    put("memory/docker/abc/memory.limit_in_bytes", "1073741824\n");
    put("memory/memory.limit_in_bytes", "9223372036854771712\n");
    put("cpu/docker/abc/cpu.cfs_quota_us", "50000\n");
    put("cpu/docker/abc/cpu.cfs_period_us", "100000\n");
    put("cpu/cpu.cfs_quota_us", "-1\n");
    put("cpu/cpu.cfs_period_us", "100000\n");
    const GroupLimits found = limits("7:cpu,cpuacct:/docker/abc\n4:memory:/docker/abc\n0::/\n");
    EXPECT_EQ(found.memory, 1073741824u);
    EXPECT_EQ(found.cores, 0.5);
}

TEST_F(GroupLimitsTest, WithinAContainerTheGroupItselfIsWhatIsMounted) {
    put("memory.max", "536870912\n");
    EXPECT_EQ(limits("0::/docker/not-seen-from-here\n").memory, 536870912u);
}

TEST_F(GroupLimitsTest, NoneAreFoundWhereThereAreNone) {
    put("memory.max", "max\n");
    put("cpu.max", "nonsense\n");
    for (const char* membership : {"", "0::/\n", "0::/../../etc\n", "nonsense", "4:memory:/\n::"}) {
        const GroupLimits found = limits(membership);
        EXPECT_EQ(found.memory, std::nullopt) << membership;
        EXPECT_EQ(found.cores, std::nullopt) << membership;
    }
}

TEST(Machine, CountsTheFilesAndThreadsOfThisProcess) {
    const std::size_t files = openFileCount(), threads = threadCount();
    EXPECT_GE(threads, 1u);
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    EXPECT_EQ(openFileCount(), files + 2);
    ::close(ends[0]);
    ::close(ends[1]);
    EXPECT_EQ(openFileCount(), files);
    std::latch counted(1);
    std::jthread another([&] { counted.wait(); });
    EXPECT_EQ(threadCount(), threads + 1);
    counted.count_down();
}

TEST(Machine, HasSomethingAndNoMoreThanThereIs) {
    EXPECT_GT(machineMemory(), 1u << 20);
    EXPECT_GE(machineCores(), 1);
    EXPECT_LE(machineCores(), int(std::max(1u, std::thread::hardware_concurrency())));
    EXPECT_GT(residentMemory(), 1u << 20);
    EXPECT_LE(residentMemory(), std::uint64_t(1) << 50);
}

}  // namespace
}  // namespace scancast::test
