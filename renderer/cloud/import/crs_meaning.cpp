#include "renderer/cloud/import/crs_meaning.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/wkt.hpp"

namespace scancast {

namespace {

using Kind = CrsMeaning::Kind;

constexpr double earthRadius = 6371000;
constexpr double degree = std::numbers::pi / 180;

double decimalOf(const std::string& text) {
    double value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    return problem == std::errc() && end == text.data() + text.size() && std::isfinite(value) ? value : 0;
}

/// Lower case, cut where letters, digits and everything else meet.
std::vector<std::string> nameWords(std::string_view text) {
    std::vector<std::string> words;
    char before = 0;  // 'a', '0', or 0 for what parts words
    for (char c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        const char kind = c >= 'a' && c <= 'z' ? 'a' : c >= '0' && c <= '9' ? '0' : char(0);
        if (kind != 0 && kind != before) words.emplace_back();
        if (kind != 0) words.back() += c;
        before = kind;
    }
    return words;
}

std::string joinedWords(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

/// "NAD83 / UTM zone 10N" and "NAD_1983_UTM_Zone_10N" are one name.
std::string plainName(std::string_view name) {
    auto words = nameWords(name.substr(0, name.find(" + ")));
    for (std::size_t i = 1; i < words.size(); ++i) {
        const bool year = words[i].size() == 4 && words[i].starts_with("19");
        const auto& of = words[i - 1];
        if (year && (of == "nad" || of == "wgs" || of == "etrs" || of == "sirgas" || of == "pulkovo"))
            words[i].erase(0, 2);
    }
    std::erase_if(words, [](const std::string& word) {
        return word == "zone" || word == "gcs" || word == "d" || word == "datum" || word == "hemisphere";
    });
    std::ranges::replace(words, "northern", "n");
    std::ranges::replace(words, "southern", "s");
    return joinedWords(words);
}

/// Programs write these where they know none.
bool saysNothing(const std::string& name) {
    static constexpr std::string_view nothings[] = {
        "",      "unnamed", "unknown",    "unknown crs", "undefined",    "geographic coordinate system",
        "local", "custom",  "projected",  "not known",   "user defined", "geographic",
        "utm",   "none",    "unspecified"};
    return std::ranges::find(nothings, name) != std::end(nothings);
}

/// "33 n" of a name in one of UTM's zones.
std::string utmZone(const std::string& name) {
    const auto words = nameWords(name);
    const auto utm = std::ranges::find(words, "utm");
    if (words.end() - utm < 3) return {};
    const bool good =
        utm[1].find_first_not_of("0123456789") == std::string::npos && (utm[2] == "n" || utm[2] == "s");
    return good ? utm[1] + " " + utm[2] : std::string();
}

Kind kindOf(const std::string& keyword, const WktNode& node) {
    if (keyword == "PROJCS" || keyword == "PROJCRS" || keyword == "PROJECTEDCRS") return Kind::Projected;
    if (keyword == "GEOGCS" || keyword == "GEOGCRS" || keyword == "GEOGRAPHICCRS") return Kind::Geographic;
    if (keyword == "GEOCCS") return Kind::Geocentric;
    if (keyword == "LOCAL_CS" || keyword == "ENGCRS" || keyword == "ENGINEERINGCRS") return Kind::Local;
    if (keyword != "GEODCRS" && keyword != "GEODETICCRS") return Kind::Unknown;
    const auto* system = node.find({"CS"});
    const bool cartesian = system != nullptr && !system->values.empty() &&
                           nameWords(system->values[0]) == std::vector<std::string>{"cartesian"};
    return cartesian ? Kind::Geocentric : Kind::Geographic;
}

std::optional<CrsMeaning::Parameter> parameterOf(std::string_view name) {
    struct Known {
        std::string_view name;
        CrsMeaning::Parameter meaning;
    };
    using M = CrsMeaning;
    static constexpr Known known[] = {{"central meridian", M::Longitude},
                                      {"longitude of center", M::Longitude},
                                      {"longitude of natural origin", M::Longitude},
                                      {"longitude of false origin", M::Longitude},
                                      {"longitude of origin", M::Longitude},
                                      {"latitude of origin", M::Latitude},
                                      {"latitude of center", M::Latitude},
                                      {"latitude of natural origin", M::Latitude},
                                      {"latitude of false origin", M::Latitude},
                                      {"standard parallel 1", M::FirstParallel},
                                      {"latitude of 1 st standard parallel", M::FirstParallel},
                                      {"standard parallel 2", M::SecondParallel},
                                      {"latitude of 2 nd standard parallel", M::SecondParallel},
                                      {"scale factor", M::Scale},
                                      {"scale factor at natural origin", M::Scale},
                                      {"false easting", M::FalseEasting},
                                      {"easting at false origin", M::FalseEasting},
                                      {"false northing", M::FalseNorthing},
                                      {"northing at false origin", M::FalseNorthing}};
    const auto words = joinedWords(nameWords(name));
    const auto found = std::ranges::find(known, words, &Known::name);
    return found == std::end(known) ? std::nullopt : std::optional(found->meaning);
}

double factorOf(const WktNode* unit) {
    const double factor = unit != nullptr && unit->values.size() >= 2 ? decimalOf(unit->values[1]) : 0;
    return factor > 0 ? factor : 0;
}

const WktNode* baseOf(const WktNode& crs) {
    return crs.find({"GEOGCS", "BASEGEOGCRS", "BASEGEODCRS", "GEOGCRS", "GEODCRS"});
}

/// Another meridian than Greenwich's shifts longitudes, and programs disagree which way they write them.
bool isGreenwich(const WktNode* base) {
    const auto* meridian = base == nullptr ? nullptr : base->find({"PRIMEM", "PRIMEMERIDIAN"});
    return meridian == nullptr || meridian->values.size() < 2 || decimalOf(meridian->values[1]) == 0;
}

void readParameters(const WktNode& crs, CrsMeaning& meaning) {
    const auto* base = baseOf(crs);
    double angle = base == nullptr ? 0 : factorOf(unitOf(*base));
    if (angle == 0) angle = degree;
    const auto* conversion = crs.find({"CONVERSION", "DERIVINGCONVERSION"});
    for (const WktNode& node : conversion == nullptr ? crs.nodes : conversion->nodes) {
        if (node.keyword != "PARAMETER" || node.values.size() < 2) continue;
        const auto which = parameterOf(node.values[0]);
        if (!which || (*which == CrsMeaning::Longitude && !isGreenwich(base))) continue;
        const bool length = *which == CrsMeaning::FalseEasting || *which == CrsMeaning::FalseNorthing;
        const double own = factorOf(node.find({"LENGTHUNIT", "ANGLEUNIT", "UNIT"}));
        const double value = decimalOf(node.values[1]);
        auto& to = meaning.parameter[*which];
        if (*which == CrsMeaning::Scale)
            to = value;
        else if (!length)
            to = value * (own > 0 ? own : angle) / degree;
        else if (own > 0 || meaning.unit > 0)
            to = value * (own > 0 ? own : meaning.unit);
    }
    // Which of two parallels is the first is a matter of taste.
    auto& first = meaning.parameter[CrsMeaning::FirstParallel];
    auto& second = meaning.parameter[CrsMeaning::SecondParallel];
    if (first && second && *first > *second) std::swap(first, second);
}

/// What is said of a compound by one number alone: the number of what x and y are in it.
std::optional<int> horizontalEpsg(int epsg) {
    struct Compound {
        int whole, horizontal;
    };
    static constexpr Compound known[] = {{5554, 25831}, {5555, 25832}, {5556, 25833}, {5972, 25832},
                                         {5973, 25833}, {5975, 25835}, {7405, 27700}, {7415, 28992},
                                         {5698, 2154},  {5498, 4269},  {6349, 6318},  {9518, 4326}};
    const auto found = std::ranges::find(known, epsg, &Compound::whole);
    return found == std::end(known) ? std::nullopt : std::optional(found->horizontal);
}

/// What a number alone says of the few that are known here.
void readNumber(int epsg, CrsMeaning& meaning) {
    if (meaning.name.empty()) meaning.name = plainName(nameOfEpsg(epsg));
    const bool known = !nameOfEpsg(epsg).empty();
    if (meaning.kind == Kind::Unknown && known)
        meaning.kind = epsg == 4326 ? Kind::Geographic : Kind::Projected;
    if (meaning.unit == 0 && known) meaning.unit = epsg == 4326 ? degree : 1;
}

void readText(const WktNode& root, CrsMeaning& meaning) {
    const auto* crs = horizontalPart(root);
    if (crs == nullptr) return;
    meaning.kind = kindOf(crs->keyword, *crs);
    meaning.unit = factorOf(unitOf(*crs));
    if (!crs->values.empty()) meaning.name = plainName(crs->values[0]);
    if (saysNothing(meaning.name)) meaning.name.clear();
    if (const auto own = ownEpsg(*crs)) meaning.epsg = own;
    const auto* base = meaning.kind == Kind::Projected ? baseOf(*crs) : crs;
    const auto* datum = base == nullptr ? nullptr : base->find({"DATUM", "ENSEMBLE", "TRF", "GEODETICDATUM"});
    if (datum != nullptr && !datum->values.empty()) meaning.datum = plainName(datum->values[0]);
    if (meaning.kind == Kind::Projected) readParameters(*crs, meaning);
}

bool differ(double a, double b, double most) {
    return std::abs(a - b) > most;
}

bool parametersDiffer(const CrsMeaning& a, const CrsMeaning& b) {
    // Degrees of a ten-millionth are a centimetre; metres as programs round feet.
    static constexpr std::array<double, CrsMeaning::parameters> most{1e-6, 1e-6, 1e-6, 1e-6,
                                                                     1e-8, 0.02, 0.02};
    for (std::size_t i = 0; i < most.size(); ++i)
        if (a.parameter[i] && b.parameter[i] && differ(*a.parameter[i], *b.parameter[i], most[i]))
            return true;
    return false;
}

/// All that makes a projection, on both sides: it differs nowhere, as was found before.
bool parametersProve(const CrsMeaning& a, const CrsMeaning& b) {
    std::size_t both = 0;
    for (std::size_t i = 0; i < CrsMeaning::parameters; ++i) {
        if (a.parameter[i].has_value() != b.parameter[i].has_value()) return false;
        both += a.parameter[i].has_value();
    }
    return both >= 5 && a.unit > 0 && b.unit > 0 && !a.datum.empty() && a.datum == b.datum;
}

bool provablyDifferent(const CrsMeaning& a, const CrsMeaning& b) {
    if (a.kind != Kind::Unknown && b.kind != Kind::Unknown && a.kind != b.kind) return true;
    if (a.unit > 0 && b.unit > 0 && differ(a.unit, b.unit, 1e-7 * a.unit)) return true;
    if (a.epsg && b.epsg) return *a.epsg != *b.epsg;
    const auto zoneA = utmZone(a.name), zoneB = utmZone(b.name);
    if (!zoneA.empty() && !zoneB.empty() && zoneA != zoneB) return true;
    return parametersDiffer(a, b);
}

}  // namespace

double CrsMeaning::metres() const {
    if (unit <= 0) return 1;
    return kind == Kind::Geographic ? unit * earthRadius : unit;
}

std::optional<CrsMeaning> crsMeaning(std::string_view wkt, std::optional<int> epsg) {
    if (wkt.empty() && !epsg) return std::nullopt;
    CrsMeaning meaning;
    std::ranges::copy_if(wkt, std::back_inserter(meaning.text),
                         [](char c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
    const auto root = parseWkt(wkt);
    if (root) readText(*root, meaning);
    // The number of a compound says nothing by itself of what x and y are.
    const bool ofCompound = root && epsg && horizontalPart(*root) != &*root && ownEpsg(*root) == epsg;
    if (!meaning.epsg && epsg)
        meaning.epsg = ofCompound ? horizontalEpsg(*epsg) : horizontalEpsg(*epsg).value_or(*epsg);
    if (meaning.epsg) readNumber(*meaning.epsg, meaning);
    return meaning;
}

CrsRelation compare(const CrsMeaning& a, const CrsMeaning& b) {
    if (provablyDifferent(a, b)) return CrsRelation::Different;
    const bool number = a.epsg && b.epsg;  // and they are the same
    const bool name = !a.name.empty() && a.name == b.name;
    const bool text = !a.text.empty() && a.text == b.text;
    return number || name || text || parametersProve(a, b) ? CrsRelation::Same : CrsRelation::Unclear;
}

}  // namespace scancast
