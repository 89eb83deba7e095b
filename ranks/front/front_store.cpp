#include "ranks/front/front_store.hpp"

#include <algorithm>
#include <utility>

namespace scancast {
namespace {

std::vector<Expected<SampleRun>> unavailable(std::size_t nodes) {
    return std::vector<Expected<SampleRun>>(
        nodes, fail(ErrorCode::Unavailable, "The ranks that draw this cloud are not there at present."));
}

}  // namespace

std::optional<SampleRun> FrontStore::find(std::uint32_t node) {
    return byRanks() ? SampleRun{} : whole_->find(node);
}

std::vector<std::optional<SampleRun>> FrontStore::findAll(std::span<const std::uint32_t> nodes) {
    if (!byRanks()) return whole_->findAll(nodes);
    return std::vector<std::optional<SampleRun>>(nodes.size(), SampleRun{});
}

Expected<SampleRun> FrontStore::load(std::uint32_t node, std::stop_token stop) {
    return whole_->load(node, std::move(stop));
}

std::vector<Expected<SampleRun>> FrontStore::loadAll(std::span<const std::uint32_t> nodes,
                                                     std::stop_token stop) {
    // Half of what a picture may hold: the other half may be here already, and other cuts of the picture follow.
    if (file_->by == DrawnBy::FrontMeanwhile && samplesIn(nodes) > whole_->capacity() / 2 &&
        !clouds_->waitForRanks(*file_, stop))
        return unavailable(nodes.size());
    const std::stop_token changes = clouds_->untilChanged(*file_);
    if (byRanks()) return std::vector<Expected<SampleRun>>(nodes.size(), SampleRun{});
    // What is being loaded when they come back they load, too, and sooner.
    std::stop_source either;
    const auto stops = [&either] { either.request_stop(); };
    const std::stop_callback wanted(stop, stops);
    const std::stop_callback changed(changes, stops);
    auto loaded = whole_->loadAll(nodes, either.get_token());
    const auto isCancelled = [](const auto& run) { return !run && run.error().code == ErrorCode::Cancelled; };
    if (!stop.stop_requested() && std::ranges::any_of(loaded, isCancelled)) return unavailable(nodes.size());
    return loaded;
}

void FrontStore::request(std::uint64_t requester, std::vector<BlockRequest> requests) {
    if (byRanks()) requests.clear();  // and what was asked for before is moot
    whole_->request(requester, std::move(requests));
}

std::uint64_t FrontStore::capacity() const {
    const std::uint64_t ofRanks = file_->capacity;
    return file_->by == DrawnBy::FrontAlone || ofRanks == 0 ? whole_->capacity() : ofRanks;
}

std::uint64_t FrontStore::samplesIn(std::span<const std::uint32_t> nodes) const {
    std::uint64_t samples = 0;
    for (const std::uint32_t node : nodes) samples += cloud_->nodes()[node].node.sampleCount;
    return samples;
}

}  // namespace scancast
