#include "ranks/front/job_keeper.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>
#include <utility>

#include "server/base/faults.hpp"
#include "server/server.hpp"

namespace scancast {
namespace {

/// From mpirun's start to the first rank's hello.
constexpr auto startsWithin = std::chrono::minutes(2);
/// The first rank says twice a second that all are there (ranks/front/heartbeat.hpp), which itself gives up sooner.
constexpr auto silenceOfLost = std::chrono::seconds(8);
constexpr auto standstillOfLost = std::chrono::seconds(5);
/// Beats show that ranks are there, not that they draw: no picture takes so long.
constexpr auto longestOnePicture = std::chrono::minutes(5);
/// Ranks that were lost twice over the same picture are not asked for it for so long.
constexpr auto remembersFor = std::chrono::minutes(10);
constexpr int mostLosses = 2;
/// mpirun, when a rank has gone.
constexpr auto endsByItselfWithin = std::chrono::milliseconds(1000);
/// Between looks at whether a picture is still wanted, and pauses, as the cpu device makes them.
constexpr auto drawSlice = std::chrono::milliseconds(5);
/// A job that has lived for so long is started again at once.
constexpr auto soundAfter = std::chrono::seconds(10);
constexpr auto firstPause = std::chrono::milliseconds(1000);
constexpr auto longestPause = std::chrono::milliseconds(10000);
/// Why ranks are gone is said at once, and the same again so often at most.
constexpr auto saysTheSameEvery = std::chrono::minutes(10);

Error ranksGone() {
    return {ErrorCode::Unavailable,
            "The ranks that draw this cloud are not there at present; try again later.",
            {}};
}

std::size_t numberOf(const RankBytes& drawing) {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(drawing.data()), drawing.size()});
}

}  // namespace

JobKeeper::~JobKeeper() {
    stop();
    if (thread_.joinable()) thread_.join();
}

void JobKeeper::stop() {
    const Lock lock(monitor_);
    stopping_ = true;
    if (process_ != nullptr) process_->ask();
    if (socket_) socket_->close();
}

void JobKeeper::begin(std::shared_ptr<JobListener> listener) {
    listener_ = std::move(listener);
    thread_ = std::thread([this] { run(); });
}

JobStatus JobKeeper::status() const {
    const Monitor::Look look(monitor_);
    return status_;
}

void JobKeeper::waitForFirstStart(std::chrono::milliseconds patience) const {
    Lock lock(monitor_);
    monitor_.waitUntil(lock, created_ + patience, [this] { return !status_.isFirstStart || stopping_; });
}

// ---- starting it again and again

void JobKeeper::run() {
    auto pause = std::chrono::milliseconds(0);
    std::string said;
    Clock::time_point saidAt{};
    for (;;) {
        const auto began = Clock::now();
        auto why = contained("Keeping the ranks", [this] { return runOnce(); });
        {
            const Lock lock(monitor_);
            status_.isFirstStart = false;
            if (stopping_) return;
        }
        if (Clock::now() - began > soundAfter) pause = {};
        const std::string sentence = why ? *why : why.error().message;
        if (sentence != said || Clock::now() - saidAt > saysTheSameEvery || pause.count() == 0) {
            spdlog::error(
                "The ranks are gone: {}. Pictures are drawn without them; they are started again until they "
                "are "
                "back.",
                sentence);
            said = sentence;
            saidAt = Clock::now();
        }
        if (!waitBeforeNext(pause)) return;
        pause = std::clamp(pause * 2, firstPause, longestPause);
    }
}

/// False: there is no next.
bool JobKeeper::waitBeforeNext(std::chrono::milliseconds pause) {
    Lock lock(monitor_);
    if (monitor_.waitUntil(lock, Clock::now() + pause, [this] { return stopping_; })) return false;
    ++status_.restarts;
    return true;
}

/// Why it is over.
std::string JobKeeper::runOnce() {
    auto door = JobDoor::open();
    if (!door) return door.error().message;
    std::vector<std::string> words = start_;
    words.insert(words.end(), draw_.begin(), draw_.end());
    words.push_back("--door");
    words.push_back(door->path().string());
    auto process = JobProcess::start(std::move(words));
    if (!process) return process.error().message;
    // Whatever happens here, nobody asks a process that is gone.
    struct Told {
        JobKeeper& keeper;
        ~Told() { keeper.setProcess(nullptr); }
    };
    std::optional<Told> told(std::in_place, *this);
    setProcess(&*process);
    const auto giveUp = Clock::now() + startsWithin;
    auto socket = door->accept([&] {
        const Monitor::Look look(monitor_);
        return stopping_ || process->hasEnded() || Clock::now() > giveUp;
    });
    if (!socket) {
        if (process->hasEnded())
            return fmt::format("{} did not start them: {}", start_.front(), process->howItEnded());
        return fmt::format("{} did not start them in time", start_.front());
    }
    std::string why = talk(std::move(*socket));
    told.reset();
    process->end(endsByItselfWithin);
    return fmt::format("{} ({}: {})", why, start_.front(), process->howItEnded());
}

