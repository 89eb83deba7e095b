// Photos that scans brought along, over the API without a socket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"
#include "renderer/render.hpp"
#include "server/net/api/api.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"
#include "tests/support/gate.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto patience = test::FakePainter::patience;

class PhotosTest : public ::testing::Test {
  protected:
    PhotosTest() {
        catalog.setReady(catalog.add("office"), office);
        catalog.setReady(catalog.add("bare"), tiny);
        scheduler.waitForDevice(patience);
    }
    ~PhotosTest() override { api.stop(); }

    using Headers = std::vector<std::pair<std::string, std::string>>;
    /// What is answered, later perhaps.
    std::future<HttpResponse> begin(const std::string& target, Headers headers = {},
                                    const std::string& method = "GET", std::stop_token gone = {}) {
        HttpRequest request{method, target, std::move(headers)};
        request.headers.emplace_back("host", "localhost:8080");
        request.client = "192.0.2.7";
        auto answer = std::make_shared<std::promise<HttpResponse>>();
        auto future = answer->get_future();
        const auto routed = api.admit(request);
        if (!routed)
            answer->set_value(routed.error());
        else
            api.answer(
                request, *routed, [answer](HttpResponse response) { answer->set_value(std::move(response)); },
                gone);
        return future;
    }
    HttpResponse ask(const std::string& target, Headers headers = {}, const std::string& method = "GET") {
        auto future = begin(target, std::move(headers), method);
        EXPECT_EQ(future.wait_for(patience), std::future_status::ready) << target;
        return future.get();
    }
    nlohmann::json list(const std::string& query = {}) {
        const HttpResponse response = ask("/api/v1/clouds/office/photos" + query);
        EXPECT_EQ(response.status, 200) << response.body();
        return parseJson(response.body()).value()["photos"];
    }
    static std::string detail(const HttpResponse& response) {
        EXPECT_EQ(*response.find("Content-Type"), "application/problem+json");
        return parseJson(response.body()).value()["detail"];
    }
    /// A cloud with one photo, which is read by `read`.
    void addSlow(const std::string& id, std::uint64_t bytes, test::PhotoInMemory::Read read) {
        auto cloud = std::make_shared<Cloud>(*tiny);
        Photo& photo = cloud->photos.emplace_back();
        photo.bytes = bytes;
        photo.data = std::make_shared<test::PhotoInMemory>(std::move(read));
        catalog.setReady(catalog.add(id), cloud);
    }

    test::FakePainter painter;
    const std::shared_ptr<const Cloud> tiny = test::tinyCloud(), office = test::withPhotos(*tiny);
    Catalog catalog;
    CloudAdmin admin{catalog, {}, 256};
    SessionRegister sessions;
    Metrics metrics{"test"};
    Scheduler scheduler{painter.open(), {}, metrics};
    const TransientMemory memory{
        8000};  // of which a quarter is for answers, an eighth for those of one client
    Api api{{.version = "1.2.3", .maxPixels = 1000 * 1000, .origins = {"127.0.0.1", {}}, .memory = memory},
            catalog,
            admin,
            sessions,
            scheduler,
            metrics};
};

TEST_F(PhotosTest, AreListedWithAllThatIsKnownOfThem) {
    const auto photos = list();
    ASSERT_EQ(photos.size(), 3U);
    auto first = photos[0];
    first.erase("view");
    EXPECT_EQ(first, parseJson(R"({"index": 0, "name": "All round", "mediaType": "image/jpeg",
        "projection": "spherical", "width": 400, "height": 200, "bytes": 500, "angles": {"across": 360.0, "down": 180.0},
        "station": {"index": 0, "name": "Tower"}, "href": "/api/v1/clouds/office/photos/0",
        "pose": {"position": [5.0, 5.0, 2.5], "forwards": [0.0, 1.0, 0.0], "up": [0.0, 0.0, 1.0]}})")
                         .value());
    EXPECT_EQ(photos[1]["name"], "Photo 2") << "it has no name of its own";
    EXPECT_EQ(photos[1]["mediaType"], "image/png");
    EXPECT_FALSE(photos[1].contains("station"));
    EXPECT_EQ(photos[2], parseJson(R"({"index": 2, "name": "Photo 3", "mediaType": "image/jpeg",
        "projection": "visual", "bytes": 200, "href": "/api/v1/clouds/office/photos/2"})")
                             .value())
        << "what is not known is left out";
    EXPECT_EQ(ask("/api/v1/clouds/bare/photos").body(), "{\"photos\":[]}");
    EXPECT_EQ(parseJson(ask("/api/v1/clouds/office").body()).value()["photos"], 3);
    const auto stations = parseJson(ask("/api/v1/clouds/office/stations").body()).value()["stations"];
    EXPECT_EQ(stations[0]["photos"], nlohmann::json({0}));
    EXPECT_EQ(ask("/api/v1/clouds/nobody/photos").status, 404);
    EXPECT_EQ(ask("/api/v1/clouds/office/photos?colour=rgb").status, 400);
    EXPECT_EQ(ask("/api/v1/clouds/office/photos", {{"accept", "image/png"}}).status, 406);
}

