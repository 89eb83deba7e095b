// The clouds being served: a name for each, and how far its loading is.
//
// Owned by the server. *Thread safety*: every function may be called from any thread; what is returned is a
// copy, and the clouds themselves are immutable and shared.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/problem.hpp"
#include "server/catalog/together/together_clouds.hpp"

namespace scancast {

struct Cloud;

enum class CloudState : std::uint8_t { Loading, Ready, Failed };
std::string_view name(CloudState state);

/// What is known of the source of a cloud that changes.
struct LiveStatus {
    enum class State : std::uint8_t {
        Running,
        Ended,   ///< nothing more comes
        Broken,  ///< what came could not be understood: nothing more is read of it
    };
    State state = State::Running;
    std::uint64_t shown = 0;    ///< frames that became clouds
    std::uint64_t skipped = 0;  ///< not built, because a newer one had come
    std::uint64_t failed = 0;   ///< that could not be read or built
    std::string error{};        ///< of the last one that failed, until another one is shown
};
std::string_view name(LiveStatus::State state);

struct CatalogEntry {
    std::string id;       ///< the name in URLs
    std::string title;    ///< for people
    bool titled = false;  ///< it was chosen for this entry: the cloud's own does not replace it
    CloudState state = CloudState::Loading;
    std::string stage;               ///< while loading: "reading", "sorting" …
    std::optional<double> progress;  ///< while loading: 0–1 of the stage, where that is known
    /// Set when Ready; while Loading, once there is a coarse one to look at.
    std::shared_ptr<const Cloud> cloud;
    std::string error;                 ///< when Failed: why, for people
    std::optional<LiveStatus> live{};  ///< of a cloud that changes: Loading until its first frame, then Ready
};

/// Turns any name into an id: letters, digits, '.', '_' and '-' stay, runs of anything else become one '-'.
/// Never empty, never starting with a dot, at most 64 characters.
std::string cloudIdFor(std::string_view stem);

/// The answer to who asks for a cloud that is not there.
Problem noSuchCloud(std::string_view id);

class Catalog {
  public:
    /// A new entry, Loading. Its id is cloudIdFor(title), with "-2", "-3" … behind it where that is taken.
    std::string add(std::string_view title);
    /// The same under this id; false, and nothing is added, where it is taken.
    bool addAs(std::string_view id, std::string_view title);
    /// As add(), for a cloud that changes.
    std::string addLive(std::string_view title);
    void setTitle(std::string_view id, std::string_view title);
    /// Forgets the entry; who looks at its cloud goes on looking. False when there is none of that id.
    bool remove(std::string_view id);
    /// The stage of what cannot be reached now, and is opened when it can be: nobody else waits for that.
    static constexpr std::string_view waitingStage = "waiting";
    void setProgress(std::string_view id, std::string_view stage, std::uint64_t done, std::uint64_t total);
    /// A coarse cloud to look at while the entry is Loading; ignored afterwards.
    void setPreview(std::string_view id, std::shared_ptr<const Cloud> cloud);
    void setReady(std::string_view id, std::shared_ptr<const Cloud> cloud);
    void setFailed(std::string_view id, std::string reason);
    /// What has Failed is Loading again; false, and nothing has changed, where it has not.
    bool tryAgain(std::string_view id);
    /// How its source is doing, and the newest cloud; without one, that of before stays.
    void setLive(std::string_view id, LiveStatus status, std::shared_ptr<const Cloud> cloud = nullptr);

    /// Another cloud - or a reason why there is none, after which it has Failed - where the entry still shows
    /// `now` (empty: it has Failed). False, and nothing has changed, where it does not.
    bool replace(std::string_view id, const std::shared_ptr<const Cloud>& now,
                 Expected<std::shared_ptr<const Cloud>> then);

    std::size_t size() const;
    /// In the order in which they were added.
    std::vector<CatalogEntry> list() const;
    std::optional<CatalogEntry> find(std::string_view id) const;
    /// The cloud, if it is Ready or can be looked at coarsely. 404 when there is none of that name or it
    /// cannot be shown, 503 while there is nothing to look at yet.
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const;
    /// Whether it is there and changes by itself.
    bool isLive(std::string_view id) const;
    /// Several of its clouds as one, to be drawn in one picture; kept for who asks again. Errors: putTogether()'s.
    Expected<std::shared_ptr<const Cloud>> together(std::vector<TogetherMember> members, bool byCloud) const;
    /// Where these keep what they need beside their clouds.
    void setCache(std::shared_ptr<BlockCache> cache) { together_.setCache(std::move(cache)); }
    /// The first cloud that is Ready, else the first that can be looked at, else the first one at all; empty
    /// when there is none.
    std::string defaultId() const;
    /// The first clouds are there: nothing was Loading and at least one cloud was Ready, once. What comes and
    /// goes later changes nothing.
    bool settled() const;
    std::uint64_t pointsResident() const;

  private:
    void addLocked(std::string id, std::string_view title);
    void settleLocked();
    CatalogEntry* findLocked(std::string_view id);
    const CatalogEntry* findLocked(std::string_view id) const;
    /// What of clouds that are not shown any more is kept.
    bool showsNow(const Cloud* cloud) const;

    mutable std::mutex mutex_;
    std::vector<CatalogEntry> entries_;  // a handful; searched in line
    bool settled_ = false;
    mutable TogetherClouds together_;
};

}  // namespace scancast
