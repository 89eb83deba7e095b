#include "server/net/log/repeats.hpp"

#include <algorithm>

namespace scancast {
namespace {

constexpr int firstFailure = 400;

}  // namespace

bool Repeats::admit(const std::string& client, int status, std::string_view route, Time now) {
    if (!limits_) return true;
    if (!began_) began_ = now;
    const bool failed = status >= firstFailure;
    RepeatKind kind{client, failed ? status : 0, failed ? std::string(route) : std::string()};
    auto found = lines_.find(kind);
    if (found == lines_.end()) {
        // Behind the last that is told apart, all are one: nobody gains lines by being many.
        if (lines_.size() >= limits_->remembered) kind = {};
        found = lines_.try_emplace(std::move(kind)).first;
    }
    Lines& lines = found->second;
    const std::uint64_t most = found->first.status != 0 ? limits_->failing : limits_->served;
    if (lines.written >= most || written_ >= limits_->all) {
        ++lines.leftOut;
        return false;
    }
    ++lines.written;
    ++written_;
    return true;
}

std::vector<Repeated> Repeats::passTime(Time now) {
    if (!limits_ || !began_ || now - *began_ < limits_->window) return {};
    return finish();
}

std::vector<Repeated> Repeats::finish() {
    std::vector<Repeated> repeated;
    for (const auto& [kind, lines] : lines_)
        if (lines.leftOut > 0) repeated.push_back({kind, lines.leftOut});
    std::ranges::stable_sort(repeated, std::ranges::greater(), &Repeated::times);
    if (limits_ && repeated.size() > limits_->told) {
        Repeated others;
        for (std::size_t i = limits_->told; i < repeated.size(); ++i) others.times += repeated[i].times;
        repeated.resize(limits_->told);
        repeated.push_back(std::move(others));
    }
    lines_.clear();
    written_ = 0;
    began_.reset();
    return repeated;
}

}  // namespace scancast
