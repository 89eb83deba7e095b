#include "server/net/shared_pictures.hpp"

#include <utility>

namespace scancast {

Expected<void> SharedPictures::order(const std::string& tag, PictureOrder order, PictureDone done) const {
    {
        const std::lock_guard lock(waiting_->mutex);
        const auto [at, first] = waiting_->byTag.try_emplace(tag);
        at->second.push_back(std::move(done));
        if (!first) return {};
    }
    auto queued =
        scheduler_.snapshot(std::move(order), [waiting = waiting_, tag](const Expected<Picture>& result) {
            std::vector<PictureDone> all;
            {
                const std::lock_guard lock(waiting->mutex);
                all = std::exchange(waiting->byTag[tag], {});
                waiting->byTag.erase(tag);
            }
            for (const PictureDone& one : all) one(result);
        });
    if (queued) return {};
    // Whoever joined in between waits for a picture that will never come.
    std::vector<PictureDone> others;
    {
        const std::lock_guard lock(waiting_->mutex);
        others = std::exchange(waiting_->byTag[tag], {});
        waiting_->byTag.erase(tag);
    }
    const Error full{ErrorCode::Cancelled, queued.error().message, {}};
    for (std::size_t i = 1; i < others.size(); ++i) others[i](tl::unexpected(full));
    return queued;
}

}  // namespace scancast
