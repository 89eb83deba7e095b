// Where tests find real scans, and how they say that one is missing.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace scancast::test {

inline std::filesystem::path testData(const char* relative) {
    return std::filesystem::path(SCANCAST_TEST_DATA) / relative;
}

}  // namespace scancast::test

/// At the top of a test: skips it, by name, when the real scan is not on this machine.
#define REQUIRE_TEST_DATA(relative)                                                                            \
    if (!std::filesystem::exists(::scancast::test::testData(relative)))                                        \
    GTEST_SKIP() << "MISSING TEST DATA: " << ::scancast::test::testData(relative)                              \
                 << " (set -DSCANCAST_TEST_DATA=… to the folder of real scans)"
