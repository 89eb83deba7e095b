#include "server/commands/serve/catalog_url.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "server/base/remote_cloud.hpp"

namespace scancast {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t mostTold = 100;  // of one look

}  // namespace

CatalogUrl::CatalogUrl(RemoteListing listing, std::shared_ptr<RemoteFiles> remote,
                       std::function<void(const std::string&)> onNote)
    : listing_(std::move(listing)),
      remote_(std::move(remote)),
      onNote_(std::move(onNote)),
      choice_(listing_.shown(), onNote_) {}

void CatalogUrl::note(const std::string& text) const {
    if (onNote_) onNote_(text);
}

void CatalogUrl::tellOfFault(const Error& error) {
    if (!std::exchange(isUnreadable_, true) && error.code != ErrorCode::Cancelled)
        note(fmt::format("The clouds stay as they are, because it cannot be seen which there are: {}",
                         error.message));
}

void CatalogUrl::take(Listed listed) {
    std::map<std::string_view, std::string_view> before;
    for (const ListedCloud& cloud : clouds_) before.emplace(cloud.url, cloud.state);
    isAnew_ = std::ranges::any_of(listed.clouds, [&](const ListedCloud& cloud) {
        const auto known = before.find(cloud.url);
        return known != before.end() && known->second != cloud.state;
    });
    std::set<std::string> leftOut;
    std::size_t told = 0;
    for (std::string& one : listed.leftOut) {
        if (!leftOut_.contains(one) && !leftOut.contains(one) && ++told <= mostTold)
            note("Not served: " + one);
        leftOut.insert(std::move(one));
    }
    if (told > mostTold) note(fmt::format("Not served: {} more.", told - mostTold));
    leftOut_ = std::move(leftOut);
    clouds_ = std::move(listed.clouds);
}

bool CatalogUrl::look(std::size_t most) {
    isAnew_ = false;
    auto listed = listing_.look(*remote_);
    if (!listed) {
        tellOfFault(listed.error());
        return false;
    }
    if (std::exchange(isUnreadable_, false))
        note(listing_.shown() + ": it can be seen again which clouds there are.");
    if (*listed) take(std::move(**listed));
    std::vector<CatalogCandidate> candidates;
    for (const ListedCloud& cloud : clouds_) {
        const auto url = RemoteUrl::parse(cloud.url);
        candidates.push_back({cloud.url, cloud.shown, url ? titleOf(*url) : cloud.name});
    }
    // Sets of EPT are called by their folders, which is another order than that of the list.
    std::ranges::stable_sort(candidates, {}, &CatalogCandidate::name);
    auto files = choice_.choose(std::move(candidates), most);
    const bool isOther = files != files_;
    files_ = std::move(files);
    return isOther || isAnew_;
}

}  // namespace scancast
