#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"
#include "simulator/scenes/glyphs.hpp"
#include "simulator/scenes/town.hpp"

namespace scancast {
namespace {

constexpr double eaves = 0.45;  ///< how far the roof hangs over
constexpr double shopFoot = 0.5, shopTop = 2.55, signFoot = 2.68, signTop = 3.22;

}  // namespace

FacadeMaterial::FacadeMaterial(const HouseStyle& style, double width, bool front, glm::vec3 along,
                               glm::vec3 outwards)
    : style_(style),
      width_(width),
      columnWidth_(width / style.columns),
      front_(front),
      sunAlong_(glm::dot(townSun, along)),
      sunUp_(townSun.z),
      sunOut_(glm::dot(townSun, outwards)) {}

std::optional<Opening> FacadeMaterial::opening(int column, int storey) const {
    if (column < 0 || column >= style_.columns || storey < 0 || storey >= style_.storeys) return std::nullopt;
    const double center = (column + 0.5) * columnWidth_;
    if (storey == 0 && front_) {
        const int doorColumn = int(style_.salt % std::uint32_t(style_.columns));
        if (column == doorColumn)
            return Opening{Opening::Kind::Door, center - 0.55, center + 0.55, 0.1, 2.5, 0.22};
        if (!style_.shop.empty()) {
            const double half = columnWidth_ / 2 - 0.18;
            return Opening{Opening::Kind::ShopWindow, center - half, center + half, shopFoot, shopTop, 0.2};
        }
    }
    const double foot = storey == 0
                            ? style_.sillHeight + 0.25
                            : style_.groundHeight + (storey - 1) * style_.storeyHeight + style_.sillHeight;
    const double half = std::min(style_.windowWidth, columnWidth_ - 0.5) / 2;
    return Opening{Opening::Kind::Window,      center - half, center + half, foot,
                   foot + style_.windowHeight, 0.16};
}

void FacadeMaterial::wall(SurfacePoint& point) const {
    const auto x = float(point.s), y = float(point.t);
    const float cloud = smoothNoise({x * 0.6F, y * 0.45F}, style_.salt),
                streak = smoothNoise({x * 5, y * 0.35F}, style_.salt + 1);
    float tone =
        1 + 0.07F * (cloud - 0.5F) + 0.05F * (streak - 0.5F) + 0.035F * (point.random->unit() - 0.5F);
    point.color = style_.wall;
    point.reflectance = 0.55F;
    if (style_.brick) {
        constexpr float brickLength = 0.25F, brickHeight = 0.083F;
        const int row = int(std::floor(y / brickHeight));
        const float shifted = x / brickLength + 0.5F * float(row & 1);
        const int column = int(std::floor(shifted));
        const float joint =
            std::min(std::min(shifted - float(column), float(column) + 1 - shifted) * brickLength,
                     std::min(y / brickHeight - float(row), float(row) + 1 - y / brickHeight) * brickHeight);
        tone += 0.28F * (hashUnit(column, row, style_.salt) - 0.5F);
        if (joint < 0.007F) {
            point.color = blend(style_.wall, glm::vec3(0.75F, 0.72F, 0.66F), 0.6F);
            point.raise(-0.006);
        }
        point.reflectance = 0.45F;
    }
    point.color *= tone;
    // Rain splashes and dust darken the foot of a wall.
    point.color *= 0.86F + 0.14F * std::min(1.0F, y / 1.1F);
    point.openness = 0.8F + 0.2F * std::min(1.0F, y / 1.5F);
}

void FacadeMaterial::bands(SurfacePoint& point) const {
    const double x = point.s, y = point.t, top = style_.height();
    const float grain = 0.97F + 0.06F * point.random->unit();
    if (y < 0.42) {
        const float stone = hashUnit(int(std::floor(x / 0.8)), int(std::floor(y / 0.42)), style_.salt);
        point.color = glm::vec3(0.47F, 0.455F, 0.43F) * (0.9F + 0.2F * stone) * grain;
        point.raise(0.035);
    } else if (y > top - 0.34) {
        const double step = y > top - 0.15 ? 0.16 : 0.08;
        point.color = style_.trim * grain;
        point.raise(step);
        point.openness *= 0.85F;
    } else if (style_.storeys > 1 && y > style_.groundHeight - 0.16 && y < style_.groundHeight) {
        point.color = style_.trim * grain;
        point.raise(0.06);
    } else if (style_.storeys > 1 && y > style_.groundHeight - 0.26 && y <= style_.groundHeight - 0.16) {
        point.openness *= 0.75F;
    } else if (style_.quoins && std::min(x, width_ - x) < ((int(std::floor(y / 0.34)) & 1) ? 0.34 : 0.5)) {
        point.color =
            style_.trim * (0.93F + 0.1F * hashUnit(int(std::floor(y / 0.34)), x < 1, style_.salt)) * grain;
        point.raise(0.025);
    }
}

void FacadeMaterial::shade(const Opening& opening, double depth, SurfacePoint& point) const {
    const double away = std::min({point.s - opening.x0, opening.x1 - point.s, opening.y1 - point.t, 0.4});
    point.openness *= float(0.55 + 0.45 * std::clamp(away / 0.35, 0.0, 1.0));
    if (sunOut_ <= 0.02) return;
    const double travel = depth / sunOut_, x = point.s + travel * sunAlong_, y = point.t + travel * sunUp_;
    if (x < opening.x0 || x > opening.x1 || y > opening.y1) point.sunlit = 0;
}

void FacadeMaterial::aroundOpening(const Opening& opening, SurfacePoint& point) const {
    const double x = point.s, y = point.t;
    const double outsideX = std::max(opening.x0 - x, x - opening.x1),
                 outsideY = std::max(opening.y0 - y, y - opening.y1);
    const float grain = 0.97F + 0.06F * point.random->unit();
    const bool belowFoot = y < opening.y0;
    if (opening.kind == Opening::Kind::Window && belowFoot && outsideX < 0.14) {
        const double under = opening.y0 - y;
        if (under < 0.09) {
            point.color = style_.trim * grain * 1.03F;
            point.raise(0.1);
        } else if (under < 0.24) {
            point.openness *= 0.72F;
            if (sunOut_ > 0 && under < 0.09 + 0.1 * sunUp_ / std::max(0.05, sunOut_)) point.sunlit *= 0.25F;
        } else if (outsideX < 0 && under < 1) {
            point.color *= 0.93F + 0.07F * float(under);  // stains
        }
        return;
    }
    constexpr double trimWidth = 0.13;
    if (std::max(outsideX, outsideY) < trimWidth && !belowFoot) {
        const bool keystone = y > opening.y1 && std::abs(x - (opening.x0 + opening.x1) / 2) < 0.12;
        point.color = style_.trim * grain * (keystone ? 1.04F : 1.0F);
        point.raise(keystone ? 0.06 : 0.03);
        return;
    }
    const bool beside = outsideY < 0 && outsideX > trimWidth && outsideX < trimWidth + 0.46;
    if (opening.kind == Opening::Kind::Window && style_.shutters && beside && point.t > 1.2) {
        const double slat = y * 15 - std::floor(y * 15), inner = outsideX - trimWidth;
        const bool rim = inner < 0.05 || inner > 0.41 || outsideY > -0.06;
        point.color = style_.shutter * grain * (rim ? 1.0F : 0.7F + 0.45F * float(slat));
        point.raise(rim ? 0.05 : 0.03 + 0.02 * slat);
        point.reflectance = 0.4F;
    }
}

void FacadeMaterial::window(const Opening& opening, SurfacePoint& point, std::uint64_t id) const {
    const double u = (point.s - opening.x0) / (opening.x1 - opening.x0),
                 v = (point.t - opening.y0) / (opening.y1 - opening.y0);
    const double width = opening.x1 - opening.x0, height = opening.y1 - opening.y0;
    const double rim = std::min(std::min(u, 1 - u) * width, std::min(v, 1 - v) * height);
    const bool bar = rim < 0.07 || std::abs(u - 0.5) * width < 0.035 || std::abs(v - 0.68) * height < 0.03;
    if (bar) {
        point.color = style_.frame * (0.96F + 0.06F * point.random->unit());
        point.raise(-opening.depth + 0.05);
        point.reflectance = 0.7F;
        shade(opening, opening.depth - 0.05, point);
        return;
    }
    point.raise(-opening.depth);
    const float inside = unitFloat(mixBits(id, style_.salt));
    const glm::vec3 sky =
        blend(rgb(0x2b3a4a), rgb(0x86a5bd), float(std::clamp(v * 0.9 + 0.25 * (u - 0.5), 0.0, 1.0)));
    point.color = sky * (0.85F + 0.1F * point.random->unit());
    const double curtain = 0.16 + 0.06 * std::cos(u * 60);
    if (inside < 0.45F && std::min(u, 1 - u) < curtain)
        point.color = blend(point.color, rgb(0xe9e2d0), 0.75F);
    if (inside > 0.8F && v > 0.45) point.color = blend(point.color, rgb(0xf0ead8), 0.65F);
    if (inside > 0.45F && inside < 0.52F) point.color = blend(point.color, rgb(0xffd98a), 0.6F);
    point.reflectance = 0.12F;
    shade(opening, opening.depth, point);
}

void FacadeMaterial::door(const Opening& opening, SurfacePoint& point) const {
    const double u = (point.s - opening.x0) / (opening.x1 - opening.x0), y = point.t - opening.y0;
    point.raise(-opening.depth);
    point.reflectance = 0.4F;
    const double half = u < 0.5 ? u * 2 : 2 - u * 2, row = y < 0.95 ? y / 0.95 : (y - 0.95) / 0.95;
    const bool light = y > 1.95;
    const bool panel = half > 0.2 && half < 0.85 && row > 0.14 && row < 0.9;
    point.color = style_.door * (panel ? 0.82F : 1.0F) * (0.96F + 0.08F * point.random->unit());
    if (panel) point.raise(-0.025);
    if (std::abs(u - 0.5) < 0.012) point.color *= 0.55F;
    if (light && y < 2.32 && half > 0.12) point.color = rgb(0x5f7a8c);
    if (light && (y < 2.0 || std::abs(u - 0.5) < 0.03)) point.color = style_.frame;
    if (std::abs(u - 0.57) < 0.035 && std::abs(y - 1.02) < 0.035) {
        point.color = rgb(0xd8b65a);
        point.raise(0.05);
    }
    shade(opening, opening.depth, point);
}

void FacadeMaterial::shopWindow(const Opening& opening, SurfacePoint& point) const {
    const double u = (point.s - opening.x0) / (opening.x1 - opening.x0),
                 v = (point.t - opening.y0) / (opening.y1 - opening.y0);
    const double rim = std::min(std::min(u, 1 - u) * (opening.x1 - opening.x0),
                                std::min(v, 1 - v) * (opening.y1 - opening.y0));
    if (rim < 0.07 || std::abs(v - 0.8) < 0.018) {
        point.color = style_.door;
        point.raise(-opening.depth + 0.06);
        shade(opening, opening.depth - 0.06, point);
        return;
    }
    point.raise(-opening.depth);
    point.reflectance = 0.15F;
    point.color = blend(rgb(0x3b3a36), rgb(0x8fa3ad), float(v * v));
    // Goods on two shelves.
    const int shelf = v < 0.28 ? 0 : v < 0.52 ? 1 : 2;
    if (shelf < 2) {
        const int item = int(std::floor(u * 9));
        const float kind = hashUnit(item, shelf, style_.salt + 20);
        const double base = shelf == 0 ? 0.04 : 0.3;
        if (v > base && v < base + 0.1 + 0.1 * kind && std::abs(u * 9 - item - 0.5) < 0.36)
            point.color = blend(rgb(0xd9a441),
                                kind < 0.35F  ? rgb(0xb23a2e)
                                : kind < 0.7F ? rgb(0x4f7f5a)
                                              : rgb(0xefe6d2),
                                0.8F);
        if (v > 0.27 && v < 0.3) point.color = rgb(0x6b4a2f);
    }
    shade(opening, opening.depth, point);
}

void FacadeMaterial::shopSign(SurfacePoint& point) const {
    point.raise(0.09);
    point.color = style_.door * (0.95F + 0.05F * point.random->unit());
    point.reflectance = 0.5F;
    const double margin = 0.15;
    if (std::min(std::min(point.s - margin, width_ - margin - point.s),
                 std::min(point.t - signFoot, signTop - point.t)) < 0.03) {
        point.color = rgb(0xe6c877);
        return;
    }
    constexpr double letters = 0.3;
    const double left = (width_ - textWidth(style_.shop) * letters) / 2;
    if (textInk(style_.shop, (point.s - left) / letters, (point.t - signFoot - 0.12) / letters, 1.15)) {
        point.color = rgb(0xfbf3dc);
        point.reflectance = 0.9F;
    }
}

void FacadeMaterial::apply(const Patch&, SurfacePoint& point) const {
    point.classification = buildingClass;
    const double y = point.t, top = style_.height();
    // Shadow of the eaves.
    if (sunOut_ > 0.02 && (top - y) < eaves * sunUp_ / sunOut_) point.sunlit = 0;
    const int column = std::clamp(int(point.s / columnWidth_), 0, style_.columns - 1);
    const int storey = y < style_.groundHeight ? 0 : int((y - style_.groundHeight) / style_.storeyHeight) + 1;
    const auto here = opening(column, storey);
    if (here && point.s >= here->x0 && point.s <= here->x1 && y >= here->y0 && y <= here->y1) {
        const std::uint64_t id = std::uint64_t(column) * 64 + std::uint64_t(storey) * 2 + (front_ ? 1 : 0);
        if (here->kind == Opening::Kind::Door) return door(*here, point);
        if (here->kind == Opening::Kind::ShopWindow) return shopWindow(*here, point);
        return window(*here, point, id);
    }
    if (front_ && !style_.shop.empty() && y > signFoot && y < signTop && point.s > 0.15 &&
        point.s < width_ - 0.15)
        return shopSign(point);
    wall(point);
    bands(point);
    if (top - y < 0.9) point.openness *= float(0.7 + 0.3 * (top - y) / 0.9);
    if (here) aroundOpening(*here, point);
}

}  // namespace scancast
