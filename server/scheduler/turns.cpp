#include "server/scheduler/turns.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t mostToEncode = 2;  // frames that wait for their encoder, or are with it
constexpr std::size_t mostWithin = 3;    // pictures within pauses of pictures within pauses
/// A picture is drawn within another that costs so many times as much.
constexpr double muchCheaper = 4;
/// That who asks for nothing goes on to be owed: who asks for one frame after another, with a moment between them,
/// loses nothing.
constexpr milliseconds mostOwed{250};
/// How long one waits for its blocks, at least, before another may.
constexpr milliseconds prepareSlice{250};

/// ms of a core. A guess, where nobody said: only how pictures compare matters.
double costOf(const PictureOrder& order) {
    if (order.price > 0) return order.price;
    constexpr double perPixel = 20e-6;
    return perPixel * order.view.width * order.view.height *
           order.view.quality.samples.value_or(order.complete ? defaultSamples : 1);
}

}  // namespace

// ---- who asks

Turns::ParticipantId Turns::openMailbox() {
    participants_.try_emplace(lastId_ + 1);
    return ++lastId_;
}

void Turns::closeMailbox(ParticipantId mailbox, Requests& ended) {
    const auto at = participants_.find(mailbox);
    if (at == participants_.end()) return;
    const auto its = [&](const Request& request) { return request.by == mailbox; };
    endWaiting(at->second, End::Gone, ended);
    endAside(its, End::Gone, ended);
    stopWork(its, End::Gone);
    participants_.erase(at);
}

void Turns::place(ParticipantId mailbox, Requests& one, Time now, Requests& ended) {
    const auto at = participants_.find(mailbox);
    if (stopping_ || at == participants_.end()) return endIn(one, one.begin(), End::Refused, ended);
    Participant& participant = at->second;
    Request& request = one.front();
    request.by = request.order.requester = mailbox;
    request.kind = request.order.interruptible ? Kind::Still : Kind::Moving;
    if (request.kind == Kind::Still) request.givesWayUntil = now + options_.stillPatience;
    request.asked = now;
    request.number = ++lastNumber_;
    const auto ownStill = [&](const Request& other) {
        return other.by == mailbox && other.kind == Kind::Still;
    };
    endAside(ownStill, End::Abandoned, ended);
    stopWork(ownStill, End::Abandoned);
    if (!participant.waiting.empty()) {
        request.number = participant.waiting.front().number;  // its place in line stays
        endWaiting(participant, false, participant.waiting.begin(), End::Overwritten, ended);
    }
    endStills(participant, ended);
    const bool moves = request.kind == Kind::Moving;
    enter(participant, false, one, one.begin());
    if (moves) stopStills(now);
}

bool Turns::replaceWaiting(ParticipantId mailbox, Requests& one, Time now, Requests& ended) {
    const auto at = participants_.find(mailbox);
    if (stopping_ || at == participants_.end() || at->second.waiting.empty()) return false;
    place(mailbox, one, now, ended);
    return true;
}

void Turns::abandon(ParticipantId mailbox, Requests& ended) {
    const auto at = participants_.find(mailbox);
    if (at == participants_.end()) return;
    const auto ownStill = [&](const Request& request) {
        return request.by == mailbox && request.kind == Kind::Still;
    };
    if (!at->second.waiting.empty())
        endWaiting(at->second, false, at->second.waiting.begin(), End::Abandoned, ended);
    endStills(at->second, ended);
    endAside(ownStill, End::Abandoned, ended);
    stopWork(ownStill, End::Abandoned);
}

