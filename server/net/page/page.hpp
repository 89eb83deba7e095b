// The page and what belongs to it, built into the program (pack_files.cpp): there is no folder on a server's disk that a path
// could lead out of.
//
// Every file has its own address, `/view/camera.js`, and one that is of this very page for ever: `/assets/HASH/view/camera.js`.
// HTML names its parts by the latter, so that browsers keep them; modules name each other relatively, and stay in that folder.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace scancast {

struct Asset {
    std::string_view path;  ///< "/view/camera.js"
    std::string_view bytes;
    std::string_view gzip, brotli;  ///< the same; empty where that is no smaller
};

struct PackedFiles {
    std::string_view hash;  ///< of all of them: 16 hexadecimal digits
    std::span<const Asset> files;
};

/// Generated at build time, from the list in client/web/files.cmake.
PackedFiles pageFiles();

/// One file: protocol/openapi.json.
PackedFiles apiDescription();

struct ServedAsset {
    const Asset* file = nullptr;
    bool forever = false;  ///< the address names the content: what is there never changes
};

/// "/" is "/index.html". Beneath `/assets/` of another hash is the current file, which is not there for ever: a tab that was
/// opened before the server was replaced goes on working. HTML is not there. Empty when there is no such file.
std::optional<ServedAsset> findAsset(std::string_view path);
/// By the name's ending: "text/html; charset=utf-8".
std::string_view contentTypeOf(std::string_view path);

/// What the page may load and where it may connect: this server only. `frameAncestors` is a list of sources: who may show
/// the page in a frame (frameAncestors() in origin_check.hpp).
std::string pagePolicy(std::string_view frameAncestors);

}  // namespace scancast
