// Objects beside the one that describes them: fetched whole, kept, missing one by one and away together. Right because the bytes are compared
// with those that the server has.
#include <gmock/gmock.h>

#include <random>
#include <thread>

#include "remote/remote_files.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/remote/range_server.hpp"

namespace scancast {
namespace {

using Milliseconds = std::chrono::milliseconds;
using test::RangeServer;
using Does = RangeServer::Does;
using ::testing::HasSubstr;

constexpr std::uint64_t anySize = 4 << 20;

std::string textOf(std::size_t bytes, unsigned seed) {
    std::mt19937 random(seed);
    std::string text(bytes, 0);
    for (char& c : text) c = char(random());
    return text;
}

RemoteOptions patient() {
    RemoteOptions options;
    options.environment = {};
    options.transfers.firstDelay = Milliseconds(1);
    options.transfers.longestDelay = Milliseconds(5);
    options.transfers.seed = 1;
    options.firstProbe = Milliseconds(10);
    options.lastProbe = Milliseconds(20);
    return options;
}

template <class Condition>
bool happens(const Condition& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(Milliseconds(10));
    return condition();
}

class RemoteFolderTest : public ::testing::Test {
  protected:
    static constexpr const char* path = "/sets/town/ept.json";

    RemoteFolderTest() {
        for (unsigned i = 0; i < 12; ++i)
            contents_["/sets/town/" + nameOf(i)] = textOf(20'000 + 70'000 * i, i);
        server_.others(path, contents_);
    }
    static std::string nameOf(unsigned i) { return "ept-data/" + std::to_string(i) + "-0-0-0.bin"; }
    std::string contentOf(unsigned i) const { return contents_.at("/sets/town/" + nameOf(i)); }

    std::shared_ptr<RemoteFolder> open(RemoteFiles& files, const std::string& query = {}) {
        const auto url = RemoteUrl::parse(server_.url(path + query));
        const auto description = files.open(*url);
        EXPECT_TRUE(description) << description.error().message;
        auto folder = files.around(*url, *description);
        EXPECT_TRUE(folder) << folder.error().message;
        return *folder;
    }
    static Expected<std::string> read(const RemoteFolder& folder, const std::string& name,
                                      std::uint64_t most = anySize) {
        const auto bytes = folder.read(name, most);
        if (!bytes) return passOn(bytes);
        return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    }

    RangeServer server_{"{\"a\": \"description\"}"};
    std::map<std::string, std::string> contents_;
};

TEST_F(RemoteFolderTest, hasObjectsWholeAndOnce) {
    RemoteFiles files(patient());
    const auto folder = open(files);
    EXPECT_EQ(read(*folder, "ept.json").value(), "{\"a\": \"description\"}");
    EXPECT_EQ(server_.requests(path), 1);
    for (unsigned i = 0; i < 3; ++i) folder->expect(nameOf(i), anySize);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(read(*folder, nameOf(i)).value_or(""), contentOf(i));
        });
    threads.clear();
    for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(server_.requests("/sets/town/" + nameOf(i)), 1) << i;
    EXPECT_EQ(files.stats().misses, 12U);
    EXPECT_TRUE(folder->forget(nameOf(3)));
    EXPECT_EQ(read(*folder, nameOf(3)).value(), contentOf(3));
    EXPECT_EQ(server_.requests("/sets/town/" + nameOf(3)), 2);
}

TEST_F(RemoteFolderTest, keepsAllItsQueryAndRefusesOneThatIsForOneObject) {
    RemoteFiles files(patient());
    const auto folder = open(files, "?token=of-all");
    EXPECT_EQ(read(*folder, nameOf(1)).value(), contentOf(1));
    EXPECT_THAT(server_.lastHead(), HasSubstr("GET /sets/town/ept-data/1-0-0-0.bin?token=of-all HTTP"));
    const auto url = RemoteUrl::parse(server_.url(std::string(path) + "?X-Amz-Signature=secret"));
    const auto refused = files.around(*url, files.open(*url).value());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(refused.error().message, HasSubstr("a presigned URL is for one object"));
    EXPECT_THAT(refused.error().message, ::testing::Not(HasSubstr("secret")));
}

TEST_F(RemoteFolderTest, whatIsMissingOrTooLongIsThatObjectsAlone) {
    RemoteFiles files(patient());
    const auto folder = open(files);
    const auto missing = read(*folder, "ept-data/9-9-9-9.bin");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::NotFound);
    EXPECT_THAT(missing.error().message, HasSubstr("its file ept-data/9-9-9-9.bin is missing"));
    const auto tooLong = read(*folder, nameOf(5), 1000);
    ASSERT_FALSE(tooLong);
    EXPECT_EQ(tooLong.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(tooLong.error().message, HasSubstr("longer than 1000 bytes"));
    for (const char* name : {"../other", "ept-data/../../x", "/etc/passwd", "a?b", "a%2fb", "a b", ""}) {
        const auto bad = read(*folder, name);
        ASSERT_FALSE(bad) << name;
        EXPECT_THAT(bad.error().message, HasSubstr("letters, digits")) << name;
    }
    EXPECT_FALSE(folder->isAway());
    EXPECT_EQ(read(*folder, nameOf(6)).value(), contentOf(6));
}

