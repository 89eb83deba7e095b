#include "tests/support/pictures/pyramid_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace scancast::test {
namespace {

constexpr double nowhere = std::numeric_limits<double>::infinity();

/// View space: x right, y up, z towards the viewer.
glm::dvec3 pointAt(const PointScreen& s, double px, double py, double depth) {
    const double x = (px - s.width / 2.0) / s.pixelsPerUnit, y = (s.height / 2.0 - py) / s.pixelsPerUnit;
    return s.perspective ? glm::dvec3{x * depth, y * depth, -depth} : glm::dvec3{x, y, -depth};
}

double pixelsPerUnitAt(const PointScreen& s, double depth) {
    return s.perspective ? s.pixelsPerUnit / depth : s.pixelsPerUnit;
}

double effectiveSpacing(const PointScreen& s, double spacing, double detail, double depth) {
    return std::max(spacing, 2 * detail / pixelsPerUnitAt(s, depth));
}

struct Level {
    int width = 0, height = 0;
    std::vector<std::optional<glm::dvec3>> points;
    bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    const std::optional<glm::dvec3>& at(int x, int y) const {
        return points[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

std::vector<Level> pointPyramid(const PointScreen& s) {
    std::vector<Level> levels(1);
    levels[0].width = s.width;
    levels[0].height = s.height;
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            const float depth = s.depth[s.at(x, y)];
            levels[0].points.push_back(std::isinf(depth)
                                           ? std::nullopt
                                           : std::optional(pointAt(s, x + 0.5, y + 0.5, double(depth))));
        }
    }
    while (levels.back().width > 1 || levels.back().height > 1 || levels.size() < 5) {
        const Level& fine = levels.back();
        Level coarse;
        coarse.width = (fine.width + 1) / 2;
        coarse.height = (fine.height + 1) / 2;
        for (int y = 0; y < coarse.height; ++y) {
            for (int x = 0; x < coarse.width; ++x) {
                std::optional<glm::dvec3> nearest;
                for (int j = 2 * y; j < 2 * y + 2; ++j) {
                    for (int i = 2 * x; i < 2 * x + 2; ++i) {
                        if (!fine.has(i, j) || !fine.at(i, j)) continue;
                        if (!nearest || fine.at(i, j)->z > nearest->z) nearest = fine.at(i, j);
                    }
                }
                coarse.points.push_back(nearest);
            }
        }
        levels.push_back(std::move(coarse));
    }
    return levels;
}

/// The level up to which a pixel looks.
int reachOf(const PointScreen& s, const std::vector<Level>& levels, const HiddenPointsPass& pass, int px,
            int py) {
    int top = 0;
    for (int k = 0; k < int(levels.size()); ++k) {
        if (std::min(levels[std::size_t(k)].width, levels[std::size_t(k)].height) >= 4) top = k;
    }
    const auto levelOf = [&](double size) { return std::clamp(int(std::floor(std::log2(size))), 0, top); };
    if (pass.fixedPx > 0) return levelOf(pass.fixedPx);
    for (int k = 4; k < int(levels.size()); ++k) {
        const auto& coarse = levels[std::size_t(k)].at(px >> k, py >> k);
        if (!coarse) continue;
        const double depth = -coarse->z;
        const double size = double(pass.scale) * effectiveSpacing(s, pass.spacing, pass.detail, depth) *
                            pixelsPerUnitAt(s, depth);
        return levelOf(size);
    }
    return 0;
}

/// 0 … 7 for the eight directions, from where the texel stands in the pattern.
int sectorOf(double right, double down) {
    const int column = right < -0.9 ? 0 : right > 0.9 ? 2 : 1, row = down < -0.9 ? 0 : down > 0.9 ? 2 : 1;
    constexpr int names[3][3] = {{0, 1, 2}, {3, -1, 4}, {5, 6, 7}};
    return names[row][column];
}

/// What a pixel's neighbours make of it, sector by sector.
struct Sectors {
    std::array<double, 8> occlusion;
    std::array<std::array<bool, 8>, 32> inside{};  ///< per level: some texel of the sector exists
    Sectors() { occlusion.fill(1); }
};

void consider(const PointScreen& s, const HiddenPointsPass& pass, int px, int py,
              const std::optional<glm::dvec3>& own, const glm::dvec3& y, double& occlusion) {
    const double depth = own ? -own->z : nowhere;
    if (depth + y.z < double(pass.minGap)) return;
    const glm::dvec3 towardsEye = s.perspective ? -glm::normalize(y) : glm::dvec3{0, 0, 1};
    const glm::dvec3 ray = pointAt(s, px + 0.5, py + 0.5, 1);
    const glm::dvec3 fromX = own             ? glm::normalize(y - *own)
                             : s.perspective ? -glm::normalize(ray)
                                             : glm::dvec3{0, 0, 1};
    occlusion = std::min(occlusion, 1 - glm::dot(fromX, towardsEye));
}

double meanOcclusion(const PointScreen& s, const std::vector<Level>& levels, const HiddenPointsPass& pass,
                     int px, int py) {
    const auto& own = levels[0].at(px, py);
    const int reach = reachOf(s, levels, pass, px, py);
    Sectors sectors;
    for (int k = 0; k <= reach; ++k) {
        const Level& level = levels[std::size_t(k)];
        const double texel = std::ldexp(1.0, k);
        const int side = k == 0 ? 3 : 4;
        const int x0 = k == 0 ? px - 1 : int(std::floor((px + 0.5) / texel - 1.5));
        const int y0 = k == 0 ? py - 1 : int(std::floor((py + 0.5) / texel - 1.5));
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i) {
                const int sector = sectorOf(i - (side - 1) / 2.0, j - (side - 1) / 2.0);
                if (sector < 0 || !level.has(x0 + i, y0 + j)) continue;
                sectors.inside[std::size_t(k)][std::size_t(sector)] = true;
                const auto& y = level.at(x0 + i, y0 + j);
                if (y) consider(s, pass, px, py, own, *y, sectors.occlusion[std::size_t(sector)]);
            }
        }
    }
    double sum = 0;
    int counting = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        bool inside = true;
        // The coarsest level decides only where it is the only one.
        for (int k = 0; k < std::max(reach, 1); ++k) inside = inside && sectors.inside[std::size_t(k)][i];
        if (!inside) continue;
        sum += std::min(1.0, sectors.occlusion[i]);
        ++counting;
    }
    return counting > 0 ? sum / counting : 1;
}

