// A well-behaved session for tests: welcomes, and answers each view with a moving frame and a final still
// whose "JPEG" is the view itself, so that a test can see which view a frame shows.
#pragma once

#include <algorithm>

#include "protocol/catalog.hpp"
#include "protocol/frame_header.hpp"
#include "protocol/json_text.hpp"
#include "protocol/messages.hpp"
#include "protocol/view/view_json.hpp"
#include "tests/unit/client/fake_server.hpp"

namespace scancast::client::test {

inline CloudInfo fakeCloud() {
    CloudInfo cloud;
    cloud.id = "town";
    cloud.title = "A town";
    cloud.format = "LAS 1.2";
    cloud.points = 1234;
    cloud.bounds = {glm::dvec3(-1, -2, 0), glm::dvec3(3, 4, 2)};
    cloud.attributes = {{"rgb", std::nullopt}};
    cloud.view.camera.eye = {11, 1, 4};
    cloud.view.camera.target = {1, 1, 1};
    cloud.view.width = 64;
    cloud.view.height = 48;
    return cloud;
}

inline MethodInfo fakeMethod() {
    return {"point", "Points", "One pixel each.", "-",
            {},      1,        Shading::Unlit,    {{"sizePx", "number", 1.0, 1, 50, {}, "px", "Size."}}};
}

inline FakeServer::Script fakeLists() {
    FakeServer::Script script;
    script.answers["/api/v1/clouds"].body = printJson(toJson(std::vector{fakeCloud()}));
    script.answers["/api/v1/clouds/town"].body = printJson(toJson(fakeCloud()));
    script.answers["/api/v1/methods"].body = printJson(toJson(std::vector{fakeMethod()}));
    return script;
}

inline Bytes frameBytes(const FrameHeader& header, const std::string& picture,
                        const Bytes& packedDepth = {}) {
    auto complete = header;
    complete.pictureLength = static_cast<std::uint32_t>(picture.size());
    const auto head = printFrameHeader(complete, packedDepth.size());
    Bytes bytes(head.begin(), head.end());
    bytes.insert(bytes.end(), packedDepth.begin(), packedDepth.end());
    bytes.insert(bytes.end(), picture.begin(), picture.end());
    return bytes;
}

/// `said` gets what the client says hello with.
inline bool welcome(FakePeer& peer, const std::string& session = "s1", const std::string& resume = {},
                    messages::Hello* said = nullptr) {
    std::string text;
    if (!peer.readText(text)) return false;
    const auto hello = parseClientMessage(text);
    if (!hello || !std::holds_alternative<messages::Hello>(*hello)) return false;
    if (said) *said = std::get<messages::Hello>(*hello);
    messages::Welcome welcome;
    welcome.session = session;
    welcome.resume = resume;
    welcome.cloud = "town";
    welcome.methods = {"point"};
    welcome.view = toJson(fakeCloud().view);
    return peer.sendText(printMessage(welcome));
}

inline void fakeSession(FakePeer& peer) {
    if (!welcome(peer)) return;
    View view = fakeCloud().view;
    std::uint64_t frameId = 0;
    for (std::string text; peer.readText(text);) {
        const auto message = parseClientMessage(text);
        if (!message) return peer.close(1007, message.error().message);
        const auto* change = std::get_if<messages::ViewChange>(&*message);
        if (!change) continue;
        const auto next = applyJson(view, change->changes);
        if (!next) {
            peer.sendText(printMessage(messages::ProblemReport{change->seq, problemOf(next.error())}));
            continue;
        }
        view = *next;
        FrameHeader header;
        header.seq = change->seq;
        header.width = static_cast<std::uint32_t>(view.width);
        header.height = static_cast<std::uint32_t>(view.height);
        for (const bool final : {false, true}) {
            header.frameId = ++frameId;
            header.moving = !final;
            header.still = header.final = final;
            peer.sendText(printMessage(messages::Stats{}));
            peer.ping();
            peer.sendText(R"({"type": "weather", "text": "a message from the future"})");
            peer.sendBinary(frameBytes(header, printJson(toJson(view)) + (final ? "" : " moving")));
        }
    }
}

}  // namespace scancast::client::test