Expected<Turns::SnapshotId> Turns::snapshot(Requests& one, Time now) {
    if (draining()) return fail(ErrorCode::ResourceLimit, "The server is shutting down.");
    if (snapshotCount_ >= options_.maxSnapshots)
        return fail(ErrorCode::ResourceLimit,
                    "Too many pictures are waiting to be rendered; try again in a moment.");
    forgetIdleClients();
    Request& request = one.front();
    const auto [known, isNew] = clients_.try_emplace(request.order.client, lastId_ + 1);
    if (isNew) {
        try {
            participants_.try_emplace(known->second);
        } catch (...) {
            clients_.erase(known);
            throw;
        }
        ++lastId_;
    }
    request.kind = Kind::Snapshot;
    request.by = known->second;
    request.asked = now;
    request.number = ++lastNumber_;
    request.deadline = now + options_.snapshotDeadline;
    enter(participants_.at(request.by), false, one, one.begin());
    return lastNumber_;
}

void Turns::abandonSnapshot(SnapshotId snapshot, Requests& ended) {
    const auto wanted = [&](const Request& request) {
        return request.number == snapshot && request.kind == Kind::Snapshot;
    };
    for (const auto& [client, id] : clients_) {
        Participant& participant = participants_.at(id);
        for (const bool prepared : {false, true}) {
            Requests& list = prepared ? participant.prepared : participant.waiting;
            const auto at = std::find_if(list.begin(), list.end(), wanted);
            if (at == list.end()) continue;
            return endWaiting(participant, prepared, at, End::Gone, ended);
        }
    }
    endAside(wanted, End::Gone, ended);
    stopWork(wanted, End::Gone);
}

void Turns::stop(Requests& ended) {
    stopping_ = true;
    const auto any = [](const Request&) { return true; };
    for (auto& [id, participant] : participants_) endWaiting(participant, End::Gone, ended);
    while (!toPrepare_.empty()) endIn(toPrepare_, toPrepare_.begin(), End::Gone, ended);
    stopWork(any, End::Gone);
}

bool Turns::idle() const {
    return waiting_[0] + waiting_[1] == 0 && toPrepare_.empty() && preparing_.empty() && !drawing() &&
           lines_[0].empty() && lines_[1].empty();
}

// ---- drawing

bool Turns::hasRoom(Line line) const {
    if (lineOf(line).size() >= mostToEncode) return false;
    // What cannot pause is not begun while a moving frame only waits for its encoder.
    return line == Line::Frames || pauses_ || waiting_[0] == 0 || hasRoom(Line::Frames);
}

template <class Visit>
void Turns::forEachInHand(const Visit& visit) const {
    for (const Requests* list : {&drawing_, &underWay_, &lineOf(Line::Pictures)})
        for (const Request& request : *list)
            if (request.kind != Kind::Moving) visit(request.order);
}

std::size_t Turns::picturesInHand() const {
    std::size_t count = 0;
    forEachInHand([&](const PictureOrder&) { ++count; });
    return count;
}

std::uint64_t Turns::frameBytes() const {
    std::uint64_t bytes = 0;
    forEachInHand([&](const PictureOrder& order) { bytes += bytesToDraw(order); });
    return bytes;
}

bool Turns::hasMemory(const Request& request) const {
    if (request.kind == Kind::Moving) return true;
    const std::uint64_t inHand = frameBytes();
    return inHand == 0 ||
           inHand + bytesToDraw(request.order) <= options_.maxFrameBytes;
}

bool Turns::hasTurn(const Participant& participant, Line line) const {
    for (const Requests* list : {&participant.prepared, &participant.waiting})
        if (!list->empty() && lineFor(list->front()) == line && hasMemory(list->front())) return true;
    return false;
}

bool Turns::hasTurn() const {
    for (const Line line : {Line::Frames, Line::Pictures}) {
        if (waiting_[std::size_t(line)] == 0 || !hasRoom(line)) continue;
        const auto its = [&](const auto& one) { return hasTurn(one.second, line); };
        if (line == Line::Frames || frameBytes() == 0 || std::ranges::any_of(participants_, its)) return true;
    }
    return false;
}

