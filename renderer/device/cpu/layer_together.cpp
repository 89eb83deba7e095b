// A layer drawn together with other devices: every pass over all tiles, then what they agree on (pass_reduction.hpp),
// then the next. Tiles are each device's own, as they follow its samples; what is agreed on are planes of the whole layer,
// of which only what somebody has something in is packed and reduced (occupied_spans.hpp).
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "renderer/device/cpu/grown.hpp"
#include "renderer/device/cpu/layer.hpp"

namespace scancast::cpu {
namespace {

/// From here on a key is none.
constexpr Key noKey = Key{infiniteOrder} << 32;
/// A magnitude that does not fit 32 bits, whatever it is.
constexpr std::uint64_t wideBits = std::uint64_t{1} << 40;

/// Room for packed planes, in which nothing is that nobody puts there.
template <class T>
T* packedIn(std::vector<T>& memory, std::size_t size, const OccupiedSpans& occupied) {
    T* const packed = grown(memory, size);
    if (occupied.hasRemnants()) std::fill_n(packed, size, T{});
    return packed;
}

float depthOf(Key key) {
    return std::bit_cast<float>(static_cast<std::int32_t>(key >> 32));
}

}  // namespace

/// work(tile, y, x, row): each row of each tile, whose first pixel is (x, row) in the layer's area.
template <class Work>
void Layer::inRows(const std::vector<TileDrawing>& drawings, const Work& work) const {
    workers_.inParallel(static_cast<int>(drawings.size()), [&](int i) {
        const TileDrawing& tile = drawings[static_cast<std::size_t>(i)];
        const KeyTile& k = tile.nearest;
        for (std::int32_t y = 0; y < k.height; ++y) work(tile, y, k.x - area_.x0, k.y - area_.y0 + y);
    });
}

/// work(tile, place, count, at): in planes of the tile's geometry, from its pixel (0, 0) on, and in a packed plane.
template <class Work>
void Layer::inOccupied(const std::vector<TileDrawing>& drawings, const Work& work) const {
    const OccupiedSpans& occupied = together_->occupied;
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::int32_t x0, std::int32_t row) {
        occupied.inRow(row, x0, x0 + tile.nearest.width,
                       [&](std::int32_t x, std::int32_t count, std::size_t at) {
                           work(tile, std::ptrdiff_t{y} * tile.nearest.stride + (x - x0), count, at);
                       });
    });
}

void Layer::reduceKeys(std::vector<TileDrawing>& drawings, Receivers to) {
    OccupiedSpans& occupied = together_->occupied;
    PassReduction& reduction = *together_->reduction;
    occupied.begin(area_.width(), area_.height(), 0);
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::int32_t x0, std::int32_t row) {
        const Key* const keys = tile.target.keys + std::ptrdiff_t{y} * tile.target.stride;
        occupied.mark(row, x0, x0 + tile.target.width, [&](std::int32_t x) { return keys[x - x0] < noKey; });
    });
    if (!reduction.agree(occupied.words())) return;
    const std::size_t size = occupied.settle();
    Key* const packed = packedIn(together_->keys, size, occupied);
    inOccupied(drawings, [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t count,
                             std::size_t at) { std::copy_n(tile.target.keys + place, count, packed + at); });
    reduction.least({packed, size}, to);
    if (to == Receivers::WhoShows && !shows()) return;
    inOccupied(drawings, [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t count,
                             std::size_t at) { std::copy_n(packed + at, count, tile.target.keys + place); });
}

/// Afterwards a sum is in its 32 bits, or all of it in its 64: as T is.
template <class T>
void Layer::addSums(std::vector<TileDrawing>& drawings, std::size_t planes, std::vector<T>& memory) {
    constexpr bool wide = sizeof(T) == 8;
    const std::size_t size = together_->occupied.settle();
    T* const packed = packedIn(memory, planes * size, together_->occupied);
    // work(tile, place in its planes, count, packed, plane).
    const auto inPlanes = [&](const auto& work) {
        inOccupied(drawings, [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t count,
                                 std::size_t at) {
            auto from = static_cast<std::size_t>(guard * std::int64_t{tile.target.stride} + guard + place);
            for (std::size_t p = 0; p < planes; ++p) {
                work(tile, from, count, packed + p * size + at, p);
                from += static_cast<std::size_t>(tile.target.planeSize);
            }
        });
    };
    inPlanes([](const TileDrawing& tile, std::size_t from, std::int32_t count, T* to, std::size_t plane) {
        const std::int32_t* const narrow = tile.memory->sums.data() + from;
        if constexpr (!wide) {
            std::copy_n(narrow, count, to);
        } else {
            const std::vector<std::int64_t>& emptied = tile.memory->wide;
            for (std::int32_t i = 0; i < count; ++i) {
                to[i] = plane < colorPlanes ? std::int64_t{static_cast<std::uint32_t>(narrow[i])}
                                            : std::int64_t{narrow[i]};
                if (!emptied.empty()) to[i] += emptied[from + static_cast<std::size_t>(i)];
            }
        }
    });
    together_->reduction->add(std::span<T>(packed, planes * size));
    if (!shows()) return;
    if constexpr (wide) {
        for (TileDrawing& tile : drawings) {
            tile.memory->wide.assign(planes * static_cast<std::size_t>(tile.target.planeSize), 0);
            std::ranges::fill(tile.memory->sums, 0);
        }
    }
    inPlanes([](const TileDrawing& tile, std::size_t to, std::int32_t count, const T* from, std::size_t) {
        if constexpr (wide)
            std::copy_n(from, count, tile.memory->wide.data() + to);
        else
            std::copy_n(from, count, tile.memory->sums.data() + to);
    });
}

