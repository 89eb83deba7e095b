#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "remote/remote_files.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/remote/range_server.hpp"

namespace scancast {
namespace {

using std::chrono::milliseconds;
using test::RangeServer;
using Does = RangeServer::Does;
using ::testing::HasSubstr;
using ::testing::Not;

std::string noise(std::size_t bytes, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::string text(bytes, '\0');
    for (char& c : text) c = char(random());
    return text;
}

RemoteOptions quick() {
    RemoteOptions options;
    options.environment = {};
    options.transfers.firstDelay = milliseconds(1);
    options.transfers.longestDelay = milliseconds(5);
    options.transfers.seed = 1;
    options.transfers.limits.stall = milliseconds(1000);
    // A machine that is slow is no server that is, of which less would be asked for at a time.
    options.pace.quick = options.pace.slow = std::chrono::minutes(10);
    options.firstProbe = milliseconds(10);
    options.lastProbe = milliseconds(20);
    return options;
}

RemoteUrl urlOf(const RangeServer& server, const std::string& path = "/cloud.scan") {
    return *RemoteUrl::parse(server.url(path));
}

std::string read(const RandomReader& reader, std::uint64_t offset, std::size_t bytes) {
    std::string into(bytes, '\0');
    const auto got = reader.readAt(offset, std::as_writable_bytes(std::span(into)));
    EXPECT_TRUE(got) << got.error().message;
    into.resize(got.value_or(0));
    return into;
}

Error errorOfReading(const RandomReader& reader, std::uint64_t offset) {
    std::byte one{};
    const auto got = reader.readAt(offset, {&one, 1});
    return got ? Error{ErrorCode::Internal, "it was read", {}} : got.error();
}

/// Until it holds, or much more time has passed than it takes.
template <class Condition>
bool comesTrue(const Condition& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(milliseconds(10));
    return condition();
}

// Right because the bytes are compared with those that the server has.
TEST(RemoteFileTest, hasTheObjectsBytesAtAnyOffset) {
    const std::string content = noise(3'000'001);
    RangeServer server(content);
    RemoteFiles files(quick());
    const auto file = files.open(urlOf(server));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ((*file)->size(), content.size());
    std::mt19937 random(7);
    for (int i = 0; i < 50; ++i) {
        const std::uint64_t offset = random() % (content.size() + 10);
        const std::size_t bytes = random() % 300'000;
        EXPECT_EQ(read(**file, offset, bytes), offset >= content.size() ? "" : content.substr(offset, bytes));
    }
}

TEST(RemoteFileTest, fetchesWhatStandsSideBySideTogether) {
    const std::string content = noise(4 << 20);
    RangeServer server(content);
    RemoteOptions patient = quick();
    patient.transfers.limits.stall = std::chrono::minutes(1);
    RemoteFiles files(patient);
    const auto file = *files.open(urlOf(server));
    EXPECT_EQ(server.requests(), 1);
    EXPECT_EQ(read(*file, RemoteFile::pieceBytes, 1 << 20), content.substr(RemoteFile::pieceBytes, 1 << 20));
    EXPECT_EQ(server.requests(), 2);
    file->expect(2 << 20, 1 << 20);
    EXPECT_EQ(read(*file, 2 << 20, 1 << 20), content.substr(2 << 20, 1 << 20));
    EXPECT_EQ(server.requests(), 3);
    EXPECT_EQ(read(*file, (2 << 20) + 5, 1000), content.substr((2 << 20) + 5, 1000));
    EXPECT_EQ(server.requests(), 3);
}

// Seeded faults of every kind that may pass: what is read is right nevertheless.
TEST(RemoteFileTest, triesAgainWhatMayPass) {
    const std::string content = noise(2 << 20);
    std::uint64_t retries = 0;
    for (unsigned seed = 1; seed <= unsigned(test::sized(8, 2)); ++seed) {
        RangeServer server(content);
        std::mt19937 random(seed);
        server.script([&](int) {
            constexpr std::array faults{Does::Hangs, Does::Answers503, Does::BreaksOff};
            return random() % 3 == 0 ? faults[random() % faults.size()] : Does::Well;
        });
        RemoteOptions options = quick();
        options.tries = 12;
        options.pace.requests = 3;
        RemoteFiles files(options);
        const auto file = files.open(urlOf(server));
        ASSERT_TRUE(file) << seed << ": " << file.error().message;
        std::vector<std::jthread> readers;
        for (unsigned r = 0; r < 4; ++r)
            readers.emplace_back([&, r] {
                std::mt19937 own(seed * 10 + r);
                for (int i = 0; i < 6; ++i) {
                    const std::uint64_t offset = own() % content.size();
                    EXPECT_EQ(read(**file, offset, 200'000), content.substr(offset, 200'000));
                }
            });
        readers.clear();
        // A connection that turns out to be dead is replaced by the library without a word.
        EXPECT_LE(files.stats().transfers.requests, std::uint64_t(server.requests()));
        retries += files.stats().transfers.retries;
    }
    EXPECT_GT(retries, 0u);
}

struct Hostile {
    Does does;
    ErrorCode code;
    const char* says;
};

TEST(RemoteFileTest, saysWhatAServerDoesWrong) {
    RangeServer server(noise(1 << 20));
    for (const Hostile& hostile : {Hostile{Does::SendsAll, ErrorCode::Unsupported, "range requests"},
                                   {Does::SendsOthers, ErrorCode::Unsupported, "another part"},
                                   {Does::SendsMore, ErrorCode::Unsupported, "more than was asked"},
                                   {Does::SendsLess, ErrorCode::Unsupported, "another part"},
                                   {Does::Compresses, ErrorCode::Unsupported, "compresses"},
                                   {Does::Answers404, ErrorCode::NotFound, "no such object"},
                                   {Does::Answers403, ErrorCode::Io, "403 AccessDenied"},
                                   {Does::Answers503, ErrorCode::Unavailable, "503"},
                                   {Does::Hangs, ErrorCode::Unavailable, ""}}) {
        server.script([&](int) { return hostile.does; });
        RemoteFiles files(quick());
        const auto file = files.open(urlOf(server, "/cloud.scan?X-Amz-Signature=topsecret"));
        ASSERT_FALSE(file) << hostile.says;
        EXPECT_EQ(file.error().code, hostile.code) << file.error().message;
        EXPECT_THAT(file.error().message, HasSubstr(hostile.says));
        EXPECT_THAT(file.error().message, Not(HasSubstr("secret")));
    }
}

TEST(RemoteFileTest, followsRedirectionsWithinBounds) {
    const std::string content = noise(100'000);
    RangeServer server(content);
    server.script([](int) { return Does::Redirects; });
    RemoteFiles files(quick());
    const auto file = files.open(urlOf(server));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(read(**file, 90'000, 10), content.substr(90'000, 10));
}

TEST(RemoteFileTest, isAwayWhileItsServerIsAndBackByItself) {
    const std::string content = noise(2 << 20);
    RangeServer server(content);
    std::mutex mutex;
    std::vector<std::string> notes;
    RemoteOptions options = quick();
    options.tries = 2;
    options.onNote = [&](const std::string& note) {
        const std::lock_guard lock(mutex);
        notes.push_back(note);
    };
    RemoteFiles files(options);
    const auto file = *files.open(urlOf(server));
    (void)read(*file, 1 << 20, 10);
    server.goAway(true);
    EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable);
    EXPECT_TRUE(file->isAway());
    EXPECT_EQ(files.stats().away, 1u);
    EXPECT_EQ(read(*file, 1 << 20, 10), content.substr(1 << 20, 10)) << "what is here is here";
    EXPECT_EQ(errorOfReading(*file, 1'500'000).code, ErrorCode::Unavailable);
    server.goAway(false);
    ASSERT_TRUE(comesTrue([&] { return !file->isAway(); }));
    EXPECT_EQ(read(*file, 500'000, 100), content.substr(500'000, 100));
    EXPECT_TRUE(comesTrue([&] {
        const std::lock_guard lock(mutex);
        return notes.size() >= 2;
    }));
    const std::lock_guard lock(mutex);
    ASSERT_EQ(notes.size(), 2u) << "once each, however much was asked for";
    EXPECT_THAT(notes[1], HasSubstr("can be fetched again"));
}

TEST(RemoteFileTest, noticesThatTheObjectIsAnother) {
    const std::string content = noise(1 << 20);
    RangeServer server(content);
    RemoteFiles files(quick());
    std::atomic<int> told{0};
    files.onChanged([&] { ++told; });
    const auto file = *files.open(urlOf(server)), looked = *files.open(urlOf(server));
    server.replace(noise(1 << 20, 2), "\"second\"");
    EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable);
    EXPECT_TRUE(file->changed());
    EXPECT_THAT(server.lastHead(), HasSubstr("If-Match: \"first\""));
    looked->look();
    EXPECT_TRUE(comesTrue([&] { return looked->changed(); }));
    EXPECT_TRUE(comesTrue([&] { return told == 2; }));
    EXPECT_EQ(read(**files.open(urlOf(server)), 500'000, 100), noise(1 << 20, 2).substr(500'000, 100));
}

TEST(RemoteFileTest, keepsPiecesOnDiskAndFetchesBrokenOnesAnew) {
    const std::string content = noise(1 << 20);
    RangeServer server(content);
    const test::TemporaryFolder folder;
    RemoteOptions options = quick();
    options.folder = folder / "pieces";
    options.folderLimit = 10 << 20;
    const auto readAll = [&] {
        RemoteFiles files(options);
        const int before = server.requests();
        EXPECT_EQ(read(**files.open(urlOf(server)), 0, content.size()), content);
        return server.requests() - before;
    };
    EXPECT_EQ(readAll(), 2);
    EXPECT_EQ(readAll(), 1) << "whether it is what it was";
    int broken = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(options.folder)) {
        if (!file.is_regular_file() || ++broken % 4 != 0) continue;
        std::fstream(file.path(), std::ios::in | std::ios::out).seekp(5000).put('!');
    }
    EXPECT_EQ(broken, 16);
    EXPECT_GT(readAll(), 1);
    EXPECT_EQ(readAll(), 1);
    server.replace(noise(1 << 20, 2), "\"second\"");
    RemoteFiles files(options);
    EXPECT_EQ(read(**files.open(urlOf(server)), 0, content.size()), noise(1 << 20, 2));
}

