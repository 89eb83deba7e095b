#include "tests/ground_truth/ray_caster.hpp"

#include <new>

#include "simulator/lighting.hpp"

namespace scancast {
namespace {

constexpr std::uint32_t none = 0xffffffff;
/// Cells only say which occluders may shade a place; this many points make them small enough to be quick.
constexpr std::uint64_t cellPoints = 1'000'000;
constexpr int reliefSteps = 6;
constexpr double reliefAgrees = 5e-4;  ///< metres

}  // namespace

struct RayCaster::Scene {
    Model model;
    glm::dvec3 origin;
    CellTable cells;
    std::vector<std::uint32_t> firstSlot;  ///< one a patch, into cellAt
    std::vector<std::uint32_t> cellAt;     ///< the cell of each column and row of each patch, or none
    std::vector<std::uint32_t> patchOf;  ///< what the tree's items are: all patches but those seen in mirrors
    BoxTree tree;

    Scene(Model of, glm::dvec3 at) : model(std::move(of)), origin(at) {
        cells = CellTable::build(model, cellPoints);
        std::uint32_t slots = 0;
        for (std::uint32_t patch = 0; patch < model.patches.size(); ++patch) {
            firstSlot.push_back(slots);
            slots += cells.columns(patch) * cells.rows(patch);
        }
        cellAt.assign(slots, none);
        for (std::uint32_t i = 0; i < cells.size(); ++i) {
            const Cell& cell = cells.cell(i);
            cellAt[firstSlot[cell.patch] + cell.row * cells.columns(cell.patch) + cell.column] = i;
        }
        std::vector<BoxTree::Box> boxes;
        for (std::uint32_t i = 0; i < model.patches.size(); ++i) {
            const Patch& patch = model.patches[i];
            if (patch.mirror >= 0) continue;
            const auto [low, high] = patch.bounds();
            const double margin = patch.material->relief() + 1e-7;
            boxes.push_back({low - margin, high + margin});
            patchOf.push_back(i);
        }
        tree = BoxTree::build(boxes);
    }

    struct Meeting {
        PatchHit hit;
        std::uint32_t patch = none;
        bool applied = false;  ///< the material has been asked already
    };

