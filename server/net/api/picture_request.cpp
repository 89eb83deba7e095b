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

// The default view of what `first` shows, at its size, changed by `change`, planned.
template <class Change>
Expected<AskedView> changed(const VisibleClouds& clouds, std::string_view id, const View& first,
                            std::uint64_t maxPixels, Change change) {
    auto cloud = clouds.viewed(id, first);
    if (!cloud) return passOn(std::move(cloud));
    const Expected<View> view = change(defaultOfSize(**cloud, first));
    if (!view) return passOn(view);
    auto made = planned(**cloud, *view, maxPixels);
    if (!made) return passOn(std::move(made));
    return AskedView{std::move(*cloud), std::move(*made)};
}

/// What must be known before there is a default view.
constexpr std::array<std::string_view, 4> firstWords{"width", "height", "with", "color"};

Expected<View> firstOfJson(const nlohmann::json& changes) {
    nlohmann::json first = nlohmann::json::object();
    if (changes.is_object()) {
        for (const std::string_view word : firstWords)
            if (const auto at = changes.find(word); at != changes.end()) first[std::string(word)] = *at;
    }
    return applyJson(View(), first);
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

Expected<AskedView> viewOfQuery(const VisibleClouds& clouds, std::string_view id, std::string_view query,
                                std::uint64_t maxPixels) {
    const auto words = parseQuery(query);
    if (!words) return passOn(words);
    return viewOfWords(clouds, id, *words, maxPixels);
}

Expected<AskedView> viewOfWords(const VisibleClouds& clouds, std::string_view id, const WordValues& words,
                                std::uint64_t maxPixels) {
    View first;
    for (const auto& [word, value] : words) {
        if (std::ranges::find(firstWords, word) == firstWords.end()) continue;
        if (auto ok = applyWord(first, word, value); !ok) return passOn(ok);
    }
    if (auto sound = validate(first); !sound) return passOn(sound);
    return changed(clouds, id, first, maxPixels, [&](const View& base) { return applyWords(base, words); });
}

Expected<AskedView> viewOfJson(const VisibleClouds& clouds, std::string_view id, const nlohmann::json& changes,
                               std::uint64_t maxPixels) {
    const auto first = firstOfJson(changes);
    if (!first) return passOn(first);
    return changed(clouds, id, *first, maxPixels, [&](const View& base) { return applyJson(base, changes); });
}

Expected<Planned> viewOfCloudAlone(const Cloud& cloud, const nlohmann::json& changes, std::uint64_t maxPixels) {
    const auto first = firstOfJson(changes);
    if (!first) return passOn(first);
    const auto view = applyJson(defaultOfSize(cloud, *first), changes);
    if (!view) return passOn(view);
    // What is seen of several, or elsewhere, is not what lies there in this one.
    if (!view->with.empty())
        return fail(ErrorCode::Unsupported,
                    "with: points of one cloud are gone over here, where it lies by itself; ask without it, for "
                    "each cloud by its own address",
                    "with");
    return planned(cloud, *view, maxPixels);
}

View depthView(View view) {
    const Quality usual;
    view.quality.samples = 1;
    view.quality.jpegQuality = usual.jpegQuality;
    view.quality.subsampling = usual.subsampling;
    return view;
}

}  // namespace scancast
