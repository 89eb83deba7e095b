// What a request for a picture asks for: the format, from the path or the Accept header; the view, from the
// query or a JSON body. Pure functions; any thread. Pipeline: router → **picture request** → api.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "protocol/view/query.hpp"
#include "renderer/plan.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

std::string_view mediaType(PictureFormat format);

/// Of a path that ends in .jpg or .png, its own, if Accept allows it; else what Accept likes best of JPEG,
/// PNG and depth. 406 when that is nothing.
tl::expected<PictureFormat, Problem> requestedFormat(const HttpRequest& request, Route route);

/// 415 unless the request says that its body is JSON.
tl::expected<void, Problem> checkJsonBody(const HttpRequest& request);

/// A complete view, planned, and what it is drawn of: a cloud, or several together (`with`).
struct AskedView {
    std::shared_ptr<const Cloud> cloud;
    std::shared_ptr<const PlannedView> planned;
};

/// A view of the cloud of that id. What is not given is the default of what it shows, at the asked size, because its camera
/// depends on the picture's shape. Errors: those of parseQuery(), applyWords(), applyJson(), VisibleClouds::viewed() and plan();
/// ResourceLimit above `maxPixels`.
Expected<AskedView> viewOfWords(const VisibleClouds& clouds, std::string_view id, const WordValues& words,
                                std::uint64_t maxPixels);
Expected<AskedView> viewOfQuery(const VisibleClouds& clouds, std::string_view id, std::string_view query,
                                std::uint64_t maxPixels);
Expected<AskedView> viewOfJson(const VisibleClouds& clouds, std::string_view id, const nlohmann::json& changes,
                               std::uint64_t maxPixels);
/// The same of one cloud alone, for who goes over its points: Unsupported where the view shows others, or moves it (`with`).
Expected<std::shared_ptr<const PlannedView>> viewOfCloudAlone(const Cloud& cloud, const nlohmann::json& changes,
                                                              std::uint64_t maxPixels);

/// Depth is that of the pixels' centres, and neither blended nor encoded: what decides the looks is put to
/// its default, so that equal pictures have equal tags.
View depthView(View view);

}  // namespace scancast
