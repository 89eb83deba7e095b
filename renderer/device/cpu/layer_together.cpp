// A layer drawn together with other devices: every pass over all tiles, then what others have in a device's rows of the screen
// goes to that device (packed_spans.hpp), and it takes the smallest keys, or adds; where a later pass looks at them, everybody gets
// the smallest keys. In the end each device has pixels of its rows. Tiles are each device's own, as they follow its samples.
#include <algorithm>
#include <atomic>
#include <bit>
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
/// Of a tile, that one thread goes through at a time.
constexpr std::int32_t rowsOfPiece = 48;
/// What is agreed on beside which spans there are.
enum Note : std::size_t { Magnitudes, notes };

static_assert(tileSteps == OccupiedSpans::length, "a span is one tile's");

float depthOf(Key key) {
    return std::bit_cast<float>(static_cast<std::int32_t>(key >> 32));
}

std::size_t sumPlanes(const SplatPass& pass) {
    return colorPlanes + (pass.sumNormals ? normalPlanes : 0);
}

/// Where the tile's first sum lies that belongs to a place in its keys.
std::size_t sumAt(const KeyTile& tile, std::ptrdiff_t place) {
    return static_cast<std::size_t>(guard * std::int64_t{tile.stride} + guard + place);
}

/// Of a tile the rows [y0, y1) of its own.
KeyTile rowsOfTile(KeyTile tile, std::int32_t y0, std::int32_t y1) {
    const std::ptrdiff_t skipped = std::ptrdiff_t{y0} * tile.stride;
    tile.keys += skipped;
    if (tile.visible != nullptr) tile.visible += skipped;
    if (tile.sums != nullptr) tile.sums += skipped;
    tile.y += y0;
    tile.height = y1 - y0;
    return tile;
}

}  // namespace

/// work(tile, rows): pieces of tiles, whose rows are the layer's.
template <class Work>
void Layer::inPieces(const std::vector<TileDrawing>& drawings, const Rows& rows, const Work& work) const {
    struct Piece {
        const TileDrawing* tile;
        Rows rows;
    };
    std::vector<Piece> pieces;
    for (const TileDrawing& tile : drawings) {
        const std::int32_t top = tile.empty.y - area_.y0;
        const Rows part = rows.intersect({top, top + tile.empty.height});
        for (std::int32_t y = part.y0; y < part.y1; y += rowsOfPiece)
            pieces.push_back({&tile, {y, std::min(part.y1, y + rowsOfPiece)}});
    }
    workers_.inParallel(static_cast<int>(pieces.size()), [&](int i) {
        const Piece& piece = pieces[static_cast<std::size_t>(i)];
        work(*piece.tile, piece.rows);
    });
}

/// work(tile, place, x, y, count, number): occupied spans, their first pixel's place in planes of the tile's geometry, from the
/// tile's pixel (0, 0) on, and in the layer.
template <class Work>
void Layer::inSpans(const std::vector<TileDrawing>& drawings, const OccupiedSpans& spans, const Rows& rows,
                    const Work& work) const {
    inPieces(drawings, rows, [&](const TileDrawing& tile, const Rows& part) {
        const std::int32_t left = tile.empty.x - area_.x0, top = tile.empty.y - area_.y0;
        for (std::int32_t y = part.y0; y < part.y1; ++y) {
            const std::ptrdiff_t row = std::ptrdiff_t{y - top} * tile.empty.stride;
            spans.inRow(y, left, left + tile.empty.width,
                        [&](std::int32_t x, std::int32_t count, std::size_t number) {
                            work(tile, row + (x - left), x, y, count, number);
                        });
        }
    });
}

