#include "server/stream/session_register.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_json.hpp"
#include "server/base/faults.hpp"

namespace scancast {
namespace {

std::string newId() {
    std::array<unsigned char, 12> bytes{};
    if (RAND_bytes(bytes.data(), int(bytes.size())) != 1)
        throw std::runtime_error("there is no randomness for a session's id");  // which would be no secret
    std::string id = "s";
    for (const unsigned char byte : bytes) id += fmt::format("{:02x}", byte);
    return id;
}

tl::unexpected<Problem> refuse(int status, std::string detail) {
    Problem problem = problemOf(status, std::move(detail));
    problem.errors.push_back({"follow", problem.detail});
    return tl::unexpected(std::move(problem));
}

nlohmann::json toJson(const SessionFacts& facts) {
    const auto seconds = std::chrono::floor<std::chrono::seconds>(facts.since);
    nlohmann::json json{{"session", facts.id},
                        {"client", name(facts.client)},
                        {"since", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                                              fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)))},
                        {"frames", facts.frames},
                        {"follows", facts.follows.empty() ? nlohmann::json() : nlohmann::json(facts.follows)},
                        {"cloud", nullptr},
                        {"view", nullptr}};
    if (facts.shows) json.update(toJson(*facts.shows));
    return json;
}

}  // namespace

std::chrono::milliseconds departure(std::size_t index, std::size_t count, std::chrono::milliseconds within) {
    constexpr std::chrono::milliseconds longestStep{100};
    const auto share = within / 2 * std::int64_t(index) / std::int64_t(std::max<std::size_t>(1, count));
    return std::min(share, longestStep * std::int64_t(index));
}

std::string_view name(ClientKind kind) {
    return kind == ClientKind::WebSocket ? "websocket" : "mjpeg";
}

nlohmann::json toJson(const SharedView& shows) {
    return {{"cloud", shows.cloudId}, {"seq", shows.seq}, {"view", toJson(shows.view)}};
}

nlohmann::json sessionListJson(const std::vector<SessionFacts>& sessions) {
    nlohmann::json list = nlohmann::json::array();
    for (const SessionFacts& facts : sessions) list.push_back(toJson(facts));
    return {{"sessions", std::move(list)}};
}

// ---- the register

std::unique_ptr<SessionRegistration> SessionRegister::enter(ClientKind client,
                                                            std::weak_ptr<LiveSession> session) {
    Entry entry;
    entry.facts.id = newId();
    entry.facts.client = client;
    entry.facts.since = std::chrono::system_clock::now();
    entry.session = std::move(session);
    auto registration = std::make_unique<SessionRegistration>(*this, entry.facts.id);
    const std::lock_guard lock(mutex_);
    entry.number = ++last_;
    entry.registration = registration.get();
    entries_.emplace(registration->id_, std::move(entry));
    return registration;
}

std::vector<SessionFacts> SessionRegister::list() const {
    std::vector<const Entry*> order;
    std::vector<SessionFacts> facts;
    const std::lock_guard lock(mutex_);
    for (const auto& [id, entry] : entries_) order.push_back(&entry);
    std::sort(order.begin(), order.end(),
              [](const Entry* a, const Entry* b) { return a->number < b->number; });
    for (const Entry* entry : order) facts.push_back(entry->facts);
    return facts;
}

std::shared_ptr<LiveSession> SessionRegister::find(std::string_view id) const {
    const std::lock_guard lock(mutex_);
    const auto at = entries_.find(id);
    return at == entries_.end() ? nullptr : at->second.session.lock();
}

std::uint64_t SessionRegister::seqOf(std::string_view id) const {
    const std::lock_guard lock(mutex_);
    const auto at = entries_.find(id);
    return at == entries_.end() || !at->second.facts.shows ? 0 : at->second.facts.shows->seq;
}

void SessionRegister::wakeAll() const {
    Sessions all;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [id, entry] : entries_) all.push_back(entry.session);
    }
    wake(all);
}

void SessionRegister::moveAll(std::chrono::milliseconds within) const {
    std::vector<const Entry*> order;
    Sessions all;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [id, entry] : entries_) order.push_back(&entry);
        std::ranges::sort(order, {}, [](const Entry* entry) {  // who hears nothing takes nobody's time
            return std::pair(entry->facts.client != ClientKind::WebSocket, entry->number);
        });
        for (const Entry* entry : order) all.push_back(entry->session);
    }
    const auto milliseconds = [](std::chrono::milliseconds time) { return std::uint64_t(time.count()); };
    for (std::size_t i = 0; i < all.size(); ++i)
        if (const auto session = all[i].lock())
            session->moveOn({milliseconds(departure(i, all.size(), within)), milliseconds(within)});
}

void SessionRegister::leave(const SessionRegistration& registration) {
    Sessions followers;
    {
        const std::lock_guard lock(mutex_);
        // Called by a destructor: without memory for the list nobody is told, but the entry goes.
        std::ignore =
            contained("The register of sessions", [&] { followers = followersLocked(registration.id_); });
        const auto at = entries_.find(registration.id_);
        endFollowingLocked(at->second);
        entries_.erase(at);
    }
    wake(followers);
}

bool SessionRegister::leadsLocked(const std::string& id) const {
    return followers_.contains(id);
}

void SessionRegister::endFollowingLocked(Entry& follower) {
    const auto at = followers_.find(follower.facts.follows);
    follower.facts.follows.clear();
    if (at != followers_.end() && --at->second == 0) followers_.erase(at);
}

