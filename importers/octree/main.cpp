// scancast-import-octree [--keep-attributes] FOLDER: reads all points of an octree that is kept as a folder, EPT or Potree,
// and writes the point stream (renderer/cloud/import/stream/POINT_STREAM.md) to standard output. Started by Scancast, once
// per octree. With --chunks it opens nothing, and decodes the tiles that come on its standard input, one after the other.
#include <unistd.h>

#include <cstdio>
#include <string_view>

#include "importers/chunk_service.hpp"
#include "importers/octree/ept/tile_chunk.hpp"
#include "importers/octree/octree_import.hpp"
#include "threads/guarded.hpp"

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--chunks" && isatty(STDOUT_FILENO) == 0)
        return scancast::serveChunks(STDIN_FILENO, STDOUT_FILENO, scancast::import_octree::decodeTile) ? 0
                                                                                                       : 1;
    const bool keepAttributes = argc > 1 && std::string_view(argv[1]) == "--keep-attributes";
    const int first = keepAttributes ? 2 : 1;
    if (argc != first + 1 || argv[first][0] == '-' || isatty(STDOUT_FILENO) != 0) {
        std::fputs(
            "scancast-import-octree [--keep-attributes] FOLDER > POINTS\n"
            "scancast-import-octree --chunks < REQUESTS > ANSWERS\n"
            "Reads an octree of EPT or Potree (its folder, or ept.json, metadata.json or cloud.js in it) and "
            "writes its "
            "points as Scancast's point stream. Scancast starts it by itself:\n"
            "  scancast serve lion/metadata.json\n"
            "With --chunks it decodes tiles of EPT that Scancast hands it, of clouds that are shown without "
            "ingest.\n",
            stderr);
        return 2;
    }
    scancast::PointStreamWriter writer(scancast::PointStreamWriter::toDescriptor(STDOUT_FILENO));
    const auto done = scancast::guarded("The importer", [&] {
        return scancast::import_octree::importOctree(argv[first], keepAttributes, writer);
    });
    if (!done && !writer.writeFailure(done.error())) return 1;
    return 0;
}
