#include "server/stream/catalog_world.hpp"

#include "renderer/method/method.hpp"
#include "renderer/render.hpp"

namespace scancast {

Expected<void> CatalogWorld::check(const Cloud& cloud, const View& view) const {
    return checkView(cloud, view);
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
