#include "server/catalog/loader.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tuple>
#include <utility>

#include "files/owned_folder.hpp"
#include "protocol/text/grouped.hpp"
#include "remote/remote_url.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/look/keep_look.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/faults.hpp"
#include "server/catalog/counted_cloud.hpp"
#include "server/catalog/preview.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

// While an octree is built in memory; about a quarter of it stays.
constexpr std::uint64_t bytesPerPoint = 60;
// While a scan is opened that is shown as it is: its upper levels.
constexpr std::uint64_t bytesToOpenNative = 32 << 20;
// A scan that does not say how many points it has: text has fewer to the byte, compressed files more.
constexpr std::uint64_t bytesPerUnknownByte = 6, keptBytesPerUnknownByte = 2;

// Ends a scan early when the server is shut down.
class StoppableSource final : public ForwardingSource {
  public:
    StoppableSource(std::unique_ptr<PointSource> source, std::stop_token stop)
        : ForwardingSource(std::move(source)), stop_(std::move(stop)) {}
    Expected<bool> read(PointBatch& batch) override {
        if (stop_.stop_requested()) return fail(ErrorCode::Cancelled, "The server is shutting down.");
        return source().read(batch);
    }

  private:
    const std::stop_token stop_;
};

bool isRemote(const fs::path& file) {
    return isRemoteUrl(file.native());
}

/// What a catalog's entry is called after, and messages name: of a URL nothing that is secret.
fs::path plainName(const fs::path& file) {
    if (!isRemote(file)) return file;
    const auto url = RemoteUrl::parse(file.native());
    return url ? fs::path(titleOf(*url)) : fs::path("cloud");
}

/// What it is known by: of a URL what it names, however that is signed.
std::string identityOf(const fs::path& file) {
    if (!isRemote(file)) return file.native();
    const auto url = RemoteUrl::parse(file.native());
    return url ? url->identity() : file.native();
}

LoaderOptions stoppedBy(std::stop_token stop, LoaderOptions options) {
    options.import.stop = std::move(stop);
    std::error_code none;
    options.import.photos = options.kept ? options.kept->folder() : fs::temp_directory_path(none);
    return options;
}

/// Native clouds share decoders and memory. What has been promised is finished when the loader has stopped, so decoders do not stop with it.
NativeOpening nativeOpening(const LoaderOptions& options) {
    constexpr std::uint64_t usual = 64 << 20;
    ImportOptions import = options.import;
    import.stop = {};
    const auto reserve = [cache = std::weak_ptr(options.cache)](std::uint64_t bytes) {
        const auto there = cache.lock();
        return there ? there->reserve(bytes) : nullptr;
    };
    const std::uint64_t limit = std::min(usual, options.cache->stats().limit / 8);
    return {.decoders = ChunkDecoders::create(std::move(import)),
            .memory = std::make_shared<GatheredMemory>(limit, reserve),
            .crs = options.import.assumeCrs,
            .surfels = options.shape.surfels};
}

/// Another path, size, time, program or way to build gives another name.
fs::path keptPath(const ScanInput& input, const LoaderOptions& options) {
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(input.path(), error);
    const FileIdentity& file = input.file().identity();
    const OctreeShape& shape = options.shape;
    std::string all =
        fmt::format("{}\n{}\n{} {}\n{}\n{} {} {} {} {}", whole.string(), file.bytes, file.changed,
                    input.mirrorsChanged(), options.version, shape.leafPoints, shape.chunkPoints,
                    shape.surfels, shape.neighbours, options.import.keepAttributes);
    if (const auto& crs = options.import.assumeCrs)
        all += fmt::format("\n{} {}", crs->epsg.value_or(0), crs->wkt);
    return options.kept->pathOf(cloudIdFor(input.path().stem().string()),
                                XXH3_64bits(all.data(), all.size()));
}

std::uint64_t bytesToKeep(const PointSource& source, const ScanInput& input, const OctreeShape& shape) {
    const auto needs = diskNeeds(source.header(), {.memoryLimit = leastIngestMemory, .shape = shape});
    return (needs ? needs->file : input.bytes() * keptBytesPerUnknownByte) + bytesOf(source.photos());
}

