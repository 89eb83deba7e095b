#include "tests/support/pictures/reference_surfels.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>

#include "renderer/cloud/surfel_codec.hpp"

namespace scancast::test {
namespace {

/// A surfel in view space: x right, y up, z towards the viewer.
struct Seen {
    glm::dvec3 center, normal, major, minor;  ///< unit vectors
    glm::dvec3 seen;                          ///< the normal turned to the eye
    double radius = 0, a = 0, b = 0;          ///< as drawn, cloud units
    double depth = 0, q = 0;
    double reach = 0;  ///< Ellipse: px behind it that are of its surface
    bool hasNormal = false;
    std::uint64_t ordinal = 0;
    Rgb8 color{};
};

struct Fragment {
    double depth = 0;
    double place = 0;  ///< Disc: distance from the centre, radii; Ellipse: xᵀV⁻¹x / 6
    glm::dvec2 way{};  ///< Disc: px to its centre, right and up
    glm::dvec3 ray{};  ///< through the pixel's centre, one unit deep
};

class SurfelRenderer {
  public:
    explicit SurfelRenderer(const Drawing& drawing)
        : drawing_(drawing), view_(drawing.mainView().viewpoint) {}

    ReferenceSurfels run() {
        picture_.width = view_.width;
        picture_.height = view_.height;
        picture_.pixels.resize(static_cast<std::size_t>(view_.width) * view_.height);
        for (const CutRun& run : drawing_.mainView().cut.runs) {
            for (const Sample& s : run.samples) picture_.colors.push_back({s.r, s.g, s.b});
        }
        for (const Pass& pass : drawing_.passes) {
            if (const auto* p = std::get_if<SilhouettePass>(&pass)) silhouette(*p);
            if (const auto* p = std::get_if<NearestPass>(&pass)) nearest(*p);
            if (const auto* p = std::get_if<SumPass>(&pass)) sum(*p);
            if (const auto* p = std::get_if<CellPass>(&pass)) cells(*p);
        }
        return std::move(picture_);
    }

  private:
    using Body = std::function<void(const Seen&, const Fragment&, ReferencePixel&)>;

    bool perspective() const { return view_.projection == Projection::Perspective; }
    double middleX() const { return view_.width / 2.0 + drawing_.jitter[0].x; }
    double middleY() const { return view_.height / 2.0 + drawing_.jitter[0].y; }
    glm::dvec2 project(const glm::dvec3& p) const {
        const double q = view_.q(-p.z);
        return {middleX() + q * p.x, middleY() - q * p.y};
    }

    std::optional<Seen> see(const CutRun& run, std::size_t i, const Splat& splat) const {
        const Sample& sample = run.samples[i];
        const Surfel surfel = decodeSurfel(sample, run.node->radiusUnit);
        if (surfel.outlier) return std::nullopt;
        const glm::dmat3 turn(view_.cloudToView);
        Seen s;
        s.center = glm::dvec3(view_.cloudToView * glm::dvec4(position(*run.node, sample), 1));
        s.depth = -s.center.z;
        if (!(s.depth >= view_.near && s.depth <= view_.far)) return std::nullopt;
        s.q = view_.q(s.depth);
        s.hasNormal = sample.normal != noNormal;
        s.normal = s.hasNormal ? turn * glm::normalize(glm::dvec3(surfel.normal)) : glm::dvec3(0, 0, 1);
        s.major = s.hasNormal ? turn * glm::normalize(glm::dvec3(surfel.majorAxis)) : glm::dvec3(1, 0, 0);
        s.minor = glm::cross(s.normal, s.major);
        const bool known = sample.logRadius != noRadius;
        s.radius = (known ? surfel.radius : run.node->spacing) * splat.size.scale;
        s.a = (known ? surfel.major : run.node->spacing) * splat.size.scale;
        double most = splat.size.maxPx / 2 / s.q;
        if (perspective()) most = std::min(most, s.depth / 2);
        s.radius = std::min(s.radius, most);
        s.a = std::min(s.a, most);
        s.b = splat.round ? s.a : s.a * surfel.minor / surfel.major;
        s.ordinal = run.firstOrdinal + i;
        s.color = {sample.r, sample.g, sample.b};
        const glm::dvec3 towardsEye = perspective() ? -s.center : glm::dvec3(0, 0, 1);
        const bool front = !s.hasNormal || !drawing_.oriented || glm::dot(s.normal, towardsEye) >= 0;
        if (splat.facing == Facing::Front && !front) return std::nullopt;
        if (splat.facing == Facing::Back && front) return std::nullopt;
        s.seen = glm::dot(s.normal, towardsEye) < 0 ? -s.normal : s.normal;
        if (!drawing_.oriented) s.normal = s.seen;
        return s;
    }

