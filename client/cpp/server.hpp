// What a server can be asked over HTTP: its clouds, its methods, pictures.
//
// A small value; each call opens a connection of its own, blocks until the answer or the deadline, and may be
// made from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/cpp/credentials.hpp"
#include "client/cpp/http_stream.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"
#include "protocol/catalog.hpp"
#include "protocol/measure/measure_request.hpp"
#include "protocol/points/lonlat_request.hpp"
#include "protocol/points/points_request.hpp"
#include "protocol/raster/raster_request.hpp"
#include "protocol/view/query.hpp"

namespace scancast::client {

enum class PictureFormat : std::uint8_t { Jpeg, Png };

struct Snapshot {
    std::vector<std::uint8_t> bytes;  ///< the JPEG or PNG; empty when notModified
    std::string etag;            ///< names exactly these bytes; hand it back to ask whether they changed.
                                 ///< Empty for a picture that is damaged
    std::string serverTiming;    ///< selection, render and encode, as the server tells them
    bool notModified = false;    ///< the picture is still that of the given ETag
    std::uint64_t damaged = 0;   ///< blocks of the cloud that it lacks, because they cannot be read
    std::string method{};        ///< that drew it; empty of a server that does not say
    std::string methodReason{};  ///< why this one, where the view left it to auto; else empty
};

/// Which part of the world a map shows, from edge to edge of its outermost pixels.
struct MapArea {
    std::string crs =
        "file";  ///< "EPSG:3857", the cloud's own "EPSG:25833", "CRS:84"; file: the cloud's coordinates
    std::array<double, 4>
        box{};                  ///< left, bottom, right, top: x and y, whatever order the system's axes have
    int width = 0, height = 0;  ///< px
    bool transparent = true;    ///< where no point is; of PNG. Else white
};

/// What a server said of the points that it gave away.
struct PointsAnswer {
    std::uint64_t bytes = 0;
    std::optional<std::uint64_t> points{};  ///< where it knew that when it began
    std::vector<std::string> losses{};      ///< what is not as the scan was, one sentence each without an end
};

/// What a profile's picture shows: its edges, and what is in it. File units.
struct ProfileFacts {
    double length = 0;  ///< of the line
    double left = 0, right = 0, bottom = 0, top = 0;
    std::array<double, 2> heights{};  ///< of its points, lowest and highest
    std::uint64_t points = 0;
};

/// Where the cells of a raster lie (PROTOCOL.md, "Rasters"). File units.
struct RasterFacts {
    std::uint64_t bytes = 0;  ///< of the file
    std::uint64_t columns = 0, rows = 0;
    double cell = 0, left = 0, top = 0;
};

class Server {
  public:
    explicit Server(ServerUrl url, Timeouts timeouts = {}, Credentials credentials = {})
        : url_(std::move(url)), timeouts_(timeouts), credentials_(std::move(credentials)) {}

    const ServerUrl& url() const { return url_; }
    const Timeouts& timeouts() const { return timeouts_; }
    const Credentials& credentials() const { return credentials_; }

    /// Errors of all calls: those of the network (http_get.hpp), Malformed for answers that are not what they
    /// should be, and whatever the server refuses with.
    Expected<std::vector<CloudInfo>> clouds() const;
    Expected<CloudInfo> cloud(const std::string& id) const;
    Expected<std::vector<MethodInfo>> methods() const;
    /// A picture of full quality. `words` are those of PROTOCOL.md; what is not given is the cloud's default.
    Expected<Snapshot> snapshot(const std::string& cloud, const WordValues& words,
                                PictureFormat format = PictureFormat::Jpeg,
                                const std::string& etag = {}) const;
    /// A map from straight above (docs/maps.md). `words`: those of a view, but for the camera's and the picture's size.
    Expected<Snapshot> map(const std::string& cloud, const MapArea& area, const WordValues& words = {},
                           PictureFormat format = PictureFormat::Png, const std::string& etag = {}) const;
    /// What the colours of such a map mean, as a small picture.
    Expected<Snapshot> legend(const std::string& cloud, const WordValues& words = {},
                              PictureFormat format = PictureFormat::Png, const std::string& etag = {}) const;
    /// File coordinates as longitudes and latitudes (WGS 84, degrees), or the other way round, in the same order; nullopt for places
    /// that have none. Unsupported where nobody knows where in the world the cloud is.
    Expected<LonLatPoints> lonLat(const std::string& cloud, const LonLatRequest& request) const;
    /// The scan's point that a pixel of a view's picture shows, as PROTOCOL.md, "A picked point", has it: position, attributes and
    /// all; null where nothing is. `view`: any subset of a view as JSON; x, y: px from the top left corner.
    Expected<nlohmann::json> pick(const std::string& cloud, const nlohmann::json& view, double x,
                                  double y) const;
    /// Lengths, areas, volumes, fitted shapes, as PROTOCOL.md, "A measurement", has them.
    Expected<nlohmann::json> measure(const std::string& cloud, const MeasureRequest& request) const;

    /// The points of a region, as a file's bytes: `take` gets them as they come, in the memory of one piece. Truncated where
    /// they break off; what take refuses with.
    Expected<PointsAnswer> points(const std::string& cloud, const PointsRequest& request,
                                  const TakeBytes& take) const;
    /// The same of the corridor along a line; the request's format is not a picture.
    Expected<PointsAnswer> profile(const std::string& cloud, const ProfileRequest& request,
                                   const TakeBytes& take) const;
    /// Its picture, a PNG.
    Expected<ProfileFacts> profilePicture(const std::string& cloud, const ProfileRequest& request,
                                          const TakeBytes& take) const;

    /// A raster in plan, elevations or an orthophoto, as the bytes of a GeoTIFF. Where it is packed the answer begins when all of it is
    /// made, and for that this waits up to an hour; with RasterPacking::None it comes while it is made.
    Expected<RasterFacts> raster(const std::string& cloud, const RasterRequest& request,
                                 const TakeBytes& take) const;

  private:
    Expected<Snapshot> picture(const std::string& target, const WordValues& size, PictureFormat format,
                               const std::string& etag) const;

    ServerUrl url_;
    Timeouts timeouts_;
    Credentials credentials_;
};

}  // namespace scancast::client
