// The clouds that somebody may know of: all of them, or a guest's only one. To him there are no others: they are neither listed
// nor found, and asking for one is answered as if it had never been there.
//
// A value over the catalog, which outlives it. *Thread safety*: any thread. Pipeline: catalog → **visible clouds** → api, sessions.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/catalog/catalog.hpp"

namespace scancast {

class VisibleClouds {
  public:
    /// `only`: the id of the one cloud; empty = all.
    explicit VisibleClouds(const Catalog& catalog, std::string only = {})
        : catalog_(catalog), only_(std::move(only)) {}

    // As the catalog's.
    std::vector<CatalogEntry> list() const;
    std::optional<CatalogEntry> find(std::string_view id) const;
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const;
    /// What a view of a cloud shows: the cloud, or several together where the view says so (`with`). Errors, as the problems of
    /// cloud(): NotFound and Unavailable, of the cloud (field `cloud`) or of another one (field `with`); putTogether()'s.
    Expected<std::shared_ptr<const Cloud>> viewed(std::string_view id, const View& view) const;
    /// Whether any of the clouds that a view of it shows is.
    bool isLive(std::string_view id, const ViewedClouds& with) const;
    bool isLive(std::string_view id) const { return sees(id) && catalog_.isLive(id); }
    std::string defaultId() const;

  private:
    bool sees(std::string_view id) const { return only_.empty() || id == only_; }

    const Catalog& catalog_;
    const std::string only_;
};

}  // namespace scancast
