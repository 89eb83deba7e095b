// What lies beneath a folder and what does not. Oracle: the kernel's own way and the one by hand share no
// code, and have to agree on every name.
#include "files/beneath.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <fstream>
#include <random>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

class Beneath : public ::testing::Test {
  protected:
    Beneath() {
        fs::create_directories(root / "sub");
        for (const fs::path& file : {root / "a", root / "sub" / "b", folder / "secret"})
            std::ofstream(file) << "x";
        const std::pair<const char*, fs::path> links[] = {{"in", "sub/b"},
                                                          {"sub/up", "../a"},
                                                          {"way", "sub"},
                                                          {"out", "../secret"},
                                                          {"sub/out", "../../secret"},
                                                          {"abs", root / "a"},
                                                          {"away", "/"},
                                                          {"loop", "loop"},
                                                          {"loop2", "sub/loop3"},
                                                          {"sub/loop3", "../loop2"},
                                                          {"dangling", "nowhere"},
                                                          {"round", "sub/../a"}};
        for (const auto& [name, target] : links) fs::create_symlink(target, root / name);
        ::mkfifo((root / "fifo").c_str(), 0600);
        opened.reset(::open(root.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    }
    /// Whether the kernel, or what this runs in, knows openat2().
    bool kernelCan() const {
        const auto tried = openBeneathByKernel(opened.get(), "a");
        return tried || (tried.error() != ENOSYS && tried.error() != EPERM);
    }
    static std::string told(const OpenedBeneath& found) {
        struct stat info {};
        if (!found) return "error " + std::to_string(found.error());
        if (::fstat(found->get(), &info) != 0) return "no descriptor";
        return "inode " + std::to_string(info.st_ino);
    }
    std::string inode(const fs::path& path) const {
        struct stat info {};
        return ::stat((root / path).c_str(), &info) == 0 ? "inode " + std::to_string(info.st_ino) : "missing";
    }

    const test::TemporaryFolder folder;
    const fs::path root = folder / "root";
    UniqueFd opened;
};

TEST_F(Beneath, NamesAndLinksThatStayInside) {
    const std::pair<const char*, const char*> names[] = {
        {"a", "a"},         {"sub/b", "sub/b"}, {"./sub/../a", "a"},  {"in", "sub/b"}, {"sub/up", "a"},
        {"way/b", "sub/b"}, {"way/../a", "a"},  {"round", "a"},       {"sub", "sub"},  {"sub/", "sub"},
        {".", "."},         {"way/..", "."},    {"sub/./b", "sub/b"}, {"way/up", "a"}};
    for (const auto& [name, leadsTo] : names) {
        EXPECT_EQ(told(openBeneathByHand(opened.get(), name)), inode(leadsTo)) << name;
        EXPECT_EQ(told(openBeneath(opened.get(), name)), inode(leadsTo)) << name;
    }
}

TEST_F(Beneath, WhatLeadsOutOrNowhere) {
    const std::pair<fs::path, int> names[] = {
        {"..", EXDEV},       {"../secret", EXDEV}, {"sub/../../secret", EXDEV},
        {"out", EXDEV},      {"sub/out", EXDEV},   {"abs", EXDEV},
        {"away/etc", EXDEV}, {root / "a", EXDEV},  {"way/../..", EXDEV},
        {"loop", ELOOP},     {"loop2", ELOOP},     {"dangling", ENOENT},
        {"none", ENOENT},    {"", ENOENT},         {"none/../a", ENOENT},
        {"a/x", ENOTDIR},    {"a/", ENOTDIR},      {"a/.", ENOTDIR},
        {"a/..", ENOTDIR},   {"in/", ENOTDIR},     {std::string("a\0b", 3), ENOENT}};
    for (const auto& [name, error] : names) {
        const std::string expected = "error " + std::to_string(error);
        EXPECT_EQ(told(openBeneathByHand(opened.get(), name)), expected) << name;
        EXPECT_EQ(told(openBeneath(opened.get(), name)), expected) << name;
    }
}

TEST_F(Beneath, ANamedPipeKeepsNobodyWaiting) {
    EXPECT_EQ(told(openBeneathByHand(opened.get(), "fifo")), inode("fifo"));
    EXPECT_EQ(told(openBeneath(opened.get(), "fifo")), inode("fifo"));
}

TEST_F(Beneath, KernelAndHandAgreeOnEveryName) {
    if (!kernelCan()) GTEST_SKIP() << "no openat2() here";
    constexpr const char* parts[] = {"a",   "b",   "sub", "..",   "..",    ".",     "in",    "up",
                                     "way", "out", "abs", "loop", "loop2", "loop3", "round", "none"};
    std::mt19937 random(11);
    for (int i = 0; i < 2000; ++i) {
        std::string name;
        for (int n = int(random() % 6) + 1; n > 0; --n)
            name += std::string(name.empty() ? "" : "/") + parts[random() % 16];
        if (random() % 8 == 0) name += '/';
        EXPECT_EQ(told(openBeneathByHand(opened.get(), name)), told(openBeneathByKernel(opened.get(), name)))
            << name;
    }
}

}  // namespace
}  // namespace scancast
