#include "protocol/problem.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

namespace scancast {
namespace {

TEST(Problem, OfAnError) {
    const auto problem =
        problemOf(Error{ErrorCode::InvalidArgument, "fov: no", "fov"}, "/api/v1/clouds/a/snapshot.jpg");
    EXPECT_EQ(problem.type, "urn:scancast:problem:invalid-argument");
    EXPECT_EQ(problem.status, 400);
    EXPECT_EQ(problem.detail, "fov: no");
    EXPECT_EQ(problem.instance, "/api/v1/clouds/a/snapshot.jpg");
    ASSERT_EQ(problem.errors.size(), 1u);
    EXPECT_EQ(problem.errors[0].parameter, "fov");
    EXPECT_TRUE(problemOf(Error{ErrorCode::NotFound, "no such cloud", ""}).errors.empty());
}

TEST(Problem, EveryCodeHasANameATitleAndAStatus) {
    std::set<std::string> types, titles;
    for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
        const auto problem = problemOf(Error{static_cast<ErrorCode>(code), "m", ""});
        EXPECT_TRUE(types.insert(problem.type).second) << problem.type;
        EXPECT_TRUE(titles.insert(problem.title).second) << problem.title;
        EXPECT_NE(reasonPhrase(problem.status), "Unknown");
        EXPECT_GE(problem.status, 400);
    }
}

TEST(Problem, StatusesThatTheInterfacePromises) {
    EXPECT_EQ(httpStatus(ErrorCode::InvalidArgument), 400);
    EXPECT_EQ(httpStatus(ErrorCode::Malformed), 400);
    EXPECT_EQ(httpStatus(ErrorCode::NotFound), 404);
    EXPECT_EQ(httpStatus(ErrorCode::ResourceLimit), 413);
    EXPECT_EQ(httpStatus(ErrorCode::ImpossibleView), 422);
    EXPECT_EQ(httpStatus(ErrorCode::DeviceLost), 503);
    EXPECT_EQ(httpStatus(ErrorCode::DeadlineExceeded), 504);
    EXPECT_EQ(httpStatus(ErrorCode::Internal), 500);
}

TEST(Problem, RoundTrip) {
    for (const auto& problem :
         {problemOf(Error{ErrorCode::ImpossibleView, "eye = target", "camera.eye"}, "/x"),
          problemOf(405, "only GET works here", "/y"), problemOf(500, "")}) {
        const auto back = problemFromJson(toJson(problem));
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(*back, problem);
    }
    EXPECT_EQ(problemOf(405, "").title, "Method Not Allowed");
}

TEST(Problem, ErrorsComeBackOnTheOtherSide) {
    for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
        const Error sent{static_cast<ErrorCode>(code), "why", "fov"};
        const auto received = errorOf(problemOf(sent));
        EXPECT_EQ(received.code, sent.code);
        EXPECT_EQ(received.message, "why");
        EXPECT_EQ(received.field, "fov");
    }
    EXPECT_EQ(errorOf(problemOf(404, "gone")).code, ErrorCode::NotFound);
    EXPECT_EQ(errorOf(problemOf(403, "")).message, "Forbidden");
    EXPECT_EQ(errorOf(problemOf(403, "")).code, ErrorCode::InvalidArgument);
    EXPECT_EQ(errorOf(problemOf(502, "")).code, ErrorCode::Internal);
}

TEST(Problem, TellsByWhichIdTheServersLogKnowsTheRequest) {
    Problem problem = problemOf(404, "There is no cloud of that id.");
    EXPECT_FALSE(toJson(problem).contains("requestId"));
    problem.requestId = "req-1";
    const auto read = problemFromJson(toJson(problem));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, problem);
    EXPECT_EQ(errorOf(*read).message, "There is no cloud of that id. (request req-1)");
}

TEST(Problem, ForeignOnesAreReadLeniently) {
    const auto problem =
        problemFromJson(nlohmann::json::parse(R"({"title": "Busy", "retry": 5, "errors": null})"));
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->title, "Busy");
    for (const auto* text :
         {"[]", "5", R"({"status": "x"})", R"({"status": 99})", R"({"errors": 5})", R"({"errors": [5]})"}) {
        const auto wrong = problemFromJson(nlohmann::json::parse(text));
        ASSERT_FALSE(wrong) << text;
        EXPECT_EQ(wrong.error().code, ErrorCode::Malformed);
    }
}

}  // namespace
}  // namespace scancast