    /// Where the ray through a pixel's centre meets the surfel's plane: its depth; infinite where it does
    /// not.
    double depthOfPlane(const Seen& s, int x, int y, glm::dvec3& place) const {
        const glm::dvec2 across{(x + 0.5 - middleX()) / view_.pixelsPerUnit,
                                (middleY() - y - 0.5) / view_.pixelsPerUnit};
        const glm::dvec3 origin = perspective() ? glm::dvec3(0) : glm::dvec3(across, 0);
        const glm::dvec3 direction = perspective() ? glm::dvec3(across, -1) : glm::dvec3(0, 0, -1);
        const double t = glm::dot(s.normal, s.center - origin) / glm::dot(s.normal, direction);
        if (!std::isfinite(t) || (perspective() && t <= 0)) return ReferencePixel::none;
        place = origin + t * direction;
        return t;
    }

    void drawDisc(const Seen& s, double radius, const Body& body) {
        const glm::dvec2 center = project(s.center);
        overPixels(center, 3 * radius * s.q + 2, [&](int x, int y, ReferencePixel& pixel) {
            Fragment f;
            glm::dvec3 place;
            f.way = {center.x - x - 0.5, y + 0.5 - center.y};
            if (perspective())
                f.ray = {(x + 0.5 - middleX()) / view_.pixelsPerUnit,
                         (middleY() - y - 0.5) / view_.pixelsPerUnit, 0};
            f.ray.z = -1;
            f.depth = depthOfPlane(s, x, y, place);
            f.place = std::isfinite(f.depth) ? glm::distance(place, s.center) / radius : 2;
            if (x == std::floor(center.x) && y == std::floor(center.y)) {
                f.depth = s.depth;
                f.place = std::min(f.place, 1.0);
            }
            if (f.place <= 1 && f.depth >= view_.near) body(s, f, pixel);
        });
    }

    /// d(pixel) / d(step along a tangent), by differences.
    glm::dvec2 slope(const Seen& s, const glm::dvec3& tangent) const {
        const double h = 1e-5 * s.depth;
        return (project(s.center + h * tangent) - project(s.center - h * tangent)) / (2 * h);
    }

    void drawEllipse(Seen s, double lowPass, const std::function<void(double)>& start, const Body& body) {
        const glm::dvec2 ja = s.a * slope(s, s.major), jb = s.b * slope(s, s.minor);
        const auto moment = [&](int i, int j) { return (ja[i] * ja[j] + jb[i] * jb[j]) / 6; };
        const double xx = moment(0, 0) + lowPass * lowPass, yy = moment(1, 1) + lowPass * lowPass;
        const double xy = moment(0, 1), det = xx * yy - xy * xy;
        const double before = moment(0, 0) * moment(1, 1) - xy * xy;
        const double steep = std::min(std::hypot(s.normal.x, s.normal.y) / std::abs(s.normal.z), 8.0);
        const double dz = std::hypot(s.a * s.major.z, s.b * s.minor.z);
        s.reach = 2 * (s.a * s.q + std::hypot(dz * s.q, std::sqrt(6) * lowPass * steep));
        start(std::sqrt(std::max(0.0, before) / det));
        const glm::dvec2 center = project(s.center);
        overPixels(center, std::sqrt(6 * std::max(xx, yy)) + 2, [&](int x, int y, ReferencePixel& pixel) {
            const double dx = x + 0.5 - center.x, dy = y + 0.5 - center.y;
            Fragment f;
            f.place = (dx * dx * yy - 2 * dx * dy * xy + dy * dy * xx) / det / 6;
            glm::dvec3 place;
            f.depth = std::clamp(depthOfPlane(s, x, y, place), s.depth, s.depth + dz);
            if (x == std::floor(center.x) && y == std::floor(center.y)) {
                f.depth = s.depth;
                f.place = std::min(f.place, 1.0);
            }
            if (f.place <= 1 && f.depth >= view_.near) body(s, f, pixel);
        });
    }

