#include "server/net/api/negotiate.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

DeviceInfo device(const char* identity) {
    DeviceInfo info;
    info.identity = identity;
    return info;
}

TEST(PictureTag, TheSameExactlyWhenThePictureIs) {
    const auto cloud = test::tinyCloud(1);
    const auto other = test::tinyCloud(2);
    View view;
    View moved = view;
    moved.camera.eye.x += 1e-9;
    View coarse = view;
    coarse.quality.jpegQuality = 89;
    const auto tag = [&](const Cloud& c, const View& v) {
        return pictureTag(c, v, PictureFormat::Jpeg, device("cpu"), "1");
    };
    EXPECT_EQ(tag(*cloud, view), tag(*cloud, View(view)));
    // Whatever pictures depend on gives another tag.
    const std::set<std::string> tags{tag(*cloud, view),
                                     tag(*other, view),
                                     tag(*cloud, moved),
                                     tag(*cloud, coarse),
                                     pictureTag(*cloud, view, PictureFormat::Png, device("cpu"), "1"),
                                     pictureTag(*cloud, view, PictureFormat::Jpeg, device("egl"), "1"),
                                     pictureTag(*cloud, view, PictureFormat::Jpeg, device("cpu"), "2")};
    EXPECT_EQ(tags.size(), 7U);
    for (const std::string& one : tags) {
        EXPECT_EQ(one.front(), '"');
        EXPECT_EQ(one.size(), 34U);
    }
    // What the picture does not depend on does not: an orthographic camera has no field of view.
    View flat = view;
    flat.camera.projection = Projection::Orthographic;
    View flatWide = flat;
    flatWide.camera.fov = 100;
    EXPECT_EQ(tag(*cloud, flat), tag(*cloud, flatWide));
}

TEST(IfNoneMatch, ListsStarAndWeakTags) {
    const std::string tag = "\"abc\"";
    for (const char* match : {"\"abc\"", "*", " * ", "W/\"abc\"", "\"x\", \"abc\"", "\"x\" ,W/\"abc\",\"y\"",
                              "\"a,b\", \"abc\""}) {
        EXPECT_TRUE(matchesAny(match, tag)) << match;
    }
    for (const char* miss :
         {"", "abc", "\"abcd\"", "\"ab\"", "\"abc", "\"x\" \"abc\"", "x, \"abc\"", "W/", ","}) {
        EXPECT_FALSE(matchesAny(miss, tag)) << miss;
    }
}

TEST(Accept, TheMostSpecificRangeDecides) {
    for (const char* yes :
         {"", "*/*", "image/*", "image/jpeg", "IMAGE/JPEG", "text/html, image/*;q=0.8",
          "image/avif,image/webp,*/*;q=0.8", "image/*;q=0, image/jpeg", "image/jpeg;q=0.001"}) {
        EXPECT_TRUE(accepts(yes, "image/jpeg")) << yes;
    }
    for (const char* no : {"image/png", "text/html", "application/json, text/*", "image/jpeg;q=0",
                           "*/*, image/jpeg;q=0", "image/*;q=0, */*", "im/*", "image/"}) {
        EXPECT_FALSE(accepts(no, "image/jpeg")) << no;
    }
}

TEST(ContentTag, DiffersWithTheBytes) {
    EXPECT_EQ(contentTag("a"), contentTag("a"));
    EXPECT_NE(contentTag("a"), contentTag("b"));
    EXPECT_NE(contentTag(""), contentTag(std::string_view("\0", 1)));
}

TEST(AcceptEncoding, TheBestLikedAndOfThoseTheSmallest) {
    using enum ContentCoding;
    const std::pair<const char*, ContentCoding> cases[] = {
        {"", Identity},
        {"gzip, deflate, br, zstd", Brotli},  // Chromium, Firefox
        {"gzip, deflate", Gzip},
        {"br;q=0.5, gzip", Gzip},
        {"BR;Q=0.9, x-gzip;q=0.9", Brotli},
        {"*", Brotli},
        {"*;q=0.5, gzip", Gzip},
        {"*, br;q=0", Gzip},
        {"identity", Identity},
        {"identity, br;q=0.9", Identity},
        {"identity;q=0.5, gzip;q=0.5", Gzip},
        {"identity;q=0, gzip;q=0.001", Gzip},
        {"gzip;q=0", Identity},
        {"*;q=0", Identity},  // nothing else is left to send
        {"deflate, compress, zstd", Identity},
        {"brotli, gzipped", Identity},
        {",, ;;, br", Brotli},
    };
    for (const auto& [header, coding] : cases) EXPECT_EQ(preferredCoding(header), coding) << header;
}

}  // namespace
}  // namespace scancast