/// What this device has in rows that others see goes to these, `planes` elements of type T a pixel: pack(tile, place, x, y, count,
/// to). What others have in rows that it sees is taken: take(tile, place, x, y, count, from).
template <class T, class Pack, class Take>
void Layer::toOwners(const std::vector<TileDrawing>& drawings, std::size_t planes, const Pack& pack,
                     const Take& take) {
    PackedSpans& packed = together_->packed;
    const std::uint32_t number = together_->reduction->number();
    const std::size_t elements = planes * spanLength;
    packed.occupied.settle();
    T* const out = packed.room<T>(packed.occupied.before(area_.height()) * elements);
    const Rows seen = seenBy(number), own = rowsOf(number);
    // Those in the middle nobody else sees.
    Rows lone = own;
    for (std::uint32_t d = 0; d < together_->reduction->devices(); ++d) {
        const Rows both = d != number ? seenBy(d).intersect(own) : Rows{};
        if (both.count() == 0) continue;
        if (d < number)
            lone.y0 = std::max(lone.y0, both.y1);
        else
            lone.y1 = std::min(lone.y1, both.y0);
    }
    if (lone.count() == 0) lone = {area_.height(), area_.height()};
    for (const Rows& rows : {Rows{0, lone.y0}, Rows{lone.y1, area_.height()}}) {
        inSpans(
            drawings, packed.occupied, rows,
            [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t x, std::int32_t y,
                std::int32_t count, std::size_t at) { pack(tile, place, x, y, count, out + at * elements); });
    }
    packed.exchange(
        *together_->reduction, elements * sizeof(T), [&](std::uint32_t d) { return seenBy(d); },
        [&](std::uint32_t) { return seen; },
        [&](std::uint32_t, const OccupiedSpans& theirs, const std::byte* in) {
            together_->all.add(theirs);
            inSpans(drawings, theirs, seen,
                    [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t x, std::int32_t y,
                        std::int32_t count, std::size_t at) {
                        take(tile, place, x, y, count, reinterpret_cast<const T*>(in) + at * elements);
                    });
        });
}

void Layer::leastToOwners(const std::vector<TileDrawing>& drawings) {
    together_->all = together_->packed.occupied;
    toOwners<Key>(
        drawings, 1,
        [](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
           Key* to) { put(tile.target.keys + place, count, to); },
        [](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
           const Key* from) {
            Key* const keys = tile.target.keys + place;
            inSpan(count, [&](std::size_t i) { keys[i] = std::min(keys[i], from[i]); });
        });
}

/// After their owners have them.
void Layer::leastToEverybody(const std::vector<TileDrawing>& drawings) {
    PackedSpans& packed = together_->packed;
    packed.occupied = together_->all;
    packed.occupied.settle();
    const Rows own = rowsOf(together_->reduction->number());
    Key* const out = packed.room<Key>(packed.occupied.before(area_.height()) * spanLength);
    inSpans(drawings, packed.occupied, own,
            [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
                std::size_t at) { put(tile.target.keys + place, count, out + at * spanLength); });
    packed.exchange(
        *together_->reduction, spanLength * sizeof(Key), [&](std::uint32_t) { return own; },
        [&](std::uint32_t d) { return rowsOf(d); },
        [&](std::uint32_t d, const OccupiedSpans& theirs, const std::byte* in) {
            inSpans(drawings, theirs, rowsOf(d),
                    [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t,
                        std::int32_t count, std::size_t at) {
                        std::copy_n(reinterpret_cast<const Key*>(in) + at * spanLength, count,
                                    tile.target.keys + place);
                    });
        });
}

void Layer::addToOwners(std::vector<TileDrawing>& drawings, const SplatPass& pass, std::uint64_t magnitudes) {
    const std::size_t planes = sumPlanes(pass);
    // work(where in all planes of the tile, where in the span), of each plane.
    const auto inPlanes = [planes](const TileDrawing& tile, std::ptrdiff_t place, const auto& work) {
        std::size_t at = sumAt(tile.target, place);
        for (std::size_t p = 0; p < planes; ++p, at += static_cast<std::size_t>(tile.target.planeSize))
            work(at, p * spanLength);
    };
    // No device's weights take more bits than all of theirs together; no other sum is more than 255 times as much.
    if (std::bit_width(magnitudes) + 8 + std::bit_width(together_->reduction->devices()) < 32) {
        toOwners<std::int32_t>(
            drawings, planes,
            [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
                std::int32_t* to) {
                inPlanes(tile, place, [&](std::size_t at, std::size_t plane) {
                    put(tile.memory->sums.data() + at, count, to + plane);
                });
            },
            [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
                const std::int32_t* from) {
                inPlanes(tile, place, [&](std::size_t at, std::size_t plane) {
                    std::int32_t* const sums = tile.memory->sums.data() + at;
                    inSpan(count, [&](std::size_t i) { sums[i] += from[plane + i]; });
                });
            });
        return;
    }
    for (TileDrawing& tile : drawings)
        tile.memory->wide.resize(planes * static_cast<std::size_t>(tile.target.planeSize));
    toOwners<std::int64_t>(
        drawings, planes,
        [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
            std::int64_t* to) {
            inPlanes(tile, place, [&](std::size_t at, std::size_t plane) {
                put(tile.memory->wide.data() + at, count, to + plane);
                for (std::int32_t i = 0; i < count; ++i) {
                    const std::int32_t narrow = tile.memory->sums[at + std::size_t(i)];
                    to[plane + std::size_t(i)] += plane < colorPlanes * spanLength
                                                      ? std::int64_t{static_cast<std::uint32_t>(narrow)}
                                                      : std::int64_t{narrow};
                }
            });
        },
        [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t, std::int32_t, std::int32_t count,
            const std::int64_t* from) {
            inPlanes(tile, place, [&](std::size_t at, std::size_t plane) {
                std::int64_t* const sums = tile.memory->wide.data() + at;
                inSpan(count, [&](std::size_t i) { sums[i] += from[plane + i]; });
            });
        });
}

