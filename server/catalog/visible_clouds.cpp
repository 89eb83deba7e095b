#include "server/catalog/visible_clouds.hpp"

#include <algorithm>

#include "protocol/view/view.hpp"

namespace scancast {
namespace {

Error errorOf(const Problem& problem, const char* field) {
    const std::string of = field == std::string_view("with") ? "with: " : "";
    return {problem.status == 404 ? ErrorCode::NotFound : ErrorCode::Unavailable, of + problem.detail, field};
}

}  // namespace

std::vector<CatalogEntry> VisibleClouds::list() const {
    std::vector<CatalogEntry> entries = catalog_.list();
    std::erase_if(entries, [this](const CatalogEntry& entry) { return !sees(entry.id); });
    return entries;
}

std::optional<CatalogEntry> VisibleClouds::find(std::string_view id) const {
    return sees(id) ? catalog_.find(id) : std::nullopt;
}

tl::expected<std::shared_ptr<const Cloud>, Problem> VisibleClouds::cloud(std::string_view id) const {
    if (!sees(id)) return tl::unexpected(noSuchCloud(id));
    return catalog_.cloud(id);
}

Expected<std::shared_ptr<const Cloud>> VisibleClouds::viewed(std::string_view id, const View& view) const {
    const auto own = cloud(id);
    if (!own) return tl::unexpected(errorOf(own.error(), "cloud"));
    const bool byCloud = view.style.color == ColorSource::Cloud;
    const auto isItself = [](const ViewedCloud& one) {
        return one.cloud == ownCloudName && one.shift == glm::dvec3(0) && !one.tint && !one.hidden;
    };
    if (!byCloud && std::ranges::all_of(view.with, isItself)) return *own;
    if (view.with.empty()) return *own;  // each cloud in its colour, and there is one
    auto members = membersOf(view.with, {.name = std::string(id), .cloud = *own},
                             [&](const ViewedCloud& one) -> Expected<std::shared_ptr<const Cloud>> {
                                 auto other = cloud(one.cloud);
                                 if (!other) return tl::unexpected(errorOf(other.error(), "with"));
                                 return *other;
                             });
    if (!members) return passOn(std::move(members));
    return catalog_.together(std::move(*members), byCloud);
}

bool VisibleClouds::isLive(std::string_view id, const ViewedClouds& with) const {
    return isLive(id) ||
           std::ranges::any_of(with, [&](const ViewedCloud& one) { return isLive(one.cloud); });
}

std::string VisibleClouds::defaultId() const {
    if (only_.empty()) return catalog_.defaultId();
    return catalog_.find(only_) ? only_ : std::string();
}

}  // namespace scancast
