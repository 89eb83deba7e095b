// client → server: read strictly, printed without what is at its default.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/messages.hpp"
#include "protocol/nearest_name.hpp"
#include "protocol/view/view.hpp"

namespace scancast {
namespace {

using namespace messages;
using nlohmann::json;

constexpr std::array<std::string_view, 6> types{"hello", "view", "quality", "pick", "ack", "ping"};

void checkRange(FieldReader& fields, std::string_view key, double value, double least, double most) {
    if (!(value >= least && value <= most))
        fields.error(key, "must lie between " + printJson(least) + " and " + printJson(most));
}

void limited(FieldReader& fields, std::string_view key, std::optional<double>& out, double least,
             double most) {
    if (fields.number(key, out) && out) checkRange(fields, key, *out, least, most);
}

Expected<ClientMessage> finish(FieldReader& fields, ClientMessage message) {
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return message;
}

void readCodecs(FieldReader& fields, std::vector<Codec>& codecs) {
    const auto* list = fields.findValue("codecs");
    if (!list) return;
    if (!list->is_array() || list->empty() || list->size() > codecNames.size())
        return fields.error("codecs", "expected an array of one or two names");
    std::vector<Codec> read;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& item = (*list)[i];
        const std::string key = "codecs[" + std::to_string(i) + "]";
        if (!item.is_string()) return fields.error(key, "expected the name of a codec");
        const auto& text = item.get_ref<const std::string&>();
        const auto codec = codecNamed(text);
        if (!codec)
            return fields.error(
                Error{ErrorCode::InvalidArgument, unknownName(fields.path(key), text, codecNames), key});
        if (std::ranges::find(read, *codec) != read.end()) return fields.error(key, "is named twice");
        read.push_back(*codec);
    }
    if (std::ranges::find(read, Codec::Jpeg) == read.end())
        return fields.error("codecs", "must hold \"jpeg\": stills are JPEG for everybody");
    codecs = std::move(read);
}

Expected<ClientMessage> readHello(FieldReader& fields) {
    Hello hello;
    fields.text("cloud", hello.cloud);
    fields.integer("width", hello.width, 1, maxPictureSide);
    fields.integer("height", hello.height, 1, maxPictureSide);
    if (fields.number("pixelRatio", hello.pixelRatio))
        checkRange(fields, "pixelRatio", hello.pixelRatio, 0.25, 8);
    if (fields.number("fps", hello.fps)) checkRange(fields, "fps", hello.fps, 1, 240);
    if (fields.findValue("resume")) fields.text("resume", hello.resume);
    if (fields.findValue("follow")) fields.text("follow", hello.follow);
    if (const auto* view = fields.findValue("view")) {
        hello.view = *view;
        if (!view->is_object()) fields.error("view", "expected an object");
    }
    fields.integer("seq", hello.seq, 0, UINT64_MAX);
    fields.integer("frame", hello.frame, 0, maxFrameId);
    fields.flag("depth", hello.depth);
    readCodecs(fields, hello.codecs);
    if (!hello.follow.empty() && !hello.cloud.empty())
        fields.error("follow", "shows its own cloud; leave cloud out");
    if (!hello.follow.empty() && !hello.view.is_null())
        fields.error("follow", "shows another session's view; leave view out");
    return finish(fields, hello);
}

Expected<ClientMessage> readView(json&& object) {
    ViewChange view;
    FieldReader fields(object);
    if (fields.require("seq")) fields.integer("seq", view.seq, 0, UINT64_MAX);
    std::string cloud;
    if (fields.text("cloud", cloud)) view.cloud = cloud;
    std::string leader;
    if (fields.find("follow")) {
        if (fields.findValue("follow")) fields.text("follow", leader);
        view.follow = leader;
    }
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    view.changes = std::move(object);  // nothing is read from it any more
    for (const auto* own : {"type", "seq", "cloud", "follow"}) view.changes.erase(own);
    return view;
}

Expected<ClientMessage> readQuality(FieldReader& fields) {
    QualityLimits limits;
    limited(fields, "fps", limits.fps, 1, 240);
    limited(fields, "minResolution", limits.minResolution, 0.1, 1);
    limited(fields, "maxDetail", limits.maxDetail, 0, 64);
    fields.integer("minQuality", limits.minQuality, 1, 100);
    return finish(fields, limits);
}

Expected<ClientMessage> readPick(FieldReader& fields) {
    Pick pick;
    fields.integer("seq", pick.seq, 0, UINT64_MAX);
    for (const auto& [key, out] : {std::pair<std::string_view, double*>{"x", &pick.x}, {"y", &pick.y}}) {
        if (!fields.require(key) || !fields.number(key, *out)) continue;
        checkRange(fields, key, *out, 0, maxPictureSide);
    }
    return finish(fields, pick);
}

Expected<ClientMessage> readAck(FieldReader& fields) {
    Ack ack;
    if (fields.require("frame")) fields.integer("frame", ack.frame, 0, UINT64_MAX);
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return ack;
}

Expected<ClientMessage> readPing(FieldReader& fields) {
    Ping ping;
    fields.integer("id", ping.id, 0, UINT64_MAX);
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return ping;
}

json print(const Hello& hello) {
    json object = {{"type", "hello"}, {"pixelRatio", hello.pixelRatio}, {"fps", hello.fps}};
    if (!hello.cloud.empty()) object["cloud"] = hello.cloud;
    if (hello.width) object["width"] = *hello.width;
    if (hello.height) object["height"] = *hello.height;
    if (!hello.resume.empty()) object["resume"] = hello.resume;
    if (!hello.follow.empty()) object["follow"] = hello.follow;
    if (!hello.view.is_null()) object["view"] = hello.view;
    if (hello.seq > 0) object["seq"] = hello.seq;
    if (hello.frame > 0) object["frame"] = hello.frame;
    if (hello.depth) object["depth"] = true;
    if (hello.codecs != std::vector{Codec::Jpeg}) {
        object["codecs"] = json::array();
        for (const Codec codec : hello.codecs) object["codecs"].push_back(name(codec));
    }
    return object;
}

json print(const ViewChange& view) {
    json object = view.changes.is_object() ? view.changes : json::object();
    object["type"] = "view";
    object["seq"] = view.seq;
    if (view.cloud) object["cloud"] = *view.cloud;
    if (view.follow) object["follow"] = view.follow->empty() ? json() : json(*view.follow);
    return object;
}

json print(const QualityLimits& limits) {
    json object = {{"type", "quality"}};
    if (limits.fps) object["fps"] = *limits.fps;
    if (limits.minResolution) object["minResolution"] = *limits.minResolution;
    if (limits.maxDetail) object["maxDetail"] = *limits.maxDetail;
    if (limits.minQuality) object["minQuality"] = *limits.minQuality;
    return object;
}

json print(const Pick& pick) {
    return {{"type", "pick"}, {"seq", pick.seq}, {"x", pick.x}, {"y", pick.y}};
}
json print(const Ack& ack) {
    return {{"type", "ack"}, {"frame", ack.frame}};
}
json print(const Ping& ping) {
    return {{"type", "ping"}, {"id", ping.id}};
}

}  // namespace

Expected<ClientMessage> parseClientMessage(std::string_view text) {
    auto object = parseJson(text);
    if (!object) return passOn(object);
    if (!object->is_object())
        return fail(ErrorCode::Malformed, "a message is a JSON object, such as {\"type\": \"hello\"}");
    FieldReader fields(*object);
    std::string type;
    if (!fields.require("type") || !fields.text("type", type)) {
        const auto wrong = fields.finishLenient();
        return passOn(wrong);
    }
    if (type == "hello") return readHello(fields);
    if (type == "view") return readView(std::move(*object));
    if (type == "quality") return readQuality(fields);
    if (type == "pick") return readPick(fields);
    if (type == "ack") return readAck(fields);
    if (type == "ping") return readPing(fields);
    return fail(ErrorCode::InvalidArgument, unknownName("type " + quoteText(type), type, types), "type");
}

std::string printMessage(const ClientMessage& message) {
    return printJson(std::visit([](const auto& m) { return print(m); }, message));
}

}  // namespace scancast
