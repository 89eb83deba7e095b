// What programs live through: their readers going away, no room for a file, streams that nobody opened. In
// processes of their own: signals and limits are a whole process's.
#include "files/program_start.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>

#include "files/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

/// Exit status of a child that does this; -1 when a signal ended it.
int statusOf(const std::function<int()>& work) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(work());
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ProgramStart, AReaderThatWentAwayIsAnError) {
    EXPECT_EQ(statusOf([] {
                  startProgram();
                  int ends[2];
                  if (::pipe(ends) != 0) return 1;
                  ::close(ends[0]);
                  return ::write(ends[1], "x", 1) < 0 && errno == EPIPE ? 0 : 2;
              }),
              0);
}

TEST(ProgramStart, AFileThatMayNotGrowIsAnErrorAndLeavesNothing) {
    const test::TemporaryFolder folder;
    const std::string name = folder.file("picture.png");
    EXPECT_EQ(statusOf([&] {
                  startProgram();
                  const rlimit most{1000, 1000};
                  if (::setrlimit(RLIMIT_FSIZE, &most) != 0) return 1;
                  const std::vector<std::byte> bytes(5000);
                  const auto written = writeWholeFile(name, bytes);
                  if (written) return 2;
                  if (written.error().code != ErrorCode::ResourceLimit) return 3;
                  const std::string& text = written.error().message;
                  return text.find(name) != text.npos && text.find("ulimit -f") != text.npos ? 0 : 4;
              }),
              0);
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(ProgramStart, NoFileGetsTheNumberOfAStandardStream) {
    EXPECT_EQ(statusOf([] {
                  for (int fd = 0; fd < 3; ++fd) ::close(fd);
                  startProgram();
                  return ::open("/dev/null", O_RDONLY) > 2 ? 0 : 1;
              }),
              0);
}

}  // namespace
}  // namespace scancast
