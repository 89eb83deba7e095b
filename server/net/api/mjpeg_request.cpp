#include "server/net/api/mjpeg_request.hpp"

#include <array>
#include <charconv>

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_json.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_request.hpp"

namespace scancast {
namespace {

constexpr std::array<std::string_view, 4> followersWords{"session", "fps", "width", "height"};

Expected<double> framesPerSecond(const std::string& text) {
    double fps = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fps);
    if (error != std::errc() || end != text.data() + text.size() || !(fps >= 1 && fps <= 240))
        return fail(ErrorCode::InvalidArgument, "fps: must be a number from 1 to 240", "fps");
    return fps;
}

Expected<void> checkFollower(const WordValues& words) {
    for (const auto& [word, value] : words)
        if (word != "width" && word != "height")
            return fail(ErrorCode::InvalidArgument,
                        unknownName(word, word, followersWords) + " beside session", word);
    return {};
}

/// Takes the words that are no view's out of the query.
Expected<WordValues> takeStreamWords(std::string_view query, messages::Hello& hello) {
    auto words = parseQuery(query);
    if (!words) return words;
    WordValues rest;
    for (auto& [word, value] : *words) {
        if (word == "session") {
            hello.follow = value;
        } else if (word == "fps") {
            const auto fps = framesPerSecond(value);
            if (!fps) return passOn(fps);
            hello.fps = *fps;
        } else {
            rest.emplace_back(std::move(word), std::move(value));
        }
    }
    return rest;
}

}  // namespace

void sayMethod(HttpResponse& response, const MjpegRequest& asked) {
    if (!asked.method.empty()) response.set("Scancast-Method", asked.method);
    if (!asked.reason.empty()) response.set("Scancast-Method-Reason", asked.reason);
}

tl::expected<MjpegRequest, Problem> mjpegRequest(const HttpRequest& request, const Routed& routed,
                                                 const VisibleClouds& clouds, std::uint64_t maxPixels) {
    const auto refuse = [](const Error& error) { return tl::unexpected(problemOf(error)); };
    const std::string accept = request.header("accept");
    if (!accepts(accept, "multipart/x-mixed-replace") && !accepts(accept, "image/jpeg")) {
        return tl::unexpected(problemOf(
            406, "This address answers with multipart/x-mixed-replace, which the Accept header rules out."));
    }
    const auto cloud = clouds.cloud(routed.id);
    if (!cloud) return passOn(cloud);
    MjpegRequest asked;
    const auto words = takeStreamWords(routed.query, asked.hello);
    if (!words) return refuse(words.error());
    const bool follows = !asked.hello.follow.empty();
    if (follows) {
        if (auto sound = checkFollower(*words); !sound) return refuse(sound.error());
    }
    const auto viewed = viewOfWords(clouds, routed.id, *words, maxPixels);
    if (!viewed) return refuse(viewed.error());
    const View& view = viewed->planned->view;
    asked.hello.width = view.width;
    asked.hello.height = view.height;
    if (follows) return asked;
    asked.hello.cloud = routed.id;
    asked.view = messages::ViewChange{0, std::nullopt, toJson(view)};
    asked.method = viewed->planned->method;
    asked.reason = viewed->planned->reason;
    return asked;
}

}  // namespace scancast
