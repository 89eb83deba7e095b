#include "server/catalog/catalog.hpp"

#include <algorithm>
#include <tuple>

#include "protocol/nearest_name.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

std::string_view name(CloudState state) {
    switch (state) {
        case CloudState::Loading:
            return "loading";
        case CloudState::Ready:
            return "ready";
        case CloudState::Failed:
            return "failed";
    }
    return "unknown";
}

std::string_view name(LiveStatus::State state) {
    switch (state) {
        case LiveStatus::State::Running:
            return "running";
        case LiveStatus::State::Ended:
            return "ended";
        case LiveStatus::State::Broken:
            return "broken";
    }
    return "unknown";
}

std::string cloudIdFor(std::string_view stem) {
    constexpr std::size_t longest = 64;
    std::string id;
    for (char c : stem) {
        const bool safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '_' || (c == '.' && !id.empty());
        if (safe) {
            id.push_back(c);
        } else if (!id.empty() && id.back() != '-') {
            id.push_back('-');
        }
        if (id.size() == longest) break;
    }
    while (!id.empty() && (id.back() == '-' || id.back() == '.')) id.pop_back();
    return id.empty() ? "cloud" : id;
}

CatalogEntry* Catalog::findLocked(std::string_view id) {
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const auto& e) { return e.id == id; });
    return at == entries_.end() ? nullptr : &*at;
}

const CatalogEntry* Catalog::findLocked(std::string_view id) const {
    return const_cast<Catalog*>(this)->findLocked(id);
}

std::string Catalog::add(std::string_view title) {
    const std::lock_guard lock(mutex_);
    const std::string wanted = cloudIdFor(title);
    std::string id = wanted;
    for (int n = 2; findLocked(id) != nullptr; ++n) id = wanted + "-" + std::to_string(n);
    addLocked(id, title);
    return id;
}

bool Catalog::addAs(std::string_view id, std::string_view title) {
    const std::lock_guard lock(mutex_);
    if (findLocked(id) != nullptr) return false;
    addLocked(std::string(id), title);
    return true;
}

std::string Catalog::addLive(std::string_view title) {
    const std::string id = add(title);
    setTitle(id, title);
    setLive(id, {});
    return id;
}

void Catalog::addLocked(std::string id, std::string_view title) {
    CatalogEntry entry;
    entry.id = std::move(id);
    entry.title = std::string(title);
    entries_.push_back(std::move(entry));
}

void Catalog::setTitle(std::string_view id, std::string_view title) {
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr) return;
    entry->title = std::string(title);
    entry->titled = true;
}

bool Catalog::remove(std::string_view id) {
    CatalogEntry last;  // a large cloud takes its time to go, which nobody else waits for
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const auto& e) { return e.id == id; });
    if (at == entries_.end()) return false;
    last = std::move(*at);
    entries_.erase(at);
    gone = together_.forget(last.cloud.get());
    settleLocked();
    return true;
}

void Catalog::setProgress(std::string_view id, std::string_view stage, std::uint64_t done,
                          std::uint64_t total) {
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr || entry->state != CloudState::Loading) return;
    entry->stage = std::string(stage);
    entry->progress.reset();
    if (total > 0) entry->progress = std::min(1.0, double(done) / double(total));
    if (stage == waitingStage) settleLocked();
}

void Catalog::setReady(std::string_view id, std::shared_ptr<const Cloud> cloud) {
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    if (CatalogEntry* entry = findLocked(id)) {
        entry->state = CloudState::Ready;
        entry->stage.clear();
        entry->progress.reset();
        entry->error.clear();
        gone = together_.forget(entry->cloud.get());
        entry->cloud.swap(cloud);  // a large one takes its time to go
        settleLocked();
    }
}

bool Catalog::tryAgain(std::string_view id) {
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr || entry->state != CloudState::Failed) return false;
    entry->state = CloudState::Loading;
    entry->error.clear();
    return true;
}

bool Catalog::replace(std::string_view id, const std::shared_ptr<const Cloud>& now,
                      Expected<std::shared_ptr<const Cloud>> then) {
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr || entry->cloud != now) return false;
    if (entry->state != (now ? CloudState::Ready : CloudState::Failed)) return false;
    entry->state = then ? CloudState::Ready : CloudState::Failed;
    entry->error = then ? std::string() : std::move(then.error().message);
    gone = together_.forget(entry->cloud.get());
    if (then)
        entry->cloud.swap(*then);  // a large one takes its time to go
    else
        entry->cloud.reset();
    return true;
}

void Catalog::setPreview(std::string_view id, std::shared_ptr<const Cloud> cloud) {
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr || entry->state != CloudState::Loading) return;
    gone = together_.forget(entry->cloud.get());
    entry->cloud = std::move(cloud);
}