/// Radius of a closing at a depth, eighths of a pixel.
int closingAt(const PointScreen& s, const HiddenPointsPass& pass, double depth) {
    if (!(pass.threshold > 0)) return 0;
    // In floats, as the page says: a fraction more or less is another pixel.
    const double unit = 8 * double(pass.closing);
    const auto scaled = float(unit * double(pass.spacing) * s.pixelsPerUnit);
    const auto least = float(unit * 2 * double(pass.detail));
    return int(std::min(std::max(s.perspective ? scaled / float(depth) : scaled, least), 16.0f * 32));
}

/// Of every block of 16 × 16: the mean over the points that are visible; where there are none, the least of the blocks
/// around that have some, or what the nearest depth says.
std::vector<int> closingSizes(const PointScreen& s, const std::vector<Level>& levels,
                              const HiddenPointsPass& pass, const std::vector<std::uint8_t>& labels) {
    const int columns = levels[4].width, rows = levels[4].height;
    std::vector<int> means(std::size_t(columns * rows), -1), out = means;
    for (int b = 0; b < columns * rows; ++b) {
        int sum = 0, count = 0;
        for (int i = 0; i < 256; ++i) {
            const int x = b % columns * 16 + i % 16, y = b / columns * 16 + i / 16;
            if (x >= s.width || y >= s.height || labels[s.at(x, y)] != 1) continue;
            sum += closingAt(s, pass, double(s.depth[s.at(x, y)]));
            ++count;
        }
        if (count > 0) means[std::size_t(b)] = sum / count;
    }
    for (int b = 0; b < columns * rows; ++b) {
        int& size = out[std::size_t(b)] = means[std::size_t(b)];
        if (size >= 0) continue;
        const int x = b % columns, y = b / columns;
        double depth = 1e300;
        for (int k = int(levels.size()) - 1; k >= 4; --k) {
            const auto& point = levels[std::size_t(k)].at(x >> (k - 4), y >> (k - 4));
            if (point) depth = -point->z;
        }
        size = closingAt(s, pass, depth);
        if (size / 8 > 32) continue;
        for (int j = std::max(0, y - 2); j <= std::min(rows - 1, y + 2); ++j)
            for (int i = std::max(0, x - 2); i <= std::min(columns - 1, x + 2); ++i)
                if (means[std::size_t(j * columns + i)] >= 0)
                    size = std::min(size, means[std::size_t(j * columns + i)]);
    }
    return out;
}