// What the participant would have drawn next, if there is room for it behind the device.
std::optional<Turns::Choice> Turns::front(Participants::iterator participant) {
    for (Requests* list : {&participant->second.prepared, &participant->second.waiting})
        if (!list->empty() && hasRoom(lineFor(list->front())) && hasMemory(list->front()))
            return Choice{participant, list};
    return std::nullopt;
}

// Of those that are eligible: before stills that give way, who is owed most; then who came first.
template <class Eligible>
std::optional<Turns::Choice> Turns::choose(Time now, const Eligible& eligible) {
    std::optional<Choice> best;
    const auto key = [&](const Choice& choice) {
        const Request& request = choice.request();
        return std::tuple(now < request.givesWayUntil, -choice.of->second.owed, request.number);
    };
    for (auto at = participants_.begin(); at != participants_.end(); ++at) {
        if (!at->second.asks()) continue;
        const auto candidate = front(at);
        if (candidate && eligible(*candidate) && (!best || key(*candidate) < key(*best))) best = candidate;
    }
    return best;
}

std::optional<Turns::Taken> Turns::take(Time now) {
    assert(drawing_.empty());
    const auto choice = choose(now, [](const Choice&) { return true; });
    if (!choice) return std::nullopt;
    return begin(*choice, now);
}

std::optional<Turns::Taken> Turns::takeWithin(Time now) {
    charge(now);
    if (drawing_.empty() || drawing_.size() > mostWithin || !hasTurn()) return std::nullopt;
    const Request& running = drawing_.back();
    if (running.end != End::Open) return std::nullopt;  // it will end now
    const auto choice = choose(now, [&](const Choice& other) { return goesBefore(other, running, now); });
    if (!choice) return std::nullopt;
    return begin(*choice, now);
}

bool Turns::goesBefore(const Choice& candidate, const Request& running, Time now) const {
    const Request& request = candidate.request();
    if (now < request.givesWayUntil) return false;
    // Frames of a session come in their order.
    const auto its = [&](const Request& drawn) { return drawn.by == request.by; };
    if (std::any_of(drawing_.begin(), drawing_.end(), its)) return false;
    const bool moves = request.kind == Kind::Moving && running.kind != Kind::Moving;
    if (!moves && costOf(request.order) * muchCheaper > costOf(running.order)) return false;
    if (moves && now < running.givesWayUntil) return true;
    return candidate.of->second.owed >= std::chrono::nanoseconds(0);
}

Turns::Taken Turns::begin(const Choice& choice, Time now) {
    std::stop_source stop;  // before anything changes: this may fail for want of memory
    charge(now);
    charged_ = now;
    const bool prepared = choice.from == &choice.of->second.prepared;
    leave(choice.of->second, prepared, choice.from->begin(), drawing_);
    Request& request = drawing_.back();
    request.stop = std::move(stop);
    request.gaveWay = false;
    request.rivals = sharers(request.by, now) - 1;
    ++request.turns;
    return std::prev(drawing_.end());
}

QueueLengths Turns::lengths() const {
    QueueLengths lengths;
    for (const auto& [id, participant] : participants_)
        for (const Requests* list : {&participant.prepared, &participant.waiting})
            for (const Request& request : *list)
                ++(request.kind == Kind::Moving  ? lengths.views
                   : request.kind == Kind::Still ? lengths.stills
                                                 : lengths.snapshots);
    lengths.blocks = toPrepare_.size() + preparing_.size();
    lengths.encodings = lines_[0].size() + lines_[1].size();
    return lengths;
}

void Turns::charge(Time now) {
    if (drawing_.empty()) return;
    spend(drawing_.back().by, now - std::exchange(charged_, now), now);
}

// Who asks for the device's time, or has it; stills that give way ask for what is left over.
bool Turns::shares(ParticipantId id, const Participant& participant, Time now) const {
    for (const Requests* list : {&participant.prepared, &participant.waiting})
        for (const Request& request : *list)
            if (now >= request.givesWayUntil) return true;
    for (const Requests* busy : {&drawing_, &underWay_})
        for (const Request& request : *busy)
            if (request.by == id && now >= request.givesWayUntil) return true;
    return false;
}

