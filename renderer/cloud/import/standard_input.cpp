#include "renderer/cloud/import/standard_input.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "renderer/cloud/import/las/las_source.hpp"

namespace scancast {

Expected<std::unique_ptr<PointSource>> openStandardInput(const ImportOptions& options) {
    if (::isatty(STDIN_FILENO))
        return fail(
            ErrorCode::InvalidArgument,
            "Standard input is a terminal; pipe a LAS file into it, for example: scancast generate town "
            "--format las14 -o - | scancast ingest - -o town.scan");
    UniqueFd fd(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3));
    auto bytes = FileByteSource::create(std::move(fd), "standard input");
    if (!bytes) return passOn(bytes);
    auto source = LasSource::create(std::move(*bytes), "standard input", options.keepAttributes,
                                    options.recover, options.exact);
    if (!source) return passOn(source);
    std::unique_ptr<PointSource> opened(std::move(*source));
    if (!options.assumeCrs) return opened;
    return withCrs(std::move(opened), *options.assumeCrs, "standard input");
}

}  // namespace scancast
