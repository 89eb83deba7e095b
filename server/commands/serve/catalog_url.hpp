// The URL of --catalog: a prefix in S3, or a list at a web server. What stands there is served as files behind URLs are: opened by the
// loader, waited for where a server is away, in the list as failed where it is no whole cloud file. What decides is the names alone, so
// nothing is fetched here but the list.
//
// A list that cannot be had, or is none, changes nothing: an outage is no empty catalogue.
//
// Owned by the lookout (catalog_lookout.hpp), and used on its thread.
#pragma once

#include <set>

#include "remote/remote_listing.hpp"
#include "server/commands/serve/catalog_place.hpp"

namespace scancast {

class CatalogUrl final : public CatalogPlace {
  public:
    /// Notes are sentences for the log: what is left out and why, once as long as it is so.
    CatalogUrl(RemoteListing listing, std::shared_ptr<RemoteFiles> remote,
               std::function<void(const std::string&)> onNote);

    bool look(std::size_t most) override;
    const std::vector<std::filesystem::path>& files() const override { return files_; }
    bool isAnew() const override { return isAnew_; }

  private:
    void note(const std::string& text) const;
    void tellOfFault(const Error& error);
    void take(Listed listed);

    RemoteListing listing_;
    const std::shared_ptr<RemoteFiles> remote_;
    const std::function<void(const std::string&)> onNote_;
    CatalogChoice choice_;
    std::vector<ListedCloud> clouds_;
    std::set<std::string> leftOut_;
    bool isUnreadable_ = false, isAnew_ = false;
    std::vector<std::filesystem::path> files_;
};

}  // namespace scancast