/// Of a tile, while it is in the core's cache: where this pass left anything, and how much.
void Layer::markPass(const TileDrawing& at, const SplatPass& pass, std::atomic<std::uint64_t>& magnitudes) {
    OccupiedSpans& occupied = together_->packed.occupied;
    const KeyTile& tile = at.target;
    const std::int32_t left = tile.x - area_.x0, right = left + tile.width;
    std::uint64_t bits = 0;
    for (std::int32_t y = 0; y < tile.height; ++y) {
        const std::int32_t row = tile.y - area_.y0 + y;
        const std::ptrdiff_t place = std::ptrdiff_t{y} * tile.stride;
        if (pass.reduction != Reduction::Sum) {
            const Key* const keys = tile.keys + place;
            occupied.mark(row, left, right, [&](std::int32_t x) { return keys[x - left] < noKey; });
            continue;
        }
        const std::size_t first = sumAt(tile, place);
        const std::int32_t* const weights = at.memory->sums.data() + first;
        const std::int64_t* const emptied =
            at.memory->wide.empty() ? nullptr : at.memory->wide.data() + first;
        if (emptied != nullptr) bits |= wideBits;
        occupied.mark(row, left, right, [&](std::int32_t x) {
            bits |= static_cast<std::uint32_t>(weights[x - left]);
            return weights[x - left] != 0 || (emptied != nullptr && emptied[x - left] != 0);
        });
    }
    magnitudes.fetch_or(bits, std::memory_order_relaxed);
}

/// After the first pass also on whose rows are whose. False: the picture is no longer wanted.
bool Layer::agree(std::uint64_t& magnitudes) {
    std::vector<std::uint64_t> words(notes);
    words[Magnitudes] = magnitudes;
    OccupiedSpans& all = together_->all;
    if (bands_.empty()) {
        const auto own = together_->packed.occupied.words();
        words.insert(words.end(), own.begin(), own.end());
    }
    if (!together_->reduction->agree(words)) return false;
    magnitudes = words[Magnitudes];
    if (!bands_.empty()) return true;
    all.begin(area_.width(), rows());
    std::copy(words.begin() + notes, words.end(), all.words().begin());
    bands_.divide(all, area_.width(), together_->reduction->devices());
    return true;
}

void Layer::reducePass(std::vector<TileDrawing>& drawings, const SplatPass& pass, bool last,
                       std::uint64_t magnitudes) {
    if (pass.reduction == Reduction::Sum) return addToOwners(drawings, pass, magnitudes);
    leastToOwners(drawings);
    // Of the samples seen, everybody colours his own.
    if (!last || passes_.bySample()) leastToEverybody(drawings);
}

