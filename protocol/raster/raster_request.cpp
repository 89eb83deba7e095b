#include "protocol/raster/raster_request.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_values.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using Parsed = tl::expected<void, std::string>;

tl::unexpected<std::string> must(std::string what) {
    return tl::unexpected(std::move(what));
}

/// Farther from anything, neighbouring cells have no places of their own.
constexpr double farthest = 1e15;

bool isNear(double number) {
    return std::isfinite(number) && std::abs(number) <= farthest;
}

template <std::size_t n>
Parsed parseName(std::string_view text, const std::array<std::string_view, n>& names,
                 const std::function<void(std::size_t)>& set) {
    const auto at = std::ranges::find(names, text);
    if (at != names.end()) {
        set(std::size_t(at - names.begin()));
        return {};
    }
    std::string list;
    for (std::size_t i = 0; i < n; ++i) {
        if (i > 0) list += i + 1 < n ? ", " : " or ";
        list += names[i];
    }
    return must("be " + list + ", not " + quoteText(text));
}

Parsed parseWhole(std::string_view text, int& out) {
    double number = 0;
    if (auto ok = values::parseNumbers(text, std::span(&number, 1)); !ok) return ok;
    if (number != std::floor(number) || std::abs(number) > 1e6)
        return must("be a whole number, not " + quoteText(text));
    out = int(number);
    return {};
}

Parsed parseBounds(std::string_view text, RasterRequest& request) {
    std::array<double, 4> box{};
    if (auto ok = values::parseNumbers(text, box); !ok) return ok;
    if (!std::ranges::all_of(box, isNear)) return must("have numbers between -1e15 and 1e15");
    if (!(box[0] < box[2] && box[1] < box[3]))
        return must("have its least x and y before its most: MINX,MINY,MAXX,MAXY");
    request.bbox = box;
    return {};
}

Parsed parseCell(std::string_view text, RasterRequest& request) {
    double cell = 0;
    if (auto ok = values::parseNumbers(text, std::span(&cell, 1)); !ok) return ok;
    if (!(cell > 0) || !isNear(cell))
        return must("be a length above 0 and at most 1e15, not " + quoteText(text));
    request.cell = cell;
    return {};
}

constexpr std::array<RasterWord, 6> words{{
    {"bbox", "MINX,MINY,MAXX,MAXY",
     "What the raster covers, in the file's coordinates; by default all of the cloud.",
     "389400,5819700,389500,5819800"},
    {"cell", "LENGTH",
     "Side of a cell, in the file's unit; by default one that suits how far the scan's points are apart.",
     "0.5"},
    {"value", "highest|lowest|mean|count",
     "Of a cell's points: the highest one's elevation, the lowest one's, their mean, or how many they are.",
     "mean", true},
    {"fill", "CELLS",
     "Holes are closed from what is around them, where that is no farther than so many cells, 0 to 64; by "
     "default "
     "cells without a point stay without a value.",
     "3", true},
    {"compress", "deflate|none",
     "How tiles are packed; with none, an answer begins at once, for where everything stands is known "
     "before.",
     "none"},
    {"tile", "256|512", "Side of the file's tiles, in cells.", "512"},
}};

Parsed parseWord(RasterRequest& request, std::string_view word, std::string_view text) {
    if (word == "bbox") return parseBounds(text, request);
    if (word == "cell") return parseCell(text, request);
    if (word == "value")
        return parseName(text, cellValueNames, [&](std::size_t i) { request.value = CellValue(i); });
    if (word == "compress")
        return parseName(text, rasterPackingNames,
                         [&](std::size_t i) { request.packing = RasterPacking(i); });
    if (word == "fill") {
        if (auto ok = parseWhole(text, request.fill); !ok) return ok;
        if (request.fill < 0 || request.fill > mostFill) return must("lie between 0 and 64");
        return {};
    }
    if (auto ok = parseWhole(text, request.tile); !ok) return ok;
    if (request.tile != 256 && request.tile != 512) return must("be 256 or 512, not " + quoteText(text));
    return {};
}

