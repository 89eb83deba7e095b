#include "server/stream/resume_store.hpp"

#include <openssl/rand.h>

#include <algorithm>
#include <utility>

#include "server/stream/session_token.hpp"

namespace scancast {
namespace {

std::optional<std::string> randomBytes(std::size_t size) {
    std::string bytes(size, '\0');
    if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), int(size)) != 1) return std::nullopt;
    return bytes;
}

std::vector<std::string> ownKey() {
    constexpr std::size_t keyBytes = 32;
    auto key = randomBytes(keyBytes);
    if (!key) return {};
    return {std::move(*key)};
}

}  // namespace

ResumeStore::ResumeStore(ResumeOptions options) : options_(std::move(options)), own_(ownKey()), keys_(own_) {}

void ResumeStore::setKeys(std::vector<std::string> keys) {
    if (keys.empty()) keys = own_;
    const std::lock_guard lock(mutex_);
    keys_ = std::move(keys);
}

std::int64_t ResumeStore::unixTime() const {
    if (options_.unixTime) return options_.unixTime();
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::seconds>(now).count();
}

std::optional<ResumeStore::Ticket> ResumeStore::open(Opening opening) {
    auto nonce = randomBytes(sessionNonceBytes);
    if (!nonce) return std::nullopt;
    SessionToken token{opening.session, std::clamp<std::uint32_t>(opening.turn, 1, lastTurn),
                       unixTime() + options_.tokenLife.count(), ownerDigest(opening.owner),
                       std::move(*nonce)};
    const std::lock_guard lock(mutex_);
    if (keys_.empty()) return std::nullopt;
    std::string text = signedToken(token, keys_.front());
    const Key key = opening.place != 0 ? opening.place : ++lastKey_;
    entries_[key] = {std::move(opening.session), text, token.turn, std::move(opening.onTaken), {}, {}};
    return Ticket{key, std::move(text)};
}

void ResumeStore::keep(Key key, SavedSession session) {
    const std::lock_guard lock(mutex_);
    const auto at = entries_.find(key);
    if (at != entries_.end()) at->second.saved = std::move(session);
}

void ResumeStore::leave(Key key, Time now) {
    const std::lock_guard lock(mutex_);
    dropLate(now);
    const auto at = entries_.find(key);
    if (at == entries_.end()) return;
    if (!at->second.saved || options_.mostAway == 0) {
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

std::optional<ResumedSession> ResumeStore::resume(std::string_view token, std::string_view owner, Time now) {
    const auto claimed = parseSessionToken(token);
    if (!claimed) return std::nullopt;
    const SessionToken& claim = claimed->token;
    if (claim.owner != ownerDigest(owner) || unixTime() >= claim.expires) return std::nullopt;
    ResumedSession resumed{claim.session, claim.turn, {}, 0};
    std::vector<std::function<void()>> taken;
    {
        const std::lock_guard lock(mutex_);
        dropLate(now);
        if (std::ranges::none_of(keys_, [&](const auto& key) { return claimed->isSignedWith(key); }))
            return std::nullopt;
        const auto isOfIt = [&](const auto& entry) { return entry.second.session == claim.session; };
        const auto isLater = [&](const auto& entry) {
            return isOfIt(entry) && (entry.second.turn > claim.turn ||
                                     (entry.second.turn == claim.turn && entry.second.token != token));
        };
        if (std::ranges::any_of(entries_, isLater)) return std::nullopt;
        // Those of earlier turns: the session was gone on with elsewhere, and has come back.
        for (auto& [key, entry] : entries_) {
            if (entry.session != claim.session) continue;
            if (entry.turn == claim.turn) resumed.saved = std::move(entry.saved);
            if (entry.onTaken) taken.push_back(std::move(entry.onTaken));
        }
        std::erase_if(entries_, isOfIt);
        resumed.place = ++lastKey_;
        entries_[resumed.place] = {claim.session, {}, claim.turn + 1, nullptr, {}, {}};
    }
    for (const auto& tell : taken) tell();
    return resumed;
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
