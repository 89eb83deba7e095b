// The certificate that the server shows, read and checked before it listens. Free function; any thread.
#pragma once

#include <filesystem>
#include <memory>

#include "protocol/error.hpp"

namespace boost::asio::ssl {
class context;
}

namespace scancast {

struct TlsFiles {
    std::filesystem::path
        certificate;            ///< PEM: the server's own, then those between it and a known authority
    std::filesystem::path key;  ///< PEM, without a pass phrase
    bool given() const { return !certificate.empty() || !key.empty(); }
};

/// TLS 1.2 and later. Errors name the file and what is wrong: missing, no PEM, another certificate's key, a
/// key that others can read, a certificate that has expired or is not valid yet.
Expected<std::shared_ptr<boost::asio::ssl::context>> openTls(const TlsFiles& files);

}  // namespace scancast
