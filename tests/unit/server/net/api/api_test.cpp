#include "server/net/api/api.hpp"

#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/look.hpp"
#include "protocol/view/view_json.hpp"
#include "renderer/render.hpp"
#include "server/net/page/page.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

// Requests and responses without a socket: what each route answers, and what is refused.
class ApiTest : public ::testing::Test {
  protected:
    ApiTest() {
        catalog.setReady(catalog.add("tiny"), cloud);
        scheduler.waitForDevice(test::FakePainter::patience);
    }

    HttpResponse ask(const std::string& target, std::vector<std::pair<std::string, std::string>> headers = {},
                     const std::string& method = "GET") {
        HttpRequest request{method, target, std::move(headers)};
        if (request.count("host") == 0) request.headers.emplace_back("host", "localhost:8080");
        const auto routed = api.admit(request);
        if (!routed) return routed.error();
        std::promise<HttpResponse> answer;
        api.answer(request, *routed, [&](HttpResponse response) { answer.set_value(std::move(response)); });
        auto future = answer.get_future();
        EXPECT_EQ(future.wait_for(test::FakePainter::patience), std::future_status::ready);
        return future.get();
    }
    static nlohmann::json problem(const HttpResponse& response) {
        EXPECT_EQ(*response.find("Content-Type"), "application/problem+json");
        return parseJson(response.body()).value();
    }

    static constexpr const char* picture = "/api/v1/clouds/tiny/snapshot.jpg?width=32&height=16";
    test::FakePainter painter, spare{"spare"};
    std::shared_ptr<const Cloud> cloud = test::tinyCloud();
    Catalog catalog;
    CloudAdmin admin{catalog, {}, 256};
    SessionRegister sessions;
    Metrics metrics{"test"};
    Scheduler scheduler{painter.open(spare.open()), {}, metrics};
    Api api{{"1.2.3", 1000 * 1000, {"127.0.0.1", {"https://viewer.example"}}},
            catalog,
            admin,
            sessions,
            scheduler,
            metrics};
};

TEST_F(ApiTest, SnapshotIsAPictureOfTheAskedSize) {
    const HttpResponse response = ask(picture);
    EXPECT_EQ(response.status, 200);
    EXPECT_EQ(*response.find("Content-Type"), "image/jpeg");
    EXPECT_NE(response.find("ETag"), nullptr);
    EXPECT_NE(response.find("Server-Timing")->find("render;dur="), std::string::npos);
    const auto frame = decodeJpeg(*response.bytes);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->width, 32);
    EXPECT_EQ(frame->height, 16);
    EXPECT_NE(response.find("Scancast-Method"), nullptr);
    const auto png = ask("/api/v1/clouds/tiny/snapshot.png?width=8&height=9");
    const auto decoded = decodePng(*png.bytes);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->height, 9);
}

TEST_F(ApiTest, APictureSaysByWhichMethodAndWhy) {
    const HttpResponse open = ask(std::string(picture) + "&method=auto");
    EXPECT_FALSE(open.find("Scancast-Method")->empty());
    EXPECT_NE(open.find("Scancast-Method-Reason")->find("points"), std::string::npos);
    const HttpResponse named = ask(std::string(picture) + "&method=cone");
    EXPECT_EQ(*named.find("Scancast-Method"), "cone");
    EXPECT_EQ(named.find("Scancast-Method-Reason"), nullptr) << "nobody left it open";
}

