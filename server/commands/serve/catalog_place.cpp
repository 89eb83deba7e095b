#include "server/commands/serve/catalog_place.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "server/catalog/catalog.hpp"
#include "server/commands/serve/catalog_folder.hpp"
#include "server/commands/serve/catalog_url.hpp"

namespace scancast {

namespace fs = std::filesystem;

std::unique_ptr<CatalogPlace> catalogPlace(const fs::path& place, std::shared_ptr<RemoteFiles> remote,
                                           std::function<void(const std::string&)> onNote) {
    if (!isRemoteUrl(place.native())) return std::make_unique<CatalogFolder>(place, std::move(onNote));
    auto listing = RemoteListing::create(place.native());
    if (!listing) return nullptr;  // check() has refused it
    return std::make_unique<CatalogUrl>(std::move(*listing), std::move(remote), std::move(onNote));
}

std::vector<fs::path> CatalogChoice::choose(std::vector<CatalogCandidate> candidates, std::size_t most) {
    std::vector<fs::path> files;
    std::set<std::string> namesakes;
    std::set<std::string> ids;
    std::size_t beyond = 0;
    for (CatalogCandidate& one : candidates) {
        const std::string id = cloudIdFor(fs::path(one.name).stem().string());
        if (ids.contains(id)) {
            if (!namesakes_.contains(one.shown) && onNote_)
                onNote_(
                    fmt::format("{} is not served: another file's cloud has the id {} already; rename one.",
                                one.shown, id));
            namesakes.insert(std::move(one.shown));
            continue;
        }
        ids.insert(id);
        if (files.size() < most)
            files.push_back(std::move(one.file));
        else
            ++beyond;
    }
    namesakes_ = std::move(namesakes);
    if (beyond > 0 && !isFull_ && onNote_)
        onNote_(fmt::format("{}: {} clouds are not served, because --max-clouds leaves room for {}.", place_,
                            beyond, most));
    isFull_ = beyond > 0;
    return files;
}

}  // namespace scancast
