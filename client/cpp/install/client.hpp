// The whole C++ client of a Scancast server, as it is installed: #include <scancast/client.hpp>.
#pragma once

#include "client/cpp/scancast_client.hpp"