// However a picture is asked for: drawn, not drawn again, or its headers alone; as a picture, as depth, as a stream.
TEST_F(ApiTest, EveryWayToAPictureSaysTheMethod) {
    const auto posted = [&](const std::string& body, const std::string& accept, const std::string& tag) {
        HttpRequest request{"POST",
                            "/api/v1/clouds/tiny/snapshot",
                            {{"host", "localhost"},
                             {"content-type", "application/json"},
                             {"accept", accept},
                             {"if-none-match", tag}},
                            body};
        const auto routed = api.admit(request);
        std::promise<HttpResponse> answer;
        api.answer(request, routed.value(),
                   [&](HttpResponse response) { answer.set_value(std::move(response)); });
        return answer.get_future().get();
    };
    const std::string open = std::string(picture) + "&method=auto",
                      stream = "/api/v1/clouds/tiny/stream.mjpg";
    const std::string body = R"({"width": 32, "height": 16, "method": "auto"})";
    const HttpResponse first = posted(body, "image/png", {});
    const HttpResponse answers[] = {ask(open),
                                    ask(open, {}, "HEAD"),
                                    ask(open, {{"if-none-match", *ask(open).find("ETag")}}),
                                    first,
                                    posted(body, "image/png", *first.find("ETag")),
                                    posted(body, "application/octet-stream", {}),
                                    ask(stream + "?method=auto", {}, "HEAD")};
    EXPECT_EQ(answers[2].status, 304);
    EXPECT_EQ(answers[4].status, 304);
    for (const HttpResponse& answer : answers) {
        ASSERT_NE(answer.find("Scancast-Method"), nullptr) << &answer - answers;
        EXPECT_EQ(*answer.find("Scancast-Method"), *answers[0].find("Scancast-Method"));
        ASSERT_NE(answer.find("Scancast-Method-Reason"), nullptr) << &answer - answers;
        EXPECT_EQ(*answer.find("Scancast-Method-Reason"), *answers[0].find("Scancast-Method-Reason"));
    }
    EXPECT_EQ(*ask(stream + "?method=cone", {}, "HEAD").find("Scancast-Method"), "cone");
    EXPECT_EQ(ask(stream + "?session=s1", {}, "HEAD").find("Scancast-Method"), nullptr)
        << "another's view decides";
}

TEST_F(ApiTest, ARevalidationRendersNothing) {
    const HttpResponse first = ask(picture);
    const std::size_t rendered = painter.begun().size();
    const HttpResponse second = ask(picture, {{"if-none-match", *first.find("ETag")}});
    EXPECT_EQ(second.status, 304);
    EXPECT_EQ(*second.find("ETag"), *first.find("ETag"));
    EXPECT_TRUE(second.body().empty());
    EXPECT_EQ(ask(picture, {}, "HEAD").status, 200);
    EXPECT_EQ(*ask(picture, {}, "HEAD").find("ETag"), *first.find("ETag"));
    EXPECT_EQ(painter.begun().size(), rendered);
}

TEST_F(ApiTest, WordsReachTheRendererAndTheOrderOfWordsDoesNotMatter) {
    const auto a = ask("/api/v1/clouds/tiny/snapshot.jpg?eye=1,2,3&width=40&height=20&method=cone&fov=33");
    ASSERT_EQ(a.status, 200);
    const View view = painter.begun().back().view;
    EXPECT_EQ(view.width, 40);
    EXPECT_EQ(view.camera.eye, glm::dvec3(1, 2, 3));
    EXPECT_EQ(view.camera.fov, 33);
    EXPECT_EQ(view.style.method, "cone");
    EXPECT_EQ(view.quality, Quality{});
    const auto b = ask("/api/v1/clouds/tiny/snapshot.jpg?fov=33&method=cone&height=20&width=40&eye=1,2,3");
    EXPECT_EQ(*a.find("ETag"), *b.find("ETag"));
}

TEST_F(ApiTest, ClipAndClassesReachTheRenderer) {
    ASSERT_EQ(ask("/api/v1/clouds/tiny/snapshot.jpg?classes=2,6&clip=0,0,0,10,10,5&width=8&height=8").status,
              200);
    const View view = painter.begun().back().view;
    EXPECT_EQ(view.style.classes, (std::vector<std::uint8_t>{2, 6}));
    ASSERT_TRUE(view.style.clip);
    EXPECT_EQ(view.style.clip->max, glm::dvec3(10, 10, 5));
    ASSERT_EQ(ask("/api/v1/clouds/tiny/snapshot.jpg?classes=none&clip=auto&width=8&height=8").status, 200);
    EXPECT_TRUE(painter.begun().back().view.style.classes->empty());
    EXPECT_FALSE(painter.begun().back().view.style.clip);
    for (const char* wrong : {"classes=300", "classes=ground", "clip=0,0,0", "clip=5,0,0,1,1,1"})
        EXPECT_EQ(ask(std::string("/api/v1/clouds/tiny/snapshot.jpg?") + wrong).status / 100, 4) << wrong;
}

