// A TLS client for tests that may be old, or want suites that nobody should: what it agreed on with the server, and
// whether by a session from before. Trusts anybody. Every wait has a deadline. One thread.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "tests/integration/raw_client.hpp"

namespace scancast::test {

class TlsClient {
  public:
    using Session = std::shared_ptr<SSL_SESSION>;
    struct Wishes {
        int leastVersion = TLS1_2_VERSION, mostVersion = TLS1_3_VERSION;
        std::string suites{};  ///< of 1.2 and before; empty = what OpenSSL has by itself
        Session session{};     ///< to resume
    };

    explicit TlsClient(std::uint16_t port) : TlsClient(port, Wishes{}) {}
    TlsClient(std::uint16_t port, const Wishes& wishes)
        : context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free) {
        SSL_CTX_set_security_level(context_.get(),
                                   0);  // what this machine thinks of a suite is not the question
        SSL_CTX_set_min_proto_version(context_.get(), wishes.leastVersion);
        SSL_CTX_set_max_proto_version(context_.get(), wishes.mostVersion);
        if (!wishes.suites.empty()) SSL_CTX_set_cipher_list(context_.get(), wishes.suites.c_str());
        SSL_CTX_set_session_cache_mode(context_.get(), SSL_SESS_CACHE_CLIENT);
        ssl_.reset(SSL_new(context_.get()));
        if (wishes.session) SSL_set_session(ssl_.get(), wishes.session.get());
        fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const timeval patience{netPatience.count(), 0};
        ::setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
        ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return;
        SSL_set_fd(ssl_.get(), fd_);
        connected_ = SSL_connect(ssl_.get()) == 1;
    }
    ~TlsClient() { ::close(fd_); }
    TlsClient(const TlsClient&) = delete;
    TlsClient& operator=(const TlsClient&) = delete;

    bool connected() const { return connected_; }
    std::string version() const { return SSL_get_version(ssl_.get()); }
    std::string suite() const { return SSL_get_cipher_name(ssl_.get()); }
    bool resumed() const { return SSL_session_reused(ssl_.get()) == 1; }
    /// Of the certificate that was shown.
    std::string digest() const {
        const std::unique_ptr<X509, void (*)(X509*)> shown(SSL_get1_peer_certificate(ssl_.get()), X509_free);
        unsigned char bytes[EVP_MAX_MD_SIZE];
        unsigned length = 0;
        if (!shown || X509_digest(shown.get(), EVP_sha256(), bytes, &length) != 1) return {};
        return {reinterpret_cast<const char*>(bytes), length};
    }
    /// The answer to a GET, all of it, up to `end`; empty when none comes. The connection stays open.
    std::string get(const std::string& target, const std::string& end = "\r\n\r\n",
                    const std::string& headers = {}) {
        const std::string text = "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
        if (!connected_ || SSL_write(ssl_.get(), text.data(), int(text.size())) <= 0) return {};
        std::string answer;
        while (answer.find(end) == std::string::npos) {
            char bytes[4096];
            const int got = SSL_read(ssl_.get(), bytes, sizeof bytes);
            if (got <= 0) break;
            answer.append(bytes, std::size_t(got));
        }
        return answer;
    }
    /// To resume later. Of TLS 1.3 there is one only when something was read (tickets come behind the greeting).
    Session session() const { return {SSL_get1_session(ssl_.get()), SSL_SESSION_free}; }

  private:
    std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_;
    struct Free {
        void operator()(SSL* ssl) const { SSL_free(ssl); }
    };
    std::unique_ptr<SSL, Free> ssl_;
    int fd_ = -1;
    bool connected_ = false;
};

}  // namespace scancast::test
