#include "transport/secret_file.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

namespace scancast {
namespace {

namespace fs = std::filesystem;

class SecretFile : public ::testing::Test {
  protected:
    fs::path write(const std::string& text, mode_t mode = 0600) const {
        std::ofstream(path) << text;
        ::chmod(path.c_str(), mode);
        return path;
    }
    const test::TemporaryFolder folder;
    const fs::path path = folder / "token";
};

constexpr const char* token = "0123456789abcdef";

TEST_F(SecretFile, HoldsAToken) {
    EXPECT_EQ(readTokenFile(write(std::string("  ") + token + "\n")).value(), token);
    EXPECT_EQ(readTokenFile(write(token, 0440)).value(), token) << "as service managers mount it";
}

TEST_F(SecretFile, ThatOthersCanReadOrChangeIsRefused) {
    for (const mode_t mode : {0644, 0604, 0620, 0602, 0601}) {
        const auto refused = readTokenFile(write(token, mode));
        ASSERT_FALSE(refused) << std::oct << mode;
        EXPECT_NE(refused.error().message.find("chmod 600 " + path.string()), std::string::npos);
        EXPECT_FALSE(readSecretFile(path, 100));
    }
}

TEST_F(SecretFile, WithoutATokenIsRefusedByName) {
    for (const std::string& text : {std::string(), std::string("\n\n"), std::string("short"),
                                    std::string(5000, 'a'), std::string(3000, ' ') + token}) {
        const auto refused = readTokenFile(write(text));
        ASSERT_FALSE(refused) << text;
        EXPECT_NE(refused.error().message.find(path.string()), std::string::npos);
    }
}

TEST_F(SecretFile, ThatIsNoFile) {
    EXPECT_EQ(readTokenFile("/no/such/file").error().code, ErrorCode::NotFound);
    EXPECT_EQ(readTokenFile("/").error().code, ErrorCode::Unsupported);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(readTokenFile(path).error().code, ErrorCode::Unsupported) << "and nobody waits for a writer";
}

}  // namespace
}  // namespace scancast
