// Takes a JSON object apart, field by field, with errors that name the path. Keeps the first error and goes
// on as if nothing were there, so that callers read a list of fields and ask once at the end.
//
// Not among the installed headers. Lives on the stack of one function; the object must outlive it.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// [x, y, z].
nlohmann::json jsonArray(const glm::dvec3& v);

class FieldReader {
  public:
    /// `path` of the object itself: empty at the top. Every error carries `code`.
    explicit FieldReader(const nlohmann::json& object, std::string path = {},
                         ErrorCode code = ErrorCode::InvalidArgument);

    /// The field, or nullptr; from now on it is a known one. A null counts as present.
    const nlohmann::json* find(std::string_view key);
    /// As find(), but nullptr for null too: for optional fields whose null means "not given".
    const nlohmann::json* findValue(std::string_view key);
    /// As find(), but a missing field is an error.
    const nlohmann::json* require(std::string_view key);

    /// Each leaves `out` alone when the field is missing or wrong, and returns whether it was set.
    bool number(std::string_view key, double& out);
    bool flag(std::string_view key, bool& out);
    bool text(std::string_view key, std::string& out, std::size_t longest = 256);
    bool numbers(std::string_view key, std::span<double> out);
    bool vector(std::string_view key, glm::dvec3& out);
    template <std::integral T>
    bool integer(std::string_view key, T& out, std::uint64_t least, std::uint64_t most) {
        std::uint64_t value = 0;
        if (!readInteger(key, value, least, most)) return false;
        out = static_cast<T>(value);
        return true;
    }
    /// null clears the optional; a missing field leaves it alone.
    bool number(std::string_view key, std::optional<double>& out);
    template <std::integral T>
    bool integer(std::string_view key, std::optional<T>& out, std::uint64_t least, std::uint64_t most) {
        const auto* field = find(key);
        if (!field) return false;
        if (field->is_null()) {
            out.reset();
            return true;
        }
        T value{};
        if (!integer(key, value, least, most)) return false;
        out = value;
        return true;
    }

    std::string path(std::string_view key) const;
    /// Records `PATH: what`, unless there is an error already.
    void error(std::string_view key, const std::string& what);
    /// Records an error from deeper down.
    void error(const Error& error);
    bool failed() const { return error_.has_value(); }

    /// The first error, if any; then, when strict, that of a field that nobody asked for.
    Expected<void> finishStrict();
    Expected<void> finishLenient();

  private:
    bool readInteger(std::string_view key, std::uint64_t& out, std::uint64_t least, std::uint64_t most);

    const nlohmann::json& object_;
    std::string path_;
    ErrorCode code_;
    std::vector<std::string_view> known_;  ///< string literals of the callers
    std::optional<Error> error_;
};

}  // namespace scancast
