#include "renderer/cloud/export/losses.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/export/cloud_points.hpp"

namespace scancast {

namespace {

bool mentions(std::string_view format, std::initializer_list<std::string_view> words) {
    return std::ranges::any_of(words, [&](std::string_view w) { return format.find(w) != format.npos; });
}

bool isLasFamily(std::string_view format) {
    return mentions(format, {"LAS ", "LAZ ", "COPC", "EPT", "Potree"});
}

std::vector<Column> columnsOf(const CloudFacts& facts) {
    std::vector<Column> columns;
    for (const KeptColumn& kept : facts.columns) columns.push_back(kept.column);
    return columns;
}

void addRounding(const CloudFile& file, const ExportOptions& options, std::vector<std::string>& losses) {
    const RoundedPoints rounded = roundedPoints(file, cloudPointsOptions(options));
    if (rounded.points == 0) return;
    losses.push_back(
        fmt::format("positions of {} points were rounded to 16 bits of their node, by at most {:.2g}, {:.2g} "
                    "and {:.2g} in x, y and "
                    "z; ingest --exact keeps them",
                    rounded.points, rounded.most.x, rounded.most.y, rounded.most.z));
}

void addNormals(const CloudFacts& facts, const std::vector<Column>& columns, const ExportOptions& options,
                std::vector<std::string>& losses) {
    const bool own = facts.sides ? facts.sides->by == KnownSides::By::File : !facts.surfels;
    if (!facts.attributes.normal || (!own && !options.estimatedNormals)) return;
    if (!own)
        losses.emplace_back("normals are those that ingest estimated; the scan has none");
    else if (!findColumns(columns, exactNormalNames, ColumnType::Float32))
        losses.emplace_back("normals were rounded, by up to a degree; ingest --exact keeps them");
}

}  // namespace

std::vector<std::string> lossesOfFormat(std::string_view format) {
    if (mentions(format, {"point format 4", "point format 5", "point format 9", "point format 10"}))
        return {"waveform packets are not kept"};
    return {};
}

std::vector<std::string> lossesOf(const CloudFile& file, const ExportOptions& options) {
    const CloudFacts& facts = file.facts();
    const auto columns = columnsOf(facts);
    std::vector<std::string> losses;
    if (facts.droppedPoints > 0)
        losses.push_back(fmt::format(
            "{} points without finite coordinates were left out when it was ingested", facts.droppedPoints));
    addRounding(file, options, losses);
    const bool color = facts.attributes.color || facts.constant.color;
    if (color && mentions(facts.format, {"LAS ", "LAZ ", "COPC", "EPT", "Potree", "text"}) &&
        !findColumns(columns, fullColorNames, ColumnType::Uint16))
        losses.emplace_back(
            facts.exact ? "colours have 8 bits a channel: the reader of this scan gives no more"
                        : "colours have 8 bits a channel, if the scan had 16; ingest --exact keeps them");
    if (columns.empty() && isLasFamily(facts.format))
        losses.emplace_back(
            "returns, GPS time, scan angles, flags and extra bytes were not kept; ingest --keep-attributes "
            "keeps them");
    if (hasNearInfrared(facts) &&
        std::ranges::none_of(columns, [](const Column& c) { return c.name == "nir"; }))
        losses.emplace_back("near infrared is not in the file; ingest --keep-attributes keeps it");
    addNormals(facts, columns, options, losses);
    if (!facts.stations.empty())
        losses.push_back(fmt::format(
            "the places of the {} stations of the scanner are not in the file, which has none for them",
            facts.stations.size()));
    if (!facts.photos.empty())
        losses.push_back(
            fmt::format("the photos of the scan ({}) are not in the file, which has no place for them",
                        facts.photos.size()));
    for (std::string& loss : lossesOfFormat(facts.format)) losses.push_back(std::move(loss));
    return losses;
}

}  // namespace scancast
