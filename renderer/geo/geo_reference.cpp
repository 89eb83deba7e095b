#include "renderer/geo/geo_reference.hpp"

#include <proj.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "renderer/cloud/import/crs_meaning.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestWkt = 16 * 1024;
/// Of what a system without a number is taken for: the same but for its spelling.
constexpr int sureEnough = 90;

struct Free {
    void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
    void operator()(PJ* pj) const { proj_destroy(pj); }
    void operator()(PJ_OBJ_LIST* list) const { proj_list_destroy(list); }
};
using Context = std::unique_ptr<PJ_CONTEXT, Free>;
using Object = std::unique_ptr<PJ, Free>;

tl::unexpected<Error> refuse(const std::string& why) {
    return fail(ErrorCode::Unsupported, "Where this cloud lies in the world is not known: " + why);
}

std::optional<int> epsgOf(const PJ* crs) {
    const char* const authority = proj_get_id_auth_name(crs, 0);
    const char* const code = proj_get_id_code(crs, 0);
    if (authority == nullptr || code == nullptr || std::string_view(authority) != "EPSG") return std::nullopt;
    const int number = std::atoi(code);
    return number > 0 ? std::optional(number) : std::nullopt;
}

/// EPSG's own object of a system that comes without its number: "NAD_1983_UTM_Zone_10N".
Object identified(PJ_CONTEXT* context, const PJ* crs) {
    int* sure = nullptr;
    const std::unique_ptr<PJ_OBJ_LIST, Free> list(proj_identify(context, crs, "EPSG", nullptr, &sure));
    Object found;
    if (list && sure != nullptr && proj_list_get_count(list.get()) > 0 && sure[0] >= sureEnough)
        found.reset(proj_list_get(context, list.get(), 0));
    proj_int_list_destroy(sure);
    return found;
}

/// What x and y are, of a compound system.
Object horizontal(PJ_CONTEXT* context, Object crs) {
    for (int depth = 0; crs && depth < 4 && proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS; ++depth)
        crs.reset(proj_crs_get_sub_crs(context, crs.get(), 0));
    return crs;
}

std::optional<CrsParts::Base> baseOf(PJ_CONTEXT* context, const PJ* crs) {
    const Object geodetic(proj_crs_get_geodetic_crs(context, crs));
    if (!geodetic) return std::nullopt;
    const Object ellipsoid(proj_get_ellipsoid(context, geodetic.get()));
    CrsParts::Base base;
    if (!ellipsoid || proj_ellipsoid_get_parameters(context, ellipsoid.get(), &base.semiMajor, nullptr,
                                                    nullptr, &base.inverseFlattening) == 0)
        return std::nullopt;
    if (const Object meridian(proj_get_prime_meridian(context, geodetic.get())); meridian) {
        double longitude = 0, radians = 0;
        if (proj_prime_meridian_get_parameters(context, meridian.get(), &longitude, &radians, nullptr) != 0)
            base.primeMeridian = longitude * radians * 180 / std::numbers::pi;
    }
    if (const char* name = proj_get_name(geodetic.get())) base.name = name;
    base.epsg = epsgOf(geodetic.get());
    if (!base.epsg)
        if (const Object same = identified(context, geodetic.get())) base.epsg = epsgOf(same.get());
    return base;
}

/// Of the map projection: its method, and what is put into it.
void readProjection(PJ_CONTEXT* context, const PJ* crs, CrsParts& parts) {
    const Object operation(proj_crs_get_coordoperation(context, crs));
    const char* code = nullptr;
    if (!operation ||
        proj_coordoperation_get_method_info(context, operation.get(), nullptr, nullptr, &code) == 0)
        return;
    parts.method = code != nullptr ? std::atoi(code) : 0;
    for (int i = 0; i < proj_coordoperation_get_param_count(context, operation.get()); ++i) {
        const char *number = nullptr, *kind = nullptr;
        double value = 0, factor = 1;
        if (proj_coordoperation_get_param(context, operation.get(), i, nullptr, nullptr, &number, &value,
                                          nullptr, &factor, nullptr, nullptr, nullptr, &kind) == 0 ||
            number == nullptr)
            continue;
        const bool isAngle = kind != nullptr && std::string_view(kind) == "angular";
        parts.parameters[std::atoi(number)] = value * factor * (isAngle ? 180 / std::numbers::pi : 1);
    }
}

