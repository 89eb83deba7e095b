// The C++ client of a Scancast server, whole: REST calls (Server) and live sessions (Stream).
//
//     using namespace scancast;
//     const auto url = client::parseServerUrl("http://127.0.0.1:8080/");
//     const client::Server server(*url);
//     const auto picture = server.snapshot("town", {{"eye", "10,0,2"}, {"method", "cone"}});
//
//     auto stream = client::Stream::open(*url, messages::Hello{.cloud = "town"});
//     auto frame = stream->receiveFrame();  // header and JPEG
//     stream->ack(frame->header);
//
// Synchronous: every call blocks until it is done, fails, or its deadline has passed. Every failure is an
// Expected error with a sentence for people. Depends on protocol/ only; Boost does not show in the headers.
#pragma once

#include "client/cpp/credentials.hpp"
#include "client/cpp/orbit_path.hpp"
#include "client/cpp/server.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/stream.hpp"
#include "client/cpp/timeouts.hpp"
