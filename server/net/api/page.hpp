// The page and what belongs to it, built into the program (server/cmake/EmbedFiles.cmake): there is no folder
// on a server's disk that a path could lead out of.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace scancast {

struct Asset {
    std::string_view path;  ///< "/app.js"
    std::string_view bytes;
};

/// Generated at build time.
std::span<const Asset> assets();

/// One file: protocol/openapi.json.
std::span<const Asset> apiDescription();

/// "/" is "/index.html". nullptr when there is none.
const Asset* findAsset(std::string_view path);
/// By the name's ending: "text/html; charset=utf-8".
std::string_view contentTypeOf(std::string_view path);

/// What the page may load and where it may connect: this server only.
inline constexpr std::string_view contentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
    "'self'; "
    "worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

}  // namespace scancast