TEST(RemoteFileTest, endsItsWaitsWhenItIsStopped) {
    RangeServer server(noise(1 << 20));
    RemoteOptions options = quick();
    options.transfers.firstDelay = options.transfers.longestDelay = std::chrono::hours(1);
    RemoteFiles files(options);
    const auto file = *files.open(urlOf(server));
    server.script([](int) { return Does::Answers503; });
    std::jthread reader([&] { EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable); });
    EXPECT_TRUE(comesTrue([&] { return server.requests() > 1; }));
    files.stop();
    reader.join();
    EXPECT_FALSE(files.open(urlOf(server)));
}

// A server that takes a request and never says anything, and one that never comes to an end: both have one, and who reads from
// another server meanwhile does not notice.
TEST(RemoteFileTest, givesUpServersThatSayNothingOrNeverEnd) {
    const std::string content = noise(1 << 20);
    RangeServer hung(content), well(content);
    RemoteOptions options = quick();
    options.tries = 1;
    options.transfers.limits.grace = milliseconds(400);
    options.transfers.limits.slowest = 1 << 30;
    RemoteFiles files(options);
    for (const Does does : {Does::Silent, Does::Drips}) {
        hung.script([](int) { return Does::Well; });
        const auto file = *files.open(urlOf(hung)), healthy = *files.open(urlOf(well));
        hung.script([does](int) { return does; });
        const int before = hung.requests();
        std::jthread reader([&] { EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable); });
        EXPECT_TRUE(comesTrue([&] { return hung.requests() > before; }));
        EXPECT_EQ(read(*healthy, 300'000, 100'000), content.substr(300'000, 100'000));
        reader.join();
        EXPECT_TRUE(file->isAway());
    }
}

