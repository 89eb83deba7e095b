// What the server agrees on with clients that speak TLS in ways of their own: nothing old, and sessions that are resumed.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/integration/operation/tls_client.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/serving/test_certificate.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string hsts = "Strict-Transport-Security: max-age=31536000\r\n";

class TlsConnectionsTest : public ServerTest {
  protected:
    void startWith(KeyKind kind) {
        const auto files = makeCertificate(folder, "server", -60, 3600, kind);
        options.tls = {files.certificate, files.key};
        start();
    }
    bool agrees(int version, const std::string& suites = {}) const {
        return TlsClient(port(), {version, version, suites, {}}).connected();
    }
    const TemporaryFolder folder;
};

TEST_F(TlsConnectionsTest, OnlySuitesWithForwardSecrecyAndAuthenticatedEncryption) {
    startWith(KeyKind::Rsa);  // with which OpenSSL knows all of these
    EXPECT_FALSE(agrees(TLS1_VERSION));
    EXPECT_FALSE(agrees(TLS1_1_VERSION));
    for (const char* suite :
         {"AES128-GCM-SHA256", "AES256-SHA", "ECDHE-RSA-AES128-SHA256", "ECDHE-RSA-AES256-SHA",
          "DHE-RSA-AES128-GCM-SHA256", "ECDHE-RSA-AES128-SHA", "ARIA128-GCM-SHA256"})
        EXPECT_FALSE(agrees(TLS1_2_VERSION, suite)) << suite;
    for (const char* suite :
         {"ECDHE-RSA-AES128-GCM-SHA256", "ECDHE-RSA-AES256-GCM-SHA384", "ECDHE-RSA-CHACHA20-POLY1305"})
        EXPECT_TRUE(agrees(TLS1_2_VERSION, suite)) << suite;
    EXPECT_TRUE(agrees(TLS1_3_VERSION));
}

TEST_F(TlsConnectionsTest, TheServerChoosesAndPrefersTheNewest) {
    startWith(KeyKind::Curve);
    EXPECT_EQ(TlsClient(port()).version(), "TLSv1.3");
    const TlsClient client(
        port(),
        {TLS1_2_VERSION, TLS1_2_VERSION, "ECDHE-ECDSA-AES256-GCM-SHA384:ECDHE-ECDSA-AES128-GCM-SHA256", {}});
    EXPECT_EQ(client.suite(), "ECDHE-ECDSA-AES128-GCM-SHA256");
}

TEST_F(TlsConnectionsTest, WhoComesAgainResumesHisSession) {
    startWith(KeyKind::Curve);
    for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
        TlsClient first(port(), {version, version, {}, {}});
        ASSERT_THAT(first.get("/healthz"), HasSubstr("200")) << version;
        EXPECT_FALSE(first.resumed());
        TlsClient second(port(), {version, version, {}, first.session()});
        EXPECT_TRUE(second.resumed()) << version;
        EXPECT_THAT(second.get("/healthz"), HasSubstr("200")) << version;
    }
}

TEST_F(TlsConnectionsTest, AnotherServersTicketIsOfNoUseAndDoesNoHarm) {
    startWith(KeyKind::Curve);
    TlsClient first(port());
    ASSERT_THAT(first.get("/healthz"), HasSubstr("200"));
    const auto session = first.session();
    server.reset();
    start();
    TlsClient second(port(), {TLS1_2_VERSION, TLS1_3_VERSION, {}, session});
    EXPECT_FALSE(second.resumed());
    EXPECT_THAT(second.get("/healthz"), HasSubstr("200"));
}

TEST_F(TlsConnectionsTest, AnotherCertificateIsShownToWhoComesAndOldConnectionsLiveOn) {
    startWith(KeyKind::Curve);
    TlsClient before(port());
    ASSERT_THAT(before.get("/healthz"), HasSubstr("200"));
    const auto next = makeCertificate(folder, "next", -60, 86400);
    auto tls = openTls({next.certificate, next.key});
    ASSERT_TRUE(tls) << tls.error().message;
    const auto expires = tls->expires;
    server->replaceTls(std::move(*tls));
    TlsClient after(port(), {TLS1_2_VERSION, TLS1_3_VERSION, {}, before.session()});
    EXPECT_FALSE(after.resumed()) << "it is a session with the certificate of before";
    EXPECT_NE(after.digest(), before.digest());
    EXPECT_THAT(after.get("/healthz"), HasSubstr("200"));
    EXPECT_THAT(before.get("/healthz"), HasSubstr("200")) << "it was there before";
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(expires.time_since_epoch()).count();
    const std::string line = fmt::format("\nscancast_tls_certificate_expiry_timestamp_seconds {}\n", seconds);
    EXPECT_THAT(after.get("/metrics", line), HasSubstr(line));
}

TEST_F(TlsConnectionsTest, EveryAnswerTellsBrowsersToComeByTls) {
    options.adminListen = ListenAddress{"127.0.0.1", 0};
    startWith(KeyKind::Curve);
    for (const char* target : {"/", "/nothing", "/api/v1/clouds", onePicture})
        EXPECT_THAT(TlsClient(port()).get(target), HasSubstr(hsts)) << target;
    EXPECT_THAT(TlsClient(port()).get("/api/v1/stream.mjpeg?cloud=one&width=32&height=16"), HasSubstr(hsts));
    EXPECT_THAT(
        TlsClient(port()).get("/api/v1/stream", "\r\n\r\n",
                              "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"),
        HasSubstr(hsts));
    EXPECT_EQ(request(server->adminPort(), "/healthz").header("strict-transport-security"), "")
        << "probes come in the clear";
}

TEST_F(TlsConnectionsTest, NothingIsSaidOfItInTheClearOrWhenItIsNotWanted) {
    start();
    EXPECT_EQ(request(port(), "/healthz").status, 200);
    EXPECT_EQ(request(port(), "/healthz").header("strict-transport-security"), "");
    server.reset();
    options.hstsSeconds = 0;
    startWith(KeyKind::Curve);
    const std::string answer = TlsClient(port()).get("/healthz");
    EXPECT_THAT(answer, HasSubstr("200"));
    EXPECT_THAT(answer, Not(HasSubstr("Strict-Transport-Security")));
}

}  // namespace
}  // namespace scancast::test