void Catalog::setFailed(std::string_view id, std::string reason) {
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    if (CatalogEntry* entry = findLocked(id)) {
        entry->state = CloudState::Failed;
        entry->stage.clear();
        entry->progress.reset();
        gone = together_.forget(entry->cloud.get());
        entry->cloud.reset();
        entry->error = std::move(reason);
        settleLocked();
    }
}

void Catalog::setLive(std::string_view id, LiveStatus status, std::shared_ptr<const Cloud> cloud) {
    TogetherClouds::Clouds gone;
    const std::lock_guard lock(mutex_);
    CatalogEntry* entry = findLocked(id);
    if (entry == nullptr) return;
    entry->live = std::move(status);
    if (cloud == nullptr) return;
    entry->state = CloudState::Ready;
    entry->stage.clear();
    entry->error.clear();
    gone = together_.forget(entry->cloud.get());
    entry->cloud.swap(cloud);  // a large one takes its time to go
    settleLocked();
}

std::size_t Catalog::size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
}

std::vector<CatalogEntry> Catalog::list() const {
    const std::lock_guard lock(mutex_);
    return entries_;
}

std::optional<CatalogEntry> Catalog::find(std::string_view id) const {
    const std::lock_guard lock(mutex_);
    const CatalogEntry* entry = findLocked(id);
    return entry == nullptr ? std::nullopt : std::optional(*entry);
}

Problem noSuchCloud(std::string_view id) {
    Problem problem = problemOf(
        404, "There is no cloud named " + quoteText(id) + " here; /api/v1/clouds lists those there are.");
    problem.errors.push_back({"cloud", problem.detail});
    return problem;
}

tl::expected<std::shared_ptr<const Cloud>, Problem> Catalog::cloud(std::string_view id) const {
    const auto refuse = [](int status, std::string detail) {
        Problem problem = problemOf(status, std::move(detail));
        problem.errors.push_back({"cloud", problem.detail});
        return tl::unexpected(std::move(problem));
    };
    const auto entry = find(id);
    if (!entry) return tl::unexpected(noSuchCloud(id));
    if (entry->state == CloudState::Failed) {
        return refuse(404, "The cloud \"" + entry->id + "\" cannot be shown: " + entry->error);
    }
    if (!entry->cloud) {
        return refuse(503, "The cloud \"" + entry->id + "\" is still being loaded; ask again in a moment.");
    }
    return entry->cloud;
}

bool Catalog::isLive(std::string_view id) const {
    const std::lock_guard lock(mutex_);
    const CatalogEntry* entry = findLocked(id);
    return entry != nullptr && entry->live;
}

bool Catalog::showsNow(const Cloud* cloud) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(entries_, [&](const auto& entry) { return entry.cloud.get() == cloud; });
}

Expected<std::shared_ptr<const Cloud>> Catalog::together(std::vector<TogetherMember> members,
                                                         bool byCloud) const {
    auto made = together_.of(std::move(members), byCloud);
    if (!made) return made;
    // What went meanwhile is not kept on its account.
    for (const TogetherMember& member : (*made)->together->members)
        if (!showsNow(member.cloud.get())) std::ignore = together_.forget(member.cloud.get());
    return made;
}

std::string Catalog::defaultId() const {
    const std::lock_guard lock(mutex_);
    for (const auto& entry : entries_) {
        if (entry.state == CloudState::Ready) return entry.id;
    }
    for (const auto& entry : entries_) {
        if (entry.cloud) return entry.id;
    }
    return entries_.empty() ? std::string() : entries_.front().id;
}

bool Catalog::settled() const {
    const std::lock_guard lock(mutex_);
    return settled_;
}

// Whoever sends clients here by /readyz would send them away whenever somebody adds a cloud.
void Catalog::settleLocked() {
    const auto isUnderWay = [](const auto& entry) {
        return entry.state == CloudState::Loading && entry.stage != waitingStage;
    };
    settled_ =
        settled_ ||
        (std::ranges::none_of(entries_, isUnderWay) &&
         std::ranges::any_of(entries_, [](const auto& entry) { return entry.state == CloudState::Ready; }));
}

std::uint64_t Catalog::pointsResident() const {
    const std::lock_guard lock(mutex_);
    std::uint64_t points = 0;
    for (const auto& entry : entries_) {
        if (!entry.cloud || entry.cloud->octree.nodes().empty()) continue;
        const SampleStore& store = entry.cloud->octree.store();
        points += store.whole() ? entry.cloud->points : store.bytesResident() / sizeof(Sample);
    }
    return points;
}

}  // namespace scancast
