// The compute programs of a device: each variant of a shader compiled when it is first asked for, then kept;
// on disk, too, where there is a folder (program_files.hpp). Owned by a GL device; everything, destruction
// included, inside a Current scope of its context.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "renderer/device/gl/programs/arithmetic.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/device/gl/programs/program_files.hpp"
#include "renderer/device/gl/programs/shader_source.hpp"

namespace scancast::gl {

class Programs {
  public:
    /// An empty `folder` keeps nothing from run to run; nor does a driver without program binaries.
    Programs(const GlFunctions& gl, const std::filesystem::path& folder, const Arithmetic& arithmetic = {});

    /// "splat.comp" and its variant; valid as long as this lives. Internal, with the driver's log and the
    /// numbered source, when it does not compile.
    Expected<const Program*> get(std::string_view shader, std::span<const Define> defines);

  private:
    Expected<Program> make(const std::string& name, const std::string& source) const;

    const GlFunctions& gl_;
    const Arithmetic arithmetic_;
    std::string driver_;
    std::optional<ProgramFiles> files_;
    std::map<std::string, Program, std::less<>> programs_;  ///< by "splat.comp SHAPE=2 …"
};

}  // namespace scancast::gl
