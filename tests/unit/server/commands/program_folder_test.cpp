#include "server/commands/program_folder.hpp"

#include <gtest/gtest.h>

#include "tests/support/environment_variable.hpp"

namespace scancast {
namespace {

using Variable = test::EnvironmentVariable;

TEST(ProgramFolder, FollowsTheFlagThenXdgThenHome) {
    const Variable home("HOME", "/home/anna");
    {
        const Variable xdg("XDG_CACHE_HOME", "/var/cache/anna");
        EXPECT_EQ(programFolder("/srv/cache"), "/srv/cache/programs");
        EXPECT_EQ(programFolder(), "/var/cache/anna/scancast/programs");
    }
    for (const char* none : {static_cast<const char*>(nullptr), "", "relative"}) {
        const Variable xdg("XDG_CACHE_HOME", none);
        EXPECT_EQ(programFolder(), "/home/anna/.cache/scancast/programs");
    }
}

TEST(ProgramFolder, IsNoneWhereThereIsNoHome) {
    const Variable xdg("XDG_CACHE_HOME", nullptr), home("HOME", nullptr);
    EXPECT_TRUE(programFolder().empty());
    EXPECT_EQ(programFolder("/srv/cache"), "/srv/cache/programs");
}

}  // namespace
}  // namespace scancast