TEST_F(ApiTest, Refusals) {
    const std::tuple<const char*, int, const char*> wrong[] = {
        {"/api/v1/clouds/tiny/snapshot.jpg?fvo=3", 400, "fvo"},
        {"/api/v1/clouds/tiny/snapshot.jpg?width=abc", 400, "width"},
        {"/api/v1/clouds/tiny/snapshot.jpg?width=0", 400, "width"},
        {"/api/v1/clouds/tiny/snapshot.jpg?width=99999", 400, "width"},
        {"/api/v1/clouds/tiny/snapshot.jpg?width=2000&height=2000", 413, "width"},
        {"/api/v1/clouds/tiny/snapshot.jpg?eye=1,1,1&target=1,1,1", 422, ""},
        {"/api/v1/clouds/tiny/snapshot.jpg?method=teapot", 400, "method"},
        {"/api/v1/clouds/other/snapshot.jpg", 404, "cloud"},
        {"/api/v1/clouds/..%2Ftiny", 404, "cloud"},
        {"/nothing.js", 404, ""},
        {"/../etc/passwd", 404, ""},
    };
    for (const auto& [target, status, parameter] : wrong) {
        const HttpResponse response = ask(target);
        EXPECT_EQ(response.status, status) << target << " " << response.body();
        const auto json = problem(response);
        EXPECT_EQ(json["status"], status);
        if (*parameter != '\0') {
            EXPECT_EQ(json["errors"][0]["parameter"], parameter) << target;
        }
    }
    EXPECT_TRUE(painter.begun().empty());
}

TEST_F(ApiTest, MethodsAcceptAndUpgrade) {
    const HttpResponse post = ask(picture, {}, "POST");
    EXPECT_EQ(post.status, 405);
    EXPECT_EQ(*post.find("Allow"), "GET, HEAD");
    EXPECT_EQ(ask(picture, {{"accept", "text/html"}}).status, 406);
    EXPECT_EQ(*ask("/api/v1/clouds/tiny/snapshot").find("Allow"), "POST");
    EXPECT_EQ(ask(picture, {{"accept", "image/*"}}).status, 200);
    EXPECT_EQ(ask("/api/v1/stream").status, 426);
    for (const char* target : {"/api/v1/clouds", "/api/v1/clouds/tiny", "/api/v1/methods", "/openapi.json"}) {
        EXPECT_EQ(ask(target, {{"accept", "image/png"}}).status, 406) << target;
        EXPECT_EQ(ask(target, {{"accept", "application/*"}}).status, 200) << target;
        EXPECT_EQ(*ask(target, {}, "PATCH").find("Allow"), infoOf(route(target)->route).methods) << target;
    }
    EXPECT_EQ(ask("/openapi.json", {{"if-none-match", *ask("/openapi.json").find("ETag")}}).status, 304);
}

TEST_F(ApiTest, BrowsersOfOtherSitesAreRefused) {
    EXPECT_EQ(ask("/healthz", {{"host", "evil.example"}}).status, 403);
    EXPECT_EQ(ask("/healthz", {{"origin", "https://evil.example"}}).status, 403);
    EXPECT_EQ(ask("/healthz", {{"origin", "https://viewer.example"}}).status, 200);
    // <img src="http://localhost:8080/…"> of another site carries no Origin, but says so here.
    EXPECT_EQ(ask(picture, {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "no-cors"}}).status, 403);
    EXPECT_EQ(ask("/", {{"sec-fetch-site", "cross-site"},
                        {"sec-fetch-mode", "navigate"},
                        {"sec-fetch-dest", "document"}})
                  .status,
              200);
    EXPECT_EQ(ask(picture, {{"sec-fetch-site", "same-origin"}, {"sec-fetch-mode", "no-cors"}}).status, 200);
}

