#include "renderer/residency/node_runs.hpp"

namespace scancast {

bool NodeRuns::has(std::uint32_t node) {
    const auto [at, isNew] = found_.try_emplace(node);
    if (isNew) at->second.run = octree_.store().find(node);
    return at->second.run.has_value();
}

bool NodeRuns::damaged(std::uint32_t node) const {
    const auto at = found_.find(node);
    return (at != found_.end() && at->second.damaged) || octree_.store().damaged(node);
}

Expected<void> NodeRuns::load(const std::vector<std::uint32_t>& nodes, const std::stop_token& stop) {
    std::vector<std::uint32_t> absent;
    for (const std::uint32_t node : nodes)
        if (!has(node) && !found_.at(node).damaged) absent.push_back(node);
    auto loaded = octree_.store().loadAll(absent, stop);
    for (std::size_t i = 0; i < absent.size(); ++i) {
        Found& found = found_.at(absent[i]);
        if (loaded[i]) {
            found.run = std::move(*loaded[i]);
        } else if (loaded[i].error().code == ErrorCode::Cancelled) {
            return tl::unexpected(std::move(loaded[i].error()));
        } else {
            found.damaged = true;
        }
    }
    return {};
}

}  // namespace scancast
