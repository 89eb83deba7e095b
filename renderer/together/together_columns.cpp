#include "renderer/together/together_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "protocol/nearest_name.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "renderer/together/together.hpp"
#include "renderer/together/together_store.hpp"

namespace scancast {
namespace {

/// The same for styles that ask the same of columns.
std::string wordsOf(const Style& style) {
    std::string words;
    if (style.color == ColorSource::Column) {
        const auto ends = style.range.value_or(std::array{0.0, 0.0});
        words = fmt::format("{:a} {:a} {} ", ends[0], ends[1], style.column.size());
        words.append(style.column);
    }
    for (const ColumnRange& range : style.filter) {
        words += fmt::format("; {:a} {:a} {} {} {} ", range.low.value_or(0), range.high.value_or(0),
                             range.low.has_value(), range.high.has_value(), range.column.size());
        words.append(range.column);
    }
    return words;
}

}  // namespace

Style withColumnEnds(const Cloud& cloud, Style style) {
    if (!cloud.together || style.color != ColorSource::Column || style.range) return style;
    for (std::size_t i = 0; i < cloud.together->members.size(); ++i) {
        if (!cloud.together->stores[i]) continue;
        const auto ends = naturalEnds(*cloud.together->members[i].cloud, style.column);
        if (!ends) continue;
        style.range = style.range ? std::array{std::min(style.range->at(0), ends->at(0)),
                                               std::max(style.range->at(1), ends->at(1))}
                                  : *ends;
    }
    return style;
}

Expected<std::shared_ptr<const Octree>> picturedOctreeOf(const Cloud& cloud, const Style& asked) {
    if (!cloud.together) return picturedOctree(cloud, asked);
    if (asked.filter.empty() && asked.color != ColorSource::Column) return nullptr;
    if (cloud.octree.nodes().empty()) return nullptr;
    const Style style = withColumnEnds(cloud, asked);
    const std::string words = wordsOf(style);
    DerivedOctrees& derived = cloud.octree.store().derived();
    if (auto known = derived.find(words)) return known;
    auto pictured = std::make_shared<Together>(*cloud.together);
    for (std::size_t i = 0; i < pictured->members.size(); ++i) {
        auto& store = pictured->stores[i];
        if (!store) continue;
        const TogetherMember& member = pictured->members[i];
        auto octree = picturedOctree(*member.cloud, *store, style);
        if (!octree) {
            Error error = octree.error();
            error.message = quoteText(member.name) + ": " + error.message;
            return tl::unexpected(std::move(error));
        }
        // The octree of one is what keeps its store; only that is needed here.
        if (*octree) store = (*octree)->sharedStore();
    }
    auto counted = pictured->count(cloud.octree.nodes().size());
    if (!counted) return passOn(std::move(counted));
    pictured->counted = std::move(*counted);
    std::vector<Node> nodes(cloud.octree.nodes().begin(), cloud.octree.nodes().end());
    return derived.keep(words,
                        std::make_shared<const Octree>(std::move(nodes), togetherStore(std::move(pictured))));
}

}  // namespace scancast
