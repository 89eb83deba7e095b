#include <utility>  // before Asio: Boost 1.74 forgets it

#include "server/net/tls.hpp"

#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/x509.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/system/system_error.hpp>

#include "files/input_file.hpp"
#include "transport/secret_file.hpp"

namespace scancast {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

// Chains have kilobytes.
constexpr std::size_t longestPem = std::size_t(1) << 20;

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

Expected<void> loadCertificate(ssl::context& context, const std::filesystem::path& file) {
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
    return {};
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

Expected<std::shared_ptr<ssl::context>> openTls(const TlsFiles& files) {
    if (files.certificate.empty() || files.key.empty()) {
        return fail(ErrorCode::InvalidArgument,
                    "TLS needs a certificate and its key: give both --tls-cert and --tls-key.",
                    files.key.empty() ? "tls-key" : "tls-cert");
    }
    std::shared_ptr<ssl::context> context;
    try {
        context = std::make_shared<ssl::context>(ssl::context::tls_server);
    } catch (const boost::system::system_error& error) {
        return fail(ErrorCode::Internal, std::string("OpenSSL cannot be used: ") + error.what());
    }
    SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
    SSL_CTX_set_options(context->native_handle(), SSL_OP_NO_RENEGOTIATION);
    // A server must not ask its terminal for a pass phrase.
    SSL_CTX_set_default_passwd_cb(context->native_handle(), [](char*, int, int, void*) { return 0; });
    if (auto ok = loadCertificate(*context, files.certificate); !ok) return passOn(ok);
    if (auto ok = loadKey(*context, files); !ok) return passOn(ok);
    return context;
}

}  // namespace scancast
