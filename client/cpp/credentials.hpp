// What a client shows of itself, and what it asks of the server's certificate. Plain values.
#pragma once

#include <filesystem>
#include <string>

namespace scancast::client {

struct Credentials {
    std::string token;  ///< access token; empty = none. Never part of a URL or a message for people
    std::filesystem::path
        authority;  ///< PEM: whom to trust to sign certificates; empty = whom the system trusts
};

}  // namespace scancast::client