std::size_t Turns::sharers(ParticipantId besides, Time now) const {
    return 1 + std::size_t(std::count_if(participants_.begin(), participants_.end(), [&](const auto& other) {
               return other.first != besides && shares(other.first, other.second, now);
           }));
}

// Everybody who shares the time is owed a part of it, and one has had all. Who asks for nothing is paid back to.
void Turns::spend(ParticipantId participant, std::chrono::nanoseconds time, Time now) {
    const std::chrono::nanoseconds part = time / std::int64_t(sharers(participant, now));
    constexpr std::chrono::nanoseconds none{0};
    for (auto& [id, other] : participants_) {
        if (id == participant)
            other.owed += part - time;
        else if (shares(id, other, now))
            other.owed += part;
        else if (other.owed < none)
            other.owed = std::min(none, other.owed + part);
    }
}

std::chrono::nanoseconds Turns::owed(ParticipantId participant) const {
    const auto at = participants_.find(participant);
    return at == participants_.end() ? std::chrono::nanoseconds(0) : at->second.owed;
}

void Turns::letGo(Taken taken, Time now) {
    charge(now);
    underWay_.splice(underWay_.end(), drawing_, taken);
}

void Turns::resume(Taken taken, Time now) {
    charge(now);
    charged_ = now;
    drawing_.splice(drawing_.end(), underWay_, taken);
}

void Turns::drawn(Taken taken, Time now) {
    charge(now);
    taken->prepared.reset();
    lineOf(lineFor(*taken)).splice(lineOf(lineFor(*taken)).end(), drawing_, taken);
}

void Turns::lacksBlocks(Taken taken, Time now, Requests& ended) {
    charge(now);
    taken->prepared.reset();
    if (taken->end != End::Open) return endIn(drawing_, taken, taken->end, ended);
    waitAside(drawing_, taken);
}

void Turns::lacks(Taken taken, Time now, Requests& ended) {
    charge(now);
    endIn(drawing_, taken, taken->end != End::Open ? taken->end : End::Lacking, ended);
}

void Turns::failed(Taken taken, Error error, Time now, Requests& ended) {
    charge(now);
    taken->prepared.reset();
    if (taken->end != End::Open) return endIn(drawing_, taken, taken->end, ended);
    const bool cancelled = error.code == ErrorCode::Cancelled;
    if (cancelled && taken->gaveWay && returnTo(drawing_, taken)) return;
    if (!cancelled) taken->error = std::move(error);
    endIn(drawing_, taken, cancelled ? End::Abandoned : End::Failed, ended);
}

void Turns::putBack(Taken taken, Time now, Requests& ended) {
    charge(now);
    taken->prepared.reset();
    if (taken->end != End::Open) return endIn(drawing_, taken, taken->end, ended);
    if (!returnTo(drawing_, taken)) endIn(drawing_, taken, End::Overwritten, ended);
}

// ---- waiting for blocks

std::optional<Turns::Taken> Turns::takeToPrepare(Time now) {
    if (!hasToPrepare()) return std::nullopt;
    std::stop_source stop;  // before anything changes: this may fail for want of memory
    const auto least =
        std::min_element(toPrepare_.begin(), toPrepare_.end(), [](const Request& a, const Request& b) {
            return std::pair(a.prepareTime, a.number) < std::pair(b.prepareTime, b.number);
        });
    if (least->kind == Kind::Snapshot) --snapshotCount_;
    least->stop = std::move(stop);
    least->gaveWay = false;
    preparing_.splice(preparing_.end(), toPrepare_, least);
    preparingSince_ = now;
    return least;
}

void Turns::blocksCame(Taken taken, Time, Requests& ended) {
    if (taken->end != End::Open) {
        taken->prepared.reset();
        return endIn(preparing_, taken, taken->end, ended);
    }
    enter(participants_.at(taken->by), true, preparing_, taken);
}

