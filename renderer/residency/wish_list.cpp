#include "renderer/residency/wish_list.hpp"

#include <algorithm>

namespace scancast {

void WishList::set(std::uint64_t cloud, std::uint64_t requester, std::vector<Wish> wishes) {
    const Requester key{cloud, requester};
    if (wishes.empty()) {
        if (lists_.erase(key) > 0) std::erase(turns_, key);
        return;
    }
    std::sort(wishes.begin(), wishes.end(), [](const Wish& a, const Wish& b) {
        return a.urgency != b.urgency ? a.urgency < b.urgency : a.node > b.node;
    });
    if (wishes.size() > mostWishes) wishes.erase(wishes.begin(), wishes.end() - mostWishes);
    std::list<Requester> turn;
    if (!lists_.contains(key)) {
        turn.push_back(key);
        if (turns_.size() == mostRequesters) {
            lists_.erase(turns_.back());
            turns_.pop_back();
        }
    }
    lists_.insert_or_assign(key,
                            std::move(wishes));  // the last that may fail: nobody has one without the other
    turns_.splice(turns_.end(), turn);
}

std::optional<WishList::Next> WishList::next() {
    if (turns_.empty()) return std::nullopt;
    const Requester turn = turns_.front();
    std::vector<Wish>& wishes = lists_.at(turn);
    const Next next{turn.first, wishes.back().node};
    wishes.pop_back();
    if (wishes.empty()) {
        lists_.erase(turn);
        turns_.pop_front();
    } else {
        turns_.splice(turns_.end(), turns_, turns_.begin());
    }
    return next;
}

void WishList::forget(std::uint64_t cloud) {
    std::erase_if(lists_, [&](const auto& entry) { return entry.first.first == cloud; });
    std::erase_if(turns_, [&](const Requester& key) { return key.first == cloud; });
}

std::size_t WishList::size() const {
    std::size_t sum = 0;
    for (const auto& [key, wishes] : lists_) sum += wishes.size();
    return sum;
}

}  // namespace scancast
