#include "renderer/residency/request_queue.hpp"

#include <algorithm>

namespace scancast {

void RequestQueue::set(std::uint64_t cloud, std::uint64_t requester, std::vector<BlockRequest> requests) {
    const Requester key{cloud, requester};
    if (requests.empty()) {
        if (lists_.erase(key) > 0) std::erase(turns_, key);
        return;
    }
    std::sort(requests.begin(), requests.end(), [](const BlockRequest& a, const BlockRequest& b) {
        return a.urgency != b.urgency ? a.urgency < b.urgency : a.node > b.node;
    });
    if (requests.size() > mostRequests) requests.erase(requests.begin(), requests.end() - mostRequests);
    std::list<Requester> turn;
    if (!lists_.contains(key)) {
        turn.push_back(key);
        if (turns_.size() == mostRequesters) {
            lists_.erase(turns_.back());
            turns_.pop_back();
        }
    }
    lists_.insert_or_assign(key,
                            std::move(requests));  // the last that may fail: nobody has one without the other
    turns_.splice(turns_.end(), turn);
}

std::optional<RequestQueue::Next> RequestQueue::next() {
    if (turns_.empty()) return std::nullopt;
    const Requester turn = turns_.front();
    std::vector<BlockRequest>& requests = lists_.at(turn);
    const Next next{turn.first, requests.back().node};
    requests.pop_back();
    if (requests.empty()) {
        lists_.erase(turn);
        turns_.pop_front();
    } else {
        turns_.splice(turns_.end(), turns_, turns_.begin());
    }
    return next;
}

void RequestQueue::forget(std::uint64_t cloud) {
    std::erase_if(lists_, [&](const auto& entry) { return entry.first.first == cloud; });
    std::erase_if(turns_, [&](const Requester& key) { return key.first == cloud; });
}

std::size_t RequestQueue::size() const {
    std::size_t sum = 0;
    for (const auto& [key, requests] : lists_) sum += requests.size();
    return sum;
}

}  // namespace scancast
