#include "server/stream/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/view/view_json.hpp"
#include "renderer/plan.hpp"
#include "renderer/together/together.hpp"

namespace scancast {
namespace {

View ofSize(int width, int height) {
    View view;
    view.width = width;
    view.height = height;
    return view;
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> StreamWorld::viewed(std::string_view id, const View&) const {
    auto own = cloud(id);
    if (own) return std::move(*own);
    const bool isNone = own.error().status == 404;
    return fail(isNone ? ErrorCode::NotFound : ErrorCode::Unavailable, own.error().detail, "cloud");
}

Problem SceneResolver::followProblem(int status, std::string detail) {
    Problem problem = problemOf(status, std::move(detail));
    problem.errors.push_back({"follow", problem.detail});
    return problem;
}

tl::expected<Scene, Problem> SceneResolver::opened(const messages::Hello& hello) const {
    const View usual;
    const int width = hello.width.value_or(usual.width);
    const int height = hello.height.value_or(usual.height);
    if (!hello.follow.empty()) return followed(leader(hello.follow), width, height);
    View first = ofSize(width, height);
    if (hello.view.is_object()) {  // the camera that is left open is one for all that is shown
        nlohmann::json clouds = nlohmann::json::object();
        for (const char* word : {"with", "color"})
            if (const auto at = hello.view.find(word); at != hello.view.end()) clouds[word] = *at;
        auto with = applyJson(first, clouds);
        if (!with) return tl::unexpected(problemOf(with.error()));
        first = std::move(*with);
    }
    auto scene = ofCloud(hello.cloud.empty() ? world_.defaultCloud() : hello.cloud, first);
    if (!scene || hello.view.is_null()) return scene;
    return changed(*scene, {.seq = hello.seq, .cloud = std::nullopt, .changes = hello.view});
}

tl::expected<Scene, Problem> SceneResolver::ofCloud(const std::string& cloudId, const View& first) const {
    if (auto own = world_.cloud(cloudId); !own) return passOn(std::move(own));
    auto cloud = world_.viewed(cloudId, first);
    if (!cloud) return tl::unexpected(problemOf(cloud.error()));
    Scene scene;
    scene.cloudId = cloudId;
    scene.view = defaultView(**cloud, first.width, first.height);
    if (!first.with.empty()) {
        scene.view.with = first.with;
        scene.view.style.color = first.style.color;
    }
    scene.cloud = std::move(*cloud);
    if (auto sound = plan(scene); !sound) return tl::unexpected(problemOf(sound.error()));
    return scene;
}

tl::expected<SharedView, Problem> SceneResolver::leader(const std::string& id) const {
    if (registration_ == nullptr)
        return tl::unexpected(followProblem(422, "This session can follow nobody."));
    return registration_->mayFollow(id);
}

tl::expected<Scene, Problem> SceneResolver::followed(const tl::expected<SharedView, Problem>& shared,
                                                     int width, int height) const {
    if (!shared) return passOn(shared);
    auto scene = ofCloud(shared->cloudId, ofSize(width, height));
    if (!scene) return scene;
    scene->view = shared->view;
    scene->view.width = width;
    scene->view.height = height;
    scene->view.with = known(shared->view.with);
    if (auto sound = lookAnew(*scene); !sound) return tl::unexpected(problemOf(sound.error()));
    return scene;
}

tl::expected<Scene, Problem> SceneResolver::changed(const Scene& now,
                                                    const messages::ViewChange& change) const {
    Scene scene = now;
    const bool follows =
        change.follow ? !change.follow->empty() : registration_ != nullptr && registration_->following();
    if (follows) {
        bool own = !change.cloud;
        for (const auto& [field, value] : change.changes.items())
            own = own && (field == "width" || field == "height");
        if (!own)
            return tl::unexpected(
                followProblem(409,
                              "While it follows another session, only width and height are this "
                              "one's own; \"follow\": null ends that."));
    }
    if (follows && change.follow) {
        auto theirs = followed(leader(*change.follow), now.view.width, now.view.height);
        if (!theirs) return theirs;
        scene = std::move(*theirs);
    }
    if (change.cloud && *change.cloud != now.cloudId) {
        auto other = ofCloud(*change.cloud, ofSize(now.view.width, now.view.height));
        if (!other) return passOn(std::move(other));
        scene = std::move(*other);
    }
    auto view = applyJson(scene.view, change.changes);
    if (!view) return tl::unexpected(problemOf(view.error()));
    scene.view = std::move(*view);
    scene.seq = change.seq;
    const auto isByCloud = [](const View& of) { return of.style.color == ColorSource::Cloud; };
    const bool isSame = scene.cloudId == now.cloudId && scene.view.with == now.view.with &&
                        isByCloud(scene.view) == isByCloud(now.view) && isCurrent(scene);
    const bool several = !isSame && (!scene.view.with.empty() || scene.cloud->together);
    if (auto sound = several ? lookAnew(scene) : plan(scene); !sound)
        return tl::unexpected(problemOf(sound.error()));
    return scene;
}

Expected<void> SceneResolver::lookAnew(Scene& scene) const {
    auto cloud = world_.viewed(scene.cloudId, scene.view);
    if (!cloud) return passOn(std::move(cloud));
    if (*cloud != scene.cloud) scene.planned.reset();
    scene.cloud = std::move(*cloud);
    return plan(scene);
}

bool SceneResolver::isCurrent(const Scene& scene) const {
    const auto has = [&](std::string_view id, const std::shared_ptr<const Cloud>& cloud) {
        const auto there = world_.cloud(id);
        return there && *there == cloud;
    };
    if (!scene.cloud->together) return has(scene.cloudId, scene.cloud);
    return std::ranges::all_of(scene.cloud->together->members,
                               [&](const TogetherMember& member) { return has(member.name, member.cloud); });
}

ViewedClouds SceneResolver::known(const ViewedClouds& clouds) const {
    ViewedClouds known = clouds;
    std::erase_if(known, [&](const ViewedCloud& one) {
        if (one.cloud == ownCloudName) return false;
        const auto cloud = world_.cloud(one.cloud);
        return !cloud && cloud.error().status == 404;
    });
    return known;
}

bool SceneResolver::loading(const Scene& scene) const {
    return world_.loading(scene.cloudId) || std::ranges::any_of(scene.view.with, [&](const ViewedCloud& one) {
               return world_.loading(one.cloud);
           });
}

bool SceneResolver::live(const Scene& scene) const {
    return world_.live(scene.cloudId) || std::ranges::any_of(scene.view.with, [&](const ViewedCloud& one) {
               return world_.live(one.cloud);
           });
}

Expected<void> SceneResolver::plan(Scene& scene) const {
    const auto pixels = std::uint64_t(scene.view.width) * std::uint64_t(scene.view.height);
    if (pixels > maxPixels_) {
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("A picture of {} x {} has {} pixels; this server draws at most {}.",
                                scene.view.width, scene.view.height, pixels, maxPixels_),
                    "width");
    }
    auto planned = world_.plan(*scene.cloud, scene.view);
    if (!planned) return passOn(std::move(planned));
    scene.planned = std::move(*planned);
    return scene.planned ? world_.mayBeDrawn(*scene.cloud, *scene.planned) : Expected<void>();
}

}  // namespace scancast