Error wrong(std::string_view word, const std::string& why) {
    return {ErrorCode::InvalidArgument, std::string(word) + ": " + why, std::string(word)};
}

bool isViewWord(std::string_view word) {
    const auto all = viewWords();
    if (word.starts_with("param.")) return true;
    return std::ranges::any_of(all, [&](const ViewWord& known) { return known.word == word; });
}

std::string numberText(double number) {
    return nlohmann::json(number).dump();
}

}  // namespace

std::span<const RasterWord> rasterWords() {
    return words;
}

bool isWordOf(RasterKind kind, std::string_view word) {
    static constexpr std::array<std::string_view, 6> points{"classes",  "clip",          "clips",
                                                            "outliers", "behindMirrors", "filter"};
    static constexpr std::array<std::string_view, 13> notOfOrthophotos{
        "eye",  "target", "up",    "viewMatrix", "projection", "fov",        "viewHeight",
        "near", "far",    "width", "height",     "quality",    "subsampling"};
    if (kind == RasterKind::Elevation) return std::ranges::find(points, word) != points.end();
    return isViewWord(word) && std::ranges::find(notOfOrthophotos, word) == notOfOrthophotos.end();
}

Expected<RasterRequest> rasterRequestOf(RasterKind kind, const WordValues& given) {
    RasterRequest request;
    request.kind = kind;
    const bool isElevation = kind == RasterKind::Elevation;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const auto& [word, text] = given[i];
        for (std::size_t j = 0; j < i; ++j)
            if (given[j].first == word) return tl::unexpected(wrong(word, "is given twice"));
        const auto own = std::ranges::find(words, word, &RasterWord::word);
        if (own != words.end()) {
            if (own->elevationOnly && !isElevation)
                return tl::unexpected(wrong(word, "is of elevation (dem.tif); an orthophoto has none of it"));
            if (auto ok = parseWord(request, word, text); !ok)
                return tl::unexpected(wrong(word, "must " + ok.error()));
            continue;
        }
        if (isWordOf(kind, word)) {
            request.view.emplace_back(word, text);
            continue;
        }
        if (word == "with")
            return tl::unexpected(
                wrong(word, "elevations are those of one cloud at a time; ask for each by itself"));
        if (isViewWord(word))
            return tl::unexpected(wrong(
                word, isElevation ? "says nothing of elevation; of a view's words, those count that say "
                                    "which points are looked at: classes, filter, clip, clips, outliers, "
                                    "behindMirrors"
                                  : "is not the request's to say: an orthophoto is seen from straight "
                                    "above, and as large as bbox and cell make it"));
        std::vector<std::string_view> known;
        for (const RasterWord& one : words)
            if (isElevation || !one.elevationOnly) known.push_back(one.word);
        for (const ViewWord& one : viewWords())
            if (isWordOf(kind, one.word)) known.push_back(one.word);
        return fail(ErrorCode::InvalidArgument, unknownName(word, word, known), word);
    }
    return request;
}

WordValues wordsOf(const RasterRequest& request) {
    const RasterRequest usual;
    WordValues list;
    if (request.bbox) {
        std::string text;
        for (const double number : *request.bbox) text += (text.empty() ? "" : ",") + numberText(number);
        list.emplace_back("bbox", text);
    }
    if (request.cell) list.emplace_back("cell", numberText(*request.cell));
    if (request.value != usual.value) list.emplace_back("value", name(request.value));
    if (request.fill != usual.fill) list.emplace_back("fill", std::to_string(request.fill));
    if (request.packing != usual.packing) list.emplace_back("compress", name(request.packing));
    if (request.tile != usual.tile) list.emplace_back("tile", std::to_string(request.tile));
    WordValues view = request.view;
    std::ranges::sort(view);
    list.insert(list.end(), view.begin(), view.end());
    return list;
}

}  // namespace scancast