// Right because the protocol's own reader takes each view, and the renderer plans it.
TEST_F(PhotosTest, ThoseWithAPoseHaveAViewThatCanBeDrawn) {
    const auto photos = list("?width=300&height=600&method=paraboloid");
    EXPECT_FALSE(photos[2].contains("view"));
    for (std::size_t i = 0; i < 2; ++i) {
        const auto view = applyJson(View{}, photos[i]["view"]);
        ASSERT_TRUE(view) << view.error().message;
        EXPECT_TRUE(checkView(*office, *view));
        EXPECT_EQ(view->width, 300);
        EXPECT_EQ(view->style.method, "paraboloid");
        EXPECT_EQ(view->camera.eye, office->photos[i].pose->position);
    }
}

TEST_F(PhotosTest, AStationThatIsNotListedIsNone) {
    auto cloud = std::make_shared<Cloud>(*office);
    cloud->photos[0].station = 1;
    catalog.setReady(catalog.add("cut"), cloud);
    const auto body = parseJson(ask("/api/v1/clouds/cut/photos").body()).value();
    EXPECT_FALSE(body["photos"][0].contains("station"));
    EXPECT_EQ(parseJson(ask("/api/v1/clouds/cut/stations").body()).value()["stations"][0]["photos"],
              nlohmann::json::array());
}

TEST_F(PhotosTest, TheBytesAreTheFilesOwn) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Photo& photo = office->photos[i];
        const HttpResponse response = ask("/api/v1/clouds/office/photos/" + std::to_string(i));
        ASSERT_EQ(response.status, 200) << response.body();
        EXPECT_EQ(*response.find("Content-Type"), mediaType(photo.format));
        EXPECT_EQ(*response.find("Cache-Control"), "no-cache");
        EXPECT_THAT(*response.find("Content-Security-Policy"), HasSubstr("sandbox"));
        const auto bytes = photo.data->read().value();
        EXPECT_EQ(response.body(),
                  std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
    HttpRequest request{"GET", "/", {}};
    HttpResponse response = ask("/api/v1/clouds/office/photos/0");
    api.complete(request, pattern(Route::CloudPhoto), response);
    EXPECT_EQ(*response.find("X-Content-Type-Options"), "nosniff");
}

TEST_F(PhotosTest, TheTagIsOfTheBytesAndOnceKnownNothingIsReadForIt) {
    std::atomic<int> reads{0};
    const auto bytes = test::photoBytes(Photo::Format::Jpeg, 64, 9);
    const auto counted = [&]() -> Expected<std::vector<std::byte>> { return ++reads, bytes; };
    addSlow("once", 64, counted);
    addSlow("twin", 64, counted);
    const std::string address = "/api/v1/clouds/once/photos/0";
    const HttpResponse head = ask(address, {}, "HEAD");
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(*head.find("Content-Type"), "image/jpeg");
    EXPECT_EQ(head.bodyBytes, 64U) << "what a GET would have";
    EXPECT_EQ(head.body(), "");
    EXPECT_EQ(reads, 1) << "nobody knew its tag";
    const std::string tag = *head.find("ETag");
    EXPECT_EQ(*ask(address, {}, "HEAD").find("ETag"), tag);
    const HttpResponse same = ask(address, {{"if-none-match", "\"x\", " + tag}});
    EXPECT_EQ(same.status, 304);
    EXPECT_EQ(*same.find("ETag"), tag);
    EXPECT_EQ(same.body(), "");
    EXPECT_EQ(ask(address, {{"if-none-match", tag}}, "HEAD").status, 304);
    EXPECT_EQ(reads, 1);
    const HttpResponse whole = ask(address, {{"if-none-match", "\"x\""}});
    EXPECT_EQ(whole.status, 200);
    EXPECT_EQ(*whole.find("ETag"), tag);
    EXPECT_EQ(reads, 2);
    EXPECT_EQ(ask("/api/v1/clouds/twin/photos/0", {{"if-none-match", tag}}).status, 304) << "the same bytes";
    EXPECT_EQ(reads, 3) << "of another photo: it had to be read to know";
    EXPECT_NE(*ask("/api/v1/clouds/office/photos/0").find("ETag"),
              *ask("/api/v1/clouds/office/photos/2").find("ETag"));
}

TEST_F(PhotosTest, AnotherPhotoInTheSamePlaceHasAnotherTag) {
    const std::string address = "/api/v1/clouds/office/photos/0";
    const std::string tag = *ask(address).find("ETag");
    auto cloud = std::make_shared<Cloud>(*office);
    cloud->photos[0] = cloud->photos[2];
    ASSERT_TRUE(catalog.replace("office", office, std::shared_ptr<const Cloud>(cloud)));
    const HttpResponse other = ask(address, {{"if-none-match", tag}});
    EXPECT_EQ(other.status, 200);
    EXPECT_NE(*other.find("ETag"), tag);
}