std::uint64_t memoryToBuild(const PointSource& source, const ScanInput& input) {
    if (source.header().points) return *source.header().points * bytesPerPoint;
    return input.bytes() * bytesPerUnknownByte;
}

}  // namespace

/// What an ingest may take: half of the limit, which those that are at work at once share. The file is the same with
/// any.
class Loader::IngestMemory {
  public:
    explicit IngestMemory(Loader& loader) : loader_(loader) {
        const Monitor::Lock lock(loader_.monitor_);
        const std::uint64_t half = loader_.options_.cache->stats().limit / 2;
        const std::size_t atOnce = std::min(loader_.loading_.size() + loader_.waiting(), loader_.ingesters());
        const std::uint64_t left = half - std::min(half, loader_.ingestMemory_);
        bytes_ = std::max(std::min(half / std::max<std::size_t>(1, atOnce), left), leastIngestMemory);
        loader_.ingestMemory_ += bytes_;
    }
    ~IngestMemory() {
        const Monitor::Lock lock(loader_.monitor_);
        loader_.ingestMemory_ -= bytes_;
    }
    IngestMemory(const IngestMemory&) = delete;
    IngestMemory& operator=(const IngestMemory&) = delete;
    std::uint64_t bytes() const { return bytes_; }

  private:
    Loader& loader_;
    std::uint64_t bytes_ = 0;
};

Loader::Loader(std::vector<fs::path> files, Catalog& catalog, LoaderOptions options)
    : catalog_(catalog),
      options_(stoppedBy(stop_.get_token(), std::move(options))),
      native_(nativeOpening(options_)),
      watch_(catalog, watchOptions()) {
    std::error_code none;
    sweepOwnedFolders(fs::temp_directory_path(none));  // of servers that were killed
    if (options_.remote) options_.remote->onChanged([this] { watch_.hurry(); });
    const Monitor::Lock lock(monitor_);
    addLocked(std::move(files));
    loading_.reserve(ingesters() + remoteOpeners);
    threads_.emplace_back([this] { run(Lane::Own); });
    for (std::size_t i = 0; options_.remote && i < remoteOpeners; ++i)
        threads_.emplace_back([this] { run(Lane::Remote); });
    for (int i = 0; i < std::max(1, options_.importers); ++i)
        threads_.emplace_back([this] { run(Lane::Importers); });
}

Loader::~Loader() {
    if (options_.remote) options_.remote->onChanged({});
    requestStop();
    for (auto& thread : threads_) thread.join();
}

bool Loader::load(ScanInput input, std::string id) {
    const Monitor::Lock lock(monitor_);
    if (stop_.stop_requested() || added() >= mostAdded) return false;
    ScanPlace place = input.place();
    disownLocked(id);
    unsorted_.push_back({std::move(place), std::move(id), std::move(input), numbers_});
    ++numbers_;
    return true;
}

/// Of those that wait, the ones that load() brought.
std::size_t Loader::added() const {
    std::size_t count = 0;
    for (const Jobs* jobs : {&unsorted_, &own_, &forImporters_})
        count +=
            std::size_t(std::ranges::count_if(*jobs, [](const Job& job) { return job.opened.has_value(); }));
    return count;
}

/// Where it is now: a URL may have been signed anew meanwhile.
ScanPlace Loader::currentPlace(const ScanPlace& place, const std::string& id) const {
    if (!isRemote(place.name)) return place;
    for (const Named& named : named_)
        if (named.id == id && identityOf(named.file) == identityOf(place.name)) return {.name = named.file};
    return place;
}

/// The same object's URL, with another signature: what waits for it, is opened again or is open goes on with that one.
void Loader::signAnewLocked(Named& named, fs::path file) {
    named.file = std::move(file);
    for (Jobs* jobs : {&unsorted_, &remote_, &later_})
        for (Job& job : *jobs)
            if (job.id == named.id) job.place = currentPlace(job.place, job.id);
    const auto url = RemoteUrl::parse(named.file.native());
    if (url && options_.remote) options_.remote->signAnew(*url);
}

/// It is another's from now on: the cloud of the file that had it was removed.
void Loader::disownLocked(const std::string& id) {
    for (Named& named : named_)
        if (named.id == id) named.id.clear();
}