/// Between the middles of four blocks, px without fraction.
int radiusAt(const std::vector<int>& sizes, int columns, int x, int y) {
    const int rows = int(sizes.size()) / columns;
    const double u = (x + 0.5) / 16 - 0.5, v = (y + 0.5) / 16 - 0.5, left = std::floor(u),
                 top = std::floor(v);
    double sum = 0;
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const int column = std::clamp(int(left) + i, 0, columns - 1);
            const int row = std::clamp(int(top) + j, 0, rows - 1);
            sum += (i ? u - left : 1 - (u - left)) * (j ? v - top : 1 - (v - top)) *
                   sizes[std::size_t(row * columns + column)];
        }
    }
    return int(sum / 8);
}

/// Whether one of `those` lies in the disc around a pixel.
bool inDisc(const PointScreen& s, const std::vector<bool>& those, int x, int y, int radius) {
    for (int j = std::max(0, y - radius); j <= std::min(s.height - 1, y + radius); ++j)
        for (int i = std::max(0, x - radius); i <= std::min(s.width - 1, x + radius); ++i)
            if (those[s.at(i, j)] && std::hypot(i - x, j - y) < radius + 0.5) return true;
    return false;
}

/// Background that a closing of the points covers is a hole in them.
void closeBackground(const PointScreen& s, const std::vector<Level>& levels, const HiddenPointsPass& pass,
                     std::vector<std::uint8_t>& labels) {
    const std::vector<int> sizes = closingSizes(s, levels, pass, labels);
    const auto radius = [&](int x, int y) { return radiusAt(sizes, levels[4].width, x, y); };
    std::vector<bool> points(s.depth.size()), uncovered(s.depth.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = !std::isinf(s.depth[i]);
    for (int y = 0; y < s.height; ++y)
        for (int x = 0; x < s.width; ++x)
            uncovered[s.at(x, y)] = !inDisc(s, points, x, y, std::min(radius(x, y), 32));
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            if (points[s.at(x, y)] || radius(x, y) > 32) continue;
            labels[s.at(x, y)] = inDisc(s, uncovered, x, y, radius(x, y)) ? 2 : 0;
        }
    }
}

}  // namespace

ReferenceHidden referenceHidden(const PointScreen& s, const HiddenPointsPass& pass) {
    const std::vector<Level> levels = pointPyramid(s);
    ReferenceHidden out;
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            out.occlusion.push_back(meanOcclusion(s, levels, pass, x, y));
            const bool background = std::isinf(s.depth[s.at(x, y)]);
            out.labels.push_back(out.occlusion.back() < double(pass.threshold) ? 0 : background ? 2 : 1);
        }
    }
    closeBackground(s, levels, pass, out.labels);
    return out;
}

std::size_t ReferenceFilled::Level::at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(std::clamp(x, 0, width - 1));
}

namespace {

ReferenceFilled::Level pulled(const ReferenceFilled::Level& fine) {
    ReferenceFilled::Level coarse;
    coarse.width = (fine.width + 1) / 2;
    coarse.height = (fine.height + 1) / 2;
    for (int y = 0; y < coarse.height; ++y) {
        for (int x = 0; x < coarse.width; ++x) {
            std::vector<std::size_t> children;
            for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j) {
                for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i) {
                    if (std::isinf(fine.depth[fine.at(i, j)])) continue;
                    children.push_back(fine.at(i, j));
                }
            }
            double depth = 0, weight = 0;
            glm::dvec3 color{0};
            for (const std::size_t i : children) {
                depth += fine.depth[i];
                color += fine.color[i];
                weight += 1;
            }
            coarse.depth.push_back(weight > 0 ? depth / weight : nowhere);
            coarse.color.push_back(weight > 0 ? color / weight : glm::dvec3{0});
        }
    }
    return coarse;
}

void pushed(const ReferenceFilled::Level& coarse, int x, int y, double& depth, glm::dvec3& color) {
    const int cx = x / 2, cy = y / 2, nx = x % 2 ? cx + 1 : cx - 1, ny = y % 2 ? cy + 1 : cy - 1;
    const std::size_t taps[4] = {coarse.at(cx, cy), coarse.at(nx, cy), coarse.at(cx, ny), coarse.at(nx, ny)};
    const double kernel[4] = {9, 3, 3, 1};
    depth = 0;
    color = {0, 0, 0};
    for (int i = 0; i < 4; ++i) {
        depth += kernel[i] * coarse.depth[taps[i]];
        color += kernel[i] * coarse.color[taps[i]];
    }
    depth /= 16;
    color /= 16.0;
}

}  // namespace

