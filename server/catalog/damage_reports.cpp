#include "server/catalog/damage_reports.hpp"

#include <utility>

namespace scancast {

std::string damageText(const CloudFile& file, const Error& error) {
    const std::string name = file.path().filename().string();
    const std::string text = error.message.substr(0, error.message.find_last_not_of('.') + 1);
    return text.find(name) == std::string::npos ? name + ": " + text : text;
}

void DamageReports::add(std::shared_ptr<const CloudFile> file, Error error) {
    const std::lock_guard lock(mutex_);
    if (listener_) return listener_({std::move(file), std::move(error)});
    if (kept_.size() < mostKept)
        kept_.push_back({std::move(file), std::move(error)});
    else
        ++leftOut_;
}

void DamageReports::listenWith(Listener listener) {
    const std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
    if (!listener_) return;
    for (DamageReport& report : std::exchange(kept_, {})) listener_(std::move(report));
}

std::uint64_t DamageReports::leftOut() const {
    const std::lock_guard lock(mutex_);
    return leftOut_;
}

}  // namespace scancast
