#include "server/commands/serve/reload.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(ReloadSummary, IsOneLine) {
    EXPECT_EQ(summary({}), "Reloaded: nothing has changed.");
    EXPECT_EQ(summary({{"tokens (1 of users, 0 of administrators)", "1 cloud added"}, {}, {}}),
              "Reloaded: tokens (1 of users, 0 of administrators), 1 cloud added.");
    EXPECT_EQ(summary({{"1 cloud removed"}, {"the certificate"}, {"port", "max-pixels"}}),
              "Reloaded: 1 cloud removed; as before: the certificate; restart for --port, --max-pixels.");
}

}  // namespace
}  // namespace scancast
