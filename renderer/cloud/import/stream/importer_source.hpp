// A scan read by an importer program: process, point stream, and the words when either fails.
// Pipeline: file → importer process → point stream → **points** → octree. Owned and used by one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/import/stream/importer_process.hpp"

namespace scancast {

class ImporterSource final : public ForwardingSource {
  public:
    /// The bytes of `input` bound what it can hold.
    static Expected<std::unique_ptr<ImporterSource>> create(const ImporterProgram& program,
                                                            const ScanInput& input,
                                                            const ImportOptions& options);

    Expected<PointBatch> glance() override;
    Expected<bool> read(PointBatch& batch) override;
    std::vector<std::string> notes() const override;

  private:
    ImporterSource(std::string program, std::string name)
        : program_(std::move(program)), name_(std::move(name)) {}
    /// `sent`: bytes of points before it.
    Error explain(const Error& error, std::uint64_t sent) const;

    std::string program_, name_;
    bool cannotRecover_ = false;  ///< it was asked for, and this importer does not know how
    std::shared_ptr<ImporterProcess> process_;
};

}  // namespace scancast
