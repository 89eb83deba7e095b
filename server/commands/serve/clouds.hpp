// Everything that the clouds of `serve` come from: files, and sources of clouds that change; what they say goes to the log,
// past the progress bar.
//
// Owned by the command, on the main thread; the server and the bar outlive it. Place: serve options → **cloud sources** →
// loader, live sources → catalog.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "server/catalog/damage_reports.hpp"
#include "server/catalog/live_source.hpp"
#include "server/catalog/loader.hpp"
#include "server/commands/serve/catalog_folder.hpp"
#include "server/commands/serve_options.hpp"
#include "server/terminal/progress_bar.hpp"

namespace scancast {

struct CloudSources {
    std::optional<CatalogFolder> folder;  ///< of --catalog
    Loader loader;
    std::vector<std::unique_ptr<LiveSource>> live;

    /// Options that check() has found sound.
    CloudSources(const ServeOptions& options, std::shared_ptr<DamageReports> damage, ScancastServer& server,
                 ProgressBar& bar);
    /// From now on these files, and what the folder holds (Loader::serve()).
    Loader::Changes serve(const std::vector<std::filesystem::path>& files);
    /// Looks whether the folder holds something else, when it is time to; what has changed is served, and told.
    void lookAround(CatalogFolder::Time now);
    /// None of them has anything to show, and none will.
    bool failed() const;
    void requestStop();
    bool finished() const;

  private:
    std::vector<std::filesystem::path> files_;  ///< beside those of the folder
};

}  // namespace scancast
