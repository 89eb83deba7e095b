// How an object is asked for: the request's URL, and who we say that we are. Credentials come from the environment that every
// program for S3 reads, never from a command line. Plain values; any thread. Place: URL → **access** → requests.
#pragma once

#include <string>
#include <vector>

#include "remote/remote_url.hpp"

namespace scancast {

/// AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_SESSION_TOKEN, AWS_REGION or AWS_DEFAULT_REGION, AWS_ENDPOINT_URL_S3 or
/// AWS_ENDPOINT_URL; SSL_CERT_FILE, and for s3:// AWS_CA_BUNDLE before it.
struct RemoteEnvironment {
    std::string keyId{}, secret{}, sessionToken{}, region{}, endpoint{};
    std::string certificates{}, s3Certificates{};  ///< files of authorities to trust; empty = the system's

    static RemoteEnvironment ofProcess();
};

struct ObjectAccess {
    std::string url;                   ///< what is sent; may be a secret
    std::string shown;                 ///< RemoteUrl::shown()
    std::string signing;               ///< CURLOPT_AWS_SIGV4; empty = unsigned
    std::string user, password;        ///< of a signed request
    std::vector<std::string> headers;  ///< beside those of the range
    std::string certificates;
    bool mayRedirect = true;  ///< signed requests do not: what signs them is for one host
};

/// Unsigned where the environment has no credentials: public buckets. InvalidArgument for half of them, and for an endpoint
/// that is no URL.
Expected<ObjectAccess> accessTo(const RemoteUrl& url, const RemoteEnvironment& environment);

/// Which objects of a bucket there are whose key begins with a prefix; what comes behind its next slash is one (ListObjectsV2).
struct ListAsk {
    std::string bucket, prefix;
    std::string next{};  ///< as the page before said; empty: the first one
};
/// How that is asked for. InvalidArgument also for what is no bucket's name.
Expected<ObjectAccess> accessTo(const ListAsk& ask, const RemoteEnvironment& environment);

}  // namespace scancast
