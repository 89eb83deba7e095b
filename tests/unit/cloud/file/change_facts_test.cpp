// Facts change and nothing else does; wherever a change is cut off, the file has the old facts or the new ones.
#include "renderer/cloud/file/change_facts.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "files/unique_fd.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ChangeFacts : public testing::Test {
  protected:
    void SetUp() override {
        const auto cloud = test::sampleCloud(500);
        ASSERT_TRUE(test::writeCloudFile(path_, cloud->octree, test::fullFacts(*cloud, true)));
        old_ = test::fileBytes(path_);
        facts_ = CloudFile::open(path_).value()->facts();
        facts_.title = "another title";
    }

    static std::string titleOf(const fs::path& path) { return CloudFile::open(path).value()->facts().title; }
    void put(std::span<const std::byte> bytes) const {
        std::ofstream(path_, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    }
    void expectRefused(ErrorCode code, const std::string& why) const {
        const auto before = test::fileBytes(path_);
        const auto changed = rewriteFacts(path_, facts_);
        ASSERT_FALSE(changed);
        EXPECT_EQ(changed.error().code, code);
        EXPECT_THAT(changed.error().message, HasSubstr(path_.string()));
        EXPECT_THAT(changed.error().message, HasSubstr(why));
        EXPECT_EQ(test::fileBytes(path_), before);
    }

    const test::TemporaryFolder folder_;
    const fs::path path_ = folder_.path() / "a.scan";
    std::vector<std::byte> old_;
    CloudFacts facts_;
};

TEST_F(ChangeFacts, NewFactsStandBehindTheOldOnes) {
    const auto before = CloudFile::open(path_).value();
    facts_.mirrors.clear();
    facts_.revision = "0123";
    const auto changed = rewriteFacts(path_, facts_);
    ASSERT_TRUE(changed) << changed.error().message;
    const auto file = CloudFile::open(path_).value();
    test::expectSameFacts(file->facts(), facts_);
    EXPECT_EQ(file->writtenBy(), before->writtenBy());
    const auto now = test::fileBytes(path_);
    EXPECT_TRUE(std::equal(old_.begin() + cloudHeaderBytes, old_.end(), now.begin() + cloudHeaderBytes));
    EXPECT_EQ(folder_.entries(), 1u);
    for (std::uint32_t i = 0; i < file->nodes().size(); ++i) {
        EXPECT_EQ(file->rows(i).value(), before->rows(i).value()) << "who has it open keeps reading";
        EXPECT_EQ(file->samples(i).value().size(), before->samples(i).value().size());
    }
}

TEST_F(ChangeFacts, AnyNumberOfTimes) {
    for (int i = 0; i < 5; ++i) {
        facts_.title = std::to_string(i);
        ASSERT_TRUE(rewriteFacts(path_, facts_));
        EXPECT_EQ(titleOf(path_), facts_.title);
    }
}

// Every file that a change can leave when it is cut off: the header is written last, in one piece.
TEST_F(ChangeFacts, CutOffAnywhere) {
    const std::string title = titleOf(path_);
    ASSERT_TRUE(rewriteFacts(path_, facts_));
    const auto whole = test::fileBytes(path_);
    for (std::size_t length = old_.size(); length <= whole.size(); length += 37) {
        auto left = std::vector<std::byte>(whole.begin(), whole.begin() + std::ptrdiff_t(length));
        std::copy_n(old_.begin(), cloudHeaderBytes, left.begin());
        put(left);
        ASSERT_EQ(titleOf(path_), title) << length;
        const auto again = rewriteFacts(path_, facts_);
        ASSERT_TRUE(again) << again.error().message;
        ASSERT_EQ(test::fileBytes(path_), whole) << "what meant nothing is written over";
    }
}

// Killed at any moment of a loop of changes: the file is whole, with one title or the other.
TEST_F(ChangeFacts, KilledAtAnyMoment) {
    for (int round = 0; round < 15; ++round) {
        put(old_);
        const pid_t child = ::fork();
        if (child == 0)
            for (;;) {
                facts_.title = facts_.title == "odd" ? "even" : "odd";
                if (!rewriteFacts(path_, facts_)) ::_exit(1);
            }
        ::usleep(useconds_t(300 + 900 * round));
        ::kill(child, SIGKILL);
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status));
        const auto file = CloudFile::open(path_);
        ASSERT_TRUE(file) << file.error().message;
        for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) ASSERT_TRUE((*file)->samples(i));
        ASSERT_TRUE(rewriteFacts(path_, facts_)) << "the lock ended with who held it";
    }
}

