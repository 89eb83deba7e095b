#include "server/commands/serve/catalog_lookout.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <future>
#include <thread>

#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds aHang{60};  // nothing but that takes so long

class CatalogLookoutTest : public ::testing::Test {
  protected:
    CatalogLookoutTest() {
        SyntheticSource source(500, ground, {});
        writeCloud(*build(source), folder / "whole");
        fs::create_directory(folder / "clouds");
        options.place = folder / "clouds";
        options.most = 10;
        options.interval = std::chrono::milliseconds(1);
    }
    void put(const std::string& name) const { fs::copy_file(folder / "whole", folder / "clouds" / name); }
    /// Whether that list is handed over, sooner or later.
    static bool comes(CatalogLookout& lookout, const std::vector<std::string>& wanted) {
        const auto end = std::chrono::steady_clock::now() + aHang;
        while (std::chrono::steady_clock::now() < end) {
            const auto news = lookout.takeNews();
            if (!news) {
                std::this_thread::yield();
                continue;
            }
            std::vector<std::string> names;
            for (const fs::path& file : news->files) names.push_back(file.filename().string());
            if (names == wanted) return true;
        }
        return false;
    }

    const TemporaryFolder folder;
    LookoutOptions options;
};

TEST_F(CatalogLookoutTest, HandsOverWhatIsThereWhenItIsAnotherList) {
    put("a.scan");
    CatalogLookout lookout(options);
    ASSERT_TRUE(lookout.waitForFirst(aHang));
    EXPECT_TRUE(comes(lookout, {"a.scan"}));
    EXPECT_FALSE(lookout.takeNews());
    put("b.scan");
    EXPECT_TRUE(comes(lookout, {"a.scan", "b.scan"}));
    lookout.setMost(1);
    EXPECT_TRUE(comes(lookout, {"a.scan"}));
    fs::remove(folder / "clouds" / "a.scan");
    fs::remove(folder / "clouds" / "b.scan");
    EXPECT_TRUE(comes(lookout, {}));
}

// As a folder of a network that does not answer: whoever asks is answered all the same.
TEST_F(CatalogLookoutTest, ALookThatHangsHoldsNobody) {
    std::promise<void> begun, release;
    std::shared_future<void> mayGoOn = release.get_future().share();
    std::atomic<bool> first = true;
    options.onNote = [&](const std::string&) {
        if (first.exchange(false)) begun.set_value();
        mayGoOn.wait();
    };
    std::ofstream(folder / "clouds" / "half.scan") << "half";
    put("a.scan");
    CatalogLookout lookout(options);
    begun.get_future().wait();
    EXPECT_FALSE(lookout.waitForFirst(std::chrono::milliseconds(1)));
    EXPECT_FALSE(lookout.takeNews());
    lookout.setMost(3);
    lookout.requestStop();
    EXPECT_FALSE(lookout.finished());
    release.set_value();
    ASSERT_TRUE(lookout.waitForFirst(aHang));
    EXPECT_TRUE(comes(lookout, {"a.scan"})) << "what it has found out is not lost";
    while (!lookout.finished()) std::this_thread::yield();
}

}  // namespace
}  // namespace scancast::test
