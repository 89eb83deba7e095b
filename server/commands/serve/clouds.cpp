#include "server/commands/serve/clouds.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "protocol/text/grouped.hpp"
#include "server/base/faults.hpp"
#include "server/server.hpp"

namespace scancast {
namespace {

LoaderOptions loaderOptions(const ServeOptions& options, std::shared_ptr<DamageReports> damage,
                            ScancastServer& server, ProgressBar& bar) {
    LoaderOptions loading;
    loading.import = *importOptions(options.importer);  // sound: check() has said so
    loading.importers = options.importers;
    loading.cache = options.server.cache;
    loading.damage = std::move(damage);
    loading.onDamaged = [&bar](const CloudFile& file, const Error& error) {
        // Nothing is wrong with the file, and every block may have a part in it.
        if (error.code == ErrorCode::ResourceLimit) return reportFault(error);
        bar.clear();
        spdlog::error("{}; coarser points are shown in its place", damageText(file, error));
    };
    loading.onChanged = [&server] { server.cloudsChanged(); };
    loading.kept = options.server.kept;
    loading.shape.surfels = !options.noSurfels;
    loading.version = std::string(scancastVersion());
    loading.onNote = [&bar](const std::string& note) {
        bar.clear();
        spdlog::warn("{}", note);
    };
    loading.threads = options.device.threads;
    loading.onProgress = [&bar](const std::string&, const Progress& progress) { bar.report(progress); };
    loading.onLoaded = [&bar](const LoadedCloud& loaded) {
        bar.clear();
        spdlog::info("{}: {} in {}, ready after {:.1f} s", loaded.id, counted(loaded.cloud.points, "point"),
                     counted(loaded.cloud.octree.nodes().size(), "node"), loaded.seconds);
        for (const std::string& remark : remarksOn(loaded.cloud)) spdlog::info("{}: {}", loaded.id, remark);
    };
    loading.onFailed = [&bar](const Error& error) {
        bar.clear();
        spdlog::error("{}", error.message);
    };
    return loading;
}

LiveOptions liveOptions(const ServeOptions& options, ScancastServer& server, ProgressBar& bar) {
    LiveOptions live;
    live.threads = options.device.threads;
    live.surfels = !options.noSurfels;
    live.cache = options.server.cache;
    live.metrics = &server.metrics();
    live.onChanged = [&server] { server.cloudsChanged(); };
    live.onNote = [&bar](const std::string& line) {
        bar.clear();
        spdlog::info("{}", line);
    };
    live.onFailure = [&bar](const std::string& line) {
        bar.clear();
        spdlog::error("{}", line);
    };
    return live;
}

std::optional<CatalogFolder> catalogFolder(const ServeOptions& options, ProgressBar& bar) {
    if (options.catalog.empty()) return std::nullopt;
    CatalogFolder folder(options.catalog, options.server.maxClouds, [&bar](const std::string& note) {
        bar.clear();
        spdlog::warn("{}", note);
    });
    folder.look(CatalogFolder::Time::clock::now());
    return folder;
}

std::vector<std::filesystem::path> bothOf(std::vector<std::filesystem::path> files,
                                          const std::optional<CatalogFolder>& folder) {
    if (folder) files.insert(files.end(), folder->files().begin(), folder->files().end());
    return files;
}

}  // namespace

CloudSources::CloudSources(const ServeOptions& options, std::shared_ptr<DamageReports> damage,
                           ScancastServer& server, ProgressBar& bar)
    : folder(catalogFolder(options, bar)),
      loader(bothOf(options.files, folder), server.catalog(),
             loaderOptions(options, std::move(damage), server, bar)),
      files_(options.files) {
    const auto inputs = liveInputs(options);  // sound: check() has said so
    for (const LiveInput& input : *inputs)
        live.push_back(
            std::make_unique<LiveSource>(input, server.catalog(), liveOptions(options, server, bar)));
}

Loader::Changes CloudSources::serve(const std::vector<std::filesystem::path>& files) {
    files_ = files;
    return loader.serve(bothOf(files_, folder));
}

void CloudSources::lookAround(CatalogFolder::Time now) {
    if (!folder || !folder->look(now)) return;
    const Loader::Changes changes = loader.serve(bothOf(files_, folder));
    spdlog::info("{}: {} clouds; {} added, {} removed", folder->path().string(), folder->files().size(),
                 changes.added, changes.removed);
}

bool CloudSources::failed() const {
    return loader.finished() && loader.allFailed() &&
           std::ranges::all_of(live, [](const auto& source) { return source->failed(); });
}

void CloudSources::requestStop() {
    loader.requestStop();
    for (const auto& source : live) source->requestStop();
}

bool CloudSources::finished() const {
    return loader.finished() &&
           std::ranges::all_of(live, [](const auto& source) { return source->finished(); });
}

}  // namespace scancast