void JobKeeper::setProcess(JobProcess* process) {
    const Lock lock(monitor_);
    process_ = process;
    if (process != nullptr && stopping_) process->ask();
}

/// Until nothing more comes from it; why.
std::string JobKeeper::talk(const std::shared_ptr<JobSocket>& socket) {
    socket->setPatience(silenceOfLost, standstillOfLost);
    bool wasUp = false;
    const auto done = contained("Listening to the ranks", [&]() -> Expected<void> {
        if (auto ok = greet(socket); !ok) return ok;
        wasUp = true;
        for (;;) {
            const auto head = socket->receiveHead();
            if (!head) return passOn(head);
            if (auto taken = take(*socket, *head); !taken) return taken;
        }
    });
    socket->close();
    if (wasUp) setLost();
    return done.error().message;
}

Expected<void> JobKeeper::greet(const std::shared_ptr<JobSocket>& socket) {
    const auto head = socket->receiveHead();
    if (!head) return passOn(head);
    const auto body = socket->receiveBody(*head);
    if (!body) return passOn(body);
    const auto hello = unpackHello(*body);
    if (!hello) return passOn(hello);
    if (head->word != JobWord::Hello || hello->version != scancastVersion())
        return fail(ErrorCode::Malformed,
                    fmt::format("the first rank is of version {}, this program of version {}", hello->version,
                                scancastVersion()));
    setUp(socket, *hello);
    return {};
}

void JobKeeper::setUp(std::shared_ptr<JobSocket> socket, const JobHello& hello) {
    {
        const Lock lock(monitor_);
        if (stopping_) return socket->close();
        socket_ = std::move(socket);
        status_.isUp = true;
        status_.ranks = hello.ranks;
    }
    spdlog::info("the ranks are there: {}", hello.ranks);
    listener_->jobIsUp();
    const Lock lock(monitor_);
    status_.isFirstStart = false;  // not sooner: who waits for it asks the listener next
}

void JobKeeper::setLost() {
    // Before anybody is told that there is no picture: what is prepared again is prepared without them. The socket is closed.
    const auto told = contained("Losing the ranks", [this] { listener_->jobIsLost(); });
    if (!told) spdlog::error("{}", told.error().message);
    const Lock lock(monitor_);
    socket_.reset();
    status_.isUp = false;
    const auto now = Clock::now();
    std::erase_if(losses_, [&](const auto& loss) { return now - loss.second.last > remembersFor; });
    for (auto& [id, awaited] : awaited_) {
        if (awaited.answer) continue;
        awaited.answer = tl::unexpected(ranksGone());
        if (stopping_) continue;
        Losses& over = losses_[awaited.drawing];
        ++over.count;
        over.last = now;
    }
}

bool JobKeeper::isFeared(const RankBytes& drawing) const {
    const Monitor::Look look(monitor_);
    const auto over = losses_.find(numberOf(drawing));
    return over != losses_.end() && over->second.count >= mostLosses &&
           Clock::now() - over->second.last <= remembersFor;
}

/// That pictures are made, or nobody waits for one.
Expected<void> JobKeeper::judgeBeat() {
    {
        const Monitor::Look look(monitor_);
        for (const auto& [id, awaited] : awaited_)
            if (!awaited.answer && Clock::now() - std::max(awaited.since, lastAnswer_) > longestOnePicture)
                return fail(ErrorCode::Unavailable, "they are there, and have drawn nothing for minutes");
    }
    listener_->jobBeats();
    return {};
}

// ---- what it says

Expected<void> JobKeeper::take(JobSocket& socket, const JobHead& head) {
    if (head.word == JobWord::Picture) return takePicture(socket, head);
    const auto body = socket.receiveBody(head);
    if (!body) return passOn(body);
    if (head.word == JobWord::Beat) return judgeBeat();
    if (head.word == JobWord::Opened) {
        const auto opened = unpackOpened(*body);
        if (!opened) return passOn(opened);
        listener_->jobOpened(head.id, *opened);
        return {};
    }
    if (head.word != JobWord::Failed)
        return fail(ErrorCode::Malformed, "the first rank said what it never says");
    auto error = unpackError(*body);
    if (!error) return passOn(error);
    answer(head.id, tl::unexpected(std::move(*error)));
    return {};
}

