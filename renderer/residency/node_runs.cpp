#include "renderer/residency/node_runs.hpp"

namespace scancast {

NodeRuns::Found& NodeRuns::found(std::uint32_t node) {
    std::uint32_t& place = places_[node];
    if (place == notAsked) {
        place = static_cast<std::uint32_t>(found_.size());
        found_.emplace_back();
    }
    return found_[place];
}

void NodeRuns::ask(std::span<const std::uint32_t> nodes) {
    std::vector<std::uint32_t> unknown;
    unknown.reserve(nodes.size());
    found_.reserve(found_.size() + nodes.size());
    for (const std::uint32_t node : nodes) {
        if (places_[node] != notAsked) continue;
        found(node);
        unknown.push_back(node);
    }
    auto runs = octree_.store().findAll(unknown);
    for (std::size_t i = 0; i < unknown.size(); ++i) found(unknown[i]).run = std::move(runs[i]);
}

bool NodeRuns::has(std::uint32_t node) {
    const bool isNew = places_[node] == notAsked;
    Found& known = found(node);
    if (isNew) known.run = octree_.store().find(node);
    return known.run.has_value();
}

bool NodeRuns::damaged(std::uint32_t node) const {
    const bool triedHere = places_[node] != notAsked && found_[places_[node]].damaged;
    return triedHere || octree_.store().damaged(node);
}

Expected<void> NodeRuns::load(std::span<const std::uint32_t> nodes, const std::stop_token& stop) {
    ask(nodes);
    std::vector<std::uint32_t> absent;
    for (const std::uint32_t node : nodes)
        if (!has(node) && !found(node).damaged) absent.push_back(node);
    if (absent.empty()) return {};
    auto loaded = octree_.store().loadAll(absent, stop);
    for (std::size_t i = 0; i < absent.size(); ++i) {
        Found& known = found(absent[i]);
        if (loaded[i]) {
            known.run = std::move(*loaded[i]);
        } else if (loaded[i].error().code == ErrorCode::Cancelled) {
            return tl::unexpected(std::move(loaded[i].error()));
        } else if (loaded[i].error().code == ErrorCode::Unavailable) {
            // Clients are told; where the cloud comes from is for who runs the server.
            return fail(
                ErrorCode::Unavailable,
                "Points of this cloud cannot be fetched at present from where it is kept; try again later.");
        } else {
            known.damaged = true;
        }
    }
    return {};
}

}  // namespace scancast
