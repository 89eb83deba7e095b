#include "server/net/log/request_ids.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

const std::string trace = "0af7651916cd43dd8448eb211c80319c", parent = "b7ad6b7169203331";
const std::string sound = "00-" + trace + "-" + parent + "-01";

TEST(RequestIds, AreTheClientsWhereTheyCanForgeNothing) {
    for (const std::string& id : {std::string("a"), std::string("A-z_0.9"), std::string(64, 'x')}) {
        EXPECT_TRUE(isRequestId(id)) << id;
        EXPECT_EQ(RequestIds::of(id, {}).request, id);
    }
    for (const std::string& id :
         {std::string(), std::string(65, 'x'), std::string("a b"), std::string("a\nb"), std::string("a, b"),
          std::string("a\"b"), std::string("\xC3\xA4"), std::string("a\0b", 3)}) {
        EXPECT_FALSE(isRequestId(id)) << id;
        const std::string made = RequestIds::of(id, {}).request;
        EXPECT_TRUE(isRequestId(made)) << made;
        EXPECT_EQ(made.size(), 32u);
    }
    EXPECT_NE(RequestIds::of({}, {}).request, RequestIds::of({}, {}).request);
}

TEST(TraceParent, IsTakenApart) {
    EXPECT_EQ(parseTraceParent(sound), (TraceParent{trace, parent, true}));
    EXPECT_FALSE(parseTraceParent("00-" + trace + "-" + parent + "-00")->sampled);
    EXPECT_FALSE(parseTraceParent("00-" + trace + "-" + parent + "-fe")->sampled);
    EXPECT_TRUE(parseTraceParent("00-" + trace + "-" + parent + "-0b")->sampled);
}

TEST(TraceParent, OfVersionsToComeSaysWhatThisOneDoes) {
    const std::string later = "cc-" + trace + "-" + parent + "-01";
    EXPECT_EQ(parseTraceParent(later), (TraceParent{trace, parent, true}));
    EXPECT_EQ(parseTraceParent(later + "-what-comes"), (TraceParent{trace, parent, true}));
    EXPECT_FALSE(parseTraceParent(later + ".what-comes"));
    EXPECT_FALSE(parseTraceParent(later + "0"));
}

TEST(TraceParent, MalformedIsAsGoodAsMissing) {
    for (const std::string& wrong :
         {std::string(), std::string("00"), "ff" + sound.substr(2), "0g" + sound.substr(2),
          "0A" + sound.substr(2), "00-" + std::string(32, '0') + "-" + parent + "-01",
          "00-" + trace + "-" + std::string(16, '0') + "-01",
          "00-0AF7651916cd43dd8448eb211c80319c-" + parent + "-01", "00-" + trace + "-" + parent + "-1",
          "00-" + trace + "-" + parent + "-zz", sound + "-00", sound + " ", " " + sound, sound + ", " + sound,
          "00_" + trace + "-" + parent + "-01", "00-" + trace + "_" + parent + "-01",
          "00-" + trace + "-" + parent + "_01"}) {
        EXPECT_FALSE(parseTraceParent(wrong)) << wrong;
        EXPECT_FALSE(RequestIds::of({}, wrong).trace) << wrong;
        EXPECT_TRUE(RequestIds::of({}, wrong).span.empty()) << wrong;
    }
}

TEST(TraceParent, GetsAStepOfItsOwn) {
    const RequestIds one = RequestIds::of({}, sound), two = RequestIds::of({}, sound);
    EXPECT_EQ(one.trace->trace, trace);
    EXPECT_EQ(one.span.size(), 16u);
    EXPECT_NE(one.span, parent);
    EXPECT_NE(one.span, two.span);
}

}  // namespace
}  // namespace scancast