    std::optional<PatchHit> meetRelief(const Patch& patch, const Ray& ray, double low, double high,
                                       std::uint64_t sample) const;
    std::optional<Meeting> meet(const Ray& ray, double low, double high, std::uint64_t sample) const;
    const Cell* cellOf(std::uint32_t patch, double a, double b) const;
    RayHit look(Meeting meeting, std::uint64_t sample) const;
    std::optional<RayHit> reflection(const Ray& ray, double low, double high, std::uint64_t sample) const;
};

/// Finds the height at which the ray meets the relief by moving the patch to where it was met the last time.
/// Where that swings between two levels, at a step of the relief, the deeper one is taken: a reveal that is a
/// patch of its own then lies before it.
std::optional<PatchHit> RayCaster::Scene::meetRelief(const Patch& patch, const Ray& ray, double low,
                                                     double high, std::uint64_t sample) const {
    const double relief = patch.material->relief();
    double height = 0;
    std::optional<PatchHit> deepest;
    for (int step = 0; step < reliefSteps; ++step) {
        auto hit = intersect(patch, ray, low, high, height);
        if (!hit && step == 0) hit = intersect(patch, ray, low, high, height = relief);
        if (!hit) break;
        PointRandom random(0x5eed, sample);
        const glm::dvec3 base = hit->point.position - glm::dvec3(hit->point.normal) * height;
        const glm::dvec3 normal(hit->point.normal);
        hit->point.position = base;
        hit->point.random = &random;
        patch.material->apply(patch, hit->point);
        hit->point.random = nullptr;
        const double found = glm::dot(hit->point.position - base, normal);
        const bool agrees = std::abs(found - height) < reliefAgrees;
        if (agrees || !deepest || hit->t > deepest->t) {
            hit->point.position = ray.at(hit->t);
            deepest = hit;
        }
        if (agrees) break;
        height = found;
    }
    return deepest;
}

std::optional<RayCaster::Scene::Meeting> RayCaster::Scene::meet(const Ray& ray, double low, double high,
                                                                std::uint64_t sample) const {
    Meeting best;
    tree.walk(ray, low, high, [&](std::uint32_t item, double nearest) {
        const Patch& patch = model.patches[patchOf[item]];
        const bool relief = patch.material->relief() > 0;
        const auto hit =
            relief ? meetRelief(patch, ray, low, nearest, sample) : intersect(patch, ray, low, nearest);
        if (!hit) return nearest;
        best = {*hit, patchOf[item], relief};
        return hit->t;
    });
    return best.patch == none ? std::nullopt : std::optional(best);
}

const Cell* RayCaster::Scene::cellOf(std::uint32_t patch, double a, double b) const {
    const std::uint32_t columns = cells.columns(patch), rows = cells.rows(patch);
    const std::uint32_t column = std::min(columns - 1, std::uint32_t(a * columns)),
                        row = std::min(rows - 1, std::uint32_t(b * rows));
    const std::uint32_t index = cellAt[firstSlot[patch] + row * columns + column];
    return index == none ? nullptr : &cells.cell(index);
}

RayHit RayCaster::Scene::look(Meeting meeting, std::uint64_t sample) const {
    const Patch& patch = model.patches[meeting.patch];
    PointRandom random(0x5eed, sample);
    SurfacePoint& point = meeting.hit.point;
    point.random = &random;
    if (!meeting.applied) patch.material->apply(patch, point);
    RayHit hit;
    hit.t = meeting.hit.t;
    hit.position = point.position + origin;
    hit.normal = point.normal;
    hit.color = glm::clamp(
        lit(model, cells, cellOf(meeting.patch, meeting.hit.a, meeting.hit.b), patch, point), 0.0F, 1.0F);
    hit.classification = point.classification;
    hit.patch = meeting.patch;
    return hit;
}

/// What the nearest glass before `high` shows: the scene, seen along the ray thrown back by it.
std::optional<RayHit> RayCaster::Scene::reflection(const Ray& ray, double low, double high,
                                                   std::uint64_t sample) const {
    const Mirror* nearest = nullptr;
    double at = high;
    for (const Mirror& mirror : model.mirrors) {
        const double slope = glm::dot(ray.direction, mirror.normal);
        if (slope >= 0) continue;
        const double t = glm::dot(mirror.center - ray.origin, mirror.normal) / slope;
        const glm::dvec3 on = ray.at(t) - mirror.center, right = glm::cross(mirror.up, mirror.normal);
        if (t > low && t < at && std::abs(glm::dot(on, right)) < mirror.width / 2 &&
            std::abs(glm::dot(on, mirror.up)) < mirror.height / 2) {
            nearest = &mirror;
            at = t;
        }
    }
    if (!nearest) return std::nullopt;
    const glm::dvec3 back = ray.direction - nearest->normal * (2 * glm::dot(ray.direction, nearest->normal));
    // The same t counts on: the reflected ray is at the glass when the ray is.
    const Ray thrown{reflected(*nearest, ray.origin), back};
    const auto meeting = meet(thrown, at * (1 + 1e-9), std::numeric_limits<double>::infinity(), sample);
    RayHit hit;
    hit.t = std::numeric_limits<double>::infinity();
    if (meeting) hit = look(*meeting, sample);
    hit.position = ray.at(hit.t) + origin;
    hit.normal -= glm::vec3(nearest->normal) * (2 * glm::dot(hit.normal, glm::vec3(nearest->normal)));
    for (int c = 0; c < 3; ++c) hit.color[c] *= float(nearest->tint[std::size_t(c)]) / 255;
    hit.reflected = true;
    return hit;
}

Expected<RayCaster> RayCaster::create(const SceneOptions& options) {
    try {
        auto model = makeScene(options.scene);
        if (!model) return fail(ErrorCode::NotFound, "There is no scene '" + options.scene + "'.", "scene");
        const glm::dvec3 origin = options.origin.value_or(model->defaultOrigin);
        return RayCaster(std::move(*model), origin);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "There is not enough memory for the scene.");
    }
}

RayCaster::RayCaster(Model model, glm::dvec3 origin)
    : scene_(std::make_unique<const Scene>(std::move(model), origin)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

const Model& RayCaster::model() const {
    return scene_->model;
}
const glm::dvec3& RayCaster::origin() const {
    return scene_->origin;
}

std::optional<RayHit> RayCaster::cast(const Ray& ray, double low, double high, std::uint64_t sample,
                                      Glass glass) const {
    const Ray local{ray.origin - scene_->origin, ray.direction};
    const auto meeting = scene_->meet(local, low, high, sample);
    if (glass == Glass::Reflects && !scene_->model.mirrors.empty()) {
        auto seen = scene_->reflection(local, low, meeting ? meeting->hit.t : high, sample);
        if (seen) return std::isfinite(seen->t) && seen->t < high ? seen : std::nullopt;
    }
    return meeting ? std::optional(scene_->look(*meeting, sample)) : std::nullopt;
}

bool RayCaster::sees(const glm::dvec3& eye, const glm::dvec3& point, double slack) const {
    const glm::dvec3 way = point - eye;
    const double reach = 1 - slack / glm::length(way);
    return reach <= 0 || !scene_->meet({eye - scene_->origin, way}, 0, reach, 0);
}

}  // namespace scancast
