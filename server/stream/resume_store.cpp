#include "server/stream/resume_store.hpp"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <utility>

namespace scancast {
namespace {

std::optional<std::string> randomToken() {
    std::array<unsigned char, 32> bytes{};
    if (RAND_bytes(bytes.data(), int(bytes.size())) != 1) return std::nullopt;
    std::string token;
    for (const unsigned char byte : bytes) {
        token.push_back("0123456789abcdef"[byte >> 4]);
        token.push_back("0123456789abcdef"[byte & 15]);
    }
    return token;
}

// However much of it is right, a wrong token takes the same time.
bool same(std::string_view a, std::string_view b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

std::optional<ResumeStore::Ticket> ResumeStore::open(std::function<void()> onTaken) {
    auto token = randomToken();
    if (!token) return std::nullopt;
    const std::lock_guard lock(mutex_);
    entries_[++lastKey_] = {*token, std::move(onTaken), std::nullopt, std::nullopt};
    return Ticket{lastKey_, std::move(*token)};
}

void ResumeStore::keep(Key key, SavedSession session) {
    const std::lock_guard lock(mutex_);
    const auto at = entries_.find(key);
    if (at != entries_.end()) at->second.session = std::move(session);
}

void ResumeStore::leave(Key key, Time now) {
    const std::lock_guard lock(mutex_);
    dropLate(now);
    const auto at = entries_.find(key);
    if (at == entries_.end()) return;
    if (!at->second.session || options_.mostAway == 0) {
        entries_.erase(at);
        return;
    }
    const auto isAway = [](const auto& entry) { return entry.second.left.has_value(); };
    if (std::size_t(std::count_if(entries_.begin(), entries_.end(), isAway)) >= options_.mostAway) {
        // Those with a connection have no time of leaving, and nullopt comes before every time.
        const auto leftFirst = [&](const auto& a, const auto& b) {
            return isAway(a) != isAway(b) ? isAway(a) : a.second.left < b.second.left;
        };
        entries_.erase(std::min_element(entries_.begin(), entries_.end(), leftFirst));
    }
    at->second.left = now;
    at->second.onTaken = nullptr;
}

void ResumeStore::forget(Key key) {
    const std::lock_guard lock(mutex_);
    entries_.erase(key);
}

std::optional<SavedSession> ResumeStore::resume(std::string_view token, Time now) {
    Entry taken;
    {
        const std::lock_guard lock(mutex_);
        dropLate(now);
        auto found = entries_.end();
        for (auto at = entries_.begin(); at != entries_.end(); ++at) {
            if (same(at->second.token, token)) found = at;
        }
        if (found == entries_.end()) return std::nullopt;
        taken = std::move(found->second);
        entries_.erase(found);
    }
    if (taken.onTaken) taken.onTaken();
    return std::move(taken.session);
}

std::size_t ResumeStore::size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
}

// Called with the lock held.
void ResumeStore::dropLate(Time now) {
    std::erase_if(entries_, [&](const auto& entry) {
        return entry.second.left && now - *entry.second.left > options_.lifetime;
    });
}

}  // namespace scancast
