#include "server/net/api/page.hpp"

#include <array>
#include <utility>

namespace scancast {

const Asset* findAsset(std::string_view path) {
    if (path == "/") path = "/index.html";
    for (const Asset& asset : assets()) {
        if (asset.path == path) return &asset;
    }
    return nullptr;
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

}  // namespace scancast
