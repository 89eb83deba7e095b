#include "server/net/tls.hpp"

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
    EXPECT_NE(*opened, nullptr);
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

}  // namespace
}  // namespace scancast
