#include "remote/remote_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "files/bytes.hpp"

namespace scancast {
namespace {

// However many files there are, a folder has some of its objects at hand.
constexpr std::uint64_t leastFolderMemory = 2 << 20;
// An object on disk is cut into parts, the first of which begins with its length.
constexpr std::size_t partBytes = 512 << 10, lengthBytes = 8;

tl::unexpected<Error> inFile(ErrorCode code, const std::string& name, const std::string& what) {
    return fail(code, "its file " + name + " " + what);
}

}  // namespace

std::shared_ptr<RemoteFolder> RemoteFolder::create(std::shared_ptr<RemoteCommons> commons,
                                                   std::shared_ptr<RemoteFile> description, RemoteUrl url,
                                                   RemoteEnvironment environment) {
    return std::shared_ptr<RemoteFolder>(
        new RemoteFolder(std::move(commons), std::move(description), std::move(url), std::move(environment)));
}

RemoteFolder::RemoteFolder(std::shared_ptr<RemoteCommons> commons, std::shared_ptr<RemoteFile> description,
                           RemoteUrl url, RemoteEnvironment environment)
    : commons_(std::move(commons)),
      description_(std::move(description)),
      descriptionName_(url.name()),
      identity_(url.identity()),
      environment_(std::move(environment)),
      url_(std::move(url)),
      pace_(commons_->pace, description_->firstTook()) {}

// ---- readers

Expected<std::vector<std::byte>> RemoteFolder::read(const std::string& name, std::uint64_t most) const {
    if (name == descriptionName_) return readDescription(most);
    bool isKnown = false;
    {
        const Monitor::Lock lock(monitor_);
        const auto at = objects_.find(name);
        isKnown = at != objects_.end();
        if (isKnown && at->second.stage == Stage::Here) {
            uses_.splice(uses_.begin(), uses_, at->second.use);
            if (at->second.saved) {
                ++commons_->memoryHits;
                return *at->second.bytes;
            }
        }
    }
    if (!isKnown) {
        if (auto kept = fromDisk(name, most)) {
            ++commons_->diskHits;
            const Monitor::Lock lock(monitor_);
            if (objects_.try_emplace(name).second) keep(name, kept, true);
            return *kept;
        }
    }
    std::vector<Request> due;
    {
        const Monitor::Lock lock(monitor_);
        const bool out = isOut();
        if (!out) isLost_ = false;
        if (!objects_.contains(name)) {
            if (out) return tl::unexpected(description_->absence());
            want(name, most);
            due = requestsDue();
        }
        ++objects_.at(name).waiting;
    }
    send(due);
    Bytes bytes;
    bool save = false;
    {
        Monitor::Lock lock(monitor_);
        Object& wanted = objects_.at(name);
        // Whoever waits for an answer that is still due does not wait longer than the server is known to be there.
        monitor_.wait(
            lock, [&] { return wanted.stage == Stage::Here || wanted.stage == Stage::Failed || isLost_; });
        --wanted.waiting;
        if (wanted.stage != Stage::Here) {
            Error error = wanted.stage == Stage::Failed ? wanted.error : description_->absence();
            if (wanted.waiting == 0 && wanted.stage == Stage::Failed) objects_.erase(name);
            return tl::unexpected(std::move(error));
        }
        bytes = wanted.bytes;
        save = !std::exchange(wanted.saved, true);
        makeRoom();
    }
    if (save) toDisk(name, *bytes);
    return *bytes;
}

Expected<std::vector<std::byte>> RemoteFolder::readDescription(std::uint64_t most) const {
    if (description_->size() > most)
        return inFile(ErrorCode::ResourceLimit, descriptionName_,
                      fmt::format("has {} bytes; {} at most are read", description_->size(), most));
    std::vector<std::byte> bytes(std::size_t(description_->size()));
    if (const auto got = description_->readAt(0, bytes); !got) return passOn(got);
    return bytes;
}

void RemoteFolder::expect(const std::string& name, std::uint64_t most) const {
    if (name == descriptionName_) return;
    std::vector<Request> due;
    {
        const Monitor::Look look(monitor_);
        if (isOut() || objects_.contains(name)) return;
    }
    if (commons_->folder && commons_->folder->has(keyOf(name), 0)) return;
    {
        const Monitor::Lock lock(monitor_);
        if (isOut() || !hasRoomAhead()) return;
        isLost_ = false;
        want(name, most);
        due = requestsDue();
    }
    send(due);
}

bool RemoteFolder::forget(const std::string& name) const {
    if (name == descriptionName_) return false;
    if (commons_->folder) commons_->folder->remove(keyOf(name), 0);
    const Monitor::Lock lock(monitor_);
    const auto at = objects_.find(name);
    if (at == objects_.end() || at->second.stage != Stage::Here || at->second.waiting > 0) return true;
    bytesHere_ -= at->second.bytes->size();
    uses_.erase(at->second.use);
    objects_.erase(at);
    return true;
}

// ---- on disk

/// What it is belongs to the state of the description: of another set it is another object.
std::string RemoteFolder::keyOf(const std::string& name) const {
    return pieceKey(identity_ + "\n" + name, description_->state());
}

RemoteFolder::Bytes RemoteFolder::fromDisk(const std::string& name, std::uint64_t most) const {
    if (!commons_->folder) return nullptr;
    const std::string key = keyOf(name);
    auto part = commons_->folder->load(key, 0);
    if (!part || part->size() < lengthBytes) return nullptr;
    const auto length = loadLe<std::uint64_t>(part->data());
    if (length > most) return nullptr;
    auto bytes = std::make_shared<std::vector<std::byte>>(part->begin() + lengthBytes, part->end());
    for (std::uint64_t i = 1; bytes->size() < length; ++i) {
        part = commons_->folder->load(key, i);
        if (!part || part->empty() || part->size() > length - bytes->size()) return nullptr;
        bytes->insert(bytes->end(), part->begin(), part->end());
    }
    return bytes->size() == length ? bytes : nullptr;
}

void RemoteFolder::toDisk(const std::string& name, const std::vector<std::byte>& bytes) const {
    if (!commons_->folder) return;
    const std::string key = keyOf(name);
    const std::span<const std::byte> all(bytes);
    const std::size_t first = std::min(bytes.size(), partBytes - lengthBytes);
    // The first part last: where that is, the others were.
    std::uint64_t part = 1;
    for (std::size_t at = first; at < bytes.size(); at += partBytes, ++part)
        commons_->folder->save(key, part, all.subspan(at, std::min(partBytes, bytes.size() - at)));
    std::vector<std::byte> start(lengthBytes + first);
    storeLe(start.data(), std::uint64_t(bytes.size()));
    std::ranges::copy(all.first(first), start.begin() + lengthBytes);
    commons_->folder->save(key, 0, start);
}

// ---- objects, with the lock held

bool RemoteFolder::isOut() const {
    return description_->isAway() || description_->changed();
}

void RemoteFolder::want(const std::string& name, std::uint64_t most) const {
    const auto [at, isNew] = objects_.try_emplace(name);
    if (!isNew) return;
    at->second.most = most;
    order_.push_back(name);
    ++commons_->misses;
}

void RemoteFolder::keep(const std::string& name, Bytes bytes, bool saved) const {
    Object& one = objects_.at(name);
    uses_.push_front(name);
    one.use = uses_.begin();
    bytesHere_ += bytes->size();
    one.bytes = std::move(bytes);
    one.saved = saved;
    one.stage = Stage::Here;
    makeRoom();
}

void RemoteFolder::failObject(const std::string& name, const Error& error) const {
    const auto at = objects_.find(name);
    if (at == objects_.end() || at->second.stage == Stage::Here) return;
    at->second.stage = Stage::Failed;
    at->second.error = error;
    if (at->second.waiting == 0) objects_.erase(at);
}

/// The last used goes first; what nobody has read yet is spared once.
void RemoteFolder::makeRoom() const {
    const std::uint64_t most = share();
    for (std::size_t left = 2 * uses_.size(); bytesHere_ > most && left > 0; --left) {
        const auto at = std::prev(uses_.end());
        const auto object = objects_.find(*at);
        Object& one = object->second;
        if (one.waiting > 0 || (!one.saved && !std::exchange(one.spared, true))) {
            uses_.splice(uses_.begin(), uses_, at);
            continue;
        }
        bytesHere_ -= one.bytes->size();
        objects_.erase(object);
        uses_.erase(at);
    }
}

std::uint64_t RemoteFolder::share() const {
    return std::max(leastFolderMemory, commons_->memory / std::max<std::size_t>(1, commons_->files.load()));
}

/// What is fetched ahead has to be there still when it is read.
bool RemoteFolder::hasRoomAhead() const {
    const auto ahead = std::ranges::count_if(
        objects_, [](const auto& one) { return !one.second.saved && one.second.waiting == 0; });
    return std::uint64_t(ahead + 1) * usual_ <= std::max(share() / 2, usual_);
}

std::vector<RemoteFolder::Request> RemoteFolder::requestsDue() const {
    std::vector<Request> due;
    const auto now = std::chrono::steady_clock::now();
    while (underWay_ < pace_.requests() && !order_.empty()) {
        const std::string name = std::move(order_.front());
        order_.pop_front();
        const auto at = objects_.find(name);
        if (at == objects_.end() || at->second.stage != Stage::Wanted) continue;
        at->second.stage = Stage::Asked;
        due.push_back({name, at->second.most, now});
        ++underWay_;
    }
    return due;
}

// ---- requests

Expected<std::shared_ptr<const ObjectAccess>> RemoteFolder::accessTo(const std::string& name) const {
    Expected<RemoteUrl> beside = fail(ErrorCode::Internal, {});
    {
        const Monitor::Look look(monitor_);
        beside = url_.beside(name);
    }
    if (!beside) return passOn(std::move(beside));
    auto access = scancast::accessTo(*beside, environment_);
    if (!access) return passOn(std::move(access));
    return std::make_shared<const ObjectAccess>(std::move(*access));
}

void RemoteFolder::send(const std::vector<Request>& requests) const {
    for (const Request& request : requests) {
        auto access = accessTo(request.name);
        if (!access) {
            arrived(request,
                    tl::unexpected(RequestFault{RequestFault::Kind::Unsuitable, access.error().message}));
            continue;
        }
        PartAsk ask{std::move(*access), 0, request.most};
        ask.whole = true;
        ask.tries = commons_->tries;
        commons_->transfers->start(std::move(ask), [weak = weak_from_this(), request](PartOrFault result) {
            if (const auto self = weak.lock()) self->arrived(request, std::move(result));
        });
    }
}

void RemoteFolder::arrived(const Request& request, PartOrFault result) const {
    std::vector<Request> due;
    if (!result) failed(request, result.error());
    {
        const Monitor::Lock lock(monitor_);
        --underWay_;
        pace_.ended(request.begun, std::chrono::steady_clock::now(),
                    result || result.error().kind != RequestFault::Kind::Unreachable);
        if (result) {
            refused_.erase(request.name);
            usual_ = std::max<std::uint64_t>(1, (3 * usual_ + result->bytes.size()) / 4);
            keep(request.name, std::make_shared<const std::vector<std::byte>>(std::move(result->bytes)),
                 false);
        }
        due = requestsDue();
    }
    if (result) description_->came();
    send(due);
}

/// What ails one object is its own; everything else, all of them.
void RemoteFolder::failed(const Request& request, const RequestFault& fault) const {
    using Kind = RequestFault::Kind;
    Error error{ErrorCode::Unavailable, "it cannot be fetched at present: " + fault.text, {}};
    bool isItsOwn = true;
    if (fault.isMissing()) {
        error = {ErrorCode::NotFound, "its file " + request.name + " is missing (" + fault.text + ")", {}};
    } else if (fault.kind == Kind::Unsuitable) {
        error = {ErrorCode::Unsupported, "its file " + request.name + " cannot be read: " + fault.text, {}};
    } else if (fault.kind == Kind::Refused) {
        // Perhaps all are, now; the description tells.
        const Monitor::Lock lock(monitor_);
        isItsOwn = !refused_.insert(request.name).second;
        if (isItsOwn) error = {ErrorCode::Io, "its file " + request.name + " is refused: " + fault.text, {}};
    } else {
        isItsOwn = false;
    }
    const bool isOld = !isItsOwn && !description_->lost(fault, request.begun);
    const Monitor::Lock lock(monitor_);
    if (isOld) {
        // Of a server that has been away and is back: it is asked once more.
        if (const auto at = objects_.find(request.name);
            at != objects_.end() && at->second.stage == Stage::Asked) {
            at->second.stage = Stage::Wanted;
            order_.push_front(request.name);
        }
        return;
    }
    failObject(request.name, error);
    if (isItsOwn) return;
    isLost_ = true;
    for (const std::string& name : std::exchange(order_, {})) failObject(name, error);
}

void RemoteFolder::signAnew(const RemoteUrl& url) {
    const Monitor::Lock lock(monitor_);
    url_ = url;
}

}  // namespace scancast
