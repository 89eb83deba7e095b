#include "renderer/cloud/distance/epoch_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "files/input_file.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/crs_units.hpp"

namespace scancast {

namespace {

constexpr std::size_t longestName = 32;  // as LAS has room for

Expected<InputFile> openEpoch(const std::filesystem::path& path) {
    auto file = InputFile::open(path);
    if (!file) return file;
    if (isCloudFile(*file)) return file;
    const std::string stem = path.stem().string();
    return fail(
        ErrorCode::Unsupported,
        fmt::format("{} is no cloud file, and distances are measured between cloud files; make one of "
                    "it first: scancast ingest {} -o {}.scan --exact",
                    path.string(), path.string(), stem.empty() ? "cloud" : stem));
}

bool isOneFile(const InputFile& a, const InputFile& b) {
    return a.identity().device == b.identity().device && a.identity().inode == b.identity().inode;
}

std::string crsOf(const CloudFacts& facts) {
    const auto name = crsName(facts.crsWkt, facts.crsEpsg);
    return name.empty() ? "a CRS without a name" : name;
}

/// Lengths in one unit along all axes, or nothing that says otherwise.
Expected<void> checkUnits(const std::string& name, const CrsUnits& units) {
    if (units.kind == CrsUnits::Kind::Geographic)
        return fail(
            ErrorCode::Unsupported,
            fmt::format("{} is in degrees, between which there are no distances; bring both epochs into "
                        "a projected system first",
                        name));
    if (std::abs(units.heightScale() - 1) > 1e-3)
        return fail(
            ErrorCode::Unsupported,
            fmt::format("{} has x and y in {} and heights in {}; bring both epochs into one unit first", name,
                        units.unit, units.verticalUnit));
    return {};
}

/// Whatever their systems are: between numbers in two units there are no distances. What one side does not say is no difference.
Expected<void> compareUnits(const DistanceOptions& options, const CrsUnits& after, const CrsUnits& before) {
    const auto differ = [](double a, double b) { return a > 0 && b > 0 && std::abs(a / b - 1) > 1e-9; };
    const bool heights = differ(after.verticalMetres, before.verticalMetres);
    if (!heights && !differ(after.metres, before.metres)) return {};
    return fail(ErrorCode::Unsupported,
                fmt::format("{} has {} in {}, {} in {}; bring both epochs into one unit first",
                            options.after.string(), heights ? "heights" : "x and y",
                            heights ? after.verticalUnit : after.unit, options.before.string(),
                            heights ? before.verticalUnit : before.unit));
}

Expected<void> compareCrs(const DistanceOptions& options, EpochPair& pair) {
    const CloudFacts& after = pair.after->facts();
    const CloudFacts& before = pair.before->facts();
    const auto meaning = crsMeaning(after.crsWkt, after.crsEpsg);
    const auto other = crsMeaning(before.crsWkt, before.crsEpsg);
    const std::string a = options.after.string(), b = options.before.string();
    if (!meaning && !other) return {};
    if (!meaning || !other) {
        pair.remarks.push_back(
            fmt::format("{} does not say its coordinate reference system; that of {}, {}, is taken for it",
                        meaning ? b : a, meaning ? a : b, crsOf(meaning ? after : before)));
        return {};
    }
    switch (compare(*meaning, *other)) {
        case CrsRelation::Same:
            break;
        case CrsRelation::Different:
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("{} is in {}, {} in {}: between different coordinate reference systems "
                                    "there are no distances. Bring both scans into one and ingest them again",
                                    a, crsOf(after), b, crsOf(before)),
                        "before");
        case CrsRelation::Unclear:
            pair.remarks.push_back(fmt::format(
                "{} is in {}, {} in {}; nothing proves that these are the same, and they are taken for it", a,
                crsOf(after), b, crsOf(before)));
    }
    return {};
}

}  // namespace

Expected<EpochPair> openEpochs(const DistanceOptions& options) {
    auto after = openEpoch(options.after);
    if (!after) return passOn(after);
    auto before = openEpoch(options.before);
    if (!before) return passOn(before);
    if (isOneFile(*after, *before))
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} and {} are one file: every distance would be 0", options.after.string(),
                                options.before.string()),
                    "before");
    for (const auto* input : {&options.after, &options.before}) {
        std::error_code ignored;
        if (std::filesystem::equivalent(*input, options.output, ignored))
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("{} is both input and output", options.output.string()), "output");
    }
    EpochPair pair;
    auto opened = CloudFile::open(std::move(*after));
    if (!opened) return passOn(opened);
    pair.after = std::move(*opened);
    opened = CloudFile::open(std::move(*before));
    if (!opened) return passOn(opened);
    pair.before = std::move(*opened);
    std::vector<CrsUnits> both;
    for (const auto& file : {pair.after, pair.before}) {
        both.push_back(crsUnits(file->facts().crsWkt, file->facts().crsEpsg));
        if (auto ok = checkUnits(file->path().string(), both.back()); !ok) return passOn(ok);
        if (pair.unit.empty()) pair.unit = both.back().unit;
    }
    if (auto ok = compareUnits(options, both[0], both[1]); !ok) return passOn(ok);
    if (auto ok = compareCrs(options, pair); !ok) return passOn(ok);
    return pair;
}

Expected<void> checkColumnName(const std::string& name, const CloudFacts& facts) {
    const auto isWord = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    const auto refuse = [](std::string why) {
        return fail(ErrorCode::InvalidArgument, std::move(why), "name");
    };
    if (name.empty() || name.size() > longestName || !std::ranges::all_of(name, isWord))
        return refuse(fmt::format(
            "The column's name is made of letters, digits and _, {} at most; distance_2024 would do",
            longestName));
    std::vector<std::string_view> taken{"intensity", "classification"};
    for (const ThreeNames* names : {&fullColorNames, &exactNormalNames, &exactPositionNames})
        taken.insert(taken.end(), names->begin(), names->end());
    if (std::ranges::find(taken, name) != taken.end())
        return refuse(fmt::format("{} means something else already; give another --name", name));
    const bool isThere =
        std::ranges::any_of(facts.columns, [&](const KeptColumn& kept) { return kept.column.name == name; });
    if (isThere)
        return refuse(
            fmt::format("The cloud has a column {} already; give another --name, such as {}_2", name, name));
    // As the writer asks in the end, so that no work is done for a file that nobody could open.
    CloudFacts with = facts;
    with.photos.clear();
    with.columns.push_back({.column = {.name = name, .type = ColumnType::Float32, .description = {}}});
    with.companions.push_back(innerPlane(with.columns.back().column));
    if (const auto json = printFacts(with, programName()); !json)
        return refuse("The cloud cannot have another column: " + json.error().message);
    return {};
}

}  // namespace scancast
