#include "client/cpp/server.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "client/cpp/http_get.hpp"
#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/problem.hpp"
#include "protocol/text/plain_text.hpp"
#include "protocol/view/view.hpp"

namespace scancast::client {
namespace {

constexpr std::string_view cloudsPath = "/api/v1/clouds";

/// Of lists and facts: thousands of clouds.
constexpr std::uint64_t longestJson = std::uint64_t{16} << 20u;

/// A packed raster of a billion cells.
constexpr std::chrono::milliseconds untilPacked = std::chrono::hours{1};

/// Of a picture: what its pixels may take in either format, noise included, and the file's head; never more than 1 GiB, which
/// holds also where the request names no size.
std::uint64_t longestPicture(const WordValues& words) {
    constexpr std::uint64_t head = std::uint64_t{1} << 20u, perPixel = 8, most = std::uint64_t{1} << 30u;
    std::uint64_t width = 0, height = 0;
    for (const auto& [word, value] : words) {
        std::uint64_t* const side = word == "width" ? &width : word == "height" ? &height : nullptr;
        if (side) std::from_chars(value.data(), value.data() + value.size(), *side);
    }
    const auto bounded = [](std::uint64_t side) {
        const auto largest = static_cast<std::uint64_t>(maxPictureSide);
        return side == 0 ? largest : std::min(side, largest);
    };
    return std::min(most, head + perPixel * bounded(width) * bounded(height));
}

Expected<nlohmann::json> getJson(const Server& server, const std::string& target) {
    const auto answer =
        httpGet(server.url(), target, longestJson, {}, server.credentials(), server.timeouts());
    if (!answer) return passOn(answer);
    auto value = parseJson({reinterpret_cast<const char*>(answer->body.data()), answer->body.size()});
    if (!value)
        return fail(ErrorCode::Malformed, server.url().authority() + target + ": " + value.error().message +
                                              "; is it a Scancast server?");
    return value;
}

Expected<nlohmann::json> postJson(const Server& server, const std::string& target,
                                  const nlohmann::json& body) {
    const auto answer = httpPostJson(server.url(), target, longestJson, printJson(body), server.credentials(),
                                     server.timeouts());
    if (!answer) return passOn(answer);
    auto value = parseJson({reinterpret_cast<const char*>(answer->body.data()), answer->body.size()});
    if (!value || !(value->is_object() || value->is_null()))
        return fail(ErrorCode::Malformed, server.url().authority() + target + ": " +
                                              (value ? "the answer is no object" : value.error().message) +
                                              "; is it a Scancast server?");
    return value;
}

/// GETs JSON and takes it apart; what is not of the shape that it should have is told with its address.
template <class Parse>
auto getParsed(const Server& server, const std::string& target, Parse parse)
    -> decltype(parse(nlohmann::json())) {
    const auto value = getJson(server, target);
    if (!value) return passOn(value);
    auto parsed = parse(*value);
    if (!parsed) parsed.error().message = server.url().authority() + target + ": " + parsed.error().message;
    return parsed;
}

std::string cloudPath(const std::string& id) {
    // An id is one segment of a path: "a/../b" must not become another route.
    const auto word = printQuery({{id, {}}});
    return std::string(cloudsPath) + "/" + word.substr(0, word.size() - 1);
}

/// A list of strings (RFC 8941); what is none of them is left out.
std::vector<std::string> listOf(std::string_view text) {
    std::vector<std::string> list;
    bool inside = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '"') {
            inside = !inside;
            if (inside) list.emplace_back();
            continue;
        }
        if (!inside) continue;
        if (text[i] == '\\' && i + 1 < text.size()) ++i;
        list.back() += text[i];
    }
    return list;
}

PointsAnswer answerOf(const StreamedAnswer& streamed) {
    PointsAnswer answer{.bytes = streamed.bytes};
    const std::string said = streamed.header("Scancast-Points");
    std::uint64_t points = 0;
    const auto read = std::from_chars(said.data(), said.data() + said.size(), points);
    if (!said.empty() && read.ec == std::errc() && read.ptr == said.data() + said.size())
        answer.points = points;
    for (std::string& loss : listOf(streamed.header("Scancast-Losses")))
        answer.losses.push_back(plainLine(loss));
    return answer;
}

bool startsWith(const std::vector<std::uint8_t>& bytes, std::initializer_list<std::uint8_t> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

}  // namespace

