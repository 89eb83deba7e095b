#include "server/commands/serve/clouds.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
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
    loading.remote = options.server.remote;
    loading.onDamaged = [&bar](const CloudFile& file, const Error& error) {
        // Nothing is wrong with the file, and every block may have a part in it.
        if (error.code == ErrorCode::ResourceLimit) return reportFault(error);
        bar.clear();
        spdlog::error("{}; coarser points are shown in its place", damageText(file, error));
    };
    loading.onChanged = [&server] { server.cloudsChanged(); };
    loading.kept = options.server.kept;
    loading.shape.surfels = !options.noSurfels;
    loading.native = options.native;
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

/// Each look is a request, or one for a thousand objects, and storage bills those.
constexpr std::chrono::seconds betweenLists{5};

std::unique_ptr<CatalogLookout> lookout(const ServeOptions& options, std::size_t most, ProgressBar& bar) {
    if (options.catalog.empty()) return nullptr;
    LookoutOptions looking;
    looking.place = options.catalog;
    looking.remote = options.server.remote;
    if (isRemoteUrl(options.catalog.native())) looking.interval = betweenLists;
    looking.most = most;
    looking.onNote = [&bar](const std::string& note) {
        bar.clear();
        spdlog::warn("{}", note);
    };
    return std::make_unique<CatalogLookout>(std::move(looking));
}

/// So that the server is not ready before the clouds of a place that answers are; for one that does not, signals do not wait.
std::vector<std::filesystem::path> firstOf(CatalogLookout* place) {
    constexpr std::chrono::seconds patience{5};
    if (!place) return {};
    if (!place->waitForFirst(patience))
        spdlog::warn("{}: it has not answered for {} s; its clouds are served when it has.", place->shown(),
                     patience.count());
    return place->takeNews().value_or(CatalogLookout::News()).files;
}

}  // namespace

CloudSources::CloudSources(const ServeOptions& options, std::shared_ptr<DamageReports> damage,
                           ScancastServer& server, ProgressBar& bar)
    : mostClouds_(options.server.maxClouds),
      files_(options.files),
      liveInputs_(*liveInputs(options)),  // sound: check() has said so
      folder_(lookout(options, roomOfFolder(), bar)),
      folderFiles_(firstOf(folder_.get())),
      loader_(both(), server.catalog(), loaderOptions(options, std::move(damage), server, bar)) {
    for (const LiveInput& input : liveInputs_)
        live_.push_back(
            std::make_unique<LiveSource>(input, server.catalog(), liveOptions(options, server, bar)));
}

CloudSources::Files CloudSources::both() const {
    Files files = files_;
    // A look that was made before there was less room may have found more.
    const auto fits = std::ptrdiff_t(std::min(folderFiles_.size(), roomOfFolder()));
    files.insert(files.end(), folderFiles_.begin(), folderFiles_.begin() + fits);
    return files;
}

/// What the others leave of --max-clouds.
std::size_t CloudSources::roomOfFolder() const {
    return mostClouds_ - std::min(mostClouds_, files_.size() + liveInputs_.size());
}

Loader::Changes CloudSources::serve(const std::vector<std::filesystem::path>& files) {
    files_ = files;
    if (folder_) folder_->setMost(roomOfFolder());
    return loader_.serve(both());
}

void CloudSources::lookAround() {
    auto news = folder_ ? folder_->takeNews() : std::nullopt;
    if (!news) return;
    folderFiles_ = std::move(news->files);
    const Loader::Changes changes =
        loader_.serve(both(), news->isAnew ? Loader::Again::TryFailed : Loader::Again::Leave);
    if (changes.added + changes.removed + changes.tried == 0) return;
    spdlog::info("{}: {} clouds; {} added, {} removed{}", folder_->shown(), folderFiles_.size(),
                 changes.added, changes.removed,
                 changes.tried > 0 ? fmt::format(", {} tried again", changes.tried) : "");
}

bool CloudSources::failed() const {
    return loader_.finished() && loader_.allFailed() &&
           std::ranges::all_of(live_, [](const auto& source) { return source->failed(); });
}

void CloudSources::requestStop() {
    if (folder_) folder_->requestStop();
    loader_.requestStop();
    for (const auto& source : live_) source->requestStop();
}

bool CloudSources::finished() const {
    return loader_.finished() && (!folder_ || folder_->finished()) &&
           std::ranges::all_of(live_, [](const auto& source) { return source->finished(); });
}

}  // namespace scancast
