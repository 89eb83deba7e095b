#include "server/stream/catalog_world.hpp"

#include "renderer/method/method.hpp"
#include "renderer/plan.hpp"

namespace scancast {

Expected<std::shared_ptr<const PlannedView>> CatalogWorld::plan(const Cloud& cloud, const View& view) const {
    return scancast::plan(cloud, view);
}

double CatalogWorld::ownDetail(const View& view) const {
    if (view.quality.detail) return *view.quality.detail;
    const Method* method = findMethod(view.style.method);
    return method == nullptr ? 1 : method->defaultDetail;
}

std::vector<std::string> CatalogWorld::methodNames() const {
    std::vector<std::string> names;
    for (const Method& method : methods()) names.push_back(method.name);
    return names;
}

}  // namespace scancast