Expected<std::vector<CloudInfo>> Server::clouds() const {
    return getParsed(*this, std::string(cloudsPath), cloudListFromJson);
}

Expected<CloudInfo> Server::cloud(const std::string& id) const {
    return getParsed(*this, cloudPath(id), cloudInfoFromJson);
}

Expected<std::vector<MethodInfo>> Server::methods() const {
    return getParsed(*this, "/api/v1/methods", methodListFromJson);
}

Expected<Snapshot> Server::snapshot(const std::string& cloud, const WordValues& words, PictureFormat format,
                                    const std::string& etag) const {
    const bool jpeg = format == PictureFormat::Jpeg;
    auto target = cloudPath(cloud) + (jpeg ? "/snapshot.jpg" : "/snapshot.png");
    if (!words.empty()) target.append("?").append(printQuery(words));
    return picture(target, words, format, etag);
}

Expected<Snapshot> Server::map(const std::string& cloud, const MapArea& area, const WordValues& words,
                               PictureFormat format, const std::string& etag) const {
    // WMS 1.1.1: x comes before y in every system.
    const auto number = [](double value) { return nlohmann::json(value).dump(); };
    std::string box;
    for (const double bound : area.box) box.append(box.empty() ? "" : ",").append(number(bound));
    WordValues all{{"SERVICE", "WMS"},
                   {"VERSION", "1.1.1"},
                   {"REQUEST", "GetMap"},
                   {"SRS", area.crs},
                   {"BBOX", box},
                   {"WIDTH", std::to_string(area.width)},
                   {"HEIGHT", std::to_string(area.height)},
                   {"FORMAT", format == PictureFormat::Jpeg ? "image/jpeg" : "image/png"},
                   {"TRANSPARENT", area.transparent ? "TRUE" : "FALSE"},
                   {"EXCEPTIONS", std::string(problemMediaType)}};
    all.insert(all.end(), words.begin(), words.end());
    return picture(cloudPath(cloud) + "/wms?" + printQuery(all),
                   {{"width", std::to_string(area.width)}, {"height", std::to_string(area.height)}}, format,
                   etag);
}

Expected<Snapshot> Server::legend(const std::string& cloud, const WordValues& words, PictureFormat format,
                                  const std::string& etag) const {
    WordValues all{{"SERVICE", "WMS"},
                   {"REQUEST", "GetLegendGraphic"},
                   {"FORMAT", format == PictureFormat::Jpeg ? "image/jpeg" : "image/png"},
                   {"EXCEPTIONS", std::string(problemMediaType)}};
    all.insert(all.end(), words.begin(), words.end());
    return picture(cloudPath(cloud) + "/wms?" + printQuery(all), {}, format, etag);
}

Expected<LonLatPoints> Server::lonLat(const std::string& cloud, const LonLatRequest& request) const {
    const auto answer = postJson(*this, cloudPath(cloud) + "/lonlat", toJson(request));
    if (!answer) return passOn(answer);
    auto points = parseLonLatAnswer(*answer);
    if (points && points->size() != request.points.size())
        return fail(ErrorCode::Malformed,
                    url_.authority() + " answered with another number of places than was asked for");
    return points;
}

