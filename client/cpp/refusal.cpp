#include "client/cpp/refusal.hpp"

#include "protocol/json_text.hpp"
#include "protocol/problem.hpp"

namespace scancast::client {

Error refusal(const ServerUrl& url, int status, std::string_view contentType, std::string_view body) {
    if (contentType.starts_with(problemMediaType))
        if (const auto value = parseJson(body))
            if (const auto problem = problemFromJson(*value)) return errorOf(*problem);
    std::string message = url.authority();
    message += " answered " + std::to_string(status) + " " + std::string(reasonPhrase(status)) +
               ": is it a Scancast server?";
    return errorOf(problemOf(status, std::move(message)));
}

}  // namespace scancast::client
