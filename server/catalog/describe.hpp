// What the server says of its clouds and methods: fills in the structs of protocol/catalog.hpp.
// Pure functions; any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "protocol/catalog.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/method/method.hpp"
#include "server/catalog/catalog.hpp"

namespace scancast {

CloudInfo describe(const std::string& id, const Cloud& cloud);
MethodInfo describe(const Method& method);

/// The bodies of `/clouds`, `/clouds/{id}` and `/methods`. Clouds that are not ready stand under "pending"
/// with their state and progress, so that `clouds` holds complete descriptions only.
nlohmann::json cloudListJson(const std::vector<CatalogEntry>& entries);
nlohmann::json cloudJson(const CatalogEntry& entry);
nlohmann::json methodListJson();
/// The body of `/clouds/{id}/views`: the best views, each as `base` but for its camera.
nlohmann::json viewsJson(const Cloud& cloud, View base);
/// The body of `/clouds/{id}/stations`: where the scanner stood, each with the view from there, as `base` but for its camera.
nlohmann::json stationsJson(const Cloud& cloud, View base);
/// The body of `/clouds/{id}/photos`: what the scan brought along, each with its address and, where it has a pose, the view from
/// there, as `base` but for its camera. `id`: the cloud's, as cloudIdFor() makes it.
nlohmann::json photosJson(const std::string& id, const Cloud& cloud, const View& base);

}  // namespace scancast