/// Everybody has resolved what samples of his own are seen; where there are others, he has background.
void Layer::joinSamples(const std::vector<TileDrawing>& drawings, const Planes& planes,
                        const Owners& owners) {
    const bool normals = passes_.resolve.normals && planes.normals != nullptr;
    const bool smoothed = owners.places != nullptr;
    together_->all = together_->packed.occupied;
    // work(place in the span, pixels): of each plane that travels, from its pixel, or owner, on; colours first.
    const auto inEach = [&](std::int32_t x, std::int32_t y, const auto& work) {
        const std::ptrdiff_t pixel = std::ptrdiff_t{y} * area_.width() + x;
        std::size_t at = 0;
        const auto next = [&](auto* pixels) {
            work(at, pixels);
            at += spanLength;
        };
        next(planes.rgba + pixel);
        if (normals) next(planes.normals + pixel);
        if (!smoothed) return;
        const std::ptrdiff_t owner = std::ptrdiff_t{y} * owners.stride + x;
        next(owners.places + owner);
        next(owners.halves + owner);
    };
    toOwners<std::uint32_t>(
        drawings, 1 + std::size_t{normals} + (smoothed ? 2 : 0),
        [&](const TileDrawing&, std::ptrdiff_t, std::int32_t x, std::int32_t y, std::int32_t count,
            std::uint32_t* to) {
            inEach(x, y, [&](std::size_t at, const auto* pixels) { put(pixels, count, to + at); });
            const float* const depth = planes.depth + std::ptrdiff_t{y} * area_.width() + x;
            // A colour of 0 says that there is no sample of his.
            for (std::int32_t i = 0; i < count; ++i)
                if (depth[i] == std::numeric_limits<float>::infinity()) to[i] = 0;
        },
        [&](const TileDrawing& tile, std::ptrdiff_t place, std::int32_t x, std::int32_t y, std::int32_t count,
            const std::uint32_t* from) {
            inEach(x, y, [&](std::size_t at, auto* pixels) {
                for (std::int32_t i = 0; i < count; ++i)
                    if (from[i] != 0)
                        pixels[i] = std::bit_cast<std::remove_reference_t<decltype(*pixels)>>(
                            from[at + static_cast<std::size_t>(i)]);
            });
            for (std::int32_t i = 0; i < count; ++i) {
                if (from[i] == 0) continue;
                const float depth = depthOf(tile.nearest.keys[place + i]);
                planes.depth[std::ptrdiff_t{y} * area_.width() + x + i] = depth;
                if (!smoothed) continue;
                const std::ptrdiff_t owner = std::ptrdiff_t{y} * owners.stride + x + i;
                owners.orders[owner] = depth;
                owners.colors[owner] = from[i];
            }
        });
}

void Layer::resolveTogether(std::vector<TileDrawing>& drawings, const FrameDrawing& frame) {
    const bool bySample = passes_.bySample();
    Planes planes = frame.planes;
    if (planes.depth == nullptr && bySample)
        planes.depth = grown(together_->depth, static_cast<std::size_t>(area_.width()) *
                                                   static_cast<std::size_t>(area_.height()));
    OccupiedSpans& occupied = together_->packed.occupied;
    occupied.begin(area_.width(), rows());
    const Rows resolved = bySample ? rows() : seenBy(together_->reduction->number());
    inPieces(drawings, resolved, [&](const TileDrawing& tile, const Rows& part) {
        const std::int32_t top = tile.nearest.y - area_.y0, left = tile.nearest.x - area_.x0;
        const std::int32_t y0 = part.y0 - top, y1 = part.y1 - top;
        const std::vector<std::int64_t>& wide = tile.memory->wide;
        resolveTile(rowsOfTile(tile.nearest, y0, y1), rowsOfTile(tile.colors, y0, y1), frame.passes.back(),
                    wide.empty()
                        ? nullptr
                        : wide.data() + sumAt(tile.nearest, std::ptrdiff_t{y0} * tile.nearest.stride),
                    planes, frame.owners);
        if (!bySample) return;
        for (std::int32_t y = part.y0; y < part.y1; ++y) {
            const float* const depth = planes.depth + std::ptrdiff_t{y} * area_.width();
            occupied.mark(y, left, left + tile.nearest.width,
                          [&](std::int32_t x) { return depth[x] < std::numeric_limits<float>::infinity(); });
        }
    });
    if (bySample) joinSamples(drawings, planes, frame.owners);
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
    double reducing = 0, waiting = 0;
    auto start = workers_.now();
    const auto spent = [&] {
        const double ms = workers_.millisecondsSince(start);
        start = workers_.now();
        return ms;
    };
    for (std::size_t p = 0; p < frame.passes.size(); ++p) {
        const SplatPass& pass = frame.passes[p];
        together_->packed.occupied.begin(area_.width(), rows());
        std::atomic<std::uint64_t> found{0};
        workers_.inParallel(static_cast<int>(drawings.size()), [&](int i) {
            TileDrawing& at = drawings[static_cast<std::size_t>(i)];
            at.pass = p;
            beginPass(at, pass);
            drawRuns(at, pass);
            markPass(at, pass, found);
        });
        stats.add(nameOf(pass), spent());
        std::uint64_t magnitudes = found;
        if (!agree(magnitudes)) return;
        waiting += spent();
        reducePass(drawings, pass, p + 1 == frame.passes.size(), magnitudes);
        reducing += spent();
    }
    resolveTogether(drawings, frame);
    stats.add("resolve", spent());
    stats.add("wait", waiting);
    stats.add("reduce", reducing);
}

}  // namespace scancast::cpu
