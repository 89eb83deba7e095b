// scancast-import-pcl [--recover] FILE: reads a PLY or PCD file with the Point Cloud Library and writes the point stream
// (renderer/cloud/import/stream/POINT_STREAM.md) to standard output. Started by Scancast, once per file.
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <string_view>

#include "importers/pcl/pcd_import.hpp"
#include "importers/pcl/ply_import.hpp"

namespace {

using scancast::ErrorCode;
using scancast::Expected;

Expected<void> importScan(const std::string& file, bool recover, scancast::PointStreamWriter& writer) {
    try {
        std::string start(3, '\0');
        std::ifstream(file, std::ios::binary).read(start.data(), 3);
        if (start == "ply") return scancast::import_pcl::importPly(file, writer, recover);
        return scancast::import_pcl::importPcd(file, writer, recover);
    } catch (const std::bad_alloc&) {
        return scancast::fail(ErrorCode::ResourceLimit,
                              "it needs more memory than this machine or its limit allows");
    } catch (const std::exception& error) {
        return scancast::fail(ErrorCode::Malformed, std::string("PCL cannot read it: ") + error.what());
    }
}

}  // namespace

int main(int argc, char** argv) {
    const bool recover = argc == 3 && std::string_view(argv[1]) == "--recover";
    const char* const file = argc == (recover ? 3 : 2) ? argv[argc - 1] : "-";
    if (file[0] == '-' || isatty(STDOUT_FILENO) != 0) {
        std::fputs(
            "scancast-import-pcl [--recover] FILE > POINTS\n"
            "Reads a PLY or PCD file and writes its points as Scancast's point stream. Scancast starts it by "
            "itself:\n"
            "  scancast serve scan.ply\n"
            "--recover reads what is whole of a file that ends too early.\n",
            stderr);
        return 2;
    }
    scancast::PointStreamWriter writer(scancast::PointStreamWriter::toDescriptor(STDOUT_FILENO));
    if (const auto done = importScan(file, recover, writer); !done) {
        if (!writer.writeFailure(done.error())) return 1;
    }
    return 0;
}
