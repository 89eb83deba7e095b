// One session of `scancast-client bench`: behaves as told, and writes down when what arrived.
//
// A function that blocks; each session has a thread of its own, and shares with the others what BenchClock
// holds. Pipeline: bench_command → **bench_session** → bench_report.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/cpp/program/orbit_start.hpp"
#include "client/cpp/server.hpp"
#include "protocol/frame_header.hpp"

namespace scancast::client {

enum class Behaviour : std::uint8_t {
    Moving,    ///< sends views at the rate of the options, acknowledges every frame
    Idle,      ///< looks at one view; sends another one when it is woken
    Slow,      ///< as moving, but reads no more than so many bytes a second
    NeverAck,  ///< as moving, but acknowledges nothing
};
inline constexpr std::array behaviours{Behaviour::Moving, Behaviour::Idle, Behaviour::Slow,
                                       Behaviour::NeverAck};
std::string_view name(Behaviour behaviour);

struct BenchOptions {
    OrbitStart start;
    std::string cloud;
    double seconds = 10;           ///< measured
    double warmUp = 1;             ///< moving before that, seconds
    double viewsPerSecond = 60;    ///< that a moving session sends
    double fps = 30;               ///< that it tells the server it wants
    double degreesPerSecond = 30;  ///< of its walk around the cloud
    double slowBytesPerSecond = 50e3;
    std::vector<Codec> codecs{Codec::Jpeg};  ///< that sessions say they read
    std::optional<double> wake;              ///< seconds after the start at which idle sessions send a view
};

/// What sessions of one run share.
struct BenchClock {
    std::atomic<int> notReady{0};        ///< sessions that have not seen their first final still, or failed
    std::atomic<int> unanswered{0};      ///< idle sessions that are to be woken and have not been answered
    std::atomic<std::int64_t> start{0};  ///< of the steady clock, ns; 0 = not yet
};

/// What a session saw while it was measured. Milliseconds.
struct BenchResult {
    Behaviour behaviour = Behaviour::Moving;
    std::string error;              ///< why it ended early; empty = it did not
    std::vector<double> latencies;  ///< of each moving frame: since the view that it shows was sent
    std::vector<double> frameBytes, resolutions, qualities, details;
    std::map<std::string, int> subsamplings;
    std::uint64_t bytes = 0;
    int videoFrames = 0;              ///< of the moving ones, those that came as video
    int frames = 0;                   ///< while it was measured
    int idleFrames = 0;               ///< of an idle session, before it was woken: there should be none
    std::optional<double> finalMs;    ///< since the last view was sent
    std::optional<double> answerMs;   ///< of an idle session: since its waking view was sent
    bool secondBeforeAll = false;     ///< it got another frame while others waited for their first
    std::vector<std::uint8_t> final;  ///< the last picture, if it was a final still
    View finalView;                   ///< what that shows
};

BenchResult benchSession(const Server& server, const BenchOptions& options, Behaviour behaviour, int number,
                         BenchClock& clock);

}  // namespace scancast::client
