// scancast-import-laz [--keep-attributes] [--recover] FILE: takes a LAZ file apart (COPC included) and writes its records as the point stream
// (renderer/cloud/import/stream/POINT_STREAM.md) to standard output. Started by Scancast, once per file. With --chunks it opens nothing, and
// decodes the chunks that come on its standard input, one after the other.
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "files/machine.hpp"
#include "importers/chunk_service.hpp"
#include "importers/in_order.hpp"
#include "importers/laz/laz_chunk.hpp"
#include "importers/laz/laz_import.hpp"
#include "threads/guarded.hpp"

namespace {

using namespace scancast;

Expected<void> importFile(const char* path, bool recover, PointStreamWriter& writer) {
    UniqueFd fd(::open(path, inputFlags));
    if (!fd) return failedToOpen("it", errno);
    auto file = InputFile::adopt(std::move(fd), "it");
    if (!file) return passOn(file);
    import_laz::ImportLimits limits;
    limits.recover = recover;
    limits.threads = importerThreads(SIZE_MAX, static_cast<std::size_t>(machineCores()));
    // Each thread has its decoders and pieces; together it is to stay below 256 MiB.
    limits.kept = std::max<std::size_t>(64, 208 - 9 * limits.threads) << 20;
    return guarded("reading it", [&] {
        return import_laz::importLaz(std::make_shared<laz::FileAccess>(std::move(*file)), limits, writer);
    });
}

}  // namespace

int main(int argc, char** argv) {
    // Each thread's own heap would reserve addresses by the dozen of megabytes, and those are limited.
    mallopt(M_ARENA_MAX, 2);
    int first = 1;
    const auto given = [&](std::string_view option) {
        return first < argc && argv[first] == option && ++first > 0;
    };
    given(
        "--keep-attributes");  // what it knows of points besides is in their records, whether it is wanted or not
    const bool recover = given("--recover");
    if (given("--chunks") && argc == first && isatty(STDOUT_FILENO) == 0)
        return serveChunks(STDIN_FILENO, STDOUT_FILENO, import_laz::decodeChunk) ? 0 : 1;
    if (argc != first + 1 || argv[first][0] == '-' || isatty(STDOUT_FILENO) != 0) {
        std::fputs(
            "scancast-import-laz [--keep-attributes] [--recover] FILE > POINTS\n"
            "scancast-import-laz --chunks < REQUESTS > ANSWERS\n"
            "Reads a LAZ file and writes its points as Scancast's point stream, with everything that it "
            "knows of them; with "
            "--recover also those of a file that ends too early, as far as they are whole. Scancast starts "
            "it by itself:\n"
            "  scancast serve scan.laz\n"
            "With --chunks it decodes chunks that Scancast hands it, of clouds that are shown without "
            "ingest.\n",
            stderr);
        return 2;
    }
    PointStreamWriter writer(PointStreamWriter::toDescriptor(STDOUT_FILENO));
    if (const auto done = importFile(argv[first], recover, writer); !done)
        if (!writer.writeFailure(done.error())) return 1;
    return 0;
}
