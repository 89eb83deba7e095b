#include "renderer/cloud/native/chunk_decoders.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <string>
#include <string_view>

#include "files/machine.hpp"
#include "files/system_error.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/importer_launch.hpp"
#include "renderer/cloud/import/stream/importer_process.hpp"
#include "threads/monitor.hpp"

namespace scancast {

namespace {

using namespace chunk_messages;

constexpr int mostPrograms = 4;
// A chunk is decoded within a second; whoever waits for it cannot be called off.
constexpr int longestSilence = 20;

/// One running program.
class ChunkProgram {
  public:
    static Expected<std::unique_ptr<ChunkProgram>> start(const ImportOptions& options, Packing packing) {
        const ImporterProgram importer{.name = nameFor(packing)};
        const auto program = findImporter(importer.name, options);
        if (!program) return passOn(program);
        auto command = importerCommand(importer, "--chunks", options);
        if (!command) return passOn(command);
        // The sandbox lets a program read one file: it is given its own.
        const UniqueFd itself(::open(program->c_str(), O_RDONLY | O_CLOEXEC));
        if (!itself) return fail(ErrorCode::Importer, program->string() + ": " + systemReason(errno));
        auto launched = launch(std::move(*command), itself.get(), ProgramInput::Pipe);
        if (!launched) return passOn(launched);
        return std::make_unique<ChunkProgram>(std::move(*launched), options, importer.name);
    }

    ChunkProgram(LaunchedProgram program, const ImportOptions& options, std::string_view name)
        : name_(name),
          silence_(std::clamp(options.importerSilenceSeconds, 1, longestSilence)),
          input_(std::move(program.input)),
          process_(std::move(program), silence_, options.stop) {}

    /// What the program says of the chunk, or Importer when it did not answer.
    Expected<std::vector<std::byte>> ask(const RequestHead& head, std::span<const std::byte> laszip,
                                         std::span<const std::byte> chunk) {
        const auto question = encode(head);
        for (const std::span<const std::byte> part : {std::span<const std::byte>(question), laszip, chunk})
            if (auto ok = write(part); !ok) return passOn(ok);
        std::array<std::byte, answerHeadBytes> start{};
        if (auto ok = read(start); !ok) return passOn(ok);
        const auto answer = parseAnswer(start, head);
        if (!answer) return fail(ErrorCode::Importer, answer.error().message);
        std::vector<std::byte> body(std::size_t(answer->bytes));
        if (auto ok = read(body); !ok) return passOn(ok);
        isWell_ = true;
        if (!answer->error) return body;
        return fail(*answer->error,
                    printableText({reinterpret_cast<const char*>(body.data()), body.size()}, longestReason));
    }

    /// Whether the last one was answered: else it is not asked again.
    bool isWell() const { return isWell_; }
    void begin() { isWell_ = false; }

  private:
    Expected<void> write(std::span<const std::byte> bytes) {
        const auto deadline = std::chrono::steady_clock::now() + silence_;
        while (!bytes.empty()) {
            const auto written = ::write(input_.get(), bytes.data(), bytes.size());
            if (written > 0) {
                bytes = bytes.subspan(std::size_t(written));
                continue;
            }
            if (written < 0 && errno == EINTR) continue;
            if (written < 0 && errno == EAGAIN && std::chrono::steady_clock::now() < deadline) {
                pollfd end{input_.get(), POLLOUT, 0};
                ::poll(&end, 1, 1000);
                continue;
            }
            return ended("takes no chunks", written < 0 && errno == EPIPE);
        }
        return {};
    }

    Expected<void> read(std::span<std::byte> into) {
        while (!into.empty()) {
            const auto got = process_.read(into);
            if (!got) return passOn(got);
            if (*got == 0) return ended("ended without an answer");
            into = into.subspan(*got);
        }
        return {};
    }