void Loader::addLocked(std::vector<fs::path> files) {
    Jobs jobs;
    for (auto& file : files) {
        std::string id = catalog_.add(plainName(file).stem().string());
        disownLocked(id);
        named_.push_back({file, std::move(id)});
        jobs.push_back({{.name = std::move(file)}, named_.back().id});
    }
    // What opens in milliseconds does not wait for what takes minutes.
    std::stable_partition(jobs.begin(), jobs.end(),
                          [](const Job& job) { return isRemote(job.file()) || isCloudFileAt(job.file()); });
    for (Job& job : jobs) {
        job.number = numbers_++;
        unsorted_.push_back(std::move(job));
    }
}

/// Whether it waited to be loaded; it does not any more.
bool Loader::dismissLocked(const std::string& id) {
    std::size_t dismissed = 0;
    for (Jobs* jobs : {&unsorted_, &own_, &remote_, &forImporters_, &later_})
        dismissed += std::erase_if(*jobs, [&](const Job& job) { return job.id == id; });
    return dismissed > 0;
}

/// False: later, by leaveLocked(). Its id is nobody else's until then, so that what a thread is at is never shown as another.
bool Loader::removeLocked(Named& named) {
    const auto entry = catalog_.find(named.id);
    const bool isBusy = !dismissLocked(named.id) && entry && entry->state == CloudState::Loading;
    if (isBusy) return named.leaves = true, false;
    catalog_.remove(named.id);
    return true;
}

bool Loader::tryAgainLocked(Named& named, Again again) {
    if (again == Again::Leave) return false;
    const auto entry = catalog_.find(named.id);
    if (!entry && again == Again::TryFailed) return false;
    if (entry && entry->state != CloudState::Failed) return false;
    if (!entry) {
        std::string id = catalog_.add(plainName(named.file).stem().string());
        disownLocked(id);
        named.id = std::move(id);
    }
    unsorted_.push_back({{.name = named.file}, named.id, {}, numbers_++});
    std::ignore = catalog_.tryAgain(named.id);  // a new one is Loading already
    return true;
}

bool Loader::leaveLocked(const std::string& id) {
    const auto left =
        std::erase_if(named_, [&](const Named& named) { return named.leaves && named.id == id; });
    if (left > 0) catalog_.remove(id);
    return left > 0;
}

Loader::Changes Loader::serve(std::vector<fs::path> files, Again again) {
    watch_.hurry();
    Changes changes;
    {
        const Monitor::Lock lock(monitor_);
        if (stop_.stop_requested()) return {};
        std::multimap<std::string, std::size_t> wanted;  // named twice: served twice
        for (std::size_t i = 0; i < files.size(); ++i) wanted.emplace(identityOf(files[i]), i);
        for (auto named = named_.begin(); named != named_.end();) {
            const auto at = wanted.find(identityOf(named->file));
            if (at == wanted.end()) {
                changes.removed += named->leaves ? 0 : 1;
                named = removeLocked(*named) ? named_.erase(named) : std::next(named);
                continue;
            }
            fs::path file = std::exchange(files[at->second], {});
            wanted.erase(at);
            named->leaves = false;
            // What an old signature did not open the new one may.
            const bool isSignedAnew = file != named->file;
            if (isSignedAnew) signAnewLocked(*named, std::move(file));
            changes.tried +=
                tryAgainLocked(*named, isSignedAnew && again == Again::Leave ? Again::TryFailed : again) ? 1
                                                                                                         : 0;
            ++named;
        }
        std::erase_if(files, [](const fs::path& file) { return file.empty(); });
        changes.added = files.size();
        addLocked(std::move(files));
    }
    if (changes.removed > 0 && options_.onChanged) options_.onChanged();
    return changes;
}

bool Loader::allFailed() const {
    const Monitor::Look look(monitor_);
    return std::ranges::all_of(named_, [&](const Named& named) {
        const auto entry = catalog_.find(named.id);
        return !entry || entry->state == CloudState::Failed;
    });
}

bool Loader::rebuild(const WatchedFile& file, const std::shared_ptr<const Cloud>& instead) {
    const Monitor::Lock lock(monitor_);
    if (stop_.stop_requested()) return false;  // the watch asks once for each cloud
    Job job{currentPlace(file.place, file.id), file.id};
    job.instead = instead;
    job.number = numbers_;
    unsorted_.push_back(std::move(job));
    ++numbers_;
    return true;
}

