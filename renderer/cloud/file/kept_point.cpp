#include "renderer/cloud/file/kept_point.hpp"

#include <algorithm>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/exact_places.hpp"
#include "renderer/cloud/file/plane_index.hpp"

namespace scancast {

namespace {

/// What stands in a row, less what position and normal come out of.
void takeRow(const CloudFacts& facts, std::span<const std::byte> row, KeptPoint& point) {
    std::vector<Column> all;
    std::vector<ColumnType> types;
    for (const KeptColumn& kept : facts.columns) {
        all.push_back(kept.column);
        types.push_back(kept.column.type);
    }
    const auto places = placesInRow(types);
    using Three = std::optional<std::array<std::size_t, 3>>;
    const Three positions =
        facts.exact ? findColumns(all, exactPositionNames, ColumnType::Float64) : std::nullopt;
    const Three normals =
        facts.exact ? findColumns(all, exactNormalNames, ColumnType::Float32) : std::nullopt;
    const auto isOf = [](const Three& three, std::size_t c) {
        return three && std::ranges::find(*three, c) != three->end();
    };
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (isOf(positions, c) || isOf(normals, c)) continue;
        point.columns.push_back(all[c]);
        const auto at = row.begin() + std::ptrdiff_t(places[c].offset);
        point.row.insert(point.row.end(), at, at + std::ptrdiff_t(places[c].bytes));
    }
    if (!normals) return;
    glm::dvec3 normal;
    for (int a = 0; a < 3; ++a)
        normal[a] = loadLe<float>(row.data() + places[(*normals)[std::size_t(a)]].offset);
    if (normal != glm::dvec3(0)) point.normal = normal;
}

}  // namespace

Expected<KeptPoint> CloudFile::point(std::uint32_t leaf, std::span<const Sample> samples,
                                     std::size_t index) const {
    const Node& node = nodes()[leaf].node;
    const ExactPlaces places(facts(), this);
    std::vector<glm::dvec3> positions(samples.size());
    if (auto ok = places.of(leaf, node, samples, positions); !ok) return passOn(ok);
    KeptPoint point;
    point.position = positions[index];
    point.exact = places.isExact(node);
    point.precision = places.precision(node, point.position);
    if (facts().columns.empty()) return point;
    const auto rows = this->rows(leaf);
    if (!rows) return passOn(rows);
    const std::size_t bytes = rowBytes(facts().columns);
    if (rows->size() != samples.size() * bytes)
        return fail(ErrorCode::Malformed, path().string() + " has no row of values for each point of node " +
                                              std::to_string(leaf) + "; the file is damaged");
    takeRow(facts(), std::span(*rows).subspan(index * bytes, bytes), point);
    return point;
}

}  // namespace scancast
