#include <utility>  // before Asio: Boost 1.74 forgets it

#include "server/net/tls/tls.hpp"

#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/system/system_error.hpp>
#include <ctime>

#include "files/input_file.hpp"
#include "server/net/tls/ticket_keys.hpp"
#include "transport/secret_file.hpp"

namespace scancast {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

// Chains have kilobytes.
constexpr std::size_t longestPem = std::size_t(1) << 20;

// Keys are agreed on anew for each connection (ECDHE), so that a key that is stolen later opens none that was recorded; and
// nothing is left of what was broken with block ciphers and MACs apart.
constexpr const char* suites12 =
    "ECDHE-ECDSA-AES128-GCM-SHA256:ECDHE-RSA-AES128-GCM-SHA256:ECDHE-ECDSA-AES256-GCM-SHA384:"
    "ECDHE-RSA-AES256-GCM-SHA384:ECDHE-ECDSA-CHACHA20-POLY1305:ECDHE-RSA-CHACHA20-POLY1305";
constexpr const char* suites13 = "TLS_AES_128_GCM_SHA256:TLS_AES_256_GCM_SHA384:TLS_CHACHA20_POLY1305_SHA256";
constexpr const char* groups = "X25519:P-256:P-384";
// Names this server's sessions among others of the process, as OpenSSL wants it (SSL_CTX_set_session_id_context(3)).
constexpr std::array<unsigned char, 8> sessionContext{'s', 'c', 'a', 'n', 'c', 'a', 's', 't'};

tl::unexpected<Error> refuse(const char* flag, const std::filesystem::path& file, const std::string& why) {
    return fail(ErrorCode::InvalidArgument, std::string("--") + flag + " " + file.string() + ": " + why,
                flag);
}

std::string dateOf(const ASN1_TIME* time) {
    std::tm utc{};
    if (ASN1_TIME_to_tm(time, &utc) != 1) return "an unknown date";
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
    return text;
}

std::chrono::system_clock::time_point pointOf(const ASN1_TIME* time) {
    std::tm utc{};
    if (ASN1_TIME_to_tm(time, &utc) != 1) return {};
    return std::chrono::system_clock::from_time_t(timegm(&utc));
}

// Clients refuse a chain for each link that has expired, unless they know another way around it.
std::chrono::system_clock::time_point expiryOf(SSL_CTX* context) {
    auto first = pointOf(X509_get0_notAfter(SSL_CTX_get0_certificate(context)));
    STACK_OF(X509)* others = nullptr;
    SSL_CTX_get_extra_chain_certs(context, &others);
    for (int i = 0; i < sk_X509_num(others); ++i)  // -1 of none
        first = std::min(first, pointOf(X509_get0_notAfter(sk_X509_value(others, i))));
    return first;
}

std::string digestOf(const std::string& text) {
    std::string digest(SHA256_DIGEST_LENGTH, '\0');
    SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(),
           reinterpret_cast<unsigned char*>(digest.data()));
    return digest;
}

Expected<void> allowOnlyModern(SSL_CTX* context) {
    SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                     SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_PRIORITIZE_CHACHA);
    // Tickets keep sessions with the clients; here there is no list of them that could grow.
    SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
    const bool done =
        SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION) == 1 &&
        SSL_CTX_set_cipher_list(context, suites12) == 1 && SSL_CTX_set_ciphersuites(context, suites13) == 1 &&
        SSL_CTX_set1_groups_list(context, groups) == 1 &&
        SSL_CTX_set_session_id_context(context, sessionContext.data(), unsigned(sessionContext.size())) == 1;
    if (!done)
        return fail(ErrorCode::Internal,
                    "The OpenSSL of this machine has none of the ciphers that this server speaks TLS with.");
    return sealTicketsOf(*context);
}