void SessionRegister::renameLocked(SessionRegistration& registration, const std::string& id) {
    std::string key = id, own = id, shown = id;  // may fail for want of memory; what follows does not
    auto node = entries_.extract(registration.id_);
    node.key() = std::move(key);
    node.mapped().facts.id = std::move(shown);
    registration.id_ = std::move(own);
    entries_.insert(std::move(node));
}

SessionRegister::Sessions SessionRegister::followersLocked(const std::string& id) const {
    Sessions followers;
    if (!leadsLocked(id)) return followers;
    for (const auto& [other, entry] : entries_)
        if (entry.facts.follows == id) followers.push_back(entry.session);
    return followers;
}

// Outside the lock: a session may be destroyed here, and leaves the register then.
void SessionRegister::wake(const Sessions& sessions) {
    for (const auto& weak : sessions)
        if (const auto session = weak.lock()) session->lookAround();
}

// ---- a registration

SessionRegistration::~SessionRegistration() {
    sessions_.leave(*this);
}

std::string SessionRegistration::id() const {
    const std::lock_guard lock(sessions_.mutex_);
    return id_;
}

void SessionRegistration::resumeAs(const std::string& id) {
    const std::lock_guard lock(sessions_.mutex_);
    const auto other = sessions_.entries_.find(id);
    if (other != sessions_.entries_.end()) sessions_.renameLocked(*other->second.registration, newId());
    sessions_.renameLocked(*this, id);
}

void SessionRegistration::show(SharedView view) {
    SessionRegister::Sessions followers;
    {
        const std::lock_guard lock(sessions_.mutex_);
        sessions_.entries_.at(id_).facts.shows = std::move(view);
        followers = sessions_.followersLocked(id_);
    }
    SessionRegister::wake(followers);
}

void SessionRegistration::frameSent() {
    const std::lock_guard lock(sessions_.mutex_);
    ++sessions_.entries_.at(id_).facts.frames;
}

bool SessionRegistration::leads() const {
    const std::lock_guard lock(sessions_.mutex_);
    return sessions_.leadsLocked(id_);
}

void SessionRegistration::share(std::shared_ptr<const SharedPicture> picture) {
    SessionRegister::Sessions followers;
    {
        const std::lock_guard lock(sessions_.mutex_);
        followers = sessions_.followersLocked(id_);
        if (followers.empty()) picture.reset();
        sessions_.entries_.at(id_).picture.swap(picture);  // the one before goes outside the lock
    }
    SessionRegister::wake(followers);
}

void SessionRegistration::makes(bool one) {
    const std::lock_guard lock(sessions_.mutex_);
    sessions_.entries_.at(id_).makes = one;
}

SessionRegistration::LeadersPicture SessionRegistration::leadersPicture() const {
    const std::lock_guard lock(sessions_.mutex_);
    const std::string& leader = sessions_.entries_.at(id_).facts.follows;
    const auto at = leader.empty() ? sessions_.entries_.end() : sessions_.entries_.find(leader);
    if (at == sessions_.entries_.end()) return {};
    return {at->second.picture, at->second.makes, true};
}

tl::expected<SharedView, Problem> SessionRegistration::mayFollow(const std::string& leader) const {
    const std::lock_guard lock(sessions_.mutex_);
    return mayFollowLocked(leader);
}

tl::expected<SharedView, Problem> SessionRegistration::follow(const std::string& leader) {
    std::shared_ptr<const SharedPicture> old;  // goes outside the lock
    const std::lock_guard lock(sessions_.mutex_);
    auto shown = mayFollowLocked(leader);
    if (!shown) return shown;
    SessionRegister::Entry& own = sessions_.entries_.at(id_);
    if (own.facts.follows == leader) return shown;
    // Of what it shared with those who have left it may have moved on since.
    if (!sessions_.leadsLocked(leader)) sessions_.entries_.at(leader).picture.swap(old);
    std::string name = leader;  // may fail for want of memory, as may a new count; what follows does not
    ++sessions_.followers_[leader];
    sessions_.endFollowingLocked(own);
    own.facts.follows.swap(name);
    return shown;
}

tl::expected<SharedView, Problem> SessionRegistration::mayFollowLocked(const std::string& leader) const {
    const auto at = sessions_.entries_.find(leader);
    if (at == sessions_.entries_.end())
        return refuse(404, "There is no session " + quoteText(leader) + "; it may have ended.");
    const SessionFacts& facts = at->second.facts;
    if (leader == id_) return refuse(409, "A session cannot follow itself.");
    if (!facts.follows.empty())
        return refuse(409, "That session follows another one itself; follow that one instead.");
    if (sessions_.leadsLocked(id_))
        return refuse(409, "Others follow this session; it cannot follow at the same time.");
    if (!facts.shows) return refuse(503, "That session shows nothing yet; try again in a moment.");
    return *facts.shows;
}

void SessionRegistration::unfollow() {
    const std::lock_guard lock(sessions_.mutex_);
    sessions_.endFollowingLocked(sessions_.entries_.at(id_));
}

bool SessionRegistration::following() const {
    const std::lock_guard lock(sessions_.mutex_);
    return !sessions_.entries_.at(id_).facts.follows.empty();
}

std::optional<SharedView> SessionRegistration::leader() const {
    const std::lock_guard lock(sessions_.mutex_);
    const auto at = sessions_.entries_.find(sessions_.entries_.at(id_).facts.follows);
    return at == sessions_.entries_.end() ? std::nullopt : at->second.facts.shows;
}

}  // namespace scancast