TEST_F(ChangeFacts, WhoOpensMeanwhileGetsTheOldOrTheNew) {
    const pid_t child = ::fork();
    if (child == 0) {
        for (int i = 0; i < 200; ++i) {
            facts_.title = i % 2 == 0 ? "even" : "odd";
            if (!rewriteFacts(path_, facts_)) ::_exit(1);
        }
        ::_exit(0);
    }
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        const auto file = CloudFile::open(path_);
        ASSERT_TRUE(file) << file.error().message;
    }
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(ChangeFacts, WhatSomebodyElseIsChangingIsRefused) {
    const UniqueFd other(::open(path_.c_str(), O_RDONLY | O_CLOEXEC));
    ASSERT_EQ(::flock(other.get(), LOCK_EX), 0);
    expectRefused(ErrorCode::InvalidArgument, "somebody else is changing this file");
    ASSERT_EQ(::flock(other.get(), LOCK_UN), 0);
    EXPECT_TRUE(rewriteFacts(path_, facts_));
}

TEST_F(ChangeFacts, FactsOfAnotherCloudAreRefused) {
    const CloudFacts sound = facts_;
    const std::vector<std::function<void(CloudFacts&)>> changes{
        [](auto& f) { ++f.points; },
        [](auto& f) { f.columns.pop_back(); },
        [](auto& f) { f.columns[0].column.type = ColumnType::Int64; },
        [](auto& f) { f.companions.clear(); },
        [](auto& f) { f.companions[0].of = ValuePlane::Of::Points; },
    };
    for (const auto& change : changes) {
        facts_ = sound;
        change(facts_);
        expectRefused(ErrorCode::InvalidArgument, "is of another cloud");
    }
}

TEST_F(ChangeFacts, FactsThatCouldNotBeReadAreRefused) {
    facts_.spacing = -1;
    expectRefused(ErrorCode::InvalidArgument, "\"spacing\" is negative");
}

TEST_F(ChangeFacts, OnlySoundCloudFilesAreChanged) {
    put(std::as_bytes(std::span("LASF, a long way from a cloud file")));
    expectRefused(ErrorCode::Unsupported, "no cloud file");
    auto damaged = old_;
    damaged[30] ^= std::byte(1);
    put(damaged);
    expectRefused(ErrorCode::Malformed, "header is damaged");
    damaged = old_;
    damaged.back() ^= std::byte(1);
    put(damaged);
    expectRefused(ErrorCode::Malformed, "description is damaged");
    EXPECT_EQ(rewriteFacts(folder_.path() / "none.scan", facts_).error().code, ErrorCode::NotFound);
    EXPECT_EQ(rewriteFacts(folder_.path(), facts_).error().code, ErrorCode::Unsupported);
    const auto pipe = folder_.path() / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(rewriteFacts(pipe, facts_).error().code, ErrorCode::Unsupported) << "and nobody waits";
}

// A limit on the size of files refuses writes as a full disk does, and hits only the child.
TEST_F(ChangeFacts, AFullDiskLeavesTheOldFacts) {
    const std::string title = titleOf(path_);
    for (const rlim_t room : {rlim_t(0), rlim_t(500)}) {
        const pid_t child = ::fork();
        if (child == 0) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit small{old_.size() + room, old_.size() + room};
            if (::setrlimit(RLIMIT_FSIZE, &small) != 0) ::_exit(10);
            const auto changed = rewriteFacts(path_, facts_);
            ::_exit(!changed && changed.error().code == ErrorCode::ResourceLimit ? 0 : 11);
        }
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 0) << "with room for " << room << " bytes";
        EXPECT_EQ(titleOf(path_), title);
    }
    EXPECT_TRUE(rewriteFacts(path_, facts_));
}

/// The header as it looks while somebody writes it, once; then as it is.
class TornOnce final : public RandomReader {
  public:
    explicit TornOnce(std::span<const std::byte> bytes) : whole_(readerOf(bytes)) {}
    std::uint64_t size() const override { return whole_->size(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        auto got = whole_->readAt(offset, into);
        if (std::exchange(torn_, false)) into[60] ^= std::byte(1);
        return got;
    }

  private:
    const std::unique_ptr<RandomReader> whole_;
    mutable bool torn_ = true;
};

TEST_F(ChangeFacts, AHeaderInTheMiddleOfAChangeIsReadAgain) {
    const auto file = CloudFile::open(std::make_unique<TornOnce>(old_), "torn.scan");
    EXPECT_TRUE(file) << file.error().message;
}

}  // namespace
}  // namespace scancast
