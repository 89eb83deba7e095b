// An HTTP answer that says no, as an error of ours. Inside the client room only; a pure function.
#pragma once

#include <string_view>

#include "client/cpp/server_url.hpp"

namespace scancast::client {

/// The problem that the body describes; when it describes none, the status.
Error refusal(const ServerUrl& url, int status, std::string_view contentType, std::string_view body);

}  // namespace scancast::client