TEST_F(PhotosTest, WhatIsNoNumberOfAPhotoIsNotThere) {
    for (const char* number :
         {"3", "18446744073709551616", "-1", "+1", "01", "1.0", "1e0", "x", "%20", "0x0", "0%00"}) {
        const HttpResponse response = ask(std::string("/api/v1/clouds/office/photos/") + number);
        EXPECT_EQ(response.status, std::string_view(number) == "0%00" ? 400 : 404) << number;
    }
    EXPECT_EQ(detail(ask("/api/v1/clouds/office/photos/3")),
              "\"3\" is no photo of this cloud: they are 0 to 2.");
    EXPECT_EQ(detail(ask("/api/v1/clouds/bare/photos/0")), "The scan of this cloud brought no photos along.");
    EXPECT_EQ(ask("/api/v1/clouds/nobody/photos/0").status, 404);
    EXPECT_EQ(ask("/api/v1/clouds/office/photos/0", {}, "POST").status, 405);
    const HttpResponse html = ask("/api/v1/clouds/office/photos/1", {{"accept", "text/html, image/jpeg"}});
    EXPECT_EQ(html.status, 406);
    EXPECT_EQ(detail(html), "This photo is image/png, which the Accept header rules out.");
    catalog.add("still loading");
    EXPECT_EQ(ask("/api/v1/clouds/still-loading/photos/0").status, 503);
    auto early = std::make_shared<Cloud>(*office);
    early->photos[0].data = nullptr;
    catalog.setReady(catalog.add("early"), early);
    EXPECT_EQ(ask("/api/v1/clouds/early/photos/0").status, 503);
}

TEST_F(PhotosTest, OneThatCannotBeReadIsAFaultOfTheServersAndNamesNoFile) {
    for (const ErrorCode code : {ErrorCode::Io, ErrorCode::Truncated, ErrorCode::Malformed}) {
        const std::string id = "bad-" + std::string(name(code));
        addSlow(id, 100, [code]() -> Expected<std::vector<std::byte>> {
            return fail(code, "/srv/secret/office.scan, photo 0: its checksum is wrong");
        });
        const HttpResponse response = ask("/api/v1/clouds/" + id + "/photos/0");
        EXPECT_EQ(response.status, 500);
        EXPECT_THAT(detail(response), Not(HasSubstr("secret")));
        EXPECT_THAT(detail(response), HasSubstr("log"));
    }
    addSlow("thrown", 100, []() -> Expected<std::vector<std::byte>> { throw std::bad_alloc(); });
    EXPECT_GE(ask("/api/v1/clouds/thrown/photos/0").status, 400);
    EXPECT_EQ(ask("/api/v1/clouds/office/photos/0").status, 200) << "the others are there";
    EXPECT_EQ(memory.bytes(MemoryUse::Answers), 0U);
}

TEST_F(PhotosTest, WhatIsNotReadIsCountedAndMoreIsRefused) {
    // Two of 500 bytes are as many as one client may leave unread.
    const std::string address = "/api/v1/clouds/office/photos/0";
    std::vector<HttpResponse> unread;
    unread.push_back(ask(address));
    unread.push_back(ask(address));
    EXPECT_GE(memory.bytes(MemoryUse::Answers), 1000U);
    const HttpResponse refused = ask(address);
    EXPECT_EQ(refused.status, 429);
    EXPECT_NE(refused.find("Retry-After"), nullptr);
    EXPECT_THAT(detail(refused), HasSubstr("not been read to their end"));
    EXPECT_EQ(ask(address, {{"if-none-match", *unread[0].find("ETag")}}).status, 304) << "takes no memory";
    unread.clear();
    EXPECT_EQ(memory.bytes(MemoryUse::Answers), 0U);
    // The request that read it may still hold its part for a moment.
    EXPECT_TRUE(test::soon([&] { return ask(address).status == 200; }));
}

TEST_F(PhotosTest, ASlowDiskKeepsNobodyElseWaiting) {
    test::Gate gate;
    gate.close();
    addSlow("slow", 10, [&]() -> Expected<std::vector<std::byte>> {
        gate.pass();
        return std::vector<std::byte>(10);
    });
    auto slow = begin("/api/v1/clouds/slow/photos/0");
    // All else is answered meanwhile: by the thread that asks.
    EXPECT_EQ(ask("/api/v1/clouds/office/photos").status, 200);
    EXPECT_EQ(ask("/api/v1/clouds/office/snapshot.jpg?width=8&height=8").status, 200);
    EXPECT_EQ(slow.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
    // Who leaves is forgotten; who waits gets his turn.
    std::stop_source gone;
    auto left = begin("/api/v1/clouds/slow/photos/0", {}, "GET", gone.get_token());
    auto waits = begin("/api/v1/clouds/office/photos/0");
    gone.request_stop();
    gate.open();
    EXPECT_EQ(slow.get().status, 200);
    EXPECT_EQ(waits.get().status, 200);
    EXPECT_THROW(left.get(), std::future_error) << "nobody was answered";
}

}  // namespace
}  // namespace scancast