Expected<std::string> loadCertificate(ssl::context& context, const std::filesystem::path& file) {
    const auto chain = readTextFile(file, longestPem);
    if (!chain) return fail(chain.error().code, "--tls-cert " + chain.error().message, "tls-cert");
    error_code ec;
    context.use_certificate_chain(boost::asio::buffer(*chain), ec);
    if (ec) return refuse("tls-cert", file, "this is no certificate in PEM format (" + ec.message() + ").");
    const X509* certificate = SSL_CTX_get0_certificate(context.native_handle());
    const ASN1_TIME* from = X509_get0_notBefore(certificate);
    const ASN1_TIME* until = X509_get0_notAfter(certificate);
    if (X509_cmp_current_time(until) < 0)
        return refuse("tls-cert", file, "the certificate expired at " + dateOf(until) + "; renew it.");
    if (X509_cmp_current_time(from) > 0) {
        return refuse(
            "tls-cert", file,
            "the certificate is valid from " + dateOf(from) + " only; is this machine's clock right?");
    }
    return digestOf(*chain);
}

Expected<void> loadKey(ssl::context& context, const TlsFiles& files) {
    auto key = readSecretFile(files.key, longestPem);
    if (!key) return fail(key.error().code, "--tls-key: " + key.error().message, "tls-key");
    error_code ec;
    context.use_private_key(boost::asio::buffer(*key), ssl::context::pem, ec);
    OPENSSL_cleanse(key->data(), key->size());
    if (!ec) return {};
    const auto reason = ERR_GET_REASON(static_cast<unsigned long>(ec.value()));
    if (reason == X509_R_KEY_VALUES_MISMATCH || reason == X509_R_KEY_TYPE_MISMATCH) {
        return refuse("tls-key", files.key,
                      "this is not the key of the certificate " + files.certificate.string() + ".");
    }
    return refuse("tls-key", files.key,
                  "this is no private key in PEM format without a pass phrase (" + ec.message() + ").");
}

}  // namespace

Expected<ServerTls> openTls(const TlsFiles& files) {
    if (files.certificate.empty() || files.key.empty()) {
        return fail(ErrorCode::InvalidArgument,
                    "TLS needs a certificate and its key: give both --tls-cert and --tls-key.",
                    files.key.empty() ? "tls-key" : "tls-cert");
    }
    ServerTls tls;
    try {
        tls.context = std::make_shared<ssl::context>(ssl::context::tls_server);
    } catch (const boost::system::system_error& error) {
        return fail(ErrorCode::Internal, std::string("OpenSSL cannot be used: ") + error.what());
    }
    SSL_CTX* context = tls.context->native_handle();
    if (auto ok = allowOnlyModern(context); !ok) return passOn(ok);
    // A server must not ask its terminal for a pass phrase.
    SSL_CTX_set_default_passwd_cb(context, [](char*, int, int, void*) { return 0; });
    auto digest = loadCertificate(*tls.context, files.certificate);
    if (!digest) return passOn(std::move(digest));
    if (auto ok = loadKey(*tls.context, files); !ok) return passOn(ok);
    tls.digest = std::move(*digest);
    tls.expires = expiryOf(context);
    return tls;
}

std::string dateText(std::chrono::system_clock::time_point time) {
    const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
    std::tm utc{};
    gmtime_r(&seconds, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
    return text;
}

std::string expiryWarning(const ServerTls& tls, const std::filesystem::path& certificate,
                          std::chrono::system_clock::time_point now) {
    if (tls.expires > now + renewalTime) return {};
    const std::string what = "--tls-cert " + certificate.string() + ": ";
    if (tls.expires <= now)
        return what + "a certificate of its chain expired at " + dateText(tls.expires) +
               "; clients that know no other way to an authority refuse it. Put the chain of today there.";
    return what + "the certificate, or one of its chain, expires at " + dateText(tls.expires) +
           "; renew it, and send this server a SIGHUP.";
}

std::string strictTransport(std::uint64_t seconds) {
    return seconds == 0 ? std::string() : "max-age=" + std::to_string(seconds);
}

}  // namespace scancast
