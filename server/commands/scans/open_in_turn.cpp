#include "server/commands/scans/open_in_turn.hpp"

#include "renderer/cloud/build/lazy_scan.hpp"

namespace scancast {

Expected<std::unique_ptr<PointSource>> openInTurn(const ScanInput& input, const ImportOptions& import) {
    return lazyScan(
        [=, path = input.path(), seen = input.file().identity()]() -> Expected<std::unique_ptr<PointSource>> {
            const auto again = ScanInput::open(path);
            if (!again) return passOn(again);
            if (again->file().identity() == seen) return openScan(*again, import);
            return fail(ErrorCode::Io, path.string() + " has changed since this began; begin again");
        });
}

}  // namespace scancast
