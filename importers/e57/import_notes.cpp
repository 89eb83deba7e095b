#include "importers/e57/import_notes.hpp"

#include <fmt/format.h>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

std::string countedScans(std::uint64_t count) {
    return count == 1 ? "1 scan" : grouped(count) + " scans";
}

void noteWhatIsInIt(const PagedFile& file, const FileDescription& description, const Attributes& has,
                    std::vector<std::string>& notes) {
    std::uint64_t without = 0, blind = 0, zero = 0, longOnes = 0, grey = 0, dim = 0;
    for (const auto& scan : description.scans) {
        without += scan.records == 0;
        if (scan.pose) {
            zero += scan.pose->wasZero;
            longOnes += scan.pose->wasLong;
        }
        if (scan.records == 0) continue;
        blind += !scan.hasCoordinates();
        if (!scan.hasCoordinates()) continue;
        grey += has.color && !scan.fieldOf.color();
        dim += has.intensity && !scan.fieldOf.has(Role::Intensity);
    }
    if (const auto unknown = scansOfUnknownPosition(description); unknown > 0 && description.scans.size() > 1)
        notes.push_back(fmt::format("of {} of {} it is not known from where they were taken",
                                    grouped(unknown), countedScans(description.scans.size())));
    if (description.emptyPhotos > 0)
        notes.push_back(grouped(description.emptyPhotos) + (description.emptyPhotos == 1
                                                                ? " entry for a photo that is not in it"
                                                                : " entries for photos that are not in it"));
    if (without > 0) notes.push_back(countedScans(without) + " without points");
    if (blind > 0) notes.push_back(countedScans(blind) + " left out, whose points have no coordinates");
    if (zero > 0)
        notes.push_back(countedScans(zero) +
                        " with a rotation of zero, which turns nothing and was left out");
    if (longOnes > 0)
        notes.push_back(countedScans(longOnes) +
                        " with a rotation that is not of length 1; it was brought to that");
    if (grey > 0) notes.push_back(countedScans(grey) + " without colours, shown black beside the others");
    if (dim > 0) notes.push_back(countedScans(dim) + " without intensities, which are 0 beside the others'");
    if (file.trailingBytes() > 0)
        notes.push_back(
            fmt::format("{} bytes follow its end, as its header gives it", grouped(file.trailingBytes())));
}

}  // namespace scancast::import_e57
