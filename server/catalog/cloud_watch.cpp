#include "server/catalog/cloud_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/faults.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

// What is beyond is counted: a file that lost its end has as many damaged blocks as it had blocks there.
constexpr std::size_t mostDamageWaiting = 1024;

bool isSameFile(const FileIdentity& a, const FileIdentity& b) {
    return a.device == b.device && a.inode == b.inode;
}

/// Each block stands where it stood, with the same checksum.
bool haveSameBlocks(const CloudFile& a, const CloudFile& b) {
    if (a.facts().revision != b.facts().revision || a.nodes().size() != b.nodes().size() ||
        !std::ranges::equal(a.planes(), b.planes()))
        return false;
    for (std::uint32_t node = 0; node < a.nodes().size(); ++node) {
        if (a.nodes()[node].samples != b.nodes()[node].samples) return false;
        for (std::size_t plane = 0; plane < a.planes().size(); ++plane)
            if (a.planePlace(node, plane) != b.planePlace(node, plane)) return false;
    }
    return true;
}

bool haveSameFacts(const CloudFile& a, const CloudFile& b) {
    const auto first = printFacts(a.facts(), a.writtenBy(), a.photoPlaces()),
               second = printFacts(b.facts(), b.writtenBy(), b.photoPlaces());
    return first && second && *first == *second;
}

}  // namespace

/// What is known of one of them.
struct CloudWatch::Watched {
    WatchedFile served;
    std::weak_ptr<const Cloud> cloud{};  ///< that the catalog shows; before shown(): none
    std::shared_ptr<const CloudFile>
        described;                            ///< whose facts it has: served.file, or the same with new facts
    std::weak_ptr<const CloudFile> before{};  ///< the file that this one came in the place of
    std::vector<DamageReport> early{};        ///< of blocks that could not be read before it was shown
    bool isShown = false;
    bool hasDamage = false;
    bool refused = false;    ///< nothing is shown of it
    bool unfound = false;    ///< its name leads nowhere, which has been told
    bool building = false;   ///< it is being built anew: until shown(), its file is the loader's
    bool tried = false;      ///< that has been asked for
    bool isOver = false;     ///< the catalog shows something else
    FileIdentity pending{};  ///< what has its name now, and is not whole: perhaps not yet
    Clock::time_point pendingSince{};
    FileIdentity told{};                        ///< what has been refused
    Clock::time_point askAgain{}, openAgain{};  ///< behind a URL: not before

    std::string name() const {
        if (served.kept) return served.kept->filename().string();
        return fs::path(shownArgument(served.place.name.native())).filename().string();
    }
};

CloudWatch::CloudWatch(Catalog& catalog, CloudWatchOptions options)
    : catalog_(catalog), options_(std::move(options)), next_(Clock::now() + options_.interval) {
    thread_ = std::thread([this] { run(); });
    if (!options_.damage) return;
    options_.damage->listenWith([this](DamageReport report) {
        const Monitor::Lock lock(monitor_);
        if (news_.damage.size() < mostDamageWaiting)
            news_.damage.push_back(std::move(report));
        else
            ++news_.damageLeftOut;
    });
    const Monitor::Lock lock(monitor_);
    news_.damageLeftOut += options_.damage->leftOut();
}

CloudWatch::~CloudWatch() {
    if (options_.damage) options_.damage->listenWith({});
    requestStop();
    thread_.join();
}

void CloudWatch::opened(WatchedFile file) {
    const Monitor::Lock lock(monitor_);
    news_.opened.push_back(std::move(file));
}

void CloudWatch::shown(const std::string& id, std::shared_ptr<const Cloud> cloud) {
    const Monitor::Lock lock(monitor_);
    news_.shown.emplace_back(id, std::move(cloud));
}

void CloudWatch::notOpened(const std::string& id, const Error& error) {
    const Monitor::Lock lock(monitor_);
    news_.notOpened.emplace_back(id, error);
}

void CloudWatch::hurry() {
    const Monitor::Lock lock(monitor_);
    hurrying_ = true;
}

void CloudWatch::requestStop() {
    const Monitor::Lock lock(monitor_);
    stopping_ = true;
}

void CloudWatch::run() {
    while (contained("The watch over cloud files", [&] { return step(); }).value_or(true)) {
    }
}

bool CloudWatch::step() {
    News news;
    {
        Monitor::Lock lock(monitor_);
        monitor_.waitUntil(lock, next_, [this] { return stopping_ || hurrying_ || !news_.empty(); });
        if (stopping_) return false;
        news = std::exchange(news_, {});
        if (std::exchange(hurrying_, false)) next_ = Clock::now();
    }
    take(std::move(news));
    if (Clock::now() >= next_) {
        lookAtAll();
        next_ = Clock::now() + options_.interval;
    }
    std::erase_if(watched_, [](const auto& one) { return one->isOver; });
    return true;
}