// Three times as long would be minutes on a slow line, in which nobody is told.
TEST(RemoteFileTest, doesNotAskAgainForAsMuchOfAServerThatIsSlow) {
    RangeServer server(noise(1 << 20));
    RemoteOptions options = quick();
    options.tries = 3;
    options.firstProbe = options.lastProbe = std::chrono::hours(1);
    options.transfers.limits.grace = milliseconds(200);
    options.transfers.limits.slowest = 1 << 30;
    RemoteFiles files(options);
    const auto file = *files.open(urlOf(server));
    server.script([](int) { return Does::Drips; });
    const int before = server.requests();
    EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable);
    EXPECT_EQ(server.requests(), before + 1);
    EXPECT_TRUE(file->isAway());
}

TEST(RemoteFileTest, goesOnWithAUrlThatIsSignedAnew) {
    const std::string content = noise(1 << 20);
    RangeServer server(content);
    RemoteFiles files(quick());
    const auto file = *files.open(urlOf(server, "/cloud.scan?X-Amz-Signature=first"));
    files.signAnew(urlOf(server, "/other.scan?X-Amz-Signature=other"));
    files.signAnew(urlOf(server, "/cloud.scan?X-Amz-Signature=second"));
    EXPECT_EQ(read(*file, 500'000, 100), content.substr(500'000, 100));
    EXPECT_NE(server.lastHead().find("/cloud.scan?X-Amz-Signature=second"), std::string::npos)
        << server.lastHead();
}

