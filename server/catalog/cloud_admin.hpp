// Clouds that come and go while the server runs: what POST /clouds and DELETE /clouds/{id} may do.
//
// Owned by the server. *Thread safety*: every function may be called from any thread. Only names of files
// under the data root are taken from outside; what they lead to is opened beneath it at once, is only ever
// read, and what is put in its place later is found beneath it, too, or not at all. Place: api → **cloud admin** → catalog,
// loader.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "protocol/add_cloud.hpp"
#include "protocol/problem.hpp"
#include "renderer/cloud/import/scan_input.hpp"
#include "server/catalog/catalog.hpp"

namespace scancast {

class CloudAdmin {
  public:
    /// Loads what is open there into that entry, later; false when too much is waiting. Must not call back.
    using Load = std::function<bool(ScanInput input, const std::string& id)>;

    /// The catalog outlives this. An empty root: nothing can be added.
    /// `mostClouds`: nothing is added beyond, whoever added what is there.
    CloudAdmin(Catalog& catalog, std::filesystem::path dataRoot, std::size_t mostClouds);

    /// Empty = nothing is loaded any more; when this returns, the old one is not called again.
    void loadWith(Load load);
    /// The id of the new entry, which is being loaded. Problems: 400 for an id that is none, 403 without a
    /// data root or for a file outside of it, 404 when there is no such file, 409 when the id is taken or as many clouds are there as may be, 422
    /// for what is no file or cannot be opened, 503 when too much is waiting.
    tl::expected<std::string, Problem> add(const AddCloud& asked);
    /// 404 when there is no such cloud, 409 while it is being loaded, and for a live one.
    tl::expected<void, Problem> remove(std::string_view id);

  private:
    tl::expected<ScanInput, Problem> open(const std::string& name) const;

    Catalog& catalog_;
    const std::filesystem::path dataRoot_;
    const std::size_t mostClouds_;
    std::mutex mutex_;
    Load load_;
};

}  // namespace scancast
