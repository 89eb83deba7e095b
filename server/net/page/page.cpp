#include "server/net/page/page.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace scancast {
namespace {

const Asset* fileAt(std::string_view path) {
    const auto files = pageFiles().files;
    const auto at = std::ranges::find(files, path, &Asset::path);
    return at == files.end() ? nullptr : &*at;
}

std::optional<ServedAsset> served(const Asset* file, bool forever) {
    if (file == nullptr) return std::nullopt;
    return ServedAsset{file, forever};
}

}  // namespace

std::optional<ServedAsset> findAsset(std::string_view path) {
    constexpr std::string_view byContent = "/assets/";
    if (path == "/") path = "/index.html";
    if (!path.starts_with(byContent)) return served(fileAt(path), false);
    const std::string_view rest = path.substr(byContent.size());
    const auto slash = rest.find('/');
    // HTML names its parts from where it is.
    if (slash == 0 || slash == std::string_view::npos || rest.ends_with(".html")) return std::nullopt;
    return served(fileAt(rest.substr(slash)), rest.substr(0, slash) == pageFiles().hash);
}

std::string_view contentTypeOf(std::string_view path) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 10> types{{
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".mjs", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".json", "application/json"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".jpg", "image/jpeg"},
        {".ico", "image/x-icon"},
        {".txt", "text/plain; charset=utf-8"},
    }};
    for (const auto& [ending, type] : types) {
        if (path.size() > ending.size() && path.substr(path.size() - ending.size()) == ending) return type;
    }
    return "application/octet-stream";
}

std::string pagePolicy(std::string_view frameAncestors) {
    return "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
           "connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors " +
           std::string(frameAncestors);
}

}  // namespace scancast