TEST(RemoteFileTest, endsItsWaitForAServerThatSaysNothing) {
    RangeServer server(noise(1 << 20));
    RemoteOptions options = quick();
    options.transfers.limits.stall = options.transfers.limits.grace = std::chrono::hours(1);
    RemoteFiles files(options);
    const auto file = *files.open(urlOf(server));
    server.script([](int) { return Does::Silent; });
    std::jthread reader([&] { EXPECT_EQ(errorOfReading(*file, 500'000).code, ErrorCode::Unavailable); });
    EXPECT_TRUE(comesTrue([&] { return server.requests() > 1; }));
    files.stop();
    reader.join();
}

// A megabyte at a time would take minutes there, and nothing would be here until then.
TEST(RemoteFileTest, asksForLessAtATimeWhereRequestsTakeLong) {
    const std::string content = noise(4 << 20);
    for (const bool slow : {true, false}) {
        RangeServer server(content);
        RemoteOptions options = quick();
        options.pace = {
            .requests = 1, .pieces = 8, .quick = std::chrono::hours(1), .slow = std::chrono::hours(2)};
        if (slow) options.pace.quick = options.pace.slow = milliseconds(0);
        RemoteFiles files(options);
        const auto file = *files.open(urlOf(server));
        EXPECT_EQ(read(*file, 1 << 20, 2 << 20), content.substr(1 << 20, 2 << 20));
        const int requests = server.requests() - 1;
        EXPECT_EQ(requests, slow ? 16 : 4);
    }
}

// What was asked for ahead is there when it is read, however little memory there is.
TEST(RemoteFileTest, doesNotFetchTwiceWhatIsReadFromItsStartToItsEnd) {
    const std::string content = noise(8 << 20);
    RangeServer server(content);
    RemoteOptions options = quick();
    options.memory = 2 << 20;
    RemoteFiles files(options);
    const auto file = *files.open(urlOf(server));
    constexpr std::uint64_t step = 100'000;
    for (std::uint64_t at = 0; at < content.size(); at += step) {
        file->expect(at, 8 << 20);
        EXPECT_EQ(read(*file, at, step), content.substr(at, step));
    }
    EXPECT_EQ(files.stats().misses, content.size() / RemoteFile::pieceBytes - 1);
}

}  // namespace
}  // namespace scancast
