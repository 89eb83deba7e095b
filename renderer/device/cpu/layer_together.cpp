// A layer drawn together with other devices: every pass over all tiles, then what they agree on (pass_reduction.hpp),
// then the next. Tiles are each device's own, as they follow its samples; what is agreed on are planes of the whole layer.
#include <algorithm>
#include <bit>
#include <cmath>

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/cpu/layer.hpp"

namespace scancast::cpu {
namespace {

bool isEmpty(Key key) {
    return static_cast<std::int32_t>(key >> 32) >= infiniteOrder;
}

float depthOf(Key key) {
    return std::bit_cast<float>(static_cast<std::int32_t>(key >> 32));
}

int sumPlanes(const SplatPass& pass) {
    return colorPlanes + (pass.sumNormals ? normalPlanes : 0);
}

}  // namespace

/// work(tile, y, at): each row of each tile, from its place in planes of the layer on.
template <class Work>
void Layer::inRows(const std::vector<TileDrawing>& drawings, const Work& work) const {
    workers_.inParallel(static_cast<int>(drawings.size()), [&](int i) {
        const TileDrawing& tile = drawings[static_cast<std::size_t>(i)];
        const KeyTile& k = tile.nearest;
        for (std::int32_t y = 0; y < k.height; ++y) {
            const std::ptrdiff_t row = k.y - area_.y0 + y;
            work(tile, y, row * area_.width() + (k.x - area_.x0));
        }
    });
}

void Layer::reduceKeys(std::vector<TileDrawing>& drawings, Receivers to) {
    Key* const plane = grown(together_->keys, pixels());
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at) {
        const KeyTile& k = tile.target;
        std::copy_n(k.keys + std::ptrdiff_t{y} * k.stride, k.width, plane + at);
    });
    together_->reduction->least({plane, pixels()}, to);
    if (workers_.stopped() || (to == Receivers::WhoShows && !shows())) return;
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at) {
        const KeyTile& k = tile.target;
        std::copy_n(plane + at, k.width, k.keys + std::ptrdiff_t{y} * k.stride);
    });
}

/// Afterwards a sum is in its 32 bits, or all of it in its 64.
void Layer::reduceSums(std::vector<TileDrawing>& drawings, const SplatPass& pass) {
    SumPlanes& sums = together_->sums;
    sums.count = static_cast<std::size_t>(sumPlanes(pass));
    sums.pixels = pixels();
    sums.isWide =
        std::ranges::any_of(drawings, [](const TileDrawing& tile) { return !tile.memory->wide.empty(); });
    sums.grow();
    // work(tile, place in its planes, place in all planes), for each row of each plane.
    const auto inPlanes = [&](const auto& work) {
        inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at) {
            for (std::size_t p = 0; p < sums.count; ++p) {
                const std::int64_t place = static_cast<std::int64_t>(p) * tile.target.planeSize +
                                           std::int64_t{guard + y} * tile.target.stride + guard;
                work(tile, place, static_cast<std::ptrdiff_t>(p * sums.pixels) + at);
            }
        });
    };
    inPlanes([&](const TileDrawing& tile, std::int64_t from, std::ptrdiff_t to) {
        const std::int32_t* const narrow = tile.memory->sums.data() + from;
        if (!sums.isWide) return void(std::copy_n(narrow, tile.target.width, sums.narrow.data() + to));
        const bool isSigned = from >= colorPlanes * tile.target.planeSize;
        const auto& wide = tile.memory->wide;
        for (std::int32_t x = 0; x < tile.target.width; ++x) {
            const std::int64_t sum =
                isSigned ? std::int64_t{narrow[x]} : std::int64_t{static_cast<std::uint32_t>(narrow[x])};
            sums.wide[static_cast<std::size_t>(to + x)] =
                sum + (wide.empty() ? 0 : wide[static_cast<std::size_t>(from + x)]);
        }
    });
    together_->reduction->total(sums);
    if (workers_.stopped() || !shows()) return;
    for (TileDrawing& tile : drawings) {
        tile.memory->wide.clear();
        if (!sums.isWide) continue;
        tile.memory->wide.resize(sums.count * static_cast<std::size_t>(tile.target.planeSize));
        std::ranges::fill(tile.memory->sums, 0);
    }
    inPlanes([&](const TileDrawing& tile, std::int64_t to, std::ptrdiff_t from) {
        if (sums.isWide)
            std::copy_n(sums.wide.data() + from, tile.target.width, tile.memory->wide.data() + to);
        else
            std::copy_n(sums.narrow.data() + from, tile.target.width, tile.memory->sums.data() + to);
    });
}

void Layer::reducePass(std::vector<TileDrawing>& drawings, const SplatPass& pass, bool last) {
    if (pass.reduction == Reduction::Sum) return reduceSums(drawings, pass);
    // Of the samples seen, everybody colours his own.
    reduceKeys(drawings, last && !passes_.bySample() ? Receivers::WhoShows : Receivers::Everybody);
}