TEST_F(RemoteFolderTest, failsAtOnceWhileItsServerIsAwayAndComesBackByItself) {
    RemoteOptions options = patient();
    std::atomic<int> away = 0, back = 0;
    options.onNote = [&](const std::string& note) {
        away += note.find("cannot be fetched at present") != note.npos;
        back += note.find("can be fetched again") != note.npos;
    };
    RemoteFiles files(options);
    const auto folder = open(files);
    EXPECT_EQ(read(*folder, nameOf(0)).value(), contentOf(0));
    server_.goAway(true);
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < 6; ++t)
        threads.emplace_back([&, t] {
            const auto got = read(*folder, nameOf(1 + t));
            ASSERT_FALSE(got);
            EXPECT_EQ(got.error().code, ErrorCode::Unavailable);
        });
    threads.clear();
    EXPECT_TRUE(folder->isAway());
    EXPECT_EQ(files.stats().away, 1U);
    EXPECT_EQ(read(*folder, nameOf(0)).value(), contentOf(0));  // it is here
    server_.goAway(false);
    EXPECT_TRUE(happens([&] { return !folder->isAway(); }));
    for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(read(*folder, nameOf(i)).value_or(""), contentOf(i));
    EXPECT_EQ(away, 1);
    EXPECT_EQ(back, 1);
}

TEST_F(RemoteFolderTest, whatFailsLateSaysNothingOfAServerThatHasComeBackSince) {
    RemoteFiles files(patient());
    const auto file = files.open(*RemoteUrl::parse(server_.url(path)));
    ASSERT_TRUE(file);
    const RequestFault fault{RequestFault::Kind::Unreachable, "nothing came"};
    const auto before = std::chrono::steady_clock::now();
    EXPECT_TRUE((*file)->lost(fault, before));
    EXPECT_TRUE(happens([&] { return !(*file)->isAway(); }));
    EXPECT_FALSE((*file)->lost(fault, before));
    EXPECT_FALSE((*file)->isAway());
    server_.goAway(true);
    EXPECT_TRUE((*file)->lost(fault, std::chrono::steady_clock::now()));
    EXPECT_TRUE((*file)->isAway());
}

TEST_F(RemoteFolderTest, oneThatIsRefusedIsDamagedWhereTheDescriptionIsNot) {
    RemoteFiles files(patient());
    const auto folder = open(files);
    server_.refuse("/sets/town/" + nameOf(4));
    const auto first = read(*folder, nameOf(4));
    ASSERT_FALSE(first);
    EXPECT_EQ(first.error().code, ErrorCode::Unavailable);
    EXPECT_TRUE(happens([&] { return !folder->isAway(); }));
    const auto second = read(*folder, nameOf(4));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::Io);
    EXPECT_THAT(second.error().message, HasSubstr("403 AccessDenied"));
    EXPECT_FALSE(folder->isAway());
    EXPECT_EQ(read(*folder, nameOf(5)).value(), contentOf(5));
}

TEST_F(RemoteFolderTest, whatWasFetchedIsOnDiskUntilItsDescriptionIsAnother) {
    const test::TemporaryFolder disk;
    RemoteOptions options = patient();
    options.folder = disk.path();
    options.folderLimit = 100 << 20;
    options.memory = 0;
    const auto readAll = [&] {
        RemoteFiles files(options);
        const auto folder = open(files);
        for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(read(*folder, nameOf(i)).value_or(""), contentOf(i));
        return files.stats().misses;
    };
    EXPECT_EQ(readAll(), 12U);
    EXPECT_EQ(readAll(), 0U);
    for (auto& [name, content] : contents_) content += "!";
    server_.others(path, contents_);
    server_.replace("another description", "\"second\"");
    EXPECT_EQ(readAll(), 12U);
}

TEST_F(RemoteFolderTest, triesAgainWhatMayPass) {
    for (unsigned seed = 1; seed <= unsigned(test::sized(4, 1)); ++seed) {
        RemoteOptions options = patient();
        options.tries = 12;
        options.pace.requests = 3;
        RemoteFiles files(options);
        const auto folder = open(files);
        std::mt19937 random(seed);
        server_.script([&](int) {
            constexpr std::array faults{Does::Hangs, Does::Answers503, Does::BreaksOff};
            return random() % 3 == 0 ? faults[random() % faults.size()] : Does::Well;
        });
        for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(read(*folder, nameOf(i)).value_or(""), contentOf(i));
        server_.script({});
    }
}

TEST(RemoteUrlTest, leadsToWhatLiesBeside) {
    const auto http = RemoteUrl::parse("https://Example.org/sets/my%20town/ept.json?token=1").value();
    EXPECT_EQ(http.folderName(), "my town");
    EXPECT_EQ(http.beside("ept-data/0-0-0-0.laz").value().whole(),
              "https://example.org/sets/my%20town/ept-data/0-0-0-0.laz?token=1");
    EXPECT_FALSE(http.isPresigned());
    const auto s3 = RemoteUrl::parse("s3://scans/my town/ept.json").value();
    EXPECT_EQ(s3.folderName(), "my town");
    EXPECT_EQ(s3.beside("ept-data/0-0-0-0.laz").value().key(), "my town/ept-data/0-0-0-0.laz");
    EXPECT_EQ(RemoteUrl::parse("s3://scans/ept.json").value().folderName(), "");
    EXPECT_EQ(RemoteUrl::parse("http://host/ept.json").value().folderName(), "");
    EXPECT_FALSE(s3.beside("../x"));
    EXPECT_FALSE(http.beside("x?y"));
}

}  // namespace
}  // namespace scancast