    template <class Visit>
    void overPixels(const glm::dvec2& center, double reach, const Visit& visit) {
        const int x0 = std::max(0, int(std::floor(center.x - reach)));
        const int x1 = std::min(view_.width - 1, int(center.x + reach));
        const int y0 = std::max(0, int(std::floor(center.y - reach)));
        const int y1 = std::min(view_.height - 1, int(center.y + reach));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x)
                visit(x, y, picture_.pixels[static_cast<std::size_t>(y) * view_.width + x]);
        }
    }

    template <class Visit>
    void overSurfels(const Splat& splat, const Visit& visit) {
        for (const CutRun& run : drawing_.mainView().cut.runs) {
            for (std::size_t i = 0; i < run.samples.size(); ++i) {
                if (const auto seen = see(run, i, splat)) visit(*seen);
            }
        }
    }

    void silhouette(const Splat& splat) {
        if (!drawing_.oriented) return;
        overSurfels(splat, [&](const Seen& seen) {
            drawDisc(seen, seen.radius, [](const Seen&, const Fragment& f, ReferencePixel& p) {
                p.border = std::min(p.border, f.depth);
            });
        });
    }

    static glm::dvec3 inSteps(const glm::dvec3& normal) { return glm::round(normal * 127.0) / 127.0; }

    /// In steps of an eighth, at least 1/256.
    static double eighths(double px) {
        const double known = std::max(px, 1.0 / 256);
        const double step = std::exp2(std::floor(std::log2(known)) - 3);
        return std::floor(known / step) * step;
    }

    template <bool disc>
    static void keepNearest(const Seen& s, const Fragment& f, ReferencePixel& p) {
        if (f.depth >= p.depth || f.depth > p.border) return;
        p.depth = f.depth;
        p.nearest = s.ordinal;
        p.facing = inSteps(disc ? s.seen : s.normal);
        p.center = glm::round(glm::clamp(f.way * 7.0 / (s.radius * s.q), -7.0, 7.0)) / 7.0;
        p.reach = eighths(s.reach);
    }

    void nearest(const Splat& splat) {
        overSurfels(splat, [&](const Seen& seen) {
            if (splat.footprint == Footprint::Disc) return drawDisc(seen, seen.radius, keepNearest<true>);
            drawEllipse(
                seen, splat.lowPassPx, [](double) {}, keepNearest<false>);
        });
    }

    double cosineTo(const glm::dvec3& normal, const glm::dvec3& facing) const {
        const double cosine = glm::dot(facing, inSteps(normal));
        return drawing_.oriented ? cosine : std::abs(cosine);
    }

    /// Whether a fragment lies near a depth, measured across its own surface, or, of a sheet, along the ray.
    bool nearDepth(const Seen& s, const Fragment& f, double depth, double tolerance, bool sheet) const {
        const glm::dvec3 ray = perspective() ? s.center / s.depth : glm::dvec3(0, 0, -1);
        const double cosine = std::clamp(std::abs(glm::dot(s.normal, ray)), 0.25, 1.0);
        const double across = sheet ? 1 : 1 / cosine;
        return std::abs(f.depth - depth) <= tolerance * s.radius * across;
    }

    enum class Crease { Convex, Concave, Crossing };

    /// By which side of each other's planes the centres lie.
    Crease meet(const Seen& s, const Fragment& f, const ReferencePixel& p) const {
        const double half = s.radius * s.q;
        const double q = perspective() ? view_.q(p.depth) : view_.pixelsPerUnit;
        const double gap = (f.depth - p.depth) * q;
        // No plane is seen more edge-on than this.
        const auto across = [&](const glm::dvec3& n) { return std::min(glm::dot(n, f.ray), -1.0 / 32); };
        const auto slide = [](const glm::dvec3& n, const glm::dvec2& way) {
            return n.x * way.x + n.y * way.y;
        };
        // Along the ray, px: from the visible place to where each centre is seen.
        const glm::dvec2 way = p.center * half;
        const double visible = -slide(p.facing, way) / across(p.facing);
        const double own = gap - slide(s.seen, f.way) / across(s.seen);
        const double above = slide(s.seen, way) + (visible - gap) * across(s.seen);
        const double itself = slide(p.facing, f.way) + own * across(p.facing);
        const double limit = half / 8;
        if (above <= limit && itself <= limit && above + itself < 0) return Crease::Convex;
        return above < -limit && itself > limit ? Crease::Crossing : Crease::Concave;
    }

