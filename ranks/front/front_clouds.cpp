#include "ranks/front/front_clouds.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <thread>
#include <utility>

#include "ranks/front/front_store.hpp"

namespace scancast {
namespace {

/// Of the ranks, to open a cloud: milliseconds where the file system answers.
constexpr auto opensWithin = std::chrono::seconds(10);
/// A job that was lost is there again after one or two seconds, or it does not start.
constexpr auto isBackWithin = std::chrono::seconds(10);
constexpr auto looksForStop = std::chrono::milliseconds(20);

const RankedFile* rankedFileOf(const Cloud& cloud) {
    const auto* const store = dynamic_cast<const FrontStore*>(&cloud.octree.store());
    return store != nullptr ? &store->file() : nullptr;
}

}  // namespace

// ---- clouds come

std::shared_ptr<SampleStore> FrontClouds::add(std::shared_ptr<const CloudFile> cloud) {
    std::error_code unknown;
    const auto path = std::filesystem::absolute(cloud->path(), unknown);
    std::string alone;
    // As SharedClouds judges them.
    if (!cloud->facts().look)
        alone = fmt::format("no look is kept in it; scancast look {} decides it once and keeps it",
                            cloud->path().string());
    else if (unknown || !std::filesystem::exists(path, unknown))
        alone = "it is no file here that ranks could open";
    if (!alone.empty()) {
        onAlone_(
            fmt::format("{}: it is drawn without the ranks: {}", cloud->path().filename().string(), alone));
        return cache_->add(std::move(cloud));
    }
    auto file = enlist({path.string(), cloud->facts().revision});
    auto whole = cache_->add(cloud);
    return std::make_shared<FrontStore>(std::move(whole), std::move(cloud), std::move(file),
                                        shared_from_this());
}

std::shared_ptr<RankedFile> FrontClouds::enlist(CloudPlace place) {
    std::shared_ptr<RankedFile> file;
    JobKeeper* keeper = nullptr;
    {
        const Lock lock(monitor_);
        std::erase_if(files_, [](const auto& entry) { return entry.second.expired(); });
        file = std::make_shared<RankedFile>(++lastNumber_, std::move(place));
        files_[file->number] = file;
        keeper = keeper_;
    }
    if (!keeper) return file;
    const auto giveUp = Clock::now() + opensWithin;
    keeper->waitForFirstStart(opensWithin);
    Lock lock(monitor_);
    if (!isUp_) return file;
    if (!file->isAnswered) askToOpen(*file);  // twice, if the ranks have just come: they answer both
    monitor_.waitUntil(lock, giveUp, [&] { return file->isAnswered || !isUp_; });
    return file;
}

/// What OpenedClouds::openOnAll() takes.
RankBytes FrontClouds::wordsFor(const RankedFile& file) const {
    RankBytes words;
    const auto add = [&words](const CloudPlace& place) {
        for (const std::string* const word : {&place.path, &place.revision}) {
            const auto bytes = std::as_bytes(std::span(*word));
            words.insert(words.end(), bytes.begin(), bytes.end());
            words.push_back(std::byte{0});
        }
    };
    add(file.place);
    for (const auto& [number, other] : files_)
        if (const auto kept = other.lock()) add(kept->place);
    return words;
}

void FrontClouds::askToOpen(const RankedFile& file) {
    if (keeper_ != nullptr) keeper_->open(file.number, wordsFor(file));
}

// ---- the job

void FrontClouds::jobIsUp() {
    const Lock lock(monitor_);
    isUp_ = true;
    for (const auto& [number, listed] : files_) {
        const auto file = listed.lock();
        if (!file) continue;
        file->isAnswered = false;
        askToOpen(*file);
    }
}

void FrontClouds::jobOpened(std::uint64_t number, const JobOpened& opened) {
    std::string alone;
    {
        const Lock lock(monitor_);
        const auto listed = files_.find(number);
        const auto file = listed != files_.end() ? listed->second.lock() : nullptr;
        if (!file || !isUp_) return;
        if (opened.whyNot.empty())
            file->capacity = opened.capacity;
        else if (!file->isAnswered)
            alone = fmt::format("{}: it is drawn without the ranks: {}",
                                std::filesystem::path(file->place.path).filename().string(), opened.whyNot);
        file->isAnswered = true;
        change(*file, opened.whyNot.empty() ? DrawnBy::Ranks : DrawnBy::FrontAlone);
    }
    if (!alone.empty()) onAlone_(alone);
}

void FrontClouds::jobIsLost() {
    const Lock lock(monitor_);
    isUp_ = false;
    lostAt_ = Clock::now();
    for (const auto& [number, listed] : files_)
        if (const auto file = listed.lock()) change(*file, DrawnBy::FrontMeanwhile);
}

void FrontClouds::change(RankedFile& file, DrawnBy by) {
    if (file.by == by) return;
    ++file.changes;
    file.by = by;
    ++file.changes;
    std::exchange(file.until, std::stop_source()).request_stop();
}

void FrontClouds::close() {
    const Lock lock(monitor_);
    keeper_ = nullptr;
}

// ---- who draws

std::uint64_t FrontClouds::changesOf(const Cloud& cloud) {
    const RankedFile* const file = rankedFileOf(cloud);
    if (file == nullptr) return 0;
    for (;;) {
        const std::uint64_t changes = file->changes;
        if (changes % 2 == 0) return changes;
        std::this_thread::yield();
    }
}

std::stop_token FrontClouds::untilChanged(const RankedFile& file) const {
    const Monitor::Look look(monitor_);
    return file.until.get_token();
}

bool FrontClouds::waitForRanks(const RankedFile& file, const std::stop_token& stop) const {
    Lock lock(monitor_);
    const auto giveUp = lostAt_ + isBackWithin;
    const auto isSettled = [&file] { return file.by != DrawnBy::FrontMeanwhile; };
    while (!isSettled() && !stop.stop_requested() && Clock::now() < giveUp)
        monitor_.waitUntil(lock, Clock::now() + looksForStop, isSettled);
    return isSettled();
}

void FrontClouds::know(const std::shared_ptr<const Cloud>& cloud) {
    const Lock lock(monitor_);
    const std::uint64_t source = cloud->octree.source();
    if (const auto known = known_.find(source); known != known_.end() && known->second.cloud.lock() == cloud)
        return;
    std::erase_if(known_, [](const auto& known) { return known.second.cloud.expired(); });
    const RankedFile* const file = rankedFileOf(*cloud);
    known_[source] = {cloud, file != nullptr ? std::optional(file->place) : std::nullopt};
}

std::optional<CloudPlace> FrontClouds::placeOf(std::uint64_t source) const {
    const Monitor::Look look(monitor_);
    const auto known = known_.find(source);
    return known != known_.end() ? known->second.place : std::nullopt;
}

}  // namespace scancast