void Turns::blocksFailed(Taken taken, Error error, Time now, Requests& ended) {
    if (taken->end != End::Open) return endIn(preparing_, taken, taken->end, ended);
    taken->prepareTime += now - preparingSince_;
    const bool cancelled = error.code == ErrorCode::Cancelled;
    if (cancelled && taken->gaveWay) return waitAside(preparing_, taken);
    if (!cancelled) taken->error = std::move(error);
    endIn(preparing_, taken, cancelled ? End::Abandoned : End::Failed, ended);
}

// So that somebody's slow disk is not everybody's: who has waited least goes next, and the one that waits now
// goes on until it has had twice as much, so that large ones get ever longer to themselves.
std::optional<Turns::Time> Turns::othersPrepareAt() const {
    if (preparing_.empty() || toPrepare_.empty()) return std::nullopt;
    const Request& now = preparing_.front();
    if (now.gaveWay || now.end != End::Open) return std::nullopt;
    auto least = std::chrono::nanoseconds::max();
    for (const Request& other : toPrepare_) least = std::min(least, other.prepareTime);
    const auto most = 2 * least + prepareSlice - now.prepareTime;
    return preparingSince_ + std::max<std::chrono::nanoseconds>(most, prepareSlice);
}

// ---- encoding

void Turns::encoded(Taken taken, std::chrono::nanoseconds took, Time now, Requests& ended) {
    spend(taken->by, took / options_.cores, now);
    endIn(lineOf(lineFor(*taken)), taken, taken->end != End::Open ? taken->end : End::Done, ended);
}

// ---- time

Turns::Time Turns::nextTime() const {
    Time next = othersPrepareAt().value_or(Time::max());
    const auto look = [&](const Requests& list) {
        for (const Request& request : list)
            if (request.end == End::Open) next = std::min(next, request.deadline);
    };
    for (const auto& [client, id] : clients_) {
        const Participant& participant = participants_.at(id);
        if (!participant.waiting.empty())  // all have the same patience: sorted
            next = std::min(next, participant.waiting.front().deadline);
        look(participant.prepared);
    }
    for (const Requests* list : {&toPrepare_, &preparing_, &drawing_, &underWay_}) look(*list);
    return next;
}

void Turns::passTime(Time now, Requests& ended) {
    const auto late = [&](const Request& request) { return request.deadline <= now; };
    stopWork(late, End::Late);
    for (const auto& [client, id] : clients_) {
        Participant& participant = participants_.at(id);
        for (const bool prepared : {false, true}) {
            Requests& list = prepared ? participant.prepared : participant.waiting;
            while (!list.empty() && late(list.front()))
                endWaiting(participant, prepared, list.begin(), End::Late, ended);
        }
    }
    endAside(late, End::Late, ended);
    if (const auto at = othersPrepareAt(); at && *at <= now) {
        preparing_.front().gaveWay = true;
        preparing_.front().stop.request_stop();
    }
}

// ---- lists

void Turns::enter(Participant& participant, bool prepared, Requests& from, Taken request) {
    if (!participant.asks())
        participant.owed = std::min<std::chrono::nanoseconds>(participant.owed, mostOwed);
    Requests& to = prepared ? participant.prepared : participant.waiting;
    to.splice(to.end(), from, request);
    ++waiting_[std::size_t(lineFor(*request))];
    if (prepared)
        ++preparedCount_;
    else if (request->kind == Kind::Snapshot)
        ++snapshotCount_;
}

void Turns::leave(Participant& participant, bool prepared, Taken request, Requests& to) {
    to.splice(to.end(), prepared ? participant.prepared : participant.waiting, request);
    --waiting_[std::size_t(lineFor(*request))];
    if (prepared)
        --preparedCount_;
    else if (request->kind == Kind::Snapshot)
        --snapshotCount_;
}

