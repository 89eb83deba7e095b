// Everything that the clouds of `serve` come from: files, and sources of clouds that change; what they say goes to the log,
// past the progress bar.
//
// Owned by the command, on the main thread; the server and the bar outlive it. Place: serve options → **cloud sources** →
// loader, live sources → catalog.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "server/catalog/damage_reports.hpp"
#include "server/catalog/live_source.hpp"
#include "server/catalog/loader.hpp"
#include "server/commands/serve/catalog_lookout.hpp"
#include "server/commands/serve_options.hpp"
#include "server/terminal/progress_bar.hpp"

namespace scancast {

class CloudSources {
  public:
    std::vector<std::unique_ptr<LiveSource>> live;

    /// Options that check() has found sound.
    CloudSources(const ServeOptions& options, std::shared_ptr<DamageReports> damage, ScancastServer& server,
                 ProgressBar& bar);
    /// From now on these files, and what the place of --catalog holds (Loader::serve()).
    Loader::Changes serve(const std::vector<std::filesystem::path>& files);
    /// What has changed in that place since the last call is served, and told. What an administrator removed from the list
    /// stays removed as long as its file is there.
    void lookAround();
    /// None of them has anything to show, and none will.
    bool failed() const;
    void requestStop();
    bool finished() const;
    Loader& loader() { return loader_; }

  private:
    using Files = std::vector<std::filesystem::path>;
    Files both() const;
    std::size_t roomOfFolder() const;

    const std::size_t mostClouds_;
    Files files_;  // beside those of the folder
    std::vector<LiveInput> liveInputs_;
    std::unique_ptr<CatalogLookout> folder_;  // of --catalog; may be null
    Files folderFiles_;                       // what it holds
    Loader loader_;
    std::vector<std::unique_ptr<LiveSource>> live_;
};

}  // namespace scancast