// As Chromium 156 sends them, of a page beside ours (same-site: another port of the same host) and of another site.
TEST_F(ApiTest, PagesOfAnAllowedOriginHaveThePageAndWhatTheyAskForByName) {
    using Headers = std::vector<std::pair<std::string, std::string>>;
    const std::string viewer = "https://viewer.example", evil = "https://evil.example";
    const auto sent = [](const char* site, const char* mode, const char* dest,
                         const std::string& origin = {}) {
        Headers headers{{"sec-fetch-site", site}, {"sec-fetch-mode", mode}, {"sec-fetch-dest", dest}};
        if (!origin.empty()) headers.emplace_back("origin", origin);
        return headers;
    };
    const std::string inFolder = "/assets/" + std::string(pageFiles().hash) + "/main.js";
    for (const char* site : {"same-site", "cross-site"}) {
        // A frame's navigation has no Origin, whoever it is of; frame-ancestors says who may show the page.
        const HttpResponse frame = ask("/", sent(site, "navigate", "iframe"));
        EXPECT_EQ(frame.status, 200) << site;
        EXPECT_NE(
            frame.find("Content-Security-Policy")->find("frame-ancestors 'self' https://viewer.example"),
            std::string::npos);
        EXPECT_EQ(*frame.find("Cross-Origin-Resource-Policy"), "cross-origin");
        EXPECT_EQ(ask("/", sent(site, "navigate", "document")).status, 200) << site;
        EXPECT_EQ(ask(picture, sent(site, "navigate", "document")).status, 200) << "a link to a picture";
        // Modules are asked for with an Origin, style sheets and classic scripts without.
        EXPECT_EQ(ask(inFolder, sent(site, "cors", "script", viewer)).status, 200) << site;
        EXPECT_EQ(ask(inFolder, sent(site, "cors", "script", evil)).status, 403) << site;
        EXPECT_EQ(ask("/styles/style.css", sent(site, "no-cors", "style")).status, 200) << site;
        const HttpResponse part = ask("/main.js", sent(site, "no-cors", "script"));
        EXPECT_EQ(part.status, 200) << site;
        EXPECT_EQ(*part.find("Cross-Origin-Resource-Policy"), "same-origin")
            << "so the browser keeps it to itself";
        // Data: by those who are allowed and say so, and nobody else.
        for (const char* target : {"/api/v1/clouds", picture, "/metrics", "/openapi.json"}) {
            EXPECT_EQ(ask(target, sent(site, "cors", "empty", viewer)).status, 200) << site << target;
            EXPECT_EQ(ask(target, sent(site, "cors", "empty", evil)).status, 403) << site << target;
            EXPECT_EQ(ask(target, sent(site, "no-cors", "image")).status, 403) << site << target;
            EXPECT_EQ(ask(target, sent(site, "navigate", "iframe")).status, 403) << site << target;
        }
        EXPECT_EQ(ask(picture, sent(site, "cors", "image", viewer)).status, 200) << "<img crossorigin>";
        EXPECT_EQ(ask("/", sent(site, "no-cors", "script"), "POST").status, 403) << site;
    }
    // A WebSocket's upgrade has Origin alone; 426 because this is none.
    EXPECT_EQ(ask("/api/v1/stream", {{"origin", viewer}}).status, 426);
    EXPECT_EQ(ask("/api/v1/stream", {{"origin", evil}}).status, 403);
}

TEST_F(ApiTest, WhereNobodyElseIsAllowedThePageIsForItsOwnOrigin) {
    Api alone{{"1.2.3", 1000 * 1000, {"127.0.0.1", {}}}, catalog, admin, sessions, scheduler, metrics};
    HttpRequest request{"GET", "/", {{"host", "localhost:8080"}}};
    HttpResponse page;
    alone.answer(request, alone.admit(request).value(),
                 [&](HttpResponse response) { page = std::move(response); });
    EXPECT_TRUE(page.find("Content-Security-Policy")->ends_with("frame-ancestors 'self'"));
    EXPECT_EQ(*page.find("Cross-Origin-Resource-Policy"), "same-origin");
    alone.complete(request, "/", page);
    EXPECT_EQ(*page.find("Vary"), "Accept-Encoding");
}

