// A scan read by an importer program: process, point stream, and the words when either fails.
// Pipeline: file → importer process → point stream → **points** → octree. Owned and used by one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/import/stream/importer_process.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast {

class ImporterSource final : public PointSource {
  public:
    /// The bytes of `input` bound what it can hold.
    static Expected<std::unique_ptr<ImporterSource>> create(const ImporterProgram& program,
                                                            const ScanInput& input,
                                                            const ImportOptions& options);

    const ScanHeader& header() const override { return reader_->header(); }
    Expected<PointBatch> glance() override;
    Expected<bool> read(PointBatch& batch) override;
    std::uint64_t droppedPoints() const override { return reader_->droppedPoints(); }
    std::vector<std::string> notes() const override;
    std::vector<Station> stations() const override { return reader_->stations(); }
    std::vector<Photo> photos() const override { return reader_->photos(); }
    std::array<std::uint64_t, 2> bytesRead() const override { return reader_->bytesRead(); }

  private:
    ImporterSource(std::string program, std::string name)
        : program_(std::move(program)), name_(std::move(name)) {}
    Error explain(const Error& error, ImporterProcess& process) const;

    std::string program_, name_;
    bool cannotRecover_ = false;  ///< it was asked for, and this importer does not know how
    std::shared_ptr<ImporterProcess> process_;
    std::unique_ptr<PointStreamReader> reader_;
};

}  // namespace scancast
