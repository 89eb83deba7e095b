#include "server/net/log/shown_target.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(ShownTarget, KeepsWhatSaysWhichPictureItWas) {
    for (const std::string target :
         {"/", "/api/v1/clouds", "/api/v1/clouds/town/snapshot.jpg?width=640&height=360&method=ewa",
          "/api/v1/clouds/a%20b/snapshot.png?eye=1,2,3&light.ambient=0.2&param.scale=2",
          "/api/v1/clouds/town/stream.mjpg?fps=10"})
        EXPECT_EQ(shownTarget(target), target);
}

TEST(ShownTarget, HidesValuesThatNobodyKnows) {
    EXPECT_EQ(shownTarget("/a?token=s3cret&width=5&guest=x.y"), "/a?token=*&width=5&guest=*");
    EXPECT_EQ(shownTarget("/a?s3cret"), "/a?*");
    EXPECT_EQ(shownTarget("/a?=s3cret&%73=1&&"), "/a?*&*&*");
    EXPECT_EQ(shownTarget("/a?" + std::string(60, 'k') + "=1"), "/a?*");
    EXPECT_EQ(shownTarget("/a?width=" + std::string(200, '1')), "/a?width=*");
    EXPECT_EQ(shownTarget("/a?session=s0123456789abcdef01234567"), "/a?session=*");
    EXPECT_EQ(shownTarget("http://me:s3cret@host/"), "*");
    EXPECT_EQ(shownTarget("*"), "*");
}

// A session's id is its key.
TEST(ShownTarget, ShowsWhichSessionItWasAndNotItsKey) {
    const std::string id = "s0123456789abcdef01234567";
    EXPECT_EQ(shownTarget("/api/v1/sessions/" + id + "/view"), "/api/v1/sessions/s0123456…/view");
    EXPECT_EQ(shownTarget("/api/v1/sessions/%730123456789abcdef01234567/view"),
              "/api/v1/sessions/s0123456…/view");
    EXPECT_EQ(shownTarget("/wrong/" + id), "/wrong/s0123456…");
    EXPECT_EQ(shownSession(id), "s0123456…");
    EXPECT_EQ(shownSession("short"), "sh…");
}

TEST(ShownTarget, IsShortAndOneLine) {
    EXPECT_LE(shownTarget("/" + std::string(8000, 'a')).size(), 720u);
    std::string many = "/?";
    for (int i = 0; i < 2000; ++i) many += "a=1&";
    EXPECT_LE(shownTarget(many).size(), 720u);
    EXPECT_TRUE(shownTarget(many).ends_with("…"));
    EXPECT_EQ(shownTarget("/a\x1b[2J\xC2\x9B\nforged"), "/a?[2J? forged");
}

}  // namespace
}  // namespace scancast