    tl::unexpected<Error> ended(const char* otherwise, bool isOver = false) {
        // How it ended is known once its output has been read to the end.
        std::array<std::byte, 4096> rest{};
        while (isOver) {
            const auto got = process_.read(rest);
            isOver = got && *got > 0;
        }
        const auto bad = process_.badEnd();
        return fail(ErrorCode::Importer, name_ + " " + bad.value_or(otherwise));
    }

    static const char* nameFor(Packing packing) {
        return packing == Packing::LazChunk ? "scancast-import-laz" : "scancast-import-octree";
    }

    const std::string name_;
    const std::chrono::seconds silence_;
    UniqueFd input_;
    ImporterProcess process_;
    bool isWell_ = true;
};

class ProgramPool final : public ChunkDecoders {
  public:
    ProgramPool(ImportOptions options, int most) : options_(std::move(options)), most_(most) {}

    Expected<std::vector<std::byte>> decode(const ChunkShape& shape, std::uint64_t points,
                                            std::span<const std::byte> chunk) override {
        if (shape.recordBytes == 0 || points > mostRecordBytes / shape.recordBytes ||
            chunk.size() > mostChunkBytes || shape.laszip.size() > longestLaszip)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("a chunk of {} points in {} bytes is too large", points, chunk.size()));
        const RequestHead head{
            shape.packing, shape.pointFormat, shape.recordBytes, std::uint32_t(shape.laszip.size()),
            points,        chunk.size()};
        // A program that another chunk made ill, or that has used up its time, is not this one's fault.
        auto records = askOnce(head, shape, chunk, false);
        if (!records && records.error().code == ErrorCode::Importer)
            records = askOnce(head, shape, chunk, true);
        return records;
    }

  private:
    using Program = std::unique_ptr<ChunkProgram>;

    Expected<std::vector<std::byte>> askOnce(const RequestHead& head, const ChunkShape& shape,
                                             std::span<const std::byte> chunk, bool anew) {
        Turn turn(*this, shape.owner);
        if (anew) turn.program.reset();
        if (!turn.program) {
            auto started = ChunkProgram::start(options_, shape.packing);
            if (!started) return passOn(started);
            turn.program = std::move(*started);
        }
        turn.program->begin();
        return turn.program->ask(head, shape.laszip, chunk);
    }

    /// A program of its own for as long as it lives, or the right to start one.
    struct Turn {
        Turn(ProgramPool& all, std::uint64_t whose) : pool(all), owner(whose) {
            Program another;  // goes without the lock
            Monitor::Lock lock(pool.monitor_);
            pool.monitor_.wait(lock, [&] { return pool.working_ < pool.most_; });
            ++pool.working_;
            const auto own = std::ranges::find(pool.idle_, owner, &Idle::owner);
            const bool isFull = pool.idle_.size() + std::size_t(pool.working_) > std::size_t(pool.most_);
            if (own != pool.idle_.end())
                program = std::move(own->program), pool.idle_.erase(own);
            else if (isFull)
                another = std::move(pool.idle_.front().program), pool.idle_.erase(pool.idle_.begin());
            lock.unlock();
            another.reset();
            lock.lock();
        }
        ~Turn() {
            if (program && !program->isWell()) program.reset();
            const Monitor::Lock lock(pool.monitor_);
            --pool.working_;
            if (program) pool.idle_.push_back({owner, std::move(program)});  // there is room: see below
        }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

        ProgramPool& pool;
        const std::uint64_t owner;
        Program program{};
    };
    struct Idle {
        std::uint64_t owner;
        Program program;
    };

    static std::vector<Idle> roomFor(int most) {
        std::vector<Idle> room;
        room.reserve(std::size_t(most));
        return room;
    }

    const ImportOptions options_;
    const int most_;
    Monitor monitor_;  // guards what follows
    int working_ = 0;
    std::vector<Idle> idle_ = roomFor(most_);  // who was asked last, last
};

}  // namespace

std::shared_ptr<ChunkDecoders> ChunkDecoders::create(ImportOptions options, int most) {
    if (most <= 0) most = std::clamp(int(machineCores()), 1, mostPrograms);
    return std::make_shared<ProgramPool>(std::move(options), most);
}

}  // namespace scancast
