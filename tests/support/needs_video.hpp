// Tests of video where there is no OpenH264 are skipped, and say so: loudly, because what is skipped is not tested.
#pragma once

#include <gtest/gtest.h>

#include "video/openh264.hpp"

/// In a test's body, or its fixture's SetUp(): ends it there.
#define SCANCAST_NEEDS_VIDEO()                               \
    if (const auto library = scancast::openH264(); !library) \
    GTEST_SKIP() << "NOT TESTED: video, because " << library.error().message
