#include "server/net/api/shared_pictures.hpp"

#include <tuple>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {
namespace {

void answer(const PictureDone& one, const Expected<EncodedPicture>& result) {
    std::ignore = contained("Handing over a picture", [&] { one(result); });
}

}  // namespace

bool SharedPictures::Waiting::add(const std::string& tag, PictureDone done) {
    const std::lock_guard lock(mutex);
    std::vector<PictureDone>& all = byTag[tag];
    all.push_back(std::move(done));
    return all.size() == 1;  // also where an exception left an empty list behind
}

std::vector<PictureDone> SharedPictures::Waiting::take(const std::string& tag) {
    const std::lock_guard lock(mutex);
    const auto at = byTag.find(tag);
    if (at == byTag.end()) return {};
    auto all = std::move(at->second);
    byTag.erase(at);
    return all;
}

std::size_t SharedPictures::Waiting::size() const {
    const std::lock_guard lock(mutex);
    std::size_t all = 0;
    for (const auto& [tag, those] : byTag) all += those.size();
    return all;
}

std::size_t SharedPictures::waiting() const {
    return waiting_->size();
}

Expected<void> SharedPictures::order(const std::string& tag, PictureOrder order, PictureDone done) const {
    if (!waiting_->add(tag, std::move(done))) return {};
    auto queued = contained("The queue of pictures", [&] {
        return scheduler_.snapshot(std::move(order),
                                   [waiting = waiting_, tag](const Expected<EncodedPicture>& result) {
                                       for (const PictureDone& one : waiting->take(tag)) answer(one, result);
                                   });
    });
    if (queued) return {};
    // Whoever joined in between waits for a picture that will never come.
    const Expected<EncodedPicture> full = fail(ErrorCode::Cancelled, queued.error().message);
    const auto others = waiting_->take(tag);
    for (std::size_t i = 1; i < others.size(); ++i) answer(others[i], full);
    return passOn(queued);
}

}  // namespace scancast
