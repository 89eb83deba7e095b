// A trace: what hostile clients, the disk, the device and the catalog do to a server, line by line; played in virtual
// time, beside a polite viewer who must not suffer from it. What tests/fuzz/fuzz_server.cpp makes up, and people can read.
//
//     machine 7                       the server's machine (drawn from that seed); only as the first line
//     1 connect                       client 1 (of 0-7) opens a stream
//     1 text {"type":"hello"}         says something; $session1, $resume1 and $frame1 are what client 1 has been told
//     1 drive {"type":"view",…}       somebody else changes what its session shows
//     1 binary                        sends what no client may
//     1 ack                           acknowledges all that came
//     1 cut / 1 bye                   its connection breaks; it leaves, and says so
//     1 picture 640 480 4             asks for a still of so many pixels and samples
//     1 gone                          does not wait for the last one any more
//     wait 40                         ms pass
//     lose / stall 500                the device is lost; the disk answers nothing for so many ms
//     remove / replace / loading / live / still     what becomes of the cloud; `replace` also brings it back
//
// What is none of these is passed over.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scancast::simulation {

/// What must not have been, the first thing of its kind; empty = nothing.
std::optional<std::string> playTrace(std::string_view trace);

}  // namespace scancast::simulation
