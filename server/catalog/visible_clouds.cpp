#include "server/catalog/visible_clouds.hpp"

namespace scancast {

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

std::string VisibleClouds::defaultId() const {
    if (only_.empty()) return catalog_.defaultId();
    return catalog_.find(only_) ? only_ : std::string();
}

}  // namespace scancast
