// scancast-import-e57 [--keep-attributes] [--recover] FILE: reads an E57 file and writes the point stream
// (renderer/cloud/import/stream/POINT_STREAM.md) to standard output. Started by Scancast, once per file.
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "importers/e57/e57_import.hpp"

namespace {

using scancast::ErrorCode;
using scancast::Expected;

Expected<void> importScan(const char* file, const scancast::import_e57::Choices& choices,
                          scancast::PointStreamWriter& writer) {
    try {
        auto opened = scancast::InputFile::open(file);
        if (!opened) return scancast::passOn(opened);
        auto bytes = scancast::FileByteSource::create(std::move(*opened).release(), "it");
        if (!bytes) return scancast::passOn(bytes);
        return scancast::import_e57::importE57(std::move(*bytes), choices, writer);
    } catch (const std::bad_alloc&) {
        return scancast::fail(ErrorCode::ResourceLimit,
                              "it needs more memory than this machine or its limit allows");
    }
}

}  // namespace

int main(int argc, char** argv) {
    int named = 1;
    const auto given = [&](std::string_view option) {
        return named < argc && argv[named] == option && ++named > 0;
    };
    scancast::import_e57::Choices choices;
    choices.keepAttributes = given("--keep-attributes");
    choices.recover = given("--recover");
    if (argc != named + 1 || argv[named][0] == '-' || isatty(STDOUT_FILENO) != 0) {
        std::fputs(
            "scancast-import-e57 [--keep-attributes] [--recover] FILE > POINTS\n"
            "Reads an E57 file, all its scans, and writes their points as Scancast's point stream; with "
            "--recover also those of a file that is damaged or cut, as far as they are whole. Scancast "
            "starts it by itself:\n"
            "  scancast serve scans.e57\n",
            stderr);
        return 2;
    }
    scancast::PointStreamWriter writer(scancast::PointStreamWriter::toDescriptor(STDOUT_FILENO));
    if (const auto done = importScan(argv[named], choices, writer); !done) {
        if (!writer.writeFailure(done.error())) return 1;
    }
    return 0;
}