void readAxes(PJ_CONTEXT* context, const PJ* crs, FileCrs& file) {
    const Object axes(proj_crs_get_coordinate_system(context, crs));
    if (!axes) return;
    const char *name = nullptr, *direction = nullptr, *second = nullptr;
    double factor = 1;
    if (proj_cs_get_axis_info(context, axes.get(), 0, &name, nullptr, &direction, &factor, nullptr, nullptr,
                              nullptr) == 0 ||
        proj_cs_get_axis_info(context, axes.get(), 1, nullptr, nullptr, &second, nullptr, nullptr, nullptr,
                              nullptr) == 0 ||
        name == nullptr || direction == nullptr || second == nullptr)
        return;
    // Around a pole both lead away from it, and only names tell them apart.
    file.northFirst = std::string_view(direction) == second ? *name == 'N' || *name == 'n'
                                                            : std::string_view(direction) == "north";
    constexpr double equator = 6378137;  // m a radian
    file.metresPerUnit = file.degrees ? factor * equator : factor;
}

}  // namespace

struct GeoReference::Proj {
    Context context;
    Object crs;
    FileCrs file;
    std::array<Object, 2> worlds;  ///< file → world

    void run(WorldCrs world, PJ_DIRECTION direction, std::span<glm::dvec2> places) const {
        static_assert(sizeof(glm::dvec2) == 2 * sizeof(double));
        PJ* const operation = worlds[std::size_t(world)].get();
        if (places.empty()) return;
        proj_errno_reset(operation);
        proj_trans_generic(operation, direction, &places[0].x, sizeof(glm::dvec2), places.size(),
                           &places[0].y, sizeof(glm::dvec2), places.size(), nullptr, 0, 0, nullptr, 0, 0);
        for (glm::dvec2& place : places)
            if (!std::isfinite(place.x) || !std::isfinite(place.y))
                place = glm::dvec2(std::numeric_limits<double>::infinity());
    }
};

GeoReference::GeoReference(std::unique_ptr<Proj> proj) : proj_(std::move(proj)) {}
GeoReference::GeoReference(GeoReference&&) noexcept = default;
GeoReference& GeoReference::operator=(GeoReference&&) noexcept = default;
GeoReference::~GeoReference() = default;

const FileCrs& GeoReference::file() const {
    return proj_->file;
}
void GeoReference::fromFile(WorldCrs world, std::span<glm::dvec2> places) const {
    proj_->run(world, PJ_FWD, places);
}
void GeoReference::toFile(WorldCrs world, std::span<glm::dvec2> places) const {
    proj_->run(world, PJ_INV, places);
}

std::optional<CrsParts> GeoReference::parts() const {
    PJ_CONTEXT* const context = proj_->context.get();
    const PJ* crs = proj_->crs.get();
    const Object base(proj_get_type(crs) == PJ_TYPE_BOUND_CRS ? proj_get_source_crs(context, crs) : nullptr);
    if (base) crs = base.get();
    const auto geodetic = baseOf(context, crs);
    if (!geodetic) return std::nullopt;
    CrsParts parts{.base = *geodetic};
    if (proj_get_type(crs) == PJ_TYPE_PROJECTED_CRS) readProjection(context, crs, parts);
    return parts;
}

