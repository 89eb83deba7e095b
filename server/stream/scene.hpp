// What a session shows, and what it may show next: a message's changes make a whole new scene or none at all.
// Nothing here draws or sends, and nothing of the session changes.
//
// Used by a stream session; its thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/problem.hpp"
#include "server/stream/session_register.hpp"

namespace scancast {

struct Cloud;
struct PlannedView;

/// What a session may know of the server.
class StreamWorld {
  public:
    virtual ~StreamWorld() = default;
    virtual std::string defaultCloud() const = 0;
    virtual tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const = 0;
    /// What a view of the cloud shows: it alone, or several together where the view says so. The same one each time, as
    /// long as nothing changes. Errors: as the problems of cloud(), of others in the field `with`; what makes them impossible to
    /// show together.
    virtual Expected<std::shared_ptr<const Cloud>> viewed(std::string_view id, const View& view) const;
    /// Whether another cloud will take this one's place soon.
    virtual bool loading(std::string_view id) const = 0;
    /// Whether it changes by itself, again and again: each cloud that takes its place is shown at once, like a new view.
    virtual bool live(std::string_view id) const = 0;
    /// What the view means for the cloud (renderer/plan.hpp).
    virtual Expected<std::shared_ptr<const PlannedView>> plan(const Cloud& cloud, const View& view) const = 0;
    /// Whether its still costs no more than it may; ResourceLimit, with what would do.
    virtual Expected<void> mayBeDrawn(const Cloud&, const PlannedView&) const { return {}; }
    /// τ of a full picture of this view, px.
    virtual double ownDetail(const View& view) const = 0;
    virtual std::vector<std::string> methodNames() const = 0;
};

/// Everything that a `view` message may change.
struct Scene {
    std::string cloudId;
    std::shared_ptr<const Cloud> cloud;  ///< what is drawn: that one, or several together
    View view;
    std::uint64_t seq = 0;
    std::shared_ptr<const PlannedView>
        planned{};  ///< of the view; before it is checked, of another of this cloud
};

class SceneResolver {
  public:
    /// `registration`: of the session in the register; null = it can follow nobody. Both outlive the resolver.
    SceneResolver(const StreamWorld& world, const SessionRegistration* registration, std::uint64_t maxPixels)
        : world_(world), registration_(registration), maxPixels_(maxPixels) {}

    /// What a hello asks for.
    tl::expected<Scene, Problem> opened(const messages::Hello& hello) const;
    /// The scene after this change. Following a session, only width and height are one's own.
    tl::expected<Scene, Problem> changed(const Scene& now, const messages::ViewChange& change) const;
    /// What another session shows, in this one's size; of its clouds those that this session's client may see.
    tl::expected<Scene, Problem> followed(const tl::expected<SharedView, Problem>& shared, int width,
                                          int height) const;
    /// Plans it, if it can be drawn here.
    Expected<void> plan(Scene& scene) const;
    /// What it shows now, and plans that.
    Expected<void> lookAnew(Scene& scene) const;
    /// Whether each of the clouds that it shows is the one that has its name now: a look at them, without putting any together.
    bool isCurrent(const Scene& scene) const;
    /// Those of the clouds that there are, for this session's client; the view's own is always one.
    ViewedClouds known(const ViewedClouds& clouds) const;
    /// Whether one of the clouds that the scene shows is being loaded; whether one changes by itself.
    bool loading(const Scene& scene) const;
    bool live(const Scene& scene) const;

    /// A problem with the field `follow`.
    static Problem followProblem(int status, std::string detail);

  private:
    /// Its default view; `with`, and whether each has a colour of its own, as `first` says.
    tl::expected<Scene, Problem> ofCloud(const std::string& cloudId, const View& first) const;
    tl::expected<SharedView, Problem> leader(const std::string& id) const;

    const StreamWorld& world_;
    const SessionRegistration* registration_;
    const std::uint64_t maxPixels_;
};

}  // namespace scancast
