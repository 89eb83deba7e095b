// What went wrong, as services of maps say it: WMS's ServiceExceptionReport, OWS's ExceptionReport (WMTS). HTTP's status is that of the
// problem, whatever the body is. Pure functions; any thread.
#pragma once

#include "server/net/api/http_message.hpp"

namespace scancast {

enum class MapService : std::uint8_t {
    Wms,
    Wmts,
    Plain,  ///< tiles by their addresses: problems as everywhere (RFC 9457)
};

/// `field`: what an error is about, from which its code follows.
HttpResponse exceptionResponse(MapService service, const Problem& problem, std::string_view field = {});

}  // namespace scancast