void Loader::requestStop() {
    watch_.requestStop();
    const Monitor::Lock lock(monitor_);
    stop_.request_stop();
}

bool Loader::finished() const {
    const Monitor::Look look(monitor_);
    return loading_.empty() && sorting_ == 0 && (waiting() == 0 || stop_.stop_requested());
}

void Loader::run(Lane lane) {
    while (step(lane)) {
    }
}

/// The same file twice is loaded once after the other: the second time it may be kept already.
Loader::Jobs::iterator Loader::nextOf(Lane lane) {
    Jobs& jobs = jobsOf(lane);
    return std::find_if(jobs.begin(), jobs.end(), [this](const Job& job) {
        return std::none_of(loading_.begin(), loading_.end(),
                            [&](const Job* other) { return other->file() == job.file(); });
    });
}

bool Loader::step(Lane lane) {
    Job job;
    bool sorted = false;
    {
        Monitor::Lock lock(monitor_);
        const auto later = nextLater();
        monitor_.waitUntil(lock, later, [&] {
            return stop_.stop_requested() || !unsorted_.empty() || nextOf(lane) != jobsOf(lane).end() ||
                   nextLater() < later;
        });
        if (stop_.stop_requested()) return false;
        takeLater();
        if (unsorted_.empty() && nextOf(lane) == jobsOf(lane).end()) return true;
        sorted = unsorted_.empty();
        Jobs& from = sorted ? jobsOf(lane) : unsorted_;
        const auto next = sorted ? nextOf(lane) : from.begin();
        job = std::move(*next);
        from.erase(next);
        if (sorted)
            loading_.push_back(&job);
        else
            ++sorting_;
    }
    if (!sorted) {
        sort(job);
        return true;
    }
    if (!contained("The loader", [&] { loadOne(job); }) && !job.instead)
        std::ignore = contained("The loader", [&] { catalog_.setFailed(job.id, {}); });
    bool left = false;
    {
        const Monitor::Lock lock(monitor_);
        loading_.erase(std::find(loading_.begin(), loading_.end(), &job));
        left = leaveLocked(job.id);
    }
    if (left && options_.onChanged) options_.onChanged();
    return true;
}

/// Whoever is free looks at what has come before anything long begins. What was not opened is not kept open.
void Loader::sort(Job& job) {
    std::string id;
    const bool again = job.instead.has_value();
    const bool overNetwork = options_.remote && isRemote(job.file());
    const auto byImporter = contained("Looking at a file", [&]() -> Expected<bool> {
        id = job.id;
        if (isRemote(job.file())) return false;
        if (job.opened) return needsImporter(*job.opened);
        const auto input = ScanInput::open(job.place);
        return input && needsImporter(*input);
    });
    Jobs& jobs = jobsOf(overNetwork                  ? Lane::Remote
                        : byImporter.value_or(false) ? Lane::Importers
                                                     : Lane::Own);
    const auto placed = contained("The loader", [&] {
        const Monitor::Lock lock(monitor_);
        const auto place = std::find_if(jobs.begin(), jobs.end(),
                                        [&](const Job& other) { return other.number > job.number; });
        jobs.insert(place, std::move(job));
    });
    if (!placed && !again) std::ignore = contained("The loader", [&] { catalog_.setFailed(id, {}); });
    const Monitor::Lock lock(monitor_);
    --sorting_;
}

