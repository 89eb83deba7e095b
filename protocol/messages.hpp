// The text messages of the WebSocket, both ways: `{"type": …}` (PROTOCOL.md, "WebSocket").
//
// Plain structs, parsed and printed by pure functions; any thread. Pipeline: net → **messages** → session.
// Messages from a client are read strictly: an unknown field is an error, because a typo must not pass
// silently (`ack` and `ping` excepted). Messages from a server are read leniently, so that servers may add
// fields.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/frame_header.hpp"
#include "protocol/problem.hpp"

namespace scancast {

inline constexpr std::string_view webSocketPath = "/api/v1/stream";
inline constexpr std::string_view webSocketProtocol = "scancast.v1";
inline constexpr std::size_t maxMessageBytes = 64 * 1024;  ///< of a client's message; the caller's to enforce
/// That a server sends at most before the first of them is acknowledged, and only to who acknowledges so quickly that they are needed.
inline constexpr int maxUnacknowledgedFrames = 16;
/// Numbers that every client can hold, those whose numbers are doubles too.
inline constexpr std::uint64_t maxFrameId = std::uint64_t(1) << 53;

/// Close codes that the server sends (RFC 6455 and its registry).
enum class CloseCode : std::uint16_t {
    Normal = 1000,
    GoingAway = 1001,        ///< the server shuts down, or the cloud that is shown was removed
    ProtocolError = 1002,    ///< wrong subprotocol or version
    UnsupportedData = 1003,  ///< a binary message, or a first message that is no hello
    InvalidPayload = 1007,   ///< text that is no JSON
    PolicyViolation = 1008,  ///< not allowed; acknowledging frames that were never sent
    MessageTooBig = 1009,
    TryAgainLater = 1013,  ///< all sessions are taken
};

namespace messages {

// ---- client → server
// -------------------------------------------------------------------------------------------

/// First message of a session. Everything is optional.
struct Hello {
    std::string cloud;                 ///< id; empty = the server's first cloud
    std::optional<int> width, height;  ///< px of the picture, 1–16384
    double pixelRatio = 1;  ///< how many of those px make one CSS px, 0.25–8; the server only takes note
    double fps = 30;        ///< wanted while moving, 1–240
    std::string resume;     ///< token of an earlier welcome, whose session goes on if it still can
    /// What is to be seen first, in place of the cloud's default view: any subset of a view, an object or null. A server that
    /// remembers the session of `resume` shows what it remembers; another one goes on with this.
    nlohmann::json view = nullptr;
    std::uint64_t seq = 0;    ///< of `view`, echoed in frames that show it
    std::uint64_t frame = 0;  ///< the newest that arrived of the session of `resume`; numbers go on behind it
    std::string follow;       ///< id of a session whose view is shown; empty = a view of one's own
    bool depth = false;  ///< each frame brings a small picture of its depth (protocol/depth/frame_depth.hpp)
    /// What this client reads, the best for moving frames first; JPEG is always among them, because stills are JPEG.
    std::vector<Codec> codecs{Codec::Jpeg};
    bool operator==(const Hello&) const = default;
};

/// The request to see something else. `changes` is any subset of a view (protocol/view/view_json.hpp), applied
/// to the view that the session has now; it is checked when it is applied.
struct ViewChange {
    std::uint64_t seq = 0;  ///< chosen by the client, echoed in frames that show this view
    std::optional<std::string>
        cloud;  ///< switches to another cloud; the base is then that cloud's default view
    nlohmann::json changes = nlohmann::json::object();
    /// Shows what that session shows from now on; empty (in JSON null) = a view of one's own again.
    std::optional<std::string> follow{};
    bool operator==(const ViewChange&) const = default;
};

/// How far quality may fall while moving; what is not given stays as it was.
struct QualityLimits {
    std::optional<double> fps;            ///< wanted while moving, 1–240
    std::optional<double> minResolution;  ///< of the full width and height, 0.1–1; at first 0.5
    std::optional<double> maxDetail;      ///< τ in px, 0–64; at first 2
    std::optional<int> minQuality;        ///< of JPEG, 1–100; at first 40
    bool operator==(const QualityLimits&) const = default;
};

/// What lies under a pixel of the view that was last asked for? Answered by picked, or by a problem.
struct Pick {
    std::uint64_t seq = 0;
    double x = 0, y = 0;  ///< px from the top left corner of the view's picture, which moving frames may be
                          ///< smaller than
    bool operator==(const Pick&) const = default;
};

struct Ack {
    std::uint64_t frame = 0;  ///< the newest frame that arrived whole; acknowledges all before it
    bool operator==(const Ack&) const = default;
};

struct Ping {
    std::uint64_t id = 0;  ///< echoed by pong
    bool operator==(const Ping&) const = default;
};

// ---- server → client
// -------------------------------------------------------------------------------------------

/// The answer to hello, before any frame.
struct Welcome {
    struct Limits {
        std::uint64_t maxMessageBytes = scancast::maxMessageBytes;
        std::uint64_t maxPixels = 0;  ///< of a picture
        int maxUnacknowledged = maxUnacknowledgedFrames;
        bool operator==(const Limits&) const = default;
    };
    std::string session;    ///< id of the session: who knows it may follow and drive it
    std::string resume;     ///< token; empty when sessions cannot be resumed
    bool resumed = false;   ///< an earlier session goes on; else this is a new one
    std::uint64_t seq = 0;  ///< of `view`: what an earlier session was asked for last; 0 in a new one
    std::string cloud;      ///< id of the cloud shown
    std::vector<std::string> methods;  ///< names; GET /api/v1/methods has the rest
    Limits limits;
    nlohmann::json view;  ///< complete: what is shown first; of a new session the cloud's default view
    std::vector<std::string> codecs{"jpeg"};  ///< that this server has, the best for moving frames first
    std::string movingCodec =
        "jpeg";                 ///< of this session's moving frames; any of them may be JPEG all the same
    std::string codecReason{};  ///< a sentence where that is not the first that hello names; else empty
    bool operator==(const Welcome&) const = default;
};

/// What the last frames cost; sent with each final still, and else at most once a second.
struct Stats {
    struct Stage {
        std::string name;  ///< "select", "nearest", "resolve", …, "encode"
        double milliseconds = 0;
        bool operator==(const Stage&) const = default;
    };
    std::uint64_t frame = 0;  ///< the frame that these numbers are of
    std::uint64_t seq = 0;
    double fps = 0;                         ///< frames sent during the last second
    double detail = 0;                      ///< τ in use, px
    std::uint64_t samples = 0, points = 0;  ///< drawn, and the scan points that they stand for
    std::uint64_t dropped = 0;              ///< views of this session that a later one overtook
    std::vector<Stage> stages;
    double resolution = 1;  ///< of the wanted width and height
    int jpegQuality = 0;
    double bandwidth = 0;  ///< of the acknowledged frames, bytes/s; 0 = no limit has shown yet
    std::string method;
    std::string methodReason;  ///< why this one, where the view says auto; else empty
    bool away = false;         ///< as in the frame's header
    std::string color{};       ///< what it is coloured by: where the view says auto, what that came to
    std::string colormap{};    ///< the ramp of that, where it takes one of colormapNames
    std::optional<std::array<double, 2>> range{};  ///< the values at its ends; null where there are none
    bool operator==(const Stats&) const = default;
};

/// The answer to pick.
struct Picked {
    std::uint64_t seq = 0;  ///< of the pick
    nlohmann::json point;   ///< as POST /clouds/{id}/pick answers; null where nothing is
    bool operator==(const Picked&) const = default;
};

/// A message was refused; the session is as it was before.
struct ProblemReport {
    std::optional<std::uint64_t> seq;  ///< of the refused view or pick, when it had one
    Problem problem;
    bool operator==(const ProblemReport&) const = default;
};

/// The server will be gone soon, and there may be others at its address: connect once more, with `resume`, and leave this
/// connection when that is welcome. Frames go on coming over this one until then.
struct Drain {
    std::uint64_t afterMilliseconds = 0;   ///< wait so long first; each client is told another time
    std::uint64_t withinMilliseconds = 0;  ///< the server is there for so long at most
    bool operator==(const Drain&) const = default;
};

/// The last words before the server closes.
struct Bye {
    CloseCode code = CloseCode::Normal;
    std::string reason;
    bool operator==(const Bye&) const = default;
};

struct Pong {
    std::uint64_t id = 0;
    bool operator==(const Pong&) const = default;
};

}  // namespace messages

using ClientMessage = std::variant<messages::Hello, messages::ViewChange, messages::QualityLimits,
                                   messages::Pick, messages::Ack, messages::Ping>;
using ServerMessage = std::variant<messages::Welcome, messages::Stats, messages::Picked,
                                   messages::ProblemReport, messages::Drain, messages::Bye, messages::Pong>;

/// Malformed when the text is no JSON object; InvalidArgument, with the JSON path as field, for everything
/// else.
Expected<ClientMessage> parseClientMessage(std::string_view text);
std::string printMessage(const ClientMessage& message);

/// Malformed for anything that no server of this protocol version sends; Unsupported for an unknown `type`,
/// which a client may skip.
Expected<ServerMessage> parseServerMessage(std::string_view text);
std::string printMessage(const ServerMessage& message);

}  // namespace scancast
