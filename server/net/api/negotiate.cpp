#include "server/net/api/negotiate.hpp"

#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "protocol/json_text.hpp"
#include "protocol/problem.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast {
namespace {

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

std::string_view takeUntil(std::string_view& text, char separator) {
    const auto end = text.find(separator);
    const std::string_view part = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    return trim(part);
}

bool equalIgnoringCase(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (lower(a[i]) != lower(b[i])) return false;
    }
    return true;
}

// 0 = does not fit; 1 = */*, 2 = image/*, 3 = image/jpeg.
int specificity(std::string_view range, std::string_view mediaType) {
    if (range == "*/*") return 1;
    if (equalIgnoringCase(range, mediaType)) return 3;
    const auto slash = mediaType.find('/');
    if (range.size() == slash + 2 && range.substr(slash) == "/*" &&
        equalIgnoringCase(range.substr(0, slash), mediaType.substr(0, slash))) {
        return 2;
    }
    return 0;
}

double weight(std::string_view parameters) {
    while (!parameters.empty()) {
        const std::string_view parameter = takeUntil(parameters, ';');
        if (parameter.size() < 3 || (parameter[0] != 'q' && parameter[0] != 'Q') || parameter[1] != '=')
            continue;
        double q = 1;
        std::from_chars(parameter.data() + 2, parameter.data() + parameter.size(), q);
        return q >= 0 && q <= 1 ? q : 1;  // "nan" is a number to from_chars
    }
    return 1;
}

}  // namespace

std::string contentTag(std::string_view bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    static constexpr char digits[] = "0123456789abcdef";
    std::string tag = "\"";
    for (unsigned char byte : canonical.digest) {
        tag.push_back(digits[byte >> 4]);
        tag.push_back(digits[byte & 15]);
    }
    return tag + '"';
}

std::string pictureTag(const Cloud& cloud, const View& view, PictureFormat format, const DeviceInfo& device,
                       std::string_view version) {
    // Parts are separated by a byte that none of them contains.
    std::string all = pictureRevision(cloud);
    all += '\0';
    all += printJson(toJson(view));
    all += '\0';
    all += format == PictureFormat::Png      ? "png"
           : format == PictureFormat::Jpeg   ? "jpeg"
           : format == PictureFormat::Pixels ? "pixels"
                                             : "depth";
    all += '\0';
    all += device.identity;
    all += '\0';
    all += version;
    // Under another memory limit a picture may be coarser.
    if (!cloud.octree.nodes().empty() && !cloud.octree.store().whole()) {
        all += '\0';
        all += std::to_string(cloud.octree.store().capacity());
    }
    return contentTag(all);
}

bool matchesAny(std::string_view ifNoneMatch, std::string_view tag) {
    std::string_view rest = trim(ifNoneMatch);
    if (rest == "*") return true;
    while (!rest.empty()) {
        if (rest.substr(0, 2) == "W/") rest.remove_prefix(2);
        if (rest.empty() || rest.front() != '"') return false;
        const auto end = rest.find('"', 1);
        if (end == std::string_view::npos) return false;
        if (rest.substr(0, end + 1) == tag) return true;
        rest = trim(rest.substr(end + 1));
        if (rest.empty()) return false;
        if (rest.front() != ',') return false;
        rest = trim(rest.substr(1));
    }
    return false;
}

bool accepts(std::string_view accept, std::string_view mediaType) {
    return preference(accept, mediaType) > 0;
}

double preference(std::string_view accept, std::string_view mediaType) {
    if (trim(accept).empty()) return 1;
    int best = 0;
    double liking = 0;
    while (!accept.empty()) {
        std::string_view item = takeUntil(accept, ',');
        const std::string_view range = takeUntil(item, ';');
        const int fit = specificity(range, mediaType);
        if (fit <= best) continue;
        best = fit;
        liking = weight(item);
    }
    return liking;
}

bool prefersPage(std::string_view accept) {
    const double json =
        std::max(preference(accept, problemMediaType), preference(accept, "application/json"));
    return preference(accept, "text/html") > json;
}

ContentCoding preferredCoding(std::string_view acceptEncoding) {
    std::optional<double> any, plain, gzip, brotli;
    while (!acceptEncoding.empty()) {
        std::string_view item = takeUntil(acceptEncoding, ',');
        const std::string_view coding = takeUntil(item, ';');
        const double liking = weight(item);
        if (coding == "*") any = liking;
        if (equalIgnoringCase(coding, "identity")) plain = liking;
        if (equalIgnoringCase(coding, "gzip") || equalIgnoringCase(coding, "x-gzip")) gzip = liking;
        if (equalIgnoringCase(coding, "br")) brotli = liking;
    }
    // What is not named is liked as `*` is; without that, only the bytes as they are may come, the last choice.
    constexpr double leastLiked = 1e-4;
    double best = plain.value_or(any.value_or(leastLiked));
    ContentCoding chosen = ContentCoding::Identity;
    const auto consider = [&](ContentCoding coding, double liking) {
        if (liking <= 0 || liking < best) return;
        best = liking;
        chosen = coding;
    };
    consider(ContentCoding::Gzip, gzip.value_or(any.value_or(0)));
    consider(ContentCoding::Brotli, brotli.value_or(any.value_or(0)));
    return chosen;
}

}  // namespace scancast
