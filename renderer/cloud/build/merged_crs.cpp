#include "renderer/cloud/build/merged_crs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"

namespace scancast {

namespace {

constexpr double farMetres = 100'000;
constexpr double farExtents = 10;
constexpr std::size_t namedFiles = 3, toldSystems = 5;

using Box = std::array<glm::dvec3, 2>;

double extent(const Box& box) {
    return std::max(box[1].x - box[0].x, box[1].y - box[0].y);
}

double gap(const Box& a, const Box& b) {
    const auto along = [&](int axis) {
        return std::max({0.0, a[0][axis] - b[1][axis], b[0][axis] - a[1][axis]});
    };
    return std::hypot(along(0), along(1));
}

bool areFar(const Box& a, const Box& b, double metres) {
    const double between = gap(a, b);
    return between * metres > farMetres && between > farExtents * std::max(extent(a), extent(b));
}

std::string crsOf(const ScanCrs& scan) {
    const auto name = crsName(scan.wkt, scan.epsg);
    return name.empty() ? "a CRS without a name" : name;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    const auto told = names.size() <= namedFiles + 1 ? names.size() : namedFiles;
    for (std::size_t i = 0; i < told; ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    if (told < names.size()) text += fmt::format(" and {} more", names.size() - told);
    return text;
}

/// How a number is asked for that nobody here knows.
std::string numberOf(const ScanCrs& scan) {
    return scan.epsg ? fmt::format("EPSG:{}", *scan.epsg) : "EPSG:NUMBER";
}

std::string waysOut(const ScanCrs& kept, const ScanCrs& other, bool otherIsSilent) {
    const auto to = numberOf(kept);
    const auto stem = std::filesystem::path(other.name).stem().string();
    const auto from = otherIsSilent ? " --filters.reprojection.in_srs=EPSG:NUMBER" : "";
    return fmt::format(
        "If they belong together as they are, --assume-crs {0} takes that for all of them; if not, bring "
        "them into one first, "
        "for example with \"pdal translate {1} {2}-reprojected.las reprojection{3} "
        "--filters.reprojection.out_srs={0}\".",
        to, other.name, stem, from);
}

tl::unexpected<Error> refuse(const std::string& why, const std::string& ways) {
    return fail(ErrorCode::InvalidArgument, why + ". " + ways, "assume-crs");
}

/// The systems that occur, each once, and who has which.
struct Systems {
    std::vector<CrsMeaning> meaning;
    std::vector<std::size_t> first;  ///< the first scan that has it
    std::vector<int> of;             ///< by scan; -1 = it says nothing
};

Systems systemsOf(std::span<const ScanCrs> scans) {
    Systems systems;
    std::map<std::pair<std::string, int>, int> known;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto [at, isNew] = known.try_emplace({scans[i].wkt, scans[i].epsg.value_or(0)}, -1);
        if (isNew)
            if (auto meaning = crsMeaning(scans[i].wkt, scans[i].epsg)) {
                at->second = int(systems.meaning.size());
                systems.meaning.push_back(std::move(*meaning));
                systems.first.push_back(i);
            }
        systems.of.push_back(at->second);
    }
    return systems;
}

Expected<void> refuseDifferent(std::span<const ScanCrs> scans, const Systems& systems) {
    for (std::size_t b = 1; b < systems.meaning.size(); ++b)
        for (std::size_t a = 0; a < b; ++a) {
            if (compare(systems.meaning[a], systems.meaning[b]) != CrsRelation::Different) continue;
            const ScanCrs& one = scans[systems.first[a]];
            const ScanCrs& other = scans[systems.first[b]];
            return refuse(
                fmt::format("{} is in {}, {} in {}: they use different coordinate reference systems",
                            one.name, crsOf(one), other.name, crsOf(other)),
                waysOut(one, other, false));
        }
    return {};
}

/// From those that are sure, step by step, to all that are near; what is left is far from all of these.
std::vector<bool> reachedFrom(std::vector<bool> sure, std::span<const ScanCrs> scans, double metres) {
    std::vector<std::size_t> ahead, left;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (!hasPlace(scans[i]))
            sure[i] = true;
        else
            (sure[i] ? ahead : left).push_back(i);
    }
    // Nothing with a place is sure: the first one is where all others are seen from.
    if (ahead.empty() && !left.empty()) {
        ahead.push_back(left.front());
        sure[left.front()] = true;
        left.erase(left.begin());
    }
    while (!ahead.empty()) {
        const Box from = *scans[ahead.back()].bounds;
        ahead.pop_back();
        std::erase_if(left, [&](std::size_t i) {
            if (areFar(from, *scans[i].bounds, metres)) return false;
            sure[i] = true;
            ahead.push_back(i);
            return true;
        });
    }
    return sure;
}

Expected<void> refuseFar(std::span<const ScanCrs> scans, const Systems& systems,
                         const std::vector<bool>& sure, double metres) {
    const auto reached = reachedFrom(sure, scans, metres);
    const auto lost = std::ranges::find(reached, false);
    if (lost == reached.end()) return {};
    const auto far = std::size_t(lost - reached.begin());
    std::size_t nearest = far;
    for (std::size_t i = 0; i < scans.size(); ++i)
        if (reached[i] && hasPlace(scans[i]) &&
            (nearest == far ||
             gap(*scans[i].bounds, *scans[far].bounds) < gap(*scans[nearest].bounds, *scans[far].bounds)))
            nearest = i;
    const ScanCrs& one = scans[nearest];
    const ScanCrs& other = scans[far];
    const bool silent = systems.of[far] < 0, nobody = systems.meaning.empty();
    const auto apart = fmt::format("{:.0f} km", gap(*one.bounds, *other.bounds) * metres / 1000);
    const auto kept = systems.meaning.empty() ? one : scans[systems.first.front()];
    const auto why =
        nobody ? fmt::format("{} and {} do not say their coordinate reference systems, and lie {} apart",
                             one.name, other.name, apart)
        : silent
            ? fmt::format(
                  "{} does not say its coordinate reference system, and lies {} from {}, which is taken to "
                  "be "
                  "in {}",
                  other.name, apart, one.name, crsOf(kept))
            : fmt::format("{} is in {}, {} in {}, which nothing proves to be the same, and they lie {} apart",
                          kept.name, crsOf(kept), other.name, crsOf(other), apart);
    return refuse(why + ": they are not put together on a guess", waysOut(kept, other, silent));
}

/// Notes stay with the cloud and are read by others: they need not know where the files were.
std::string shortName(const ScanCrs& scan) {
    return std::filesystem::path(scan.name).filename().string();
}

std::vector<std::string> notesOn(std::span<const ScanCrs> scans, const Systems& systems) {
    std::vector<std::string> notes;
    if (systems.meaning.empty()) return notes;
    const ScanCrs& kept = scans[systems.first.front()];
    std::vector<std::string> silent;
    for (std::size_t i = 0; i < scans.size(); ++i)
        if (systems.of[i] < 0) silent.push_back(shortName(scans[i]));
    if (!silent.empty())
        notes.push_back(fmt::format(
            "{} {} not say {} coordinate reference system; that of {}, {}, is taken for {}", listed(silent),
            silent.size() == 1 ? "does" : "do", silent.size() == 1 ? "its" : "their", shortName(kept),
            crsOf(kept), silent.size() == 1 ? "it" : "them"));
    std::size_t unclear = 0;
    for (std::size_t s = 1; s < systems.meaning.size(); ++s) {
        if (compare(systems.meaning.front(), systems.meaning[s]) == CrsRelation::Same) continue;
        if (++unclear > toldSystems) continue;
        const ScanCrs& other = scans[systems.first[s]];
        notes.push_back(fmt::format(
            "{} is in {}, {} in {}; nothing proves that these are the same, and they are taken for it",
            shortName(kept), crsOf(kept), shortName(other), crsOf(other)));
    }
    if (unclear > toldSystems)
        notes.push_back(
            fmt::format("{} more coordinate reference systems are taken for that of {} on no proof",
                        unclear - toldSystems, shortName(kept)));
    return notes;
}

}  // namespace

