// server → client: read leniently, printed whole.
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/messages.hpp"
#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

using namespace messages;
using nlohmann::json;

constexpr std::size_t longestReason = 4096;
constexpr std::uint64_t longestDrain = std::uint64_t(24) * 60 * 60 * 1000;  // ms

/// Reads each entry of an array of strings or objects; absent is empty.
template <class Use>
void eachEntry(FieldReader& fields, std::string_view key, std::size_t most, Use use) {
    const auto* array = fields.findValue(key);
    if (!array) return;
    if (!array->is_array() || array->size() > most)
        return fields.error(key, "expected an array of at most " + std::to_string(most));
    for (const auto& item : *array) use(item);
}

Expected<ServerMessage> finish(FieldReader& fields, ServerMessage message) {
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return message;
}

Expected<ServerMessage> readWelcome(FieldReader& fields) {
    Welcome welcome;
    if (fields.require("session")) fields.text("session", welcome.session);
    fields.text("resume", welcome.resume);
    fields.flag("resumed", welcome.resumed);
    fields.integer("seq", welcome.seq, 0, UINT64_MAX);
    if (fields.require("cloud")) fields.text("cloud", welcome.cloud);
    eachEntry(fields, "methods", 256, [&](const json& item) {
        if (item.is_string())
            welcome.methods.push_back(item.get<std::string>());
        else
            fields.error("methods", "expected names");
    });
    if (const auto* object = fields.findValue("limits")) {
        FieldReader limits(*object, "limits", ErrorCode::Malformed);
        limits.integer("maxMessageBytes", welcome.limits.maxMessageBytes, 0, UINT64_MAX);
        limits.integer("maxPixels", welcome.limits.maxPixels, 0, UINT64_MAX);
        limits.integer("maxUnacknowledged", welcome.limits.maxUnacknowledged, 1, 1024);
        if (auto sound = limits.finishLenient(); !sound) fields.error(sound.error());
    }
    if (const auto* view = fields.require("view")) {
        if (view->is_object())
            welcome.view = *view;
        else
            fields.error("view", "expected an object");
    }
    if (fields.findValue("codecs")) welcome.codecs.clear();
    eachEntry(fields, "codecs", 256, [&](const json& item) {
        if (item.is_string())
            welcome.codecs.push_back(item.get<std::string>());
        else
            fields.error("codecs", "expected names");
    });
    fields.text("movingCodec", welcome.movingCodec);
    fields.text("codecReason", welcome.codecReason, 1024);
    return finish(fields, std::move(welcome));
}

Expected<ServerMessage> readStats(FieldReader& fields) {
    Stats stats;
    fields.integer("frame", stats.frame, 0, UINT64_MAX);
    fields.integer("seq", stats.seq, 0, UINT64_MAX);
    fields.number("fps", stats.fps);
    fields.number("detail", stats.detail);
    fields.integer("samples", stats.samples, 0, UINT64_MAX);
    fields.integer("points", stats.points, 0, UINT64_MAX);
    fields.integer("dropped", stats.dropped, 0, UINT64_MAX);
    fields.number("resolution", stats.resolution);
    fields.integer("jpegQuality", stats.jpegQuality, 0, 100);
    fields.number("bandwidth", stats.bandwidth);
    fields.text("method", stats.method);
    fields.text("methodReason", stats.methodReason);
    fields.flag("away", stats.away);
    fields.text("color", stats.color);
    fields.text("colormap", stats.colormap);
    if (fields.findValue("range")) {
        std::array<double, 2> range{};
        if (fields.numbers("range", range)) stats.range = range;
    }
    eachEntry(fields, "stages", 64, [&](const json& item) {
        auto& stage = stats.stages.emplace_back();
        FieldReader entry(item, "stages", ErrorCode::Malformed);
        entry.text("name", stage.name);
        entry.number("milliseconds", stage.milliseconds);
        if (auto sound = entry.finishLenient(); !sound) fields.error(sound.error());
    });
    return finish(fields, std::move(stats));
}

Expected<ServerMessage> readPicked(FieldReader& fields) {
    Picked picked;
    if (fields.require("seq")) fields.integer("seq", picked.seq, 0, UINT64_MAX);
    if (const auto* point = fields.require("point")) {
        if (point->is_object() || point->is_null())
            picked.point = *point;
        else
            fields.error("point", "expected an object or null");
    }
    return finish(fields, std::move(picked));
}