void Turns::endIn(Requests& list, Taken request, End how, Requests& ended) {
    request->end = how;
    ended.splice(ended.end(), list, request);
}

void Turns::endWaiting(Participant& participant, bool prepared, Taken request, End how, Requests& ended) {
    leave(participant, prepared, request, ended);
    request->end = how;
}

void Turns::endWaiting(Participant& participant, End how, Requests& ended) {
    for (const bool prepared : {false, true}) {
        Requests& list = prepared ? participant.prepared : participant.waiting;
        while (!list.empty()) endWaiting(participant, prepared, list.begin(), how, ended);
    }
}

// Of a mailbox, those whose samples have come.
void Turns::endStills(Participant& participant, Requests& ended) {
    for (auto at = participant.prepared.begin(); at != participant.prepared.end();) {
        const auto request = at++;
        if (request->kind == Kind::Still) endWaiting(participant, true, request, End::Abandoned, ended);
    }
}

// Those that wait for blocks, or for an encoder.
template <class Wanted>
void Turns::endAside(const Wanted& wanted, End how, Requests& ended) {
    for (auto at = toPrepare_.begin(); at != toPrepare_.end();) {
        const auto request = at++;
        if (!wanted(*request)) continue;
        if (request->kind == Kind::Snapshot) --snapshotCount_;
        endIn(toPrepare_, request, how, ended);
    }
    for (Requests& line : lines_) {
        for (auto at = line.empty() ? line.end() : std::next(line.begin()); at != line.end();) {
            const auto request = at++;
            if (wanted(*request)) endIn(line, request, how, ended);
        }
    }
}

// Whoever works on them finds out.
template <class Wanted>
void Turns::stopWork(const Wanted& wanted, End how) {
    const auto stop = [&](Request& request) {
        if (request.end != End::Open || !wanted(request)) return;
        request.end = how;
        request.stop.request_stop();
    };
    for (Requests* busy : {&drawing_, &underWay_, &preparing_})
        for (Request& request : *busy) stop(request);
    for (Requests& line : lines_)
        if (!line.empty()) stop(line.front());
}

// For a moving frame, where it cannot be drawn in a pause; blocks may go on being loaded meanwhile.
void Turns::stopStills(Time now) {
    if (pauses_) return;
    for (Requests* busy : {&drawing_, &underWay_}) {
        for (Request& request : *busy) {
            if (request.end != End::Open || now >= request.givesWayUntil) continue;
            request.gaveWay = true;
            request.stop.request_stop();
        }
    }
}

// Unless something has taken its place in its mailbox since.
bool Turns::returnTo(Requests& from, Taken taken) {
    const auto at = participants_.find(taken->by);
    if (stopping_ || at == participants_.end()) return false;
    if (taken->kind != Kind::Snapshot && !at->second.waiting.empty()) return false;
    enter(at->second, false, from, taken);
    at->second.waiting.splice(at->second.waiting.begin(), at->second.waiting, taken);  // it was first
    return true;
}

void Turns::waitAside(Requests& from, Taken taken) {
    if (taken->kind == Kind::Snapshot) ++snapshotCount_;
    toPrepare_.splice(toPrepare_.end(), from, taken);
}

// What a client has had too much counts until it is paid back.
void Turns::forgetIdleClients() {
    const auto isBusy = [&](ParticipantId id) {
        const auto its = [id](const Request& request) { return request.by == id; };
        for (const Requests* list : {&toPrepare_, &preparing_, &drawing_, &underWay_, &lines_[0], &lines_[1]})
            if (std::any_of(list->begin(), list->end(), its)) return true;
        return participants_.at(id).asks();
    };
    for (auto at = clients_.begin(); at != clients_.end();) {
        const auto client = at++;
        if (isBusy(client->second) || owed(client->second).count() < 0) continue;
        participants_.erase(client->second);
        clients_.erase(client);
    }
}

}  // namespace scancast
