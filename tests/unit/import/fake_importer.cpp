// An importer that misbehaves as the first word of its file says; for tests of the process runner.
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace {

using scancast::PointBatch;
using scancast::PointStreamWriter;

PointStreamWriter writer(PointStreamWriter::toDescriptor(STDOUT_FILENO));

void header(std::uint64_t points) {
    scancast::ScanHeader scan;
    scan.format = "FAKE";
    if (points > 0) scan.points = points;
    if (!writer.writeHeader(scan)) _exit(3);
}

void points(std::size_t count, double x = 1) {
    PointBatch batch;
    batch.position.doubles().assign(count, {x, 2, 3});
    if (!writer.writeChunk(batch)) _exit(3);
}

void finish() {
    if (!writer.finish(0)) _exit(3);
}

[[noreturn]] void waitForEver() {
    for (;;) ::pause();
}

/// Ends by the signal itself: a sanitizer would catch it and make an exit status of it.
void dieOf(int signal) {
    ::signal(signal, SIG_DFL);
    ::raise(signal);
}

void good() {
    header(10);
    points(10);
    finish();
}

/// Who reads its output has to wait for it.
void late() {
    ::usleep(20'000);
    good();
}

/// Descriptors that it should not have, limits and environment that it should: exit status 0 only if all is
/// as promised.
void inspect() {
    if (::close(3) != 0) _exit(17);  // the scan
    for (int fd = 4; fd < 1000; ++fd)
        if (::close(fd) == 0) _exit(10);
    if (std::getenv("SCANCAST_TEST_SECRET") != nullptr) _exit(11);
    if (::getpgrp() != ::getpid()) _exit(12);
    char byte = 0;
    if (::read(STDIN_FILENO, &byte, 1) != 0) _exit(13);
    rlimit limit{};
    ::getrlimit(RLIMIT_CORE, &limit);
    if (limit.rlim_cur != 0) _exit(14);
    ::getrlimit(RLIMIT_CPU, &limit);
    if (limit.rlim_cur == RLIM_INFINITY) _exit(15);
    good();
}

/// More than the limit of the test; what is touched is nothing.
void bigAllocation() {
    header(10);
    const std::vector<char> big(std::size_t(3) << 30);
    points(big.empty() ? 0 : 10);
    finish();
}

/// For 1.6 s it sends nothing, and reads.
void readLong() {
    for (int i = 0; i < 16; ++i) {
        std::ifstream scan("/proc/self/fd/3");
        std::string word;
        scan >> word;
        ::usleep(100'000);
    }
    good();
}

/// As bigAllocation(), never to be written to.
void reserve() {
    if (::mmap(nullptr, std::size_t(3) << 30, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1,
               0) == MAP_FAILED)
        _exit(16);
    good();
}

const std::map<std::string, std::function<void()>> behaviours{
    {"good", good},
    {"late", late},
    {"inspect", inspect},
    {"crash", [] { dieOf(SIGSEGV); }},
    {"crash-midway",
     [] {
         header(10);
         points(5);
         dieOf(SIGSEGV);
     }},
    {"abort", [] { dieOf(SIGABRT); }},
    {"status",
     [] {
         std::fputs("first line\nthe scanner is out of paper\n", stderr);
         _exit(3);
     }},
    {"silent-end", [] {}},
    {"hang", [] { waitForEver(); }},
    {"hang-midway",
     [] {
         header(10);
         points(5);
         waitForEver();
     }},
    {"hang-with-noise",
     [] {
         for (;;) {
             std::fputs("still thinking\n", stderr);
             ::usleep(1000);
         }
     }},
    {"hang-after-end",
     [] {
         good();
         waitForEver();
     }},
    {"child-hangs",
     [] {
         if (::fork() == 0) waitForEver();
         header(10);
         waitForEver();
     }},
    {"garbage",
     [] {
         for (int i = 0; i < 100; ++i)
             std::puts("Reading scan.pcd ... everything is fine, here are your points: 1 2 3");
     }},
    {"nan",
     [] {
         header(10);
         points(10, std::numeric_limits<double>::quiet_NaN());
         finish();
     }},
    {"lie-more",
     [] {
         header(10);
         points(11);
         finish();
     }},
    {"lie-fewer",
     [] {
         header(10);
         points(9);
         finish();
     }},
    {"flood",
     [] {
         header(0);
         for (;;) points(65536);
     }},
    {"flood-errors",
     [] {
         for (int i = 0; i < 100000; ++i) std::fprintf(stderr, "line %d of a long complaint\n", i);
         good();
     }},
    {"failure",
     [] { (void)!writer.writeFailure({scancast::ErrorCode::Truncated, "it ends at byte 7", {}}); }},
    {"allocate", bigAllocation},
    {"reserve", reserve},
    {"read-long", readLong},
    {"spin",
     [] {
         while (::getppid() != 0) continue;
     }},
};

}  // namespace

int main(int argc, char** argv) {
    std::string word;
    if (argc != 2 || !(std::ifstream(argv[1]) >> word)) return 2;
    const auto found = behaviours.find(word);
    if (found == behaviours.end()) return 2;
    found->second();
    return 0;
}