Expected<Snapshot> Server::picture(const std::string& target, const WordValues& size, PictureFormat format,
                                   const std::string& etag) const {
    const bool jpeg = format == PictureFormat::Jpeg;
    auto answer = httpGet(url_, target, longestPicture(size), etag, credentials_, timeouts_);
    if (!answer) return passOn(answer);
    if (answer->status == 304) return Snapshot{{}, etag, {}, true, 0, answer->method, answer->methodReason};
    const bool picture = jpeg ? startsWith(answer->body, {0xFF, 0xD8, 0xFF})
                              : startsWith(answer->body, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
    if (answer->status != 200 || !picture)
        return fail(ErrorCode::Malformed, url_.authority() + " answered " + std::to_string(answer->status) +
                                              " without a picture; is it a Scancast server?");
    std::uint64_t damaged = 0;
    const std::string& said = answer->damaged;
    if (const auto read = std::from_chars(said.data(), said.data() + said.size(), damaged);
        !said.empty() && (read.ec != std::errc() || read.ptr != said.data() + said.size()))
        return fail(ErrorCode::Malformed,
                    url_.authority() + " answered with a Scancast-Damaged that is no number");
    return Snapshot{std::move(answer->body), answer->etag,        answer->serverTiming, false, damaged,
                    answer->method,          answer->methodReason};
}

Expected<PointsAnswer> Server::points(const std::string& cloud, const PointsRequest& request,
                                      const TakeBytes& take) const {
    const auto answer = httpPostStreamed(url_, cloudPath(cloud) + "/points", printJson(toJson(request)), {},
                                         credentials_, timeouts_, take);
    if (!answer) return passOn(answer);
    return answerOf(*answer);
}

Expected<PointsAnswer> Server::profile(const std::string& cloud, const ProfileRequest& request,
                                       const TakeBytes& take) const {
    const auto answer = httpPostStreamed(url_, cloudPath(cloud) + "/profile", printJson(toJson(request)), {},
                                         credentials_, timeouts_, take);
    if (!answer) return passOn(answer);
    return answerOf(*answer);
}

Expected<ProfileFacts> Server::profilePicture(const std::string& cloud, const ProfileRequest& request,
                                              const TakeBytes& take) const {
    ProfileRequest drawn = request;
    drawn.format.reset();
    const auto answer = httpPostStreamed(url_, cloudPath(cloud) + "/profile", printJson(toJson(drawn)),
                                         "image/png", credentials_, timeouts_, take);
    if (!answer) return passOn(answer);
    const auto malformed = [&](const std::string& why) {
        return fail(ErrorCode::Malformed, url_.authority() + " does not say what its profile shows (" + why +
                                              "); is it a Scancast server?");
    };
    const auto value = parseJson(answer->header("Scancast-Profile"));
    if (!value) return malformed(value.error().message);
    ProfileFacts facts;
    FieldReader fields(*value, {}, ErrorCode::Malformed);
    for (const auto& [name, to] :
         {std::pair("length", &facts.length), std::pair("left", &facts.left),
          std::pair("right", &facts.right), std::pair("bottom", &facts.bottom), std::pair("top", &facts.top)})
        if (fields.require(name) != nullptr) fields.number(name, *to);
    fields.numbers("heights", facts.heights);
    fields.integer("points", facts.points, 0, std::numeric_limits<std::uint64_t>::max());
    if (auto ok = fields.finishLenient(); !ok) return malformed(ok.error().message);
    return facts;
}

Expected<nlohmann::json> Server::pick(const std::string& cloud, const nlohmann::json& view, double x,
                                      double y) const {
    return postJson(*this, cloudPath(cloud) + "/pick", {{"view", view}, {"x", x}, {"y", y}});
}

Expected<nlohmann::json> Server::measure(const std::string& cloud, const MeasureRequest& request) const {
    return postJson(*this, cloudPath(cloud) + "/measure", toJson(request));
}

Expected<RasterFacts> Server::raster(const std::string& cloud, const RasterRequest& request,
                                     const TakeBytes& take) const {
    const bool isElevation = request.kind == RasterKind::Elevation;
    std::string target = cloudPath(cloud) + (isElevation ? "/dem.tif" : "/ortho.tif");
    if (const std::string query = printQuery(wordsOf(request)); !query.empty()) target += "?" + query;
    Timeouts timeouts = timeouts_;
    if (request.packing != RasterPacking::None) timeouts.answer = std::max(timeouts.answer, untilPacked);
    const auto answer = httpGetStreamed(url_, target, "image/tiff", credentials_, timeouts, take);
    if (!answer) return passOn(answer);
    const auto malformed = [&](const std::string& why) {
        return fail(ErrorCode::Malformed, url_.authority() + " does not say where its raster lies (" + why +
                                              "); is it a Scancast server?");
    };
    const auto value = parseJson(answer->header("Scancast-Raster"));
    if (!value) return malformed(value.error().message);
    RasterFacts facts;
    facts.bytes = answer->bytes;
    FieldReader fields(*value, {}, ErrorCode::Malformed);
    for (const auto& [name, to] :
         {std::pair("cell", &facts.cell), std::pair("left", &facts.left), std::pair("top", &facts.top)})
        if (fields.require(name) != nullptr) fields.number(name, *to);
    for (const auto& [name, to] : {std::pair("columns", &facts.columns), std::pair("rows", &facts.rows)})
        if (fields.require(name) != nullptr) fields.integer(name, *to, 1, std::uint64_t{1} << 32u);
    if (auto ok = fields.finishLenient(); !ok) return malformed(ok.error().message);
    return facts;
}

}  // namespace scancast::client
