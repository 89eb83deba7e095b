#include "renderer/map/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace scancast {
namespace {

/// Pixels of a map that are not square are drawn as the picture where nobody can tell: so far off at its ends, px.
constexpr double squareEnough = 0.01;
/// Around the cloud's bounds: samples reach so far beyond their points, in spacings, or in pixels of the picture.
constexpr double reachSpacings = 4, reachPixels = 8;
/// The picture of a map whose pixels are long and thin may have so many times the map's pixels, and is coarser else.
constexpr double mostFiner = 8;
constexpr int widestStep = 64;
constexpr std::size_t mostNodes = 65'536;
/// Places along an edge of the cloud's bounds that say where it lies in a map.
constexpr int placesOfEdge = 33;
/// px beside what a bilinear sample needs.
constexpr int edge = 2;

struct Box {
    glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec2& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void grow(const glm::dvec2& by) {
        low -= by;
        high += by;
    }
    bool empty() const { return !(low.x < high.x && low.y < high.y); }
};

Box intersection(const Box& a, const Box& b) {
    return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

bool isPlace(const glm::dvec2& p) {
    return std::isfinite(p.x) && std::isfinite(p.y);
}

Box boundsOf(const CloudFacts& cloud) {
    return {{cloud.bounds[0].x, cloud.bounds[0].y}, {cloud.bounds[1].x, cloud.bounds[1].y}};
}

/// Where the cloud lies in the map, in its coordinates; everywhere where that cannot be said.
Box boundsInMap(const Box& bounds, const MapProjection& projection) {
    std::vector<glm::dvec2> places;
    for (int row = 0; row < placesOfEdge; ++row)
        for (int column = 0; column < placesOfEdge; ++column)
            places.push_back(
                glm::mix(bounds.low, bounds.high, glm::dvec2(column, row) / double(placesOfEdge - 1)));
    if (projection.fromCloud) projection.fromCloud(places);
    Box box;
    for (const glm::dvec2& place : places) {
        constexpr double everything = std::numeric_limits<double>::infinity();
        if (!isPlace(place)) return {glm::dvec2(-everything), glm::dvec2(everything)};
        box.add(place);
    }
    box.grow((box.high - box.low) * 0.01);
    return box;
}

/// Pixels of the map in which something of the cloud may be.
struct NetWindow {
    glm::ivec2 first{0}, size{0};
    bool empty() const { return size.x <= 0 || size.y <= 0; }
};

NetWindow windowOf(const MapExtent& extent, const Box& box) {
    const glm::dvec2 sides(extent.width, extent.height);
    const glm::dvec2 pixel = (extent.high - extent.low) / sides;
    const auto clamped = [&](const glm::dvec2& p) { return glm::ivec2(glm::clamp(p, glm::dvec2(0), sides)); };
    const glm::dvec2 low =
        (glm::dvec2(box.low.x, extent.high.y) - glm::dvec2(extent.low.x, box.high.y)) / pixel;
    const glm::dvec2 high =
        (glm::dvec2(box.high.x, extent.high.y) - glm::dvec2(extent.low.x, box.low.y)) / pixel;
    const glm::ivec2 first = clamped(glm::floor(low) - reachPixels);
    return {first, clamped(glm::ceil(high) + reachPixels) - first};
}

/// The net of a window, in the cloud's coordinates.
struct Net {
    int step = widestStep, columns = 0, rows = 0;
    std::vector<glm::dvec2> nodes;
    const glm::dvec2& at(int column, int row) const {
        return nodes[std::size_t(row) * std::size_t(columns) + std::size_t(column)];
    }
};

void toCloud(const MapProjection& projection, std::vector<glm::dvec2>& places) {
    if (projection.toCloud) projection.toCloud(places);
}

Net netOf(const MapExtent& extent, const MapProjection& projection, const NetWindow& window, int step) {
    Net net;
    net.step = step;
    net.columns = (window.size.x + step - 1) / step + 1;
    net.rows = (window.size.y + step - 1) / step + 1;
    net.nodes.reserve(std::size_t(net.columns) * std::size_t(net.rows));
    for (int row = 0; row < net.rows; ++row)
        for (int column = 0; column < net.columns; ++column)
            net.nodes.push_back(
                extent.placeAt(glm::dvec2(window.first) + double(step) * glm::dvec2(column, row)));
    toCloud(projection, net.nodes);
    return net;
}

std::size_t nodesOf(const NetWindow& window, int step) {
    return std::size_t((window.size.x + step - 1) / step + 1) *
           std::size_t((window.size.y + step - 1) / step + 1);
}

/// How far the net is off in the middle of cells and of their edges, cloud units: what bends is farthest off there.
double errorOf(const Net& net, const MapExtent& extent, const MapProjection& projection,
               const NetWindow& window) {
    if (!projection.toCloud) return 0;
    std::vector<glm::dvec2> there, between;
    for (int row = 0; row + 1 < net.rows; ++row) {
        for (int column = 0; column + 1 < net.columns; ++column) {
            const glm::dvec2 corners[4] = {net.at(column, row), net.at(column + 1, row),
                                           net.at(column, row + 1), net.at(column + 1, row + 1)};
            const auto look = [&](double x, double y) {
                there.push_back(extent.placeAt(glm::dvec2(window.first) +
                                               double(net.step) * glm::dvec2(column + x, row + y)));
                between.push_back(
                    glm::mix(glm::mix(corners[0], corners[1], x), glm::mix(corners[2], corners[3], x), y));
            };
            look(0.5, 0.5);
            look(0.5, 0);
            look(0, 0.5);
        }
    }
    toCloud(projection, there);
    double most = 0;
    for (std::size_t i = 0; i < there.size(); ++i)
        if (isPlace(there[i]) && isPlace(between[i]))
            most = std::max(most, glm::distance(there[i], between[i]));
    return most;
}

/// The smallest side of a pixel of the map, cloud units; 0: it has no places.
double finestPixel(const Net& net) {
    double finest = std::numeric_limits<double>::infinity();
    const auto look = [&](const glm::dvec2& a, const glm::dvec2& b) {
        if (isPlace(a) && isPlace(b) && a != b) finest = std::min(finest, glm::distance(a, b) / net.step);
    };
    for (int row = 0; row < net.rows; ++row)
        for (int column = 0; column < net.columns; ++column) {
            if (column + 1 < net.columns) look(net.at(column, row), net.at(column + 1, row));
            if (row + 1 < net.rows) look(net.at(column, row), net.at(column, row + 1));
        }
    return std::isfinite(finest) ? finest : 0;
}

bool isSquare(const MapExtent& extent) {
    const glm::dvec2 pixel = (extent.high - extent.low) / glm::dvec2(extent.width, extent.height);
    return std::abs(pixel.x / pixel.y - 1) * std::max(extent.width, extent.height) < squareEnough;
}

tl::unexpected<Error> tooLarge(double width, double height, std::uint64_t most) {
    return fail(
        ErrorCode::ResourceLimit,
        fmt::format("For this map a picture of {:.0f} x {:.0f} pixels would be drawn, and the limit of this "
                    "server is {} pixels with sides of up to {}. Ask for fewer pixels.",
                    width, height, most, maxPictureSide),
        "width");
}

Expected<std::optional<MapPicture>> drawnDirectly(const CloudFacts& cloud, const MapExtent& extent,
                                                  const std::optional<Rgb8>& background,
                                                  const MapLimits& limits) {
    const int margin = limits.margin;
    // What is asked for is within the limit; its margin is a little more.
    if (std::max(extent.width, extent.height) + 2 * margin > maxPictureSide ||
        std::uint64_t(extent.width) * std::uint64_t(extent.height) > limits.mostPixels)
        return tooLarge(extent.width + 2 * margin, extent.height + 2 * margin, limits.mostPixels);
    MapPicture picture;
    picture.width = extent.width + 2 * margin;
    picture.height = extent.height + 2 * margin;
    const double perPixel = (extent.high.y - extent.low.y) / extent.height;
    picture.camera = cameraAbove(cloud, (extent.low + extent.high) * 0.5, perPixel * picture.height);
    if (margin == 0) return picture;
    auto warp = std::make_shared<MapWarp>();
    warp->width = extent.width;
    warp->height = extent.height;
    warp->size = {extent.width, extent.height};
    warp->offset = glm::ivec2(margin);
    warp->opaque = background.has_value();
    picture.warp = std::move(warp);
    return picture;
}

}  // namespace

glm::dvec2 MapExtent::placeAt(const glm::dvec2& pixel) const {
    const glm::dvec2 share = pixel / glm::dvec2(width, height);
    return {low.x + (high.x - low.x) * share.x, high.y - (high.y - low.y) * share.y};
}

Camera cameraAbove(const CloudFacts& cloud, const glm::dvec2& middle, double viewHeight) {
    const double high = cloud.bounds[1].z, low = cloud.bounds[0].z;
    const double above = std::max({high - low, cloud.spacing, 1e-6});
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.eye = {middle, high + above};
    camera.target = {middle, low};
    camera.up = {0, 1, 0};
    camera.viewHeight = viewHeight;
    return camera;
}

Expected<std::optional<MapPicture>> mapPicture(const CloudFacts& cloud, const MapExtent& extent,
                                               const MapProjection& projection,
                                               const std::optional<Rgb8>& background,
                                               const MapLimits& limits) {
    const bool isCloudsOwn = !projection.toCloud;
    const Box bounds = boundsOf(cloud);
    Box reached = bounds;
    reached.grow(glm::dvec2(reachSpacings * cloud.spacing));
    Box here = boundsInMap(reached, projection);
    if (isCloudsOwn) {
        here = bounds;
        const glm::dvec2 pixel = (extent.high - extent.low) / glm::dvec2(extent.width, extent.height);
        here.grow(glm::max(glm::dvec2(reachSpacings * cloud.spacing), reachPixels * pixel));
        if (isSquare(extent)) {
            if (intersection(here, {extent.low, extent.high}).empty()) return std::nullopt;
            return drawnDirectly(cloud, extent, background, limits);
        }
    }
    const NetWindow window = windowOf(extent, here);
    if (window.empty()) return std::nullopt;
    Net net;
    double perPixel = 0, off = 0;
    for (int step = isCloudsOwn ? std::max(window.size.x, window.size.y) : widestStep;; step /= 2) {
        net = netOf(extent, projection, window, step);
        perPixel = finestPixel(net);
        if (perPixel == 0) return std::nullopt;
        // Of all of the net, which may reach beyond the window.
        const double area = double(net.columns - 1) * (net.rows - 1) * step * step;
        Box covered;
        for (const glm::dvec2& node : net.nodes)
            if (isPlace(node)) covered.add(node);
        const glm::dvec2 sides = covered.high - covered.low;
        perPixel = std::max(perPixel, std::sqrt(sides.x * sides.y / (mostFiner * area)));
        off = errorOf(net, extent, projection, window) / perPixel;
        // In the middle of a cell it may be a little more than where it was looked at.
        if (off <= limits.mostError / 2) break;
        if (step == 1 || nodesOf(window, step / 2) > mostNodes)
            return fail(ErrorCode::ResourceLimit,
                        "The projection bends so much here that this map would not be accurate. Ask for a "
                        "smaller part, or in the cloud's own coordinates.",
                        "bbox");
    }
    Box part;
    for (const glm::dvec2& node : net.nodes)
        if (isPlace(node)) part.add(node);
    Box seen = bounds;
    seen.grow(glm::dvec2(std::max(reachSpacings * cloud.spacing, reachPixels * perPixel)));
    part = intersection(part, seen);
    if (part.empty()) return std::nullopt;
    part.grow(glm::dvec2(perPixel * (edge + limits.margin)));
    const glm::dvec2 sides = glm::ceil((part.high - part.low) / perPixel);
    if (std::max(sides.x, sides.y) > maxPictureSide || sides.x * sides.y > double(limits.mostPixels))
        return tooLarge(sides.x, sides.y, limits.mostPixels);
    MapPicture picture;
    picture.width = int(sides.x);
    picture.height = int(sides.y);
    const glm::dvec2 middle = (part.low + part.high) * 0.5;
    picture.camera = cameraAbove(cloud, middle, sides.y * perPixel);
    auto warp = std::make_shared<MapWarp>();
    warp->width = extent.width;
    warp->height = extent.height;
    warp->first = window.first;
    warp->size = window.size;
    warp->step = net.step;
    warp->columns = net.columns;
    warp->rows = net.rows;
    warp->error = off;
    warp->opaque = background.has_value();
    warp->outside = background.value_or(Rgb8{0, 0, 0});
    warp->nodes = std::move(net.nodes);
    for (glm::dvec2& node : warp->nodes)
        node = {(node.x - middle.x) / perPixel + sides.x * 0.5,
                (middle.y - node.y) / perPixel + sides.y * 0.5};
    picture.warp = std::move(warp);
    return picture;
}

std::optional<MapPlace> placeUnder(const MapExtent& extent, const MapProjection& projection,
                                   const glm::dvec2& pixel) {
    std::vector<glm::dvec2> places{extent.placeAt(pixel), extent.placeAt(pixel + glm::dvec2(0.5, 0)),
                                   extent.placeAt(pixel - glm::dvec2(0.5, 0)),
                                   extent.placeAt(pixel + glm::dvec2(0, 0.5)),
                                   extent.placeAt(pixel - glm::dvec2(0, 0.5))};
    toCloud(projection, places);
    for (const glm::dvec2& place : places)
        if (!isPlace(place)) return std::nullopt;
    const glm::dvec2 right = places[1] - places[2], down = places[3] - places[4];
    const double area = std::abs(right.x * down.y - right.y * down.x);
    if (!(area > 0)) return std::nullopt;
    return MapPlace{places[0], std::sqrt(area)};
}

}  // namespace scancast