Expected<ServerMessage> readProblem(FieldReader& fields) {
    ProblemReport report;
    fields.integer("seq", report.seq, 0, UINT64_MAX);
    if (const auto* object = fields.require("problem")) {
        if (auto problem = problemFromJson(*object))
            report.problem = std::move(*problem);
        else
            fields.error(problem.error());
    }
    return finish(fields, std::move(report));
}

Expected<ServerMessage> readDrain(FieldReader& fields) {
    Drain drain;
    fields.integer("afterMilliseconds", drain.afterMilliseconds, 0, longestDrain);
    fields.integer("withinMilliseconds", drain.withinMilliseconds, 0, longestDrain);
    return finish(fields, drain);
}

Expected<ServerMessage> readBye(FieldReader& fields) {
    Bye bye;
    std::uint16_t code = 1000;
    fields.integer("code", code, 1000, 4999);
    bye.code = static_cast<CloseCode>(code);
    fields.text("reason", bye.reason, longestReason);
    return finish(fields, std::move(bye));
}

Expected<ServerMessage> readPong(FieldReader& fields) {
    Pong pong;
    fields.integer("id", pong.id, 0, UINT64_MAX);
    return finish(fields, pong);
}

json print(const Welcome& welcome) {
    return {{"type", "welcome"},
            {"session", welcome.session},
            {"resume", welcome.resume},
            {"resumed", welcome.resumed},
            {"seq", welcome.seq},
            {"cloud", welcome.cloud},
            {"methods", welcome.methods},
            {"limits",
             {{"maxMessageBytes", welcome.limits.maxMessageBytes},
              {"maxPixels", welcome.limits.maxPixels},
              {"maxUnacknowledged", welcome.limits.maxUnacknowledged}}},
            {"view", welcome.view.is_object() ? welcome.view : json::object()},
            {"codecs", welcome.codecs},
            {"movingCodec", welcome.movingCodec},
            {"codecReason", welcome.codecReason}};
}

json print(const Stats& stats) {
    json stages = json::array();
    for (const auto& stage : stats.stages)
        stages.push_back({{"name", stage.name}, {"milliseconds", stage.milliseconds}});
    return {{"type", "stats"},
            {"frame", stats.frame},
            {"seq", stats.seq},
            {"fps", stats.fps},
            {"detail", stats.detail},
            {"resolution", stats.resolution},
            {"jpegQuality", stats.jpegQuality},
            {"bandwidth", stats.bandwidth},
            {"samples", stats.samples},
            {"points", stats.points},
            {"dropped", stats.dropped},
            {"method", stats.method},
            {"methodReason", stats.methodReason},
            {"away", stats.away},
            {"color", stats.color},
            {"colormap", stats.colormap},
            {"range", stats.range ? json(*stats.range) : json()},
            {"stages", stages}};
}

json print(const Picked& picked) {
    return {{"type", "picked"}, {"seq", picked.seq}, {"point", picked.point}};
}

json print(const ProblemReport& report) {
    json object = {{"type", "problem"}, {"problem", toJson(report.problem)}};
    if (report.seq) object["seq"] = *report.seq;
    return object;
}

json print(const Drain& drain) {
    return {{"type", "drain"},
            {"afterMilliseconds", drain.afterMilliseconds},
            {"withinMilliseconds", drain.withinMilliseconds}};
}

json print(const Bye& bye) {
    return {{"type", "bye"}, {"code", static_cast<int>(bye.code)}, {"reason", bye.reason}};
}

json print(const Pong& pong) {
    return {{"type", "pong"}, {"id", pong.id}};
}

}  // namespace

Expected<ServerMessage> parseServerMessage(std::string_view text) {
    const auto object = parseJson(text);
    if (!object) return passOn(object);
    FieldReader fields(*object, {}, ErrorCode::Malformed);
    std::string type;
    if (!fields.require("type") || !fields.text("type", type)) {
        const auto wrong = fields.finishLenient();
        return passOn(wrong);
    }
    if (type == "welcome") return readWelcome(fields);
    if (type == "stats") return readStats(fields);
    if (type == "picked") return readPicked(fields);
    if (type == "problem") return readProblem(fields);
    if (type == "drain") return readDrain(fields);
    if (type == "bye") return readBye(fields);
    if (type == "pong") return readPong(fields);
    return fail(ErrorCode::Unsupported,
                "the server sent a message of type " + quoteText(type) + ", which this program does not know",
                "type");
}

std::string printMessage(const ServerMessage& message) {
    return printJson(std::visit([](const auto& m) { return print(m); }, message));
}

}  // namespace scancast