void CloudWatch::take(News news) {
    for (WatchedFile& file : news.opened) {
        auto one = std::make_unique<Watched>();
        one->described = file.file;
        one->served = std::move(file);
        const auto at = std::ranges::find_if(
            watched_, [&](const auto& other) { return other->served.id == one->served.id; });
        if (at == watched_.end()) {
            watched_.push_back(std::move(one));
            continue;
        }
        one->before = (*at)->served.file;
        *at = std::move(one);
    }
    for (auto& [id, cloud] : news.shown) {
        for (auto& one : watched_) {
            if (one->served.id != id) continue;
            one->cloud = cloud;
            one->isShown = true;
            one->building = false;
            for (const DamageReport& report : std::exchange(one->early, {})) damaged(*one, report.error);
        }
    }
    for (const auto& [id, error] : news.notOpened) {
        for (auto& one : watched_) {
            if (one->served.id != id) continue;
            one->building = false;
            if (!std::exchange(one->unfound, true))
                note(fmt::format("{}: {}; what was fetched of it before is shown.", id, error.message));
        }
    }
    for (const DamageReport& report : news.damage) takeDamage(report);
    if (news.damageLeftOut > 0)
        note(fmt::format("{} more blocks could not be read; coarser points are shown in their place.",
                         news.damageLeftOut));
}

void CloudWatch::takeDamage(const DamageReport& report) {
    for (auto& one : watched_) {
        if (one->served.file == report.file)
            return one->isShown ? damaged(*one, report.error) : one->early.push_back(report);
        // Pictures that have begun still ask for blocks of a file that has been replaced, which was told.
        if (one->before.lock() == report.file) return;
    }
    if (options_.onDamaged) options_.onDamaged(*report.file, report.error);
}

void CloudWatch::lookAtAll() {
    for (auto& one : watched_)
        if (one->isShown) lookAt(*one);
}

// Opened anew rather than asked for by name: what lies beneath --data-root is found beneath it, or not at all.
void CloudWatch::lookAt(Watched& one) {
    const auto entry = catalog_.find(one.served.id);
    const bool isKeptAnew = one.building && !one.served.remote;  // then the loader says what is shown
    one.isOver = !entry || (!isKeptAnew && (one.refused ? entry->state != CloudState::Failed
                                                        : entry->cloud != one.cloud.lock()));
    if (one.isOver || one.building) return;
    if (one.served.remote) return lookAtRemote(one);
    std::optional<ScanInput> found;
    auto file = [&]() -> Expected<InputFile> {
        if (one.served.kept) return InputFile::open(*one.served.kept);
        auto input = ScanInput::open(one.served.place);
        if (!input) return passOn(input);
        found = std::move(*input);
        return found->file().share();
    }();
    if (file) {
        one.unfound = false;
        if (file->identity() != one.served.identity)
            changed(one, std::move(*file), found && canBeNative(*found) ? &*found : nullptr);
        else
            one.pending = {};
    } else if (!std::exchange(one.unfound, true) && !one.refused) {
        note(fmt::format("{}: {}; what was opened of it is served on.", one.served.id, file.error().message));
    }
}

// An object is replaced as a whole: what was read of the old one goes on being drawn until the new one is open. The loader opens
// it: its server may take its time, and other files are watched meanwhile.
void CloudWatch::lookAtRemote(Watched& one) {
    const auto now = Clock::now();
    if (!one.served.remote->changed()) {
        if (now < one.askAgain) return;
        one.askAgain = now + options_.remoteInterval;
        return one.served.remote->look();
    }
    if (now < one.openAgain) return;
    one.openAgain = now + 2 * options_.interval;
    one.building = options_.rebuild && options_.rebuild(one.served, one.cloud.lock());
}

void CloudWatch::changed(Watched& one, InputFile file, const ScanInput* scan) {
    const FileIdentity identity = file.identity();
    if (identity == one.told) return;
    auto opened = scan ? openNative(*scan, options_.native) : CloudFile::open(std::move(file));
    if (opened) return serveAgain(one, identity, std::move(*opened));
    // Somebody may be writing it.
    if (identity != one.pending) {
        one.pending = identity;
        one.pendingSince = Clock::now();
    }
    if (Clock::now() >= one.pendingSince + options_.interval) notWhole(one, identity, opened.error());
}