void Loader::loadOne(Job& job) {
    const auto start = std::chrono::steady_clock::now();
    auto cloud = contained("Loading", [&] {
        if (isRemote(job.file())) return openRemote(job);
        auto opened = job.opened ? Expected<ScanInput>(std::move(*job.opened)) : ScanInput::open(job.place);
        return opened ? shownCloudOf(*opened, job) : tl::unexpected(std::move(opened.error()));
    });
    if (job.instead)
        return isRemote(job.file()) ? settleReopened(job, std::move(cloud))
                                    : settleRebuilt(job, std::move(cloud));
    if (!cloud && tryLater(job, cloud.error())) return;
    settle(job, std::move(cloud),
           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void Loader::settle(const Job& job, Result cloud, double seconds) {
    if (!cloud) return settleFailed(job, std::move(cloud.error()));
    if (options_.onLoaded)
        std::ignore = contained("Telling of a cloud", [&] { options_.onLoaded({job.id, **cloud, seconds}); });
    auto ready = contained("The catalog", [&] { catalog_.setReady(job.id, *cloud); });
    if (!ready) return settleFailed(job, std::move(ready.error()));
    if (job.watched) watch_.shown(job.id, std::move(*cloud));
}

// Who has something to look at keeps it.
void Loader::settleRebuilt(const Job& job, Result cloud) {
    const std::string title = job.place.name.filename().string();
    if (!cloud) {
        if (cloud.error().code != ErrorCode::Cancelled)
            note(fmt::format("{}: {} could not be built anew, and is served as it was: {}", job.id, title,
                             cloud.error().message));
        return watch_.shown(job.id, job.instead->lock());
    }
    const bool isShown =
        catalog_.replace(job.id, job.instead->lock(), *cloud);  // else it was removed meanwhile
    watch_.shown(job.id, job.watched ? std::move(*cloud) : nullptr);
    if (!isShown) return;
    note(fmt::format("{}: {} has been built anew.", job.id, title));
    if (options_.onChanged) options_.onChanged();
}

// What was read of the old object goes on being drawn until the new one is there.
void Loader::settleReopened(const Job& job, Result cloud) {
    if (!cloud) return watch_.notOpened(job.id, cloud.error());
    // Removed meanwhile, and perhaps another has its id: the watch sees that by itself.
    const auto before = job.instead->lock();
    if (!before || !catalog_.replace(job.id, before, *cloud)) return;
    watch_.opened(*job.watched);
    watch_.shown(job.id, *cloud);
    note(fmt::format("{}: {} has been replaced, and the new one is served from now on: {} in {}.", job.id,
                     plainName(job.file()).string(), counted((*cloud)->points, "point"),
                     counted((*cloud)->octree.nodes().size(), "node")));
    if (options_.onChanged) options_.onChanged();
}

void Loader::settleFailed(const Job& job, Error error) {
    // Errors name a URL as it is shown, whose host is in small letters however it was written.
    const std::string word = job.file().native();
    const auto url = isRemote(job.file()) ? RemoteUrl::parse(word) : fail(ErrorCode::InvalidArgument, "");
    const fs::path file = url ? url->shown() : shownArgument(word);
    // Everybody may read the catalog: it names files, not where they are.
    std::string reason = error.message;
    for (auto at = reason.find(file.string()); file.has_parent_path() && at != std::string::npos;
         at = reason.find(file.string()))
        reason.replace(at, file.string().size(), file.filename().string());
    catalog_.setFailed(job.id, std::move(reason));
    if (error.message.find(file.filename().string()) == std::string::npos) {
        error.message = file.string() + ": " + error.message;
    }
    if (options_.onFailed && error.code != ErrorCode::Cancelled)
        std::ignore = contained("Telling of a failure", [&] { options_.onFailed(error); });
}

Loader::Result Loader::shownCloudOf(const ScanInput& input, Job& job) {
    auto cloud = cloudOf(input, job);
    if (!cloud) return cloud;
    return withLook(std::move(*cloud));
}

Loader::Result Loader::openRemote(Job& job) {
    if (!options_.remote)
        return fail(ErrorCode::Unsupported,
                    shownArgument(job.file().native()) + ": URLs are not opened here");
    const auto opening = options_.cache->reserve(bytesToOpenNative);
    auto opened = openRemoteCloud(*options_.remote, job.file().native(), native_);
    if (!opened) return passOn(std::move(opened));
    WatchedFile watched{.id = job.id, .place = job.place, .file = opened->file, .remote = opened->object};
    job.watched = watched;
    if (!job.instead)
        watch_.opened(std::move(watched));  // else what is shown is watched until it is not any more
    auto cloud = openCloud(std::move(opened->file), options_.cache);
    if (!cloud) return cloud;
    return withLook(std::move(*cloud));
}

/// Whether it is opened again by and by: what cannot be reached now is not gone.
bool Loader::tryLater(Job& job, const Error& error) {
    if (!isRemote(job.file()) || error.code != ErrorCode::Unavailable) return false;
    if (!std::exchange(job.waitsForRemote, true))
        note(error.message + "; it is opened as soon as that can be");
    catalog_.setProgress(job.id, Catalog::waitingStage, 0, 0);
    const Monitor::Lock lock(monitor_);
    if (stop_.stop_requested()) return false;
    Job again{.place = currentPlace(job.place, job.id), .id = job.id, .number = job.number};
    again.due = Clock::now() + options_.remoteRetry;
    again.waitsForRemote = true;
    later_.push_back(std::move(again));
    return true;
}

Loader::Clock::time_point Loader::nextLater() const {
    auto next = Clock::time_point::max();
    for (const Job& job : later_) next = std::min(next, job.due);
    return next;
}

/// Those whose time has come wait in line again.
void Loader::takeLater() {
    const auto now = Clock::now();
    for (auto job = later_.begin(); job != later_.end();) {
        if (job->due > now) {
            ++job;
            continue;
        }
        remote_.push_back(std::move(*job));
        job = later_.erase(job);
    }
}

Loader::Result Loader::openIn(Expected<InputFile> file, Job& job, bool kept) {
    if (!file) return passOn(std::move(file));
    WatchedFile watched{.id = job.id, .place = job.place, .identity = file->identity()};
    if (kept) watched.kept = file->name();
    watched.rebuilt = job.instead.has_value();
    auto opened = CloudFile::open(std::move(*file));
    if (!opened) return passOn(std::move(opened));
    watched.file = *opened;
    job.watched = watched;
    watch_.opened(std::move(watched));  // first: its blocks are read, and may be damaged, from now on
    return openCloud(std::move(*opened), options_.cache);
}

/// Without ingest. Its own file is watched, as a cloud file is.
Loader::Result Loader::openAsItIs(const ScanInput& input, Job& job) {
    WatchedFile watched{.id = job.id, .place = job.place, .identity = input.file().identity()};
    const auto opening = options_.cache->reserve(bytesToOpenNative);
    auto opened = openNative(input, native_);
    if (!opened) return passOn(std::move(opened));
    watched.file = *opened;
    job.watched = watched;
    watch_.opened(std::move(watched));
    return openCloud(std::move(*opened), options_.cache);
}

Loader::Result Loader::cloudOf(const ScanInput& input, Job& job) {
    if (isCloudFile(input.file())) return openIn(input.file().share(), job, false);
    if (options_.native && canBeNative(input)) return openAsItIs(input, job);
    const std::string title = input.path().filename().string();
    const fs::path path = options_.kept ? keptPath(input, options_) : fs::path();
    if (options_.kept && !job.instead) {
        auto kept = openIn(options_.kept->open(path), job, true);
        if (kept) return kept;
        if (kept.error().code != ErrorCode::NotFound)
            note(fmt::format("{} is built anew: {}", title, kept.error().message));
    }
    auto source = openScan(input, options_.import);
    if (!source) return passOn(std::move(source));
    std::unique_ptr<KeptClouds::Room> place;
    if (options_.kept) {
        auto made = options_.kept->makeRoom(bytesToKeep(**source, input, options_.shape));
        if (made)
            place = std::move(*made);
        else
            note(fmt::format("{} is not kept: {}.", title, made.error().message));
    }
    bool fits = false;
    std::shared_ptr<const void> room;
    {
        // Asked and taken at once: another thread may ask the same.
        const std::lock_guard lock(room_);
        const BlockCacheStats memory = options_.cache->stats();
        const std::uint64_t needed = memoryToBuild(**source, input);
        fits = memory.bytes + needed <= memory.limit;
        if (!place && fits) room = options_.cache->reserve(needed);
    }
    source->reset();
    if (room) return build(input, job.id, std::move(room));
    if (!place) return buildOnDisk(input, job.id);

    auto cloud = keep(path, input, job);
    if (cloud || cloud.error().code == ErrorCode::Cancelled || !fits) return cloud;
    const bool worthAnotherTry =
        cloud.error().code == ErrorCode::Io || cloud.error().code == ErrorCode::ResourceLimit ||
        cloud.error().code == ErrorCode::InvalidArgument || cloud.error().code == ErrorCode::NotFound;
    if (!worthAnotherTry) return cloud;
    note(fmt::format("{} is kept in memory only: {}", title, cloud.error().message));
    job.watched.reset();
    return build(input, job.id);
}

Loader::Result Loader::keep(const fs::path& path, const ScanInput& input, Job& job) {
    if (auto ok = ingestTo(path, input, job.id); !ok) return passOn(std::move(ok));
    return openIn(options_.kept->open(path), job, true);
}

// An open file without a name goes away with the process, whatever ends it.
Loader::Result Loader::buildOnDisk(const ScanInput& input, const std::string& id) {
    std::error_code none;
    const auto folder = OwnedFolder::make(fs::temp_directory_path(none));
    if (!folder) return passOn(folder);
    const fs::path output = folder->path() / "cloud.scan";
    if (auto ok = ingestTo(output, input, id); !ok) return passOn(std::move(ok));
    return openCloud(output, options_.cache);
}

Loader::Result Loader::build(const ScanInput& input, const std::string& id,
                             std::shared_ptr<const void> room) {
    auto source = open(input, id);
    if (!source) return passOn(std::move(source));
    if (!room) room = options_.cache->reserve(memoryToBuild(**source, input));
    BuildOptions options;
    options.shape = options_.shape;
    options.title = input.path().filename().string();
    options.threads = options_.threads;
    auto mirrors = input.mirrors();
    if (!mirrors) return passOn(std::move(mirrors));
    options.mirrors = std::move(*mirrors);
    auto cloud = buildCloud(**source, options, progressOf(id));
    if (!cloud) return cloud;
    // The look first: a cloud that is given one is a copy, which would count nothing.
    return counted(withLook(std::move(*cloud)), options_.cache);
}

Expected<void> Loader::ingestTo(const fs::path& output, const ScanInput& input, const std::string& id) {
    auto source = open(input, id);
    if (!source) return passOn(std::move(source));
    IngestOptions options;
    options.output = output;
    options.readers = Readers::OwnerAlone;
    options.shape = options_.shape;
    const std::string title = input.path().filename().string();
    options.title = title;
    options.threads = options_.threads;
    const IngestMemory memory(*this);
    options.memoryLimit = memory.bytes();
    auto mirrors = input.mirrors();
    if (!mirrors) return passOn(std::move(mirrors));
    options.mirrors = std::move(*mirrors);
    {
        const auto building = options_.cache->reserve(options.memoryLimit);
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::move(*source));
        auto report = ingest(std::move(sources), options, progressOf(id), stop_.get_token());
        if (!report) return passOn(std::move(report));
    }
    // Kept with the cloud, so that the next start need not look again; if not, it is decided now.
    if (auto kept = decideAndKeepLook(output, {}); !kept)
        note(fmt::format("{} has no look of its own: {}", title, kept.error().message));
    return {};
}

Expected<std::unique_ptr<PointSource>> Loader::open(const ScanInput& input, const std::string& id) const {
    auto source = openScan(input, options_.import);
    if (!source) return source;
    PreviewOptions preview;
    preview.title = input.path().filename().string();
    preview.threads = options_.threads;
    preview.show = [this, id](std::shared_ptr<const Cloud> cloud) {
        catalog_.setPreview(id, std::move(cloud));
    };
    auto stoppable = std::make_unique<StoppableSource>(std::move(*source), stop_.get_token());
    return std::make_unique<PreviewSource>(std::move(stoppable), std::move(preview));
}

ProgressSink Loader::progressOf(const std::string& id) const {
    return [this, id](const Progress& progress) {
        catalog_.setProgress(id, progress.stage, progress.done, progress.total);
        if (options_.onProgress) options_.onProgress(id, progress);
    };
}

CloudWatchOptions Loader::watchOptions() {
    CloudWatchOptions watching;
    watching.interval = options_.watchInterval;
    watching.cache = options_.cache;
    watching.damage = options_.damage;
    watching.native = native_;
    watching.onNote = [this](const std::string& text) { note(text); };
    watching.onRefused = options_.onFailed;
    watching.onDamaged = options_.onDamaged;
    watching.onChanged = options_.onChanged;
    watching.rebuild = [this](const WatchedFile& file, const std::shared_ptr<const Cloud>& instead) {
        return rebuild(file, instead);
    };
    return watching;
}

void Loader::note(const std::string& text) const {
    if (options_.onNote) options_.onNote(text);
}

}  // namespace scancast