void Layer::reduceSums(std::vector<TileDrawing>& drawings, const SplatPass& pass) {
    OccupiedSpans& occupied = together_->occupied;
    occupied.begin(area_.width(), area_.height(), 1);
    std::atomic<std::uint64_t> magnitudes{0};
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t y, std::int32_t x0, std::int32_t row) {
        const std::int64_t place = std::int64_t{guard + y} * tile.target.stride + guard;
        const std::int32_t* const weights = tile.memory->sums.data() + place;
        const std::int64_t* const emptied =
            tile.memory->wide.empty() ? nullptr : tile.memory->wide.data() + place;
        std::uint64_t bits = emptied != nullptr ? wideBits : 0;
        occupied.mark(row, x0, x0 + tile.target.width, [&](std::int32_t x) {
            bits |= static_cast<std::uint32_t>(weights[x - x0]);
            return weights[x - x0] != 0 || (emptied != nullptr && emptied[x - x0] != 0);
        });
        magnitudes.fetch_or(bits, std::memory_order_relaxed);
    });
    occupied.note(0) = magnitudes;
    if (!together_->reduction->agree(occupied.words())) return;
    // No device's weights take more bits than all of theirs together; no other sum is more than 255 times as much.
    const int widest = std::bit_width(occupied.note(0)) + 8 + std::bit_width(together_->reduction->devices());
    const std::size_t planes = colorPlanes + (pass.sumNormals ? normalPlanes : 0);
    if (widest < 32)
        addSums(drawings, planes, together_->sums);
    else
        addSums(drawings, planes, together_->wideSums);
}

void Layer::reducePass(std::vector<TileDrawing>& drawings, const SplatPass& pass, bool last) {
    if (pass.reduction == Reduction::Sum) return reduceSums(drawings, pass);
    // Of the samples seen, everybody colours his own.
    reduceKeys(drawings, last && !passes_.bySample() ? Receivers::WhoShows : Receivers::Everybody);
}

/// Everybody has resolved what samples of his own are seen; where there are others, he has background.
void Layer::joinSamples(std::vector<TileDrawing>& drawings, const Planes& planes, const Owners& owners) {
    OccupiedSpans& occupied = together_->occupied;
    occupied.begin(area_.width(), area_.height(), 0);
    inRows(drawings, [&](const TileDrawing& tile, std::int32_t, std::int32_t x0, std::int32_t row) {
        const float* const depth = planes.depth + std::ptrdiff_t{row} * area_.width();
        occupied.mark(row, x0, x0 + tile.nearest.width,
                      [&](std::int32_t x) { return depth[x] < std::numeric_limits<float>::infinity(); });
    });
    if (!together_->reduction->agree(occupied.words())) return;
    const std::size_t size = occupied.settle();
    const bool normals = passes_.resolve.normals && planes.normals != nullptr;
    const std::size_t count = 1 + std::size_t{normals} + (owners.places != nullptr ? 2 : 0);
    std::uint32_t* const words = packedIn(together_->words, count * size, occupied);
    // work(packed, pixels): of each plane that travels, from a packed place, a pixel and an owner on.
    const auto inEach = [&](std::size_t at, std::ptrdiff_t pixel, std::ptrdiff_t owner, const auto& work) {
        std::uint32_t* packed = words + at;
        const auto next = [&](auto* pixels) {
            work(packed, pixels);
            packed += size;
        };
        next(planes.rgba + pixel);
        if (normals) next(planes.normals + pixel);
        if (owners.places == nullptr) return;
        next(owners.places + owner);
        next(owners.halves + owner);
    };
    // work(keys of the samples seen, keys of the depths, pixel, owner, n, at).
    const auto inPixels = [&](const auto& work) {
        inOccupied(drawings,
                   [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t n, std::size_t at) {
                       const std::ptrdiff_t y = tile.nearest.y - area_.y0 + place / tile.nearest.stride;
                       const std::ptrdiff_t x = tile.nearest.x - area_.x0 + place % tile.nearest.stride;
                       work(tile.colors.keys + place, tile.nearest.keys + place, y * area_.width() + x,
                            y * owners.stride + x, n, at);
                   });
    };
    inPixels([&](const Key*, const Key*, std::ptrdiff_t pixel, std::ptrdiff_t owner, std::int32_t n,
                 std::size_t at) {
        const float* const depth = planes.depth + pixel;
        inEach(at, pixel, owner, [&](std::uint32_t* out, const auto* from) {
            for (std::int32_t i = 0; i < n; ++i)
                out[i] = std::isfinite(depth[i]) ? std::bit_cast<std::uint32_t>(from[i]) : 0;
        });
    });
    together_->reduction->join({words, count * size});
    if (!shows()) return;
    inPixels([&](const Key* seen, const Key* depths, std::ptrdiff_t pixel, std::ptrdiff_t owner,
                 std::int32_t n, std::size_t at) {
        inEach(at, pixel, owner, [&](const std::uint32_t* from, auto* to) {
            for (std::int32_t i = 0; i < n; ++i)
                if (seen[i] < noKey) to[i] = std::bit_cast<std::remove_reference_t<decltype(*to)>>(from[i]);
        });
        for (std::int32_t i = 0; i < n; ++i) {
            if (seen[i] >= noKey) continue;
            const float depth = depthOf(depths[i]);
            planes.depth[pixel + i] = depth;
            if (owners.places == nullptr) continue;
            owners.orders[owner + i] = depth;
            owners.colors[owner + i] = planes.rgba[pixel + i];
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
