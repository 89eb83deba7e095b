#include "server/net/api/picture_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "protocol/view/query.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_words.hpp"
#include "renderer/plan.hpp"
#include "server/net/api/negotiate.hpp"

namespace scancast {
namespace {

using Planned = std::shared_ptr<const PlannedView>;

constexpr std::array formats{PictureFormat::Jpeg, PictureFormat::Png, PictureFormat::Depth};

Problem notAcceptable(std::string_view answersWith) {
    return problemOf(
        406, fmt::format("This address answers with {}, which the Accept header rules out.", answersWith));
}

Expected<Planned> planned(const Cloud& cloud, const View& view, std::uint64_t maxPixels) {
    if (std::uint64_t(view.width) * std::uint64_t(view.height) > maxPixels) {
        return fail(
            ErrorCode::ResourceLimit,
            fmt::format(
                "A picture of {} x {} pixels is larger than this server draws; the limit is {} pixels.",
                view.width, view.height, maxPixels),
            "width");
    }
    return plan(cloud, view);
}

View defaultOfSize(const Cloud& cloud, const View& size) {
    const auto side = [](int px) { return std::clamp(px, 1, maxPictureSide); };
    return defaultView(cloud, side(size.width), side(size.height));
}

// The default view at the size that `size` says, changed by `change`, planned.
template <class Change>
Expected<Planned> changed(const Cloud& cloud, const View& size, std::uint64_t maxPixels, Change change) {
    const Expected<View> view = change(defaultOfSize(cloud, size));
    if (!view) return passOn(view);
    return planned(cloud, *view, maxPixels);
}

}  // namespace

std::string_view mediaType(PictureFormat format) {
    switch (format) {
        case PictureFormat::Jpeg:
            return "image/jpeg";
        case PictureFormat::Png:
            return "image/png";
        case PictureFormat::Depth:
        case PictureFormat::Pixels:
            break;
    }
    return "application/octet-stream";
}

tl::expected<PictureFormat, Problem> requestedFormat(const HttpRequest& request, Route route) {
    const std::string accept = request.header("accept");
    if (route != Route::Snapshot) {
        const auto own = route == Route::SnapshotPng ? PictureFormat::Png : PictureFormat::Jpeg;
        if (!accepts(accept, mediaType(own))) return tl::unexpected(notAcceptable(mediaType(own)));
        return own;
    }
    PictureFormat best = formats.front();
    double most = 0;
    for (const PictureFormat format : formats) {  // of equally liked ones the first
        const double liking = preference(accept, mediaType(format));
        if (liking > most) {
            most = liking;
            best = format;
        }
    }
    if (most > 0) return best;
    return tl::unexpected(notAcceptable("image/jpeg, image/png or application/octet-stream (depth)"));
}

tl::expected<void, Problem> checkJsonBody(const HttpRequest& request) {
    std::string type = request.header("content-type");
    type = type.substr(0, type.find(';'));
    while (!type.empty() && type.back() == ' ') type.pop_back();
    std::transform(type.begin(), type.end(), type.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    if (type == "application/json") return {};
    return tl::unexpected(problemOf(415, "Send JSON, and say so: Content-Type: application/json."));
}

Expected<Planned> viewOfQuery(const Cloud& cloud, std::string_view query, std::uint64_t maxPixels) {
    const auto words = parseQuery(query);
    if (!words) return passOn(words);
    return viewOfWords(cloud, *words, maxPixels);
}

Expected<Planned> viewOfWords(const Cloud& cloud, const WordValues& words, std::uint64_t maxPixels) {
    View size;
    for (const auto& [word, value] : words) {
        if (word != "width" && word != "height") continue;
        if (auto ok = applyWord(size, word, value); !ok) return passOn(ok);
    }
    return changed(cloud, size, maxPixels, [&](const View& base) { return applyWords(base, words); });
}

Expected<Planned> viewOfJson(const Cloud& cloud, const nlohmann::json& changes, std::uint64_t maxPixels) {
    nlohmann::json sides = nlohmann::json::object();
    if (changes.is_object()) {
        for (const char* side : {"width", "height"})
            if (const auto at = changes.find(side); at != changes.end()) sides[side] = *at;
    }
    const auto size = applyJson(View(), sides);
    if (!size) return passOn(size);
    return changed(cloud, *size, maxPixels, [&](const View& base) { return applyJson(base, changes); });
}

View depthView(View view) {
    const Quality usual;
    view.quality.samples = 1;
    view.quality.jpegQuality = usual.jpegQuality;
    view.quality.subsampling = usual.subsampling;
    return view;
}

}  // namespace scancast