/// Everybody has resolved what samples of his own are seen; where there are others, he has background.
void Layer::joinSamples(std::vector<TileDrawing>& drawings, const Planes& planes, const Owners& owners) {
    const bool normals = passes_.resolve.normals && planes.normals != nullptr;
    const std::size_t count = 1 + std::size_t{normals} + (owners.places != nullptr ? 2 : 0);
    std::uint32_t* const words = grown(together_->words, count * pixels());
    // work(plane of words, plane of pixels), for each of them.
    const auto inEach = [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at, const auto& work) {
        std::uint32_t* plane = words + at;
        const auto next = [&](auto* pixels) {
            work(plane, pixels);
            plane += this->pixels();
        };
        next(planes.rgba + at);
        if (normals) next(planes.normals + at);
        if (owners.places == nullptr) return;
        const std::ptrdiff_t place = std::ptrdiff_t{tile.nearest.y - planes.area.y0 + y} * owners.stride +
                                     (tile.nearest.x - planes.area.x0);
        next(owners.places + place);
        next(owners.halves + place);
    };
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at) {
        const float* const depth = planes.depth + at;
        inEach(tile, y, at, [&](std::uint32_t* out, const auto* from) {
            for (std::int32_t x = 0; x < tile.nearest.width; ++x)
                out[x] = std::isfinite(depth[x]) ? std::bit_cast<std::uint32_t>(from[x]) : 0;
        });
    });
    together_->reduction->join({words, count * pixels()});
    if (workers_.stopped() || !shows()) return;
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::ptrdiff_t at) {
        const std::ptrdiff_t row = std::ptrdiff_t{y} * tile.nearest.stride;
        const Key* const seen = tile.colors.keys + row;
        inEach(tile, y, at, [&](const std::uint32_t* from, auto* to) {
            for (std::int32_t x = 0; x < tile.nearest.width; ++x)
                if (!isEmpty(seen[x])) to[x] = std::bit_cast<std::remove_reference_t<decltype(*to)>>(from[x]);
        });
        const std::ptrdiff_t place = std::ptrdiff_t{tile.nearest.y - planes.area.y0 + y} * owners.stride +
                                     (tile.nearest.x - planes.area.x0);
        for (std::int32_t x = 0; x < tile.nearest.width; ++x) {
            if (isEmpty(seen[x])) continue;
            const float depth = depthOf(tile.nearest.keys[row + x]);
            planes.depth[at + x] = depth;
            if (owners.places == nullptr) continue;
            owners.orders[place + x] = depth;
            owners.colors[place + x] = planes.rgba[at + x];
        }
    });
}

void Layer::resolveTogether(std::vector<TileDrawing>& drawings, const FrameDrawing& frame) {
    if (!shows() && !passes_.bySample()) return;
    Planes planes = frame.planes;
    if (planes.depth == nullptr && passes_.bySample()) planes.depth = grown(together_->depth, pixels());
    workers_.inParallel(static_cast<int>(drawings.size()), [&](int i) {
        const TileDrawing& tile = drawings[static_cast<std::size_t>(i)];
        resolveTile(tile.nearest, tile.colors, frame.passes.back(), *tile.memory, planes, frame.owners);
    });
    if (passes_.bySample()) joinSamples(drawings, planes, frame.owners);
}

void Layer::drawTogether(const FrameDrawing& frame, FrameStats& stats) {
    if (workers_.stopped()) return;
    TileMemories& memories = together_->tiles;
    while (memories.size() < tiles_.size()) memories.push_back(std::make_unique<TileMemory>());
    std::vector<TileDrawing> drawings(tiles_.size());
    for (std::size_t i = 0; i < drawings.size(); ++i) {
        drawings[i].memory = memories[i].get();
        begin(drawings[i], tiles_[i]);
    }
    double reducing = 0;
    auto start = workers_.now();
    const auto spent = [&] {
        const double ms = workers_.millisecondsSince(start);
        start = workers_.now();
        return ms;
    };
    for (std::size_t p = 0; p < frame.passes.size(); ++p) {
        const SplatPass& pass = frame.passes[p];
        workers_.inParallel(static_cast<int>(drawings.size()), [&](int i) {
            TileDrawing& at = drawings[static_cast<std::size_t>(i)];
            at.pass = p;
            beginPass(at, pass);
            drawRuns(at, pass);
        });
        stats.add(nameOf(pass), spent());
        reducePass(drawings, pass, p + 1 == frame.passes.size());
        reducing += spent();
        if (workers_.stopped()) return;
    }
    resolveTogether(drawings, frame);
    stats.add("resolve", spent());
    stats.add("reduce", reducing);
}

}  // namespace scancast::cpu