/// Some programs leave the header's bounds 0, and some headers are damaged.
bool hasPlace(const ScanCrs& scan) {
    if (!scan.bounds) return false;
    const auto& [low, high] = *scan.bounds;
    bool finite = true, zero = true;
    for (int a = 0; a < 3; ++a) {
        finite = finite && std::isfinite(low[a]) && std::isfinite(high[a]);
        zero = zero && low[a] == 0 && high[a] == 0;
    }
    return finite && !zero && low.x <= high.x && low.y <= high.y;
}

Expected<MergedCrs> mergeCrs(std::span<const ScanCrs> scans) {
    const Systems systems = systemsOf(scans);
    if (auto ok = refuseDifferent(scans, systems); !ok) return passOn(ok);
    std::vector<bool> sure(scans.size());
    for (std::size_t i = 0; i < scans.size(); ++i)
        sure[i] = systems.of[i] >= 0 &&
                  compare(systems.meaning.front(), systems.meaning[std::size_t(systems.of[i])]) ==
                      CrsRelation::Same;
    const double metres = systems.meaning.empty() ? 1 : systems.meaning.front().metres();
    if (auto ok = refuseFar(scans, systems, sure, metres); !ok) return passOn(ok);

    MergedCrs merged;
    merged.notes = notesOn(scans, systems);
    const bool doubtful = std::ranges::find(sure, false) != sure.end();
    merged.boundsMatter =
        doubtful && std::ranges::any_of(scans, [](const ScanCrs& scan) { return !hasPlace(scan); });
    if (systems.meaning.empty()) return merged;
    merged.wkt = scans[systems.first.front()].wkt;
    merged.epsg = scans[systems.first.front()].epsg;
    // What the first leaves out, another may say of the same.
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (!sure[i]) continue;
        if (merged.wkt.empty()) merged.wkt = scans[i].wkt;
        if (!merged.epsg) merged.epsg = scans[i].epsg;
    }
    return merged;
}

}  // namespace scancast