Expected<GeoReference> GeoReference::create(const CloudFacts& cloud) {
    const auto meaning = crsMeaning(cloud.crsWkt, cloud.crsEpsg);
    if (!meaning || (meaning->kind == CrsMeaning::Kind::Unknown && !meaning->epsg))
        return refuse("the scan says nothing of its coordinate reference system that is understood.");
    if (meaning->kind == CrsMeaning::Kind::Local) return refuse("its coordinates are local ones.");
    if (meaning->kind == CrsMeaning::Kind::Geocentric)
        return refuse("its coordinates are geocentric, and up is not z.");
    auto proj = std::make_unique<Proj>();
    proj->context.reset(proj_context_create());
    PJ_CONTEXT* const context = proj->context.get();
    if (context == nullptr) return fail(ErrorCode::Internal, "PROJ gave no context");
    proj_log_level(context, PJ_LOG_NONE);
    proj_context_set_enable_network(context, 0);
    if (proj_context_get_database_metadata(context, "EPSG.VERSION") == nullptr)
        return fail(ErrorCode::Internal, "PROJ's database (proj.db) cannot be read");
    Object crs;
    if (meaning->epsg) {
        crs.reset(proj_create_from_database(context, "EPSG", std::to_string(*meaning->epsg).c_str(),
                                            PJ_CATEGORY_CRS, 0, nullptr));
    }
    if (!crs && !cloud.crsWkt.empty() && cloud.crsWkt.size() <= longestWkt)
        crs.reset(proj_create_from_wkt(context, cloud.crsWkt.c_str(), nullptr, nullptr, nullptr));
    crs = horizontal(context, std::move(crs));
    if (!crs) return refuse("PROJ does not know its coordinate reference system.");
    proj->file.epsg = epsgOf(crs.get());
    if (!proj->file.epsg) {
        if (Object same = identified(context, crs.get())) {
            proj->file.epsg = epsgOf(same.get());
            readAxes(context, same.get(), proj->file);
        }
    }
    const PJ_TYPE type = proj_get_type(crs.get());
    const bool isBound = type == PJ_TYPE_BOUND_CRS;
    const Object base(isBound ? proj_get_source_crs(context, crs.get()) : nullptr);
    const PJ_TYPE plain = base ? proj_get_type(base.get()) : type;
    proj->file.degrees = plain == PJ_TYPE_GEOGRAPHIC_2D_CRS || plain == PJ_TYPE_GEOGRAPHIC_3D_CRS;
    if (!proj->file.degrees && plain != PJ_TYPE_PROJECTED_CRS)
        return refuse("its coordinate reference system is neither projected nor geographic.");
    const bool northFirst = proj->file.northFirst;
    readAxes(context, base ? base.get() : crs.get(), proj->file);
    proj->file.northFirst = proj->file.northFirst || northFirst;
    if (const char* name = proj_get_name(crs.get())) proj->file.name = name;
    // EPSG's number of longitude and latitude, whose axes are put in order below: between EPSG's systems PROJ takes EPSG's own ways, the
    // same ones for both, and those that GDAL takes. OGC:CRS84 may be a metre elsewhere in America.
    constexpr std::array<const char*, 2> targets{"EPSG:4326", "EPSG:3857"};
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const Object target(proj_create(context, targets[i]));
        if (!target) return fail(ErrorCode::Internal, "PROJ's database (proj.db) cannot be read");
        const Object direct(
            proj_create_crs_to_crs_from_pj(context, crs.get(), target.get(), nullptr, nullptr));
        if (direct) proj->worlds[i].reset(proj_normalize_for_visualization(context, direct.get()));
        if (!proj->worlds[i]) return refuse("PROJ knows no way from its coordinates to WGS 84.");
    }
    proj->crs = std::move(crs);
    return GeoReference(std::move(proj));
}

std::string projectionsVersion() {
    std::string version = proj_info().version;
    const Context context(proj_context_create());
    if (!context) return version;
    proj_log_level(context.get(), PJ_LOG_NONE);
    for (const char* key : {"EPSG.VERSION", "PROJ_DATA.VERSION"})
        if (const char* said = proj_context_get_database_metadata(context.get(), key))
            version.append(" ").append(said);
    return version;
}

}  // namespace scancast