void CloudWatch::notWhole(Watched& one, const FileIdentity& identity, const Error& error) {
    one.told = identity;
    if (one.served.kept && !one.served.rebuilt && !one.tried) {
        note(fmt::format("{}: the file that it is kept in has changed and is not whole ({}).", one.served.id,
                         error.message));
        return buildAnew(one);
    }
    // Who has opened another file, or built its own, still has what it was.
    const bool isOverwritten = !one.refused && isSameFile(identity, one.served.identity);
    std::string told =
        fmt::format("{}: {} has changed while it was served, and is no whole cloud file now: {}",
                    one.served.id, one.name(), error.message);
    if (isOverwritten && !one.served.kept) {
        // Everybody may read the catalog: it names files, not where they are.
        std::string reason = error.message;
        const std::string where = one.served.file->path().string();
        if (const auto at = reason.find(where); at != std::string::npos)
            reason.replace(at, where.size(), one.name());
        if (!catalog_.replace(one.served.id, one.cloud.lock(),
                              fail(error.code, "its file was changed while it was served: " + reason)))
            return;
        one.refused = true;
        one.before = one.served.file;
        one.served.file.reset();
        one.described.reset();
        told += "; it is not served any more until a whole file takes that name";
    } else if (!one.refused) {
        told += "; what was opened before is served on";
    }
    if (options_.onRefused) options_.onRefused({error.code, told + ".", {}});
    if (one.refused && options_.onChanged) options_.onChanged();
}

void CloudWatch::serveAgain(Watched& one, const FileIdentity& identity,
                            std::shared_ptr<const CloudFile> file) {
    const bool sameBlocks = !one.refused && !one.hasDamage && isSameFile(identity, one.served.identity) &&
                            haveSameBlocks(*one.served.file, *file);
    if (sameBlocks && haveSameFacts(*one.described, *file)) {
        one.served.identity = identity;
        return;
    }
    std::shared_ptr<const Cloud> cloud;
    if (const auto now = one.cloud.lock(); sameBlocks && now) {
        auto changed = std::make_shared<Cloud>();
        static_cast<CloudFacts&>(*changed) = file->facts();
        changed->octree = now->octree;
        cloud = withLook(std::move(changed));
    } else {
        auto opened = openCloud(file, options_.cache);
        if (!opened) return notWhole(one, identity, opened.error());
        cloud = withLook(std::move(*opened));
    }
    if (!showInstead(one, cloud)) return;
    if (!sameBlocks) {
        one.before = one.served.file;
        one.served.file = file;
        one.hasDamage = false;
    }
    one.served.identity = identity;
    one.described = std::move(file);
    note(fmt::format("{}: {} {} from now on: {} in {}.", one.served.id, one.name(),
                     sameBlocks ? "has another description, which is shown"
                                : "has been replaced, and the new one is served",
                     counted(cloud->points, "point"), counted(cloud->octree.nodes().size(), "node")));
    if (options_.onChanged) options_.onChanged();
}

bool CloudWatch::showInstead(Watched& one, std::shared_ptr<const Cloud> cloud) {
    const std::shared_ptr<const Cloud> now = one.refused ? nullptr : one.cloud.lock();
    one.isOver = !catalog_.replace(one.served.id, now, cloud);
    if (one.isOver) return false;
    one.cloud = cloud;
    one.refused = false;
    one.told = one.pending = {};
    return true;
}

void CloudWatch::damaged(Watched& one, const Error& error) {
    const bool ofTheFile = error.code == ErrorCode::Malformed || error.code == ErrorCode::Truncated;
    if (ofTheFile || error.code == ErrorCode::Io) {
        one.hasDamage = true;
        const std::shared_ptr<const CloudFile> file = one.served.file;
        lookAt(one);
        // Then it is no damage: the file has changed, or is about to.
        if (one.isOver || one.served.file != file) return;
        if (one.pending != FileIdentity{} && one.pending != one.told) return;
    }
    if (options_.onDamaged) options_.onDamaged(*one.served.file, error);
    if (ofTheFile && one.served.kept) buildAnew(one);
}

void CloudWatch::buildAnew(Watched& one) {
    if (std::exchange(one.tried, true)) return;
    const std::string title = one.served.place.name.filename().string();
    if (one.served.rebuilt)
        return note(
            fmt::format("{}: the file that {} is kept in was built anew already and is damaged again; look "
                        "after the disk under --cache-dir. It is not built a second time.",
                        one.served.id, title));
    one.building = options_.rebuild && options_.rebuild(one.served, one.cloud.lock());
    note(one.building ? fmt::format("{}: {} is built anew, because the file that it is kept in is damaged.",
                                    one.served.id, title)
                      : fmt::format("{}: {} is kept in a damaged file, and cannot be built anew now.",
                                    one.served.id, title));
}

void CloudWatch::note(const std::string& text) const {
    if (options_.onNote) options_.onNote(text);
}

}  // namespace scancast