ReferenceFilled referenceFilled(const PointScreen& s) {
    ReferenceFilled out;
    ReferenceFilled::Level picture;
    picture.width = s.width;
    picture.height = s.height;
    for (std::size_t i = 0; i < s.depth.size(); ++i) {
        picture.depth.push_back(s.labels[i] == 1 ? double(s.depth[i]) : nowhere);
        picture.color.emplace_back(s.rgba[i] & 255, s.rgba[i] >> 8 & 255, s.rgba[i] >> 16 & 255);
    }
    out.levels.push_back(std::move(picture));
    while (out.levels.back().width > 1 || out.levels.back().height > 1 || out.levels.size() < 5) {
        out.levels.push_back(pulled(out.levels.back()));
    }
    for (std::size_t k = out.levels.size() - 1; k-- > 0;) {
        ReferenceFilled::Level& fine = out.levels[k];
        for (int y = 0; y < fine.height; ++y) {
            for (int x = 0; x < fine.width; ++x) {
                const std::size_t i = fine.at(x, y);
                if (!std::isinf(fine.depth[i]) || (k == 0 && s.labels[i] == 2)) continue;
                pushed(out.levels[k + 1], x, y, fine.depth[i], fine.color[i]);
            }
        }
    }
    return out;
}

namespace {

glm::dvec3 normalAt(const PointScreen& s, const ReferenceFilled::Level& level, int k, int x, int y) {
    const double texel = std::ldexp(1.0, k);
    const double own = level.depth[level.at(x, y)];
    const double size = texel / (s.perspective ? s.pixelsPerUnit / own : s.pixelsPerUnit);
    const auto depthAt = [&](int i, int j) -> double {
        const bool outside = i < 0 || j < 0 || i >= level.width || j >= level.height;
        return outside ? INFINITY : level.depth[level.at(i, j)];
    };
    const auto at = [&](int i, int j) {
        return pointAt(s, (i + 0.5) * texel, (j + 0.5) * texel, level.depth[level.at(i, j)]);
    };
    // Across an outline - far steeper than the other side - there is no slope to take.
    const auto point = [&](int i, int j) {
        if (std::isinf(depthAt(i, j))) return at(x, y);
        const double rise = std::abs(depthAt(i, j) - own);
        const double other = std::min(std::abs(depthAt(2 * x - i, 2 * y - j) - own), 1e30);
        const double share = std::clamp(2 - rise / (2 * size + 4 * other), 0.0, 1.0);
        return at(x, y) + share * (at(i, j) - at(x, y));
    };
    return glm::normalize(glm::cross(point(x + 1, y) - point(x - 1, y), point(x, y - 1) - point(x, y + 1)));
}

glm::dvec3 bilinear(const PointScreen& s, const ReferenceFilled::Level& level, int k, int px, int py) {
    const double x = (px + 0.5) / std::ldexp(1.0, k) - 0.5, y = (py + 0.5) / std::ldexp(1.0, k) - 0.5;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    glm::dvec3 sum{0};
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const double weight = (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0));
            if (weight == 0) continue;
            sum += weight * normalAt(s, level, k, std::clamp(x0 + i, 0, level.width - 1),
                                     std::clamp(y0 + j, 0, level.height - 1));
        }
    }
    return sum;
}

}  // namespace

std::vector<glm::dvec3> referenceNormals(const PointScreen& s, const ReferenceFilled& filled,
                                         const DepthNormalsPass& pass) {
    double last = 0;
    while (last + 1 < double(filled.levels.size()) &&
           std::min(filled.levels[std::size_t(last) + 1].width,
                    filled.levels[std::size_t(last) + 1].height) >= 2) {
        ++last;
    }
    std::vector<glm::dvec3> normals;
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            const double depth = filled.levels[0].depth[s.at(x, y)];
            if (std::isinf(depth)) {
                normals.emplace_back(0.0);
                continue;
            }
            const double size = double(pass.scale) * effectiveSpacing(s, pass.spacing, pass.detail, depth) *
                                pixelsPerUnitAt(s, depth);
            const double level = std::clamp(std::log2(size), 0.0, last);
            const int lower = int(level), upper = std::min(lower + 1, int(last));
            const double t = level - lower;
            normals.push_back(
                glm::normalize((1 - t) * bilinear(s, filled.levels[std::size_t(lower)], lower, x, y) +
                               t * bilinear(s, filled.levels[std::size_t(upper)], upper, x, y)));
        }
    }
    return normals;
}

}  // namespace scancast::test