// A browser that has a style sheet's answer must not take it for a module's, which needs the origin in it.
TEST_F(ApiTest, WhereOriginsAreAllowedEveryAnswerVariesWithThem) {
    HttpRequest request{"GET", "/main.js", {{"host", "localhost:8080"}}};
    HttpResponse response = ask("/main.js");
    api.complete(request, "/", response);
    bool varies = false;
    for (const auto& [name, value] : response.headers) varies |= name == "Vary" && value == "Origin";
    EXPECT_TRUE(varies);
    EXPECT_EQ(response.find("Access-Control-Allow-Origin"), nullptr);
}

TEST_F(ApiTest, ThePageHasAPolicyAndATag) {
    const HttpResponse page = ask("/");
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(*page.find("Content-Type"), "text/html; charset=utf-8");
    EXPECT_NE(page.find("Content-Security-Policy")->find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(ask("/", {{"if-none-match", *page.find("ETag")}}).status, 304);
}

TEST_F(ApiTest, ADamagedPictureSaysSoAndIsKeptByNobody) {
    const std::string tag = *ask(picture).find("ETag");
    painter.damage(3);
    const HttpResponse damaged = ask(picture);
    EXPECT_EQ(damaged.status, 200);
    EXPECT_EQ(*damaged.find("Scancast-Damaged"), "3");
    EXPECT_EQ(*damaged.find("Cache-Control"), "no-store");
    EXPECT_EQ(damaged.find("ETag"), nullptr);
    EXPECT_EQ(ask(picture, {{"if-none-match", tag}}).status, 304) << "who has the whole picture keeps it";
    painter.damage(0);
    const HttpResponse whole = ask(picture);
    EXPECT_EQ(whole.find("Scancast-Damaged"), nullptr);
    EXPECT_EQ(*whole.find("ETag"), tag);
}

TEST_F(ApiTest, ReadyOnceTheFirstCloudsAreWhateverComesLater) {
    EXPECT_EQ(ask("/readyz").status, 200);
    const auto loading = catalog.add("later");
    EXPECT_EQ(ask("/readyz").status, 200);
    const HttpResponse early = ask("/api/v1/clouds/later/snapshot.jpg");
    EXPECT_EQ(early.status, 503);
    EXPECT_NE(early.find("Retry-After"), nullptr);
    EXPECT_EQ(ask("/api/v1/clouds/later").status, 200);
    catalog.setFailed(loading, "it is broken");
    EXPECT_EQ(ask("/readyz").status, 200);
    EXPECT_EQ(ask("/api/v1/clouds/later").status, 404);
}

/// The tag promises bytes: it must be that of the device which drew them, not of the one which was asked.
TEST_F(ApiTest, ALostDeviceIsToldOfAndTagsAreOfTheOneThatDraws) {
    const std::string before = *ask(picture).find("ETag");
    painter.failWith(Error{ErrorCode::DeviceLost, "The GPU was reset.", {}});
    const HttpResponse response = ask(picture);
    EXPECT_EQ(response.status, 200);
    EXPECT_NE(*response.find("ETag"), before);
    EXPECT_EQ(ask(picture, {{"if-none-match", before}}).status, 200) << "not the bytes of that tag any more";
    EXPECT_EQ(ask(picture, {{"if-none-match", *response.find("ETag")}}).status, 304);
    EXPECT_EQ(*ask(picture, {}, "HEAD").find("ETag"), *response.find("ETag"));
    const HttpResponse ready = ask("/readyz");
    EXPECT_EQ(ready.status, 200);
    EXPECT_EQ(ready.body(),
              "ready\nThe device fake was lost, and spare draws in its place: The GPU was reset.\n");
}

TEST_F(ApiTest, WithoutAnyDeviceItIsNotReady) {
    for (auto* each : {&painter, &spare})
        each->failWith(Error{ErrorCode::DeviceLost, "The GPU was reset.", {}});
    const HttpResponse response = ask(picture);
    EXPECT_EQ(response.status, 503);
    EXPECT_NE(problem(response)["detail"].get<std::string>().find("The GPU was reset."), std::string::npos);
    EXPECT_EQ(ask("/readyz").status, 503);
}

TEST_F(ApiTest, AllowedOriginsAreToldSoAndEveryAnswerIsCounted) {
    HttpRequest request{"GET", "/healthz", {{"host", "localhost"}, {"origin", "https://viewer.example"}}};
    HttpResponse response = textResponse(200, "ok");
    api.complete(request, pattern(Route::Health), response);
    EXPECT_EQ(*response.find("Access-Control-Allow-Origin"), "https://viewer.example");
    EXPECT_NE(response.find("Access-Control-Expose-Headers")->find("Scancast-Damaged"), std::string::npos);
    EXPECT_EQ(*response.find("X-Content-Type-Options"), "nosniff");
    EXPECT_NE(metrics.text().find("scancast_http_requests_total{code=\"200\",route=\"/healthz\"} 1"),
              std::string::npos);
}

/// The same cloud with a look of three views.
std::shared_ptr<const Cloud> lookedAt(const Cloud& tiny) {
    auto cloud = std::make_shared<Cloud>(tiny);
    Look& look = cloud->look.emplace();
    look.kind = SceneKind::Street;
    look.outline = {{0, 0, 0}, {10, 10, 5}, {10, 0, 0}, {0, 10, 5}};
    look.style.method = "point";
    Camera outside, inside, top;
    outside.eye = {30, -40, 20};
    inside.eye = {5, 5, 2};
    inside.target = {6, 5, 2};
    top.eye = {0, 0, 9};
    top.up = {0, 1, 0};
    look.views = {{"from the south-east", false, outside}, {"inside", true, inside}, {"top", false, top}};
    return cloud;
}

// Right because the protocol's own reader takes each view, and the renderer plans it.
TEST_F(ApiTest, ViewsAreWhatACloudIsBestSeenFrom) {
    const auto with = lookedAt(*cloud);
    catalog.setReady(catalog.add("looked"), with);
    for (const std::shared_ptr<const Cloud>& one : {cloud, with})
        for (const char* query :
             {"", "?width=300&height=700", "?color=intensity&method=paraboloid&width=64&height=64"}) {
            const std::string id = one == cloud ? "tiny" : "looked";
            const HttpResponse response = ask("/api/v1/clouds/" + id + "/views" + query);
            ASSERT_EQ(response.status, 200) << response.body();
            EXPECT_EQ(*response.find("Content-Type"), "application/json");
            const auto body = parseJson(response.body()).value();
            ASSERT_EQ(body.size(), 1U);
            const auto& list = body["views"];
            EXPECT_EQ(list.size(), one->look ? 3U : 1U);
            for (std::size_t i = 0; i < list.size(); ++i) {
                ASSERT_EQ(list[i].size(), 3U);
                const auto view = applyJson(View{}, list[i]["view"]);
                ASSERT_TRUE(view) << view.error().message;
                const auto drawable = checkView(*one, *view);
                EXPECT_TRUE(drawable) << drawable.error().message;
                EXPECT_EQ(view->width, *query == 0                                ? 1280
                                       : std::string(query).starts_with("?width") ? 300
                                                                                  : 64);
                EXPECT_EQ(view->style.method, one->look && *query != '?' ? "point" : view->style.method);
                if (!one->look) continue;
                EXPECT_EQ(list[i]["name"], one->look->views[i].name);
                EXPECT_EQ(list[i]["inside"], one->look->views[i].inside);
                EXPECT_EQ(view->camera,
                          cameraFor(*one->look, one->look->views[i], double(view->width) / view->height));
            }
            const HttpResponse head = ask("/api/v1/clouds/" + id + "/views" + query, {}, "HEAD");
            EXPECT_EQ(head.status, 200);
            EXPECT_EQ(*head.find("Content-Type"), "application/json");
        }
}

// Right because the protocol's own reader takes each view, and the renderer plans it.
TEST_F(ApiTest, StationsAreWhereTheScannerStood) {
    auto scanned = std::make_shared<Cloud>(*cloud);
    const glm::dvec3 middle = (cloud->bounds[0] + cloud->bounds[1]) * 0.5;
    scanned->stations = {{.name = "Tower",
                          .position = middle + glm::dvec3(1, 0, 0),
                          .points = 7,
                          .forwards = glm::dvec3(0, 0.6, 0.8)},
                         {.position = middle + glm::dvec3(0, 3, 1), .forwards = glm::dvec3(0, 0, 1)},
                         {.position = middle}};
    catalog.setReady(catalog.add("scanned"), scanned);
    const HttpResponse response = ask("/api/v1/clouds/scanned/stations?width=300&height=200&color=intensity");
    ASSERT_EQ(response.status, 200) << response.body();
    const auto list = parseJson(response.body()).value()["stations"];
    ASSERT_EQ(list.size(), 3U);
    EXPECT_EQ(list[0]["name"], "Tower");
    EXPECT_EQ(list[0]["points"], 7);
    EXPECT_EQ(list[2]["name"], "Scan 3");
    EXPECT_FALSE(list[2].contains("forwards"));
    // Level: the scanner's own direction, the middle of the cloud where that points upwards, anything at the middle itself.
    const std::array<std::optional<glm::dvec3>, 3> ahead{glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0),
                                                         std::nullopt};
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto view = applyJson(View{}, list[i]["view"]);
        ASSERT_TRUE(view) << view.error().message;
        EXPECT_TRUE(checkView(*scanned, *view));
        EXPECT_EQ(view->width, 300);
        EXPECT_EQ(view->camera.eye, scanned->stations[i].position);
        const glm::dvec3 way = view->camera.target - view->camera.eye;
        EXPECT_LT(way.z, 0) << "a little downwards";
        EXPECT_GT(glm::length(way), -10 * way.z);
        if (!ahead[i]) continue;
        EXPECT_GT(glm::dot(glm::normalize(glm::dvec3(way.x, way.y, 0)), *ahead[i]), 0.999);
    }
    EXPECT_EQ(parseJson(ask("/api/v1/clouds/tiny/stations").body()).value()["stations"].size(), 0U);
    EXPECT_EQ(parseJson(ask("/api/v1/clouds/scanned").body()).value()["stations"], 3);
    EXPECT_EQ(ask("/api/v1/clouds/nobody/stations").status, 404);
    EXPECT_EQ(ask("/api/v1/clouds/scanned/stations?colour=rgb").status, 400);
    EXPECT_EQ(ask("/api/v1/clouds/scanned/stations", {}, "POST").status, 405);
}

