// Problems as people meet them: whoever follows a link to something that is not there gets a page that says so, with a way
// out, instead of JSON. Programs get the problem itself (protocol/problem.hpp).
//
// Pure functions; any thread. Pipeline: api → **error page** → http connection, after everything else that an answer carries.
#pragma once

#include <string>
#include <string_view>

#include "protocol/problem.hpp"
#include "server/net/api/http_message.hpp"

namespace scancast {

/// UTF-8 as it may stand in HTML, between tags and in quoted attributes; what plainText() replaces is replaced.
std::string htmlText(std::string_view text);

/// A whole page of static text, which loads nothing but the site's icon: what happened, what to do, a link to `/`.
std::string errorPage(const Problem& problem);

/// Lets in the page's own style sheet, by its hash, and nothing else. `frameAncestors` is a list of sources
/// (frameAncestors(), origin_check.hpp).
std::string errorPagePolicy(std::string_view frameAncestors);

/// Makes the answer a page when it is a problem and the request's Accept likes HTML better than JSON; says in any case that
/// this was asked (Vary). Status, ids and whatever else the answer carries stay.
void presentProblem(const HttpRequest& request, HttpResponse& response, std::string_view frameAncestors);

}  // namespace scancast
