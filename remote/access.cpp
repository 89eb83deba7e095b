#include "remote/access.hpp"

#include <algorithm>
#include <cstdlib>

namespace scancast {
namespace {

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::string firstOf(const char* one, const char* other) {
    std::string value = variable(one);
    return value.empty() ? variable(other) : value;
}

/// Of a query's value, everything that is not plain.
std::string valueEncoded(const std::string& value) {
    std::string encoded;
    for (const char c : percentEncoded(value)) encoded += c == '/' ? std::string("%2F") : std::string(1, c);
    return encoded;
}

bool isWord(const std::string& text) {
    return std::ranges::all_of(text, [](char c) { return c > 0x20 && c < 0x7f; });
}

Expected<std::string> addressOf(const RemoteUrl& url, const RemoteEnvironment& environment,
                                const std::string& region) {
    const std::string key = "/" + percentEncoded(url.key());
    if (!environment.endpoint.empty()) {
        std::string endpoint = environment.endpoint;
        while (endpoint.ends_with('/')) endpoint.pop_back();
        const auto judged = RemoteUrl::parse(endpoint + "/" + url.bucket() + key);
        if (!judged || judged->scheme() == RemoteUrl::Scheme::S3 || endpoint.find('?') != endpoint.npos)
            return fail(
                ErrorCode::InvalidArgument,
                "AWS_ENDPOINT_URL: must be an address such as https://storage.example.org, without a name, a "
                "password or a query.");
        return judged->whole();
    }
    const std::string host = "s3." + region + ".amazonaws.com";
    // A certificate for *.s3.… is none for names with more dots.
    if (url.bucket().find('.') != std::string::npos) return "https://" + host + "/" + url.bucket() + key;
    return "https://" + url.bucket() + "." + host + key;
}

}  // namespace

RemoteEnvironment RemoteEnvironment::ofProcess() {
    RemoteEnvironment environment;
    environment.keyId = variable("AWS_ACCESS_KEY_ID");
    environment.secret = variable("AWS_SECRET_ACCESS_KEY");
    environment.sessionToken = variable("AWS_SESSION_TOKEN");
    environment.region = firstOf("AWS_REGION", "AWS_DEFAULT_REGION");
    environment.endpoint = firstOf("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL");
    environment.certificates = variable("SSL_CERT_FILE");
    environment.s3Certificates = variable("AWS_CA_BUNDLE");
    return environment;
}

Expected<ObjectAccess> accessTo(const RemoteUrl& url, const RemoteEnvironment& environment) {
    ObjectAccess access;
    access.shown = url.shown();
    access.url = url.whole();
    access.certificates = environment.certificates;
    if (url.scheme() != RemoteUrl::Scheme::S3) return access;
    if (!environment.s3Certificates.empty()) access.certificates = environment.s3Certificates;
    const std::string region = environment.region.empty() ? "us-east-1" : environment.region;
    const bool isRegion = region.size() <= 64 && std::ranges::all_of(region, [](char c) {
                              return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
                          });
    if (!isRegion)
        return fail(ErrorCode::InvalidArgument, "AWS_REGION: must be a region such as eu-central-1.");
    auto address = addressOf(url, environment, region);
    if (!address) return passOn(address);
    access.url = std::move(*address);
    if (environment.keyId.empty() && environment.secret.empty()) return access;
    if (environment.keyId.empty() || environment.secret.empty())
        return fail(ErrorCode::InvalidArgument,
                    environment.keyId.empty() ? "AWS_ACCESS_KEY_ID: is missing beside AWS_SECRET_ACCESS_KEY; "
                                                "set both, or neither for a public "
                                                "bucket."
                                              : "AWS_SECRET_ACCESS_KEY: is missing beside AWS_ACCESS_KEY_ID; "
                                                "set both, or neither for a public "
                                                "bucket.");
    if (!isWord(environment.keyId) || !isWord(environment.secret) || !isWord(environment.sessionToken))
        return fail(ErrorCode::InvalidArgument,
                    "The AWS credentials in the environment have blanks or line breaks in them.");
    access.signing = "aws:amz:" + region + ":s3";
    access.user = environment.keyId;
    access.password = environment.secret;
    access.mayRedirect = false;
    // Of nothing: a GET has no body. S3 wants to be told, and not every version of the library does.
    access.headers.push_back(
        "x-amz-content-sha256: e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    if (!environment.sessionToken.empty())
        access.headers.push_back("x-amz-security-token: " + environment.sessionToken);
    return access;
}

Expected<ObjectAccess> accessTo(const ListAsk& ask, const RemoteEnvironment& environment) {
    constexpr std::string_view object = "/x";
    const auto inside = RemoteUrl::parse("s3://" + ask.bucket + std::string(object));
    if (!inside) return passOn(inside);
    auto access = accessTo(*inside, environment);
    if (!access) return access;
    access->url.resize(access->url.size() - object.size());
    access->shown = "s3://" + ask.bucket + "/" + ask.prefix;
    if (access->url.find('/', access->url.find("://") + 3) == access->url.npos) access->url += '/';
    // In the order in which they are signed.
    access->url += '?';
    if (!ask.next.empty()) access->url += "continuation-token=" + valueEncoded(ask.next) + "&";
    access->url += "delimiter=%2F&list-type=2&prefix=" + valueEncoded(ask.prefix);
    return access;
}

}  // namespace scancast
