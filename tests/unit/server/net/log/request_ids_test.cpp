#include "server/net/log/request_ids.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

const std::string someTrace = "0af7651916cd43dd8448eb211c80319c", someParent = "b7ad6b7169203331";
const std::string soundParent = "00-" + someTrace + "-" + someParent + "-01";

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
    EXPECT_EQ(parseTraceParent(soundParent), (TraceParent{someTrace, someParent, true}));
    EXPECT_FALSE(parseTraceParent("00-" + someTrace + "-" + someParent + "-00")->sampled);
    EXPECT_FALSE(parseTraceParent("00-" + someTrace + "-" + someParent + "-fe")->sampled);
    EXPECT_TRUE(parseTraceParent("00-" + someTrace + "-" + someParent + "-0b")->sampled);
}

TEST(TraceParent, OfVersionsToComeSaysWhatThisOneDoes) {
    const std::string later = "cc-" + someTrace + "-" + someParent + "-01";
    EXPECT_EQ(parseTraceParent(later), (TraceParent{someTrace, someParent, true}));
    EXPECT_EQ(parseTraceParent(later + "-what-comes"), (TraceParent{someTrace, someParent, true}));
    EXPECT_FALSE(parseTraceParent(later + ".what-comes"));
    EXPECT_FALSE(parseTraceParent(later + "0"));
}

TEST(TraceParent, MalformedIsAsGoodAsMissing) {
    for (const std::string& wrong :
         {std::string(), std::string("00"), "ff" + soundParent.substr(2), "0g" + soundParent.substr(2),
          "0A" + soundParent.substr(2), "00-" + std::string(32, '0') + "-" + someParent + "-01",
          "00-" + someTrace + "-" + std::string(16, '0') + "-01",
          "00-0AF7651916cd43dd8448eb211c80319c-" + someParent + "-01",
          "00-" + someTrace + "-" + someParent + "-1", "00-" + someTrace + "-" + someParent + "-zz",
          soundParent + "-00", soundParent + " ", " " + soundParent, soundParent + ", " + soundParent,
          "00_" + someTrace + "-" + someParent + "-01", "00-" + someTrace + "_" + someParent + "-01",
          "00-" + someTrace + "-" + someParent + "_01"}) {
        EXPECT_FALSE(parseTraceParent(wrong)) << wrong;
        EXPECT_FALSE(RequestIds::of({}, wrong).trace) << wrong;
        EXPECT_TRUE(RequestIds::of({}, wrong).span.empty()) << wrong;
    }
}

TEST(TraceParent, GetsAStepOfItsOwn) {
    const RequestIds one = RequestIds::of({}, soundParent), two = RequestIds::of({}, soundParent);
    EXPECT_EQ(one.trace->trace, someTrace);
    EXPECT_EQ(one.span.size(), 16u);
    EXPECT_NE(one.span, someParent);
    EXPECT_NE(one.span, two.span);
}

}  // namespace
}  // namespace scancast
