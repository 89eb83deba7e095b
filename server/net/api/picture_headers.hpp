// What answers with pictures say about them in headers. Pure functions; any thread. Pipeline: scheduler → **headers** → answer.
#pragma once

#include <cstdint>
#include <string>

#include "server/net/api/http_message.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// Server-Timing.
std::string serverTiming(const EncodedPicture& picture);
/// Nobody shall keep it as the picture of its view, or ask by a tag whether it is still the same.
void forbidKeeping(HttpResponse& response);
/// A picture that lacks blocks is no picture of its view.
void sayDamaged(HttpResponse& response, std::uint32_t blocks);

}  // namespace scancast
