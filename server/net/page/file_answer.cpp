#include "server/net/page/file_answer.hpp"

#include "server/net/api/negotiate.hpp"

namespace scancast {
namespace {

struct Encoded {
    std::string_view bytes;
    std::string_view coding;  ///< as Content-Encoding names it; empty = none
};

Encoded encodedAs(ContentCoding coding, const Asset& file) {
    if (coding == ContentCoding::Brotli && !file.brotli.empty()) return {file.brotli, "br"};
    if (coding == ContentCoding::Gzip && !file.gzip.empty()) return {file.gzip, "gzip"};
    return {file.bytes, {}};
}

}  // namespace

HttpResponse fileAnswer(const HttpRequest& request, const ServedAsset& asset) {
    const Encoded encoded = encodedAs(preferredCoding(request.header("accept-encoding")), *asset.file);
    const std::string tag = contentTag(encoded.bytes);
    HttpResponse response;
    response.set("ETag", tag)
        .set("Cache-Control", asset.forever ? "public, max-age=31536000, immutable" : "no-cache")
        .set("Vary", "Accept-Encoding");
    if (matchesAny(request.header("if-none-match"), tag)) {
        response.status = 304;
        return response;
    }
    response.set("Content-Type", std::string(contentTypeOf(asset.file->path)));
    if (!encoded.coding.empty()) response.set("Content-Encoding", std::string(encoded.coding));
    response.text = std::string(encoded.bytes);
    return response;
}

}  // namespace scancast
