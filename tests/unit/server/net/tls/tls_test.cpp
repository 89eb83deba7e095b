#include "server/net/tls/tls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/serving/test_certificate.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

class Tls : public ::testing::Test {
  protected:
    static std::string refusal(const fs::path& certificate, const fs::path& key) {
        const auto opened = openTls({certificate, key});
        return opened ? "it was taken" : opened.error().message;
    }
    const test::TemporaryFolder folder;
};

TEST_F(Tls, ACertificateAndItsKey) {
    const auto files = test::makeCertificate(folder, "good");
    const auto opened = openTls({files.certificate, files.key});
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_NE(opened->context, nullptr);
}

TEST_F(Tls, EveryErrorNamesFlagFileAndReason) {
    const auto good = test::makeCertificate(folder, "good");
    const auto other = test::makeCertificate(folder, "other");
    const auto old = test::makeCertificate(folder, "old", -7200, -3600);
    const auto early = test::makeCertificate(folder, "early", 3600, 7200);
    const auto text = folder / "text.pem";
    std::ofstream(text) << "nothing of the kind\n";
    fs::permissions(text, fs::perms::owner_read);
    using ::testing::AllOf;
    using ::testing::HasSubstr;
    EXPECT_THAT(refusal("/no/such.crt", good.key),
                AllOf(HasSubstr("--tls-cert /no/such.crt"), HasSubstr("no such")));
    EXPECT_THAT(refusal(good.certificate, "/no/such.key"),
                AllOf(HasSubstr("--tls-key"), HasSubstr("/no/such.key")));
    EXPECT_THAT(refusal(text, good.key), HasSubstr("no certificate in PEM format"));
    EXPECT_THAT(refusal(good.certificate, text), HasSubstr("no private key in PEM format"));
    EXPECT_THAT(refusal(good.certificate, other.key), HasSubstr("not the key of the certificate"));
    EXPECT_THAT(refusal(old.certificate, old.key), HasSubstr("expired"));
    EXPECT_THAT(refusal(early.certificate, early.key), HasSubstr("valid from"));
    EXPECT_THAT(refusal(good.certificate, {}), HasSubstr("give both --tls-cert and --tls-key"));
    const auto pipe = folder / "pipe.pem";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(refusal(pipe, good.key), HasSubstr("--tls-cert " + pipe.string() + " is a pipe, not a file"));
    EXPECT_THAT(refusal(good.certificate, pipe), HasSubstr(pipe.string() + " is a pipe, not a file"));
    fs::permissions(good.key, fs::perms::others_read, fs::perm_options::add);
    EXPECT_THAT(refusal(good.certificate, good.key), HasSubstr("chmod 600"));
}

TEST_F(Tls, WhoExpiresSoonIsSaidInTime) {
    using ::testing::HasSubstr;
    const auto now = std::chrono::system_clock::now();
    const auto files = test::makeCertificate(folder, "soon", -60, 15 * 86400);
    const auto tls = openTls({files.certificate, files.key});
    ASSERT_TRUE(tls) << tls.error().message;
    EXPECT_LT(std::chrono::abs(tls->expires - now - std::chrono::hours(15 * 24)), std::chrono::minutes(1));
    EXPECT_EQ(expiryWarning(*tls, files.certificate, now), "");
    EXPECT_THAT(expiryWarning(*tls, files.certificate, now + std::chrono::hours(25)),
                HasSubstr("expires at " + dateText(tls->expires)));
    EXPECT_THAT(expiryWarning(*tls, files.certificate, now + std::chrono::hours(16 * 24)),
                HasSubstr("expired at"));
}

TEST_F(Tls, TheFirstOfTheChainToExpireCounts) {
    const auto own = test::makeCertificate(folder, "own", -60, 90 * 86400);
    const auto above = test::makeCertificate(folder, "above", -60, 20 * 86400);
    const auto digest = openTls({own.certificate, own.key}).value().digest;
    std::ofstream(own.certificate, std::ios::app) << std::ifstream(above.certificate).rdbuf();
    const auto tls = openTls({own.certificate, own.key});
    ASSERT_TRUE(tls) << tls.error().message;
    EXPECT_LT(std::chrono::abs(tls->expires - std::chrono::system_clock::now() - std::chrono::hours(20 * 24)),
              std::chrono::minutes(1));
    EXPECT_NE(tls->digest, digest);
}

}  // namespace
}  // namespace scancast
