#include "renderer/cloud/import/stream/importer_source.hpp"

#include <limits>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast {

namespace {

// No format packs more points into a byte; a program that sends more is making them up.
constexpr std::uint64_t mostPointsPerByte = 1000;

/// The reader owns its source of bytes; the process has to outlive it, because it is asked how it ended.
class SharedBytes final : public ByteSource {
  public:
    explicit SharedBytes(std::shared_ptr<ByteSource> bytes) : bytes_(std::move(bytes)) {}
    Expected<std::size_t> read(std::span<std::byte> into) override { return bytes_->read(into); }

  private:
    std::shared_ptr<ByteSource> bytes_;
};

}  // namespace

Expected<std::unique_ptr<ImporterSource>> ImporterSource::create(const ImporterProgram& program,
                                                                 const ScanInput& input,
                                                                 const ImportOptions& options) {
    const std::string name = input.path().string();
    std::unique_ptr<ImporterSource> source(new ImporterSource(program.name, name));
    source->cannotRecover_ = options.recover && !program.knowsRecover;
    auto process = ImporterProcess::start(program, input, options);
    if (!process) return fail(process.error().code, name + ": " + process.error().message);
    source->process_ = std::move(*process);

    const std::uint64_t fileBytes = input.bytes();
    constexpr auto unbounded = std::numeric_limits<std::uint64_t>::max();
    const auto mostPoints =
        fileBytes > unbounded / mostPointsPerByte ? unbounded : fileBytes * mostPointsPerByte;
    auto reader = PointStreamReader::create(std::make_unique<SharedBytes>(source->process_),
                                            {.mostPoints = mostPoints,
                                             .keepAttributes = options.keepAttributes,
                                             .fullColors = options.exact,
                                             .mostPhotoBytes = fileBytes,
                                             .photos = options.photos});
    if (!reader) return tl::unexpected(source->explain(reader.error(), 0));
    source->wrap(std::move(*reader));
    return source;
}

Expected<PointBatch> ImporterSource::glance() {
    auto points = source().glance();
    if (!points) return tl::unexpected(explain(points.error(), bytesRead()[0]));
    return points;
}

Expected<bool> ImporterSource::read(PointBatch& batch) {
    auto more = source().read(batch);
    if (!more) return tl::unexpected(explain(more.error(), bytesRead()[0]));
    return more;
}

std::vector<std::string> ImporterSource::notes() const {
    const std::filesystem::path file(name_);
    const auto short_ = (file.has_filename() ? file : file.parent_path()).filename().string();
    auto notes = source().notes();
    for (auto& note : notes) note = short_ + ": " + note;
    return notes;
}

Error ImporterSource::explain(const Error& error, std::uint64_t sent) const {
    // What the importer itself reports is about the file; everything else is about the importer.
    const bool inVain = error.code == ErrorCode::Truncated && cannotRecover_;
    if (error.code != ErrorCode::Importer)
        return {error.code,
                name_ + ": " + error.message +
                    (inVain ? "; what is whole of such a file cannot be recovered" : ""),
                {}};
    const auto where = " while reading " + name_;
    if (const auto end = process_->badEnd()) {
        // A program that could not even start says nothing about the file.
        if (sent == 0 && end->starts_with("cannot be started"))
            return {error.code, name_ + ": " + program_ + " " + *end, {}};
        const auto after = sent > 0 ? " (after " + grouped(sent) + " bytes of points)" : "";
        return {error.code, program_ + " " + *end + where + after + ": the file is probably damaged", {}};
    }
    return {error.code, program_ + " failed" + where + ": " + error.message, {}};
}

}  // namespace scancast
