// Conditional requests and content negotiation: ETag, If-None-Match, Accept, Accept-Encoding. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "renderer/cloud/cloud.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// Strong ETag, with its quotes, of a picture: the same exactly when the bytes are. Made of the cloud's
/// revision, the canonical view, the format, the device and the program's version.
std::string pictureTag(const Cloud& cloud, const View& view, PictureFormat format, const DeviceInfo& device,
                       std::string_view version);
/// Strong ETag of any bytes.
std::string contentTag(std::string_view bytes);

/// RFC 9110, 13.1.2: a list of tags or `*`, weak comparison. A malformed list matches nothing.
bool matchesAny(std::string_view ifNoneMatch, std::string_view tag);

/// RFC 9110, 12.5.1: whether the Accept header allows "image/jpeg". Empty allows everything; of the ranges
/// that fit, the most specific one decides.
bool accepts(std::string_view accept, std::string_view mediaType);
/// How much it is liked, 0-1: the quality of the range that decides.
double preference(std::string_view accept, std::string_view mediaType);
/// Whether a problem is for a person in a browser: HTML is liked better than JSON, as in what browsers send when somebody
/// follows a link. Nobody prefers anything by `*/*`, or by saying nothing.
bool prefersPage(std::string_view accept);

enum class ContentCoding : std::uint8_t { Identity, Gzip, Brotli };

/// RFC 9110, 12.5.3: the coding that the Accept-Encoding header likes best; of equally liked ones the one that packs best. As
/// it is where there is no header, it is empty, or nothing that we have is acceptable.
ContentCoding preferredCoding(std::string_view acceptEncoding);

}  // namespace scancast
