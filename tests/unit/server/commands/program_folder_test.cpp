#include "server/commands/program_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace scancast {
namespace {

/// An environment variable, as it was when this goes.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        value ? ::setenv(name, value, 1) : ::unsetenv(name);
    }
    ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

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
