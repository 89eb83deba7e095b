#include "remote/remote_listing.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "remote/cloud_list.hpp"
#include "remote/object_list.hpp"

namespace scancast {
namespace {

constexpr std::string_view ending = ".scan", beneath = "x";
constexpr std::size_t longestTold = 200, mostPages = 1000;

/// The beginning of what stands in the place of a name.
std::string told(std::string text) {
    if (text.size() > longestTold) text.replace(longestTold, text.npos, "...");
    return text;
}

void order(Listed& listed) {
    std::ranges::sort(listed.clouds, {},
                      [](const ListedCloud& one) { return std::tie(one.name, one.shown); });
}

}  // namespace

Expected<RemoteListing> RemoteListing::create(const std::string& url) {
    const auto behind = url.find("://");
    const bool isBucket = behind != url.npos && url.find('/', behind + 3) == url.npos;
    std::string folder = url + (isBucket ? "/" : "");
    const auto inside = RemoteUrl::parse(folder + std::string(beneath));
    if (inside && inside->scheme() == RemoteUrl::Scheme::S3 && folder.ends_with('/')) {
        std::string shown = inside->shown();
        shown.resize(shown.size() - beneath.size());
        return RemoteListing(*inside, std::move(shown), true);
    }
    auto list = RemoteUrl::parse(url);
    if (!list) return passOn(std::move(list));
    std::string shown = list->shown();
    return RemoteListing(std::move(*list), std::move(shown), false);
}

Expected<std::optional<Listed>> RemoteListing::look(RemoteFiles& remote) {
    return isPrefix_ ? lookBeneath(remote) : lookIn(remote);
}

Expected<std::optional<Listed>> RemoteListing::lookBeneath(RemoteFiles& remote) const {
    const std::string prefix = url_.key().substr(0, url_.key().size() - beneath.size());
    Listed listed;
    std::string next;
    std::size_t pages = 0;
    do {
        const auto answer = remote.fetch(ListAsk{url_.bucket(), prefix, next}, shown_, longestList);
        if (!answer) return passOn(answer);
        const auto page = parseObjectPage(answer->text);
        if (!page) return fail(page.error().code, shown_ + ": " + page.error().message);
        for (const ListedObject& object : page->objects) {
            if (!object.key.starts_with(prefix)) continue;
            const std::string_view name = std::string_view(object.key).substr(prefix.size());
            if (name.find('/') != name.npos || name.starts_with('.') || !name.ends_with(ending)) continue;
            const auto url = RemoteUrl::parse("s3://" + url_.bucket() + "/" + object.key);
            if (!url) {
                listed.leftOut.push_back(told(percentEncoded(object.key)) + ": " + url.error().message);
                continue;
            }
            listed.clouds.push_back({url->whole(), url->shown(), url->name(), object.state});
        }
        if (!next.empty() && page->next == next)
            return fail(ErrorCode::Malformed, shown_ + ": its list of objects goes on with itself.");
        next = page->next;
        if (listed.clouds.size() + listed.leftOut.size() > mostClouds)
            return fail(ErrorCode::ResourceLimit,
                        shown_ + ": it holds more than " + std::to_string(mostClouds) + " clouds.");
        if (++pages > mostPages)
            return fail(ErrorCode::ResourceLimit, shown_ + ": its list of objects has more than " +
                                                      std::to_string(mostPages) + " pages.");
    } while (!next.empty());
    order(listed);
    return std::optional(std::move(listed));
}

Expected<std::optional<Listed>> RemoteListing::lookIn(RemoteFiles& remote) {
    auto answer = remote.fetch(url_, longestList, etag_);
    if (!answer) return passOn(answer);
    if (answer->isUnchanged || (edition_ > 0 && answer->text == text_)) return std::optional<Listed>();
    const auto words = parseCloudList(answer->text);
    if (!words) return fail(words.error().code, shown_ + ": " + words.error().message);
    Listed listed;
    for (const std::string& word : *words) {
        auto url = urlIn(url_, word);
        if (url) {
            listed.clouds.push_back({url->whole(), url->shown(), url->name(), std::to_string(edition_ + 1)});
            continue;
        }
        const std::string shown = shownArgument(word), &why = url.error().message;
        const std::string what = shown.substr(0, shown.find('?'));
        listed.leftOut.push_back(why.starts_with(what) ? why : told(what) + ": " + why);
    }
    ++edition_;
    etag_ = std::move(answer->etag);
    text_ = std::move(answer->text);
    order(listed);
    return std::optional(std::move(listed));
}

}  // namespace scancast