TEST_F(ApiTest, ViewsOfNothingAndOfNonsenseAreRefused) {
    const auto none = ask("/api/v1/clouds/nobody/views");
    EXPECT_EQ(none.status, 404);
    problem(none);
    for (const char* query :
         {"?colour=rgb", "?width=0", "?width=many", "?method=magic", "?color=beauty", "?shading=dark"}) {
        const auto wrong = ask(std::string("/api/v1/clouds/tiny/views") + query);
        EXPECT_EQ(wrong.status, 400) << query;
        problem(wrong);
    }
    EXPECT_EQ(ask("/api/v1/clouds/tiny/views?fov=180").status, 422) << "no picture could be made of it";
    EXPECT_EQ(ask("/api/v1/clouds/tiny/views", {}, "POST").status, 405);
    catalog.add("still loading");
    EXPECT_EQ(ask("/api/v1/clouds/still-loading/views").status, 503);
}

TEST_F(ApiTest, ACloudTellsItsLookWithoutItsOutline) {
    const auto with = lookedAt(*cloud);
    catalog.setReady(catalog.add("looked"), with);
    const auto body = parseJson(ask("/api/v1/clouds/looked").body()).value();
    ASSERT_TRUE(body.contains("look"));
    EXPECT_FALSE(body["look"].contains("outline"));
    EXPECT_EQ(body["look"]["kind"], "street");
    auto whole = toJson(*with->look);
    whole.erase("outline");
    EXPECT_EQ(body["look"], whole);
    EXPECT_FALSE(parseJson(ask("/api/v1/clouds/tiny").body()).value().contains("look"));
    EXPECT_NE(body["revision"], with->revision) << "what is kept of its pictures depends on it";
    const auto view = applyJson(View{}, body["view"]);
    ASSERT_TRUE(view);
    EXPECT_EQ(*view, defaultView(*with));
}

}  // namespace
}  // namespace scancast
