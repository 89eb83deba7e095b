#include "remote/remote_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace scancast {
namespace {

using std::chrono::milliseconds;

// However many files there are, each can have a block's pieces at hand.
constexpr std::uint64_t leastMemory = 2 << 20;
// However long a server wants to be left alone.
constexpr milliseconds longestWait{600'000};

std::shared_ptr<const void> beyondShare(const RemoteCommons& commons) {
    if (!commons.reserve || commons.files.load() < commons.memory / leastMemory) return nullptr;
    return commons.reserve(leastMemory);
}

}  // namespace

std::shared_ptr<RemoteFile> RemoteFile::create(std::shared_ptr<RemoteCommons> commons,
                                               std::shared_ptr<const ObjectAccess> access,
                                               std::string identity, Part start,
                                               std::chrono::nanoseconds took) {
    std::shared_ptr<RemoteFile> file(new RemoteFile(std::move(commons), std::move(access),
                                                    std::move(identity), std::move(start.state), took));
    const Monitor::Lock lock(file->monitor_);
    file->pieces_.emplace(0, Piece{});
    file->keep(0, std::make_shared<const std::vector<std::byte>>(std::move(start.bytes)), false);
    return file;
}

RemoteFile::RemoteFile(std::shared_ptr<RemoteCommons> commons, std::shared_ptr<const ObjectAccess> access,
                       std::string identity, ObjectState state, std::chrono::nanoseconds took)
    : commons_(std::move(commons)),
      shown_(access->shown),
      access_(std::move(access)),
      state_(std::move(state)),
      took_(took),
      key_(pieceKey(identity, state_)),
      reserved_(beyondShare(*commons_)),
      pace_(commons_->pace, took) {
    ++commons_->files;
}

RemoteFile::~RemoteFile() {
    --commons_->files;
    if (away_) --commons_->away;
}

// ---- readers

Expected<std::size_t> RemoteFile::readAt(std::uint64_t offset, std::span<std::byte> into) const {
    if (offset >= state_.bytes) return std::size_t(0);
    const std::size_t bytes = std::size_t(std::min<std::uint64_t>(into.size(), state_.bytes - offset));
    std::uint64_t expected = 0;
    for (std::size_t done = 0; done < bytes;) {
        if (done >= expected) {
            const std::uint64_t ahead = std::min<std::uint64_t>(bytes - done, share() / 2);
            expect(offset + done, ahead);
            expected = done + ahead;
        }
        const std::uint64_t at = offset + done, piece = at / pieceBytes, within = at % pieceBytes;
        const auto from = bytesOf(piece);
        if (!from) return passOn(from);
        const std::size_t here = std::min<std::size_t>(bytes - done, (*from)->size() - within);
        std::memcpy(into.data() + done, (*from)->data() + within, here);
        done += here;
    }
    return bytes;
}

void RemoteFile::expect(std::uint64_t offset, std::uint64_t bytes) const {
    if (offset >= state_.bytes || bytes == 0) return;
    bytes =
        std::min({bytes, state_.bytes - offset, share() / 2});  // more would drop the first before it is read
    std::vector<Request> due;
    {
        std::vector<std::uint64_t> missing;
        {
            const Monitor::Look look(monitor_);
            if (away_ || changed_) return;
            for (std::uint64_t p = offset / pieceBytes; p <= (offset + bytes - 1) / pieceBytes; ++p)
                if (!pieces_.contains(p)) missing.push_back(p);
        }
        if (commons_->folder)
            std::erase_if(missing, [&](std::uint64_t p) { return commons_->folder->has(key_, p); });
        if (missing.empty()) return;
        const Monitor::Lock lock(monitor_);
        for (const std::uint64_t p : missing) want(p);
        due = requestsDue();
    }
    send(due);
}

bool RemoteFile::forget(std::uint64_t offset, std::uint64_t bytes) const {
    if (offset >= state_.bytes || bytes == 0) return false;
    const std::uint64_t last = (offset + std::min(bytes, state_.bytes - offset) - 1) / pieceBytes;
    for (std::uint64_t p = offset / pieceBytes; p <= last; ++p) {
        if (commons_->folder) commons_->folder->remove(key_, p);
        const Monitor::Lock lock(monitor_);
        const auto at = pieces_.find(p);
        if (at == pieces_.end() || at->second.stage != Stage::Here || at->second.waiting > 0) continue;
        bytesHere_ -= at->second.bytes->size();
        uses_.erase(at->second.use);
        pieces_.erase(at);
    }
    return true;
}

Expected<RemoteFile::Bytes> RemoteFile::bytesOf(std::uint64_t piece) const {
    bool waited = false;
    {
        const Monitor::Lock lock(monitor_);
        const auto at = pieces_.find(piece);
        if (at != pieces_.end() && at->second.stage == Stage::Here) {
            uses_.splice(uses_.begin(), uses_, at->second.use);
            if (at->second.saved) {
                ++commons_->memoryHits;
                return at->second.bytes;
            }
        }
        waited = at != pieces_.end();
    }
    if (!waited) {
        if (auto kept = fromDisk(piece)) {
            ++commons_->diskHits;
            const Monitor::Lock lock(monitor_);
            if (pieces_.try_emplace(piece).second) keep(piece, kept, true);
            return kept;
        }
    }
    std::vector<Request> due;
    {
        const Monitor::Lock lock(monitor_);
        if (!pieces_.contains(piece)) {
            if (away_ || changed_) return unavailable();
            want(piece);
            due = requestsDue();
        }
        Piece& wanted = pieces_.at(piece);
        if (wanted.stage == Stage::Failed) return unavailable();
        ++wanted.waiting;
    }
    send(due);
    Bytes bytes;
    bool save = false;
    {
        Monitor::Lock lock(monitor_);
        Piece& wanted = pieces_.at(piece);
        // Whoever waits for an answer that is still due does not wait longer than the server is known to be there.
        monitor_.wait(lock, [&] {
            return wanted.stage == Stage::Here || wanted.stage == Stage::Failed || away_ || changed_;
        });
        --wanted.waiting;
        if (wanted.stage != Stage::Here) {
            if (wanted.waiting == 0 && wanted.stage == Stage::Failed) pieces_.erase(piece);
            return unavailable();
        }
        bytes = wanted.bytes;
        save = !std::exchange(wanted.saved, true);
        makeRoom();
    }
    if (save && commons_->folder) commons_->folder->save(key_, piece, *bytes);
    return bytes;
}

RemoteFile::Bytes RemoteFile::fromDisk(std::uint64_t piece) const {
    if (!commons_->folder) return nullptr;
    auto bytes = commons_->folder->load(key_, piece);
    if (!bytes || bytes->size() != bytesIn(piece)) return nullptr;
    return std::make_shared<const std::vector<std::byte>>(std::move(*bytes));
}

std::uint64_t RemoteFile::bytesIn(std::uint64_t piece) const {
    return std::min(pieceBytes, state_.bytes - piece * pieceBytes);
}

tl::unexpected<Error> RemoteFile::unavailable() const {
    if (changed_) return fail(ErrorCode::Unavailable, "it has been replaced by another while it was read");
    return fail(ErrorCode::Unavailable,
                fmt::format("it cannot be fetched at present: {}", away_ ? away_->text : "nothing came"));
}

// ---- pieces, with the lock held

void RemoteFile::want(std::uint64_t piece) const {
    if (away_ || changed_ || !pieces_.try_emplace(piece).second) return;
    order_.push_back(piece);
    ++commons_->misses;
}

void RemoteFile::keep(std::uint64_t piece, Bytes bytes, bool saved) const {
    Piece& one = pieces_.at(piece);
    uses_.push_front(piece);
    one.use = uses_.begin();
    bytesHere_ += bytes->size();
    one.bytes = std::move(bytes);
    one.saved = saved;
    one.stage = Stage::Here;
    makeRoom();
}

/// The last used goes first; what nobody has read yet is spared once.
void RemoteFile::makeRoom() const {
    const std::uint64_t most = share();
    for (std::size_t left = 2 * uses_.size(); bytesHere_ > most && left > 0; --left) {
        const auto at = std::prev(uses_.end());
        const auto piece = pieces_.find(*at);
        Piece& one = piece->second;
        if (one.waiting > 0 || (!one.saved && !std::exchange(one.spared, true))) {
            uses_.splice(uses_.begin(), uses_, at);
            continue;
        }
        bytesHere_ -= one.bytes->size();
        pieces_.erase(piece);
        uses_.erase(at);
    }
}

std::uint64_t RemoteFile::share() const {
    return std::max(leastMemory, commons_->memory / std::max<std::size_t>(1, commons_->files.load()));
}

/// What waits in a row is one request, whoever asked first.
std::vector<RemoteFile::Request> RemoteFile::requestsDue() const {
    std::vector<Request> due;
    const auto isWanted = [&](std::uint64_t piece) {
        const auto at = pieces_.find(piece);
        return at != pieces_.end() && at->second.stage == Stage::Wanted;
    };
    const std::uint64_t mostPieces = pace_.pieces();
    const auto now = std::chrono::steady_clock::now();
    while (underWay_ < pace_.requests() && !order_.empty()) {
        const std::uint64_t wanted = order_.front();
        order_.pop_front();
        if (!isWanted(wanted)) continue;
        std::uint64_t first = wanted, end = wanted + 1;
        while (end - first < mostPieces && isWanted(end)) ++end;
        while (end - first < mostPieces && first > 0 && isWanted(first - 1)) --first;
        for (std::uint64_t p = first; p < end; ++p) pieces_.at(p).stage = Stage::Asked;
        due.push_back({first, end - first, now});
        ++underWay_;
    }
    return due;
}

void RemoteFile::goAway(const RequestFault& fault) const {
    if (fault.kind == RequestFault::Kind::Changed) changed_ = true;
    if (!away_) {
        away_ = fault;
        ++commons_->away;
    }
    for (const std::uint64_t piece : std::exchange(order_, {}))
        if (const auto at = pieces_.find(piece); at != pieces_.end() && at->second.stage == Stage::Wanted)
            failPiece(piece);
}

milliseconds RemoteFile::backOff(const RequestFault& fault) const {
    const auto own = backOff_ ? std::min(*backOff_ * 2, commons_->lastProbe) : commons_->firstProbe;
    backOff_ = own;
    const milliseconds wanted = fault.after ? milliseconds(*fault.after) : milliseconds(0);
    return std::max(own, std::min(wanted, longestWait));
}

void RemoteFile::failPiece(std::uint64_t piece) const {
    const auto at = pieces_.find(piece);
    if (at == pieces_.end() || at->second.stage == Stage::Here) return;
    at->second.stage = Stage::Failed;
    if (at->second.waiting == 0) pieces_.erase(at);
}

// ---- requests

void RemoteFile::send(const std::vector<Request>& requests) const {
    if (requests.empty()) return;
    const auto access = currentAccess();
    for (const Request& request : requests) {
        const std::uint64_t first = request.first * pieceBytes;
        const std::uint64_t end = std::min(state_.bytes, (request.first + request.count) * pieceBytes);
        commons_->transfers->start({access, first, end - first, state_, commons_->tries},
                                   [weak = weak_from_this(), request](PartOrFault result) {
                                       if (const auto self = weak.lock())
                                           self->arrived(request, std::move(result));
                                   });
    }
}

void RemoteFile::arrived(const Request& request, PartOrFault result) const {
    std::vector<Request> due;
    bool isChange = false, isAbsence = false, isFirst = false, isBack = false;
    milliseconds delay{0};
    {
        const Monitor::Lock lock(monitor_);
        --underWay_;
        pace_.ended(request.begun, std::chrono::steady_clock::now(),
                    result || result.error().kind != RequestFault::Kind::Unreachable);
        try {
            for (std::uint64_t i = 0; result && i < request.count; ++i) {
                const auto one = std::span<const std::byte>(result->bytes)
                                     .subspan(i * pieceBytes, bytesIn(request.first + i));
                keep(request.first + i,
                     std::make_shared<const std::vector<std::byte>>(one.begin(), one.end()), false);
            }
        } catch (const std::bad_alloc&) {
            result =
                tl::unexpected(RequestFault{RequestFault::Kind::Unreachable, "there is not enough memory"});
        }
        if (!result) {
            isChange = result.error().kind == RequestFault::Kind::Changed && !changed_;
            isAbsence = result.error().kind != RequestFault::Kind::Changed &&
                        result.error().kind != RequestFault::Kind::Stopped && !away_ && !changed_;
            isFirst = isAbsence && !backOff_;
            if (isAbsence) delay = backOff(result.error());
            goAway(result.error());
            for (std::uint64_t i = 0; i < request.count; ++i) failPiece(request.first + i);
        } else if (!away_) {
            isBack = std::exchange(backOff_, std::nullopt).has_value();
        }
        due = requestsDue();
    }
    send(due);
    if (isBack) note(fmt::format("{} can be fetched again.", shown()));
    if (isChange) tellOfChange();
    if (isFirst) tellOfAbsence(result.error());
    if (isAbsence) probe(delay);
}

void RemoteFile::tellOfChange() const {
    note(fmt::format("{} has been replaced by another.", shown()));
    if (commons_->onChanged) commons_->onChanged();
}

void RemoteFile::tellOfAbsence(const RequestFault& fault) const {
    note(fmt::format(
        "{} cannot be fetched at present: {}. What is here of it is shown, and it is tried again.", shown(),
        fault.text));
}

void RemoteFile::probe(std::optional<milliseconds> delay) const {
    PartAsk ask{currentAccess(), 0, 1, state_};
    ask.delay = delay.value_or(milliseconds(0));
    commons_->transfers->start(std::move(ask), [weak = weak_from_this(), delay](PartOrFault result) {
        if (const auto self = weak.lock()) self->probed(result, delay.has_value());
    });
}

void RemoteFile::probed(const PartOrFault& result, bool again) const {
    if (!result && result.error().kind == RequestFault::Kind::Stopped) return;
    const bool isOther = !result && result.error().kind == RequestFault::Kind::Changed;
    bool isNews = false;
    milliseconds delay{0};
    {
        const Monitor::Lock lock(monitor_);
        if (!again) looking_ = false;
        isNews = isOther && !changed_;
        again = again && !result && !isOther;
        if (again) delay = backOff(result.error());
        if (isOther) goAway(result.error());
        if (result && away_ && !changed_) {
            away_.reset();
            back_ = std::chrono::steady_clock::now();
            --commons_->away;
        }
    }
    if (isNews) tellOfChange();
    if (again) probe(delay);
}

// ---- state

std::shared_ptr<const ObjectAccess> RemoteFile::currentAccess() const {
    const Monitor::Look look(monitor_);
    return access_;
}

void RemoteFile::signAnew(std::shared_ptr<const ObjectAccess> access) {
    const Monitor::Lock lock(monitor_);
    access_ = std::move(access);
}

bool RemoteFile::lost(const RequestFault& fault, RequestPace::Time begun) {
    bool isAbsence = false, isFirst = false;
    milliseconds delay{0};
    {
        const Monitor::Lock lock(monitor_);
        isAbsence = fault.kind != RequestFault::Kind::Stopped && !away_ && !changed_;
        if (isAbsence && begun < back_) return false;
        isFirst = isAbsence && !backOff_;
        if (isAbsence) {
            delay = backOff(fault);
            goAway(fault);
        }
    }
    if (isFirst) tellOfAbsence(fault);
    if (isAbsence) probe(delay);
    return true;
}

void RemoteFile::came() {
    bool isBack = false;
    {
        const Monitor::Lock lock(monitor_);
        isBack = !away_ && std::exchange(backOff_, std::nullopt).has_value();
    }
    if (isBack) note(fmt::format("{} can be fetched again.", shown()));
}

Error RemoteFile::absence() const {
    const Monitor::Look look(monitor_);
    return unavailable().value();
}

bool RemoteFile::changed() const {
    const Monitor::Look look(monitor_);
    return changed_;
}

bool RemoteFile::isAway() const {
    const Monitor::Look look(monitor_);
    return away_.has_value();
}

void RemoteFile::look() {
    {
        const Monitor::Lock lock(monitor_);
        if (looking_ || away_ || changed_) return;
        looking_ = true;
    }
    probe(std::nullopt);
}

void RemoteFile::note(const std::string& text) const {
    if (commons_->onNote) commons_->onNote(text);
}

}  // namespace scancast
