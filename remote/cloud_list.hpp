// A list of clouds at any web server: plain text, a name or a URL a line, or JSON. And which URL such a word means, beside that
// list. What a list may name is bounded, because whoever writes it has the server fetch it. Pure functions; any thread. Place:
// requests → **cloud list** → clouds that come and go.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "remote/remote_url.hpp"

namespace scancast {

/// The words, in their order. Text: blank lines and those that begin with # say nothing. JSON: an array of texts, or an object whose
/// "clouds" is one. Malformed for a page of HTML, for text without any line that is a URL or ends with .scan, .laz or /ept.json (a proxy's apology), for JSON
/// of another kind; and for nothing at all, which a file is while it is being written: a list that is to be empty has a comment in it, or is [].
Expected<std::vector<std::string>> parseCloudList(std::string_view text);

/// A URL as it is; or a path, relative to the list's folder or, with a / in front, to its host: characters that no URL has become
/// %XX. InvalidArgument for what RemoteUrl::parse() refuses, and for what this list may not name: http:// from one behind https://;
/// s3://, which the server would sign, from any that is not in S3 itself; "..".
Expected<RemoteUrl> urlIn(const RemoteUrl& list, std::string_view word);

}  // namespace scancast
