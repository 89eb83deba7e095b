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
//     auto picture = client::decodeJpeg(frame->jpeg);
//
// Moving frames come as video, three times smaller, to who says in `Hello::codecs` that he reads it: frame_decoder.hpp.
//
// Server and Stream are synchronous: every call blocks until it is done, fails, or its deadline has passed.
// LiveStream has a thread of its own, tells by callbacks, and connects again when the connection is lost.
// Every failure is an Expected error with a sentence for people, which a terminal obeys nothing of; titles, ids and the like are as
// the server said them, and go through plainText() before they are printed. Depends on protocol/ only; neither Boost nor
// the JPEG decoder shows in the headers. Installed, it is `find_package(scancast)`, `scancast::client`,
// `#include <scancast/client.hpp>`: example/ is a whole project.
#pragma once

#include "client/cpp/camera_path.hpp"
#include "client/cpp/credentials.hpp"
#include "client/cpp/decode.hpp"
#include "client/cpp/frame_decoder.hpp"
#include "client/cpp/guest.hpp"
#include "client/cpp/live_stream.hpp"
#include "client/cpp/orbit_path.hpp"
#include "client/cpp/server.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/stream.hpp"
#include "client/cpp/timeouts.hpp"
#include "protocol/depth/frame_depth.hpp"
#include "protocol/text/plain_text.hpp"