    /// How far behind what is visible a fragment may lie, px, to be of its surface.
    double agreed(const Seen& s, const ReferencePixel& p) const {
        const double cosine = cosineTo(s.normal, p.facing);
        const double agreement = std::clamp((cosine + 0.25) / 0.5, 0.125, 1.0);
        const double edgeOn = std::min((0.5 - std::abs(p.facing.z)) / 0.25, 1.0);
        return std::max(std::min(p.reach, s.reach) * agreement, s.a * s.q * edgeOn);
    }

    /// Weights are whole, 1 … 4095.
    static void add(const Seen& s, double weight, ReferencePixel& p) {
        const double w = std::max(std::round(4095 * weight), 1.0);
        p.weight += w;
        p.color += w * glm::dvec3(s.color[0], s.color[1], s.color[2]);
        if (s.hasNormal) p.normal += w * s.normal;
    }

    void sum(const SumPass& pass) {
        double tolerance = 0;
        for (const Pass& other : drawing_.passes) {
            if (const auto* cell = std::get_if<CellPass>(&other)) tolerance = 1.01 * cell->tolerance;
        }
        overSurfels(pass, [&](const Seen& seen) {
            if (pass.footprint == Footprint::Disc) {
                double reach = seen.radius * pass.reach;
                if (perspective()) reach = std::min(reach, 0.9 * seen.depth);
                return drawDisc(seen, reach, [&](const Seen& s, const Fragment& f, ReferencePixel& p) {
                    if (f.depth > p.border || !nearDepth(s, f, p.depth, tolerance, false)) return;
                    if (!nearDepth(s, f, p.cellDepth, tolerance, true)) return;
                    const double share = 2 * cosineTo(s.seen, p.cellFacing) - 0.5;
                    if (share <= 0) return;
                    add(s,
                        (1 - 3 * f.place * f.place + 2 * f.place * f.place * f.place) * std::min(share, 1.0),
                        p);
                });
            }
            double peak = 0;
            drawEllipse(
                seen, pass.lowPassPx, [&](double p) { peak = p; },
                [&](const Seen& s, const Fragment& f, ReferencePixel& p) {
                    if (p.depth == ReferencePixel::none || f.depth > p.border) return;
                    const double behind = (f.depth - p.depth) * view_.q(p.depth);
                    if (behind > s.reach) return;
                    const double share = behind <= agreed(s, p) ? 1 : 1.0 / 32;
                    add(s, share * peak * std::exp(-3 * f.place), p);
                });
        });
    }

    void cells(const CellPass& pass) {
        overSurfels(pass, [&](const Seen& seen) {
            drawDisc(seen, seen.radius, [&](const Seen& s, const Fragment& f, ReferencePixel& p) {
                const bool sameSide = cosineTo(s.seen, p.facing) >= 0.5;
                if (f.depth > p.border || !nearDepth(s, f, p.depth, pass.tolerance, sameSide)) return;
                double distance = f.place * s.radius, gap = 0;
                if (!sameSide) {
                    gap = (f.depth - p.depth) * (perspective() ? view_.q(p.depth) : view_.pixelsPerUnit);
                    const Crease crease = meet(s, f, p);
                    if (crease == Crease::Concave) return;
                    if (crease == Crease::Convex) distance /= 4096;
                }
                if (distance >= p.distance) return;
                p.distance = distance;
                p.cell = s.ordinal;
                p.cellFacing = inSteps(s.seen);
                p.cellDepth = p.depth + eighths(gap) / view_.q(p.depth);
            });
        });
    }

    const Drawing& drawing_;
    const Viewpoint& view_;
    ReferenceSurfels picture_;
};

}  // namespace

ReferenceSurfels referenceSurfels(const Drawing& drawing) {
    return SurfelRenderer(drawing).run();
}

}  // namespace scancast::test