Expected<void> JobKeeper::takePicture(JobSocket& socket, const JobHead& head) {
    std::uint32_t length = 0;
    if (auto ok = socket.receive(std::as_writable_bytes(std::span(&length, 1))); !ok) return ok;
    if (length > longestPictureHead) return fail(ErrorCode::Malformed, "a picture's head is too long");
    RankBytes packed(length);
    if (auto ok = socket.receive(packed); !ok) return ok;
    const auto picture = unpackPicture(packed);
    if (!picture) return passOn(picture);
    if (head.bytes != sizeof length + length + picture->pixelBytes())
        return fail(ErrorCode::Malformed, "a picture has another size than it says");
    bool isWanted = false;
    {
        const Monitor::Look look(monitor_);
        const auto at = awaited_.find(head.id);
        isWanted = at != awaited_.end();
        if (isWanted && (at->second.width != picture->width || at->second.height != picture->height ||
                         at->second.depth != picture->depth))
            return fail(ErrorCode::Malformed, "a picture is another than was asked for");
    }
    if (!isWanted) {
        std::vector<std::byte> thrown(64 << 10);
        for (std::uint64_t left = picture->pixelBytes(); left > 0;) {
            const auto part = std::span(thrown).first(std::min<std::uint64_t>(left, thrown.size()));
            if (auto ok = socket.receive(part); !ok) return ok;
            left -= part.size();
        }
        return {};
    }
    const std::size_t pixels = std::size_t(picture->width) * std::size_t(picture->height);
    std::vector<std::uint8_t> rgba(pixels * 4);
    if (auto ok = socket.receive(std::as_writable_bytes(std::span(rgba))); !ok) return ok;
    std::vector<float> depth(picture->depth ? pixels : 0);
    if (auto ok = socket.receive(std::as_writable_bytes(std::span(depth))); !ok) return ok;
    Frame frame;
    frame.width = picture->width;
    frame.height = picture->height;
    frame.rgba = std::move(rgba);
    frame.depth = std::move(depth);
    frame.stats.stages = picture->stages;
    answer(head.id, std::move(frame));
    return {};
}

void JobKeeper::answer(std::uint64_t id, Expected<Frame> frame) {
    const Lock lock(monitor_);
    lastAnswer_ = Clock::now();
    if (const auto at = awaited_.find(id); at != awaited_.end()) at->second.answer = std::move(frame);
}

// ---- what is asked of it

void JobKeeper::open(std::uint64_t number, const RankBytes& words) {
    std::shared_ptr<JobSocket> socket;
    {
        const Monitor::Look look(monitor_);
        socket = socket_;
    }
    if (socket && !socket->send(JobWord::Open, number, words)) socket->close();
}

Expected<Frame> JobKeeper::draw(const RankBytes& drawing, const Drawing& of, const std::stop_token& stop) {
    const bool pauses = of.pause != nullptr && *of.pause;
    std::shared_ptr<JobSocket> socket;
    std::uint64_t id = 0;
    {
        const Lock lock(monitor_);
        if (!socket_) return tl::unexpected(ranksGone());
        socket = socket_;
        id = ++lastId_;
        awaited_[id] = {of.window.width, of.window.height, of.depth, numberOf(drawing), Clock::now(), {}};
    }
    const std::byte flag{std::uint8_t(pauses)};
    const std::array<std::span<const std::byte>, 2> parts{std::span(&flag, 1), std::span(drawing)};
    const auto sent = socket->send(JobWord::Draw, id, parts);
    Lock lock(monitor_);
    if (!sent && sent.error().code == ErrorCode::ResourceLimit) {
        awaited_.erase(id);
        return passOn(sent);
    }
    if (!sent) socket->close();  // the reader finds it lost
    for (;;) {
        const auto at = awaited_.find(id);
        if (monitor_.waitUntil(lock, Clock::now() + drawSlice,
                               [&] { return at->second.answer.has_value(); })) {
            Expected<Frame> answer = std::move(*at->second.answer);
            awaited_.erase(at);
            return answer;
        }
        if (stop.stop_requested()) {
            awaited_.erase(at);
            lock.unlock();
            if (!socket->send(JobWord::Cancel, id)) socket->close();
            lock.lock();
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        }
        if (!pauses) continue;
        lock.unlock();
        (*of.pause)();
        lock.lock();
    }
}

}  // namespace scancast
