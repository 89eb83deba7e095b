#include "protocol/json_fields.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/nearest_name.hpp"

namespace scancast {

nlohmann::json jsonArray(const glm::dvec3& v) {
    return nlohmann::json::array({v.x, v.y, v.z});
}

FieldReader::FieldReader(const nlohmann::json& object, std::string path, ErrorCode code)
    : object_(object), path_(std::move(path)), code_(code) {
    if (!object_.is_object())
        error_ = Error{
            code_, (path_.empty() ? std::string("expected a JSON object") : path_ + ": expected an object"),
            path_};
}

std::string FieldReader::path(std::string_view key) const {
    if (key.empty()) return path_;
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void FieldReader::error(std::string_view key, const std::string& what) {
    if (!error_) error_ = Error{code_, path(key) + ": " + what, path(key)};
}

void FieldReader::error(const Error& error) {
    if (!error_) error_ = error;
}

const nlohmann::json* FieldReader::find(std::string_view key) {
    if (known_.empty() || known_.back() != key) known_.push_back(key);  // asked again, mostly, right away
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
}

const nlohmann::json* FieldReader::findValue(std::string_view key) {
    const auto* field = find(key);
    return field && !field->is_null() ? field : nullptr;
}

const nlohmann::json* FieldReader::require(std::string_view key) {
    const auto* field = find(key);
    if (!field) error(key, "is missing");
    return field;
}

bool FieldReader::number(std::string_view key, double& out) {
    const auto* field = find(key);
    if (!field) return false;
    if (!field->is_number()) {
        error(key, "expected a number");
        return false;
    }
    out = field->get<double>();
    return true;
}

bool FieldReader::number(std::string_view key, std::optional<double>& out) {
    const auto* field = find(key);
    if (!field) return false;
    if (field->is_null()) {
        out.reset();
        return true;
    }
    double value = 0;
    if (!number(key, value)) return false;
    out = value;
    return true;
}

bool FieldReader::flag(std::string_view key, bool& out) {
    const auto* field = find(key);
    if (!field) return false;
    if (!field->is_boolean()) {
        error(key, "expected true or false");
        return false;
    }
    out = field->get<bool>();
    return true;
}

bool FieldReader::text(std::string_view key, std::string& out, std::size_t longest) {
    const auto* field = find(key);
    if (!field) return false;
    if (!field->is_string()) {
        error(key, "expected a string");
        return false;
    }
    const auto& value = field->get_ref<const std::string&>();
    if (value.size() > longest) {
        error(key, "is longer than " + std::to_string(longest) + " bytes");
        return false;
    }
    out = value;
    return true;
}

bool FieldReader::numbers(std::string_view key, std::span<double> out) {
    const auto* field = find(key);
    if (!field) return false;
    const bool sound =
        field->is_array() && field->size() == out.size() &&
        std::all_of(field->begin(), field->end(), [](const auto& item) { return item.is_number(); });
    if (!sound) {
        error(key, "expected an array of " + std::to_string(out.size()) + " numbers");
        return false;
    }
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (*field)[i].template get<double>();
    return true;
}

bool FieldReader::vector(std::string_view key, glm::dvec3& out) {
    std::array<double, 3> values{};
    if (!numbers(key, values)) return false;
    out = {values[0], values[1], values[2]};
    return true;
}

bool FieldReader::readInteger(std::string_view key, std::uint64_t& out, std::uint64_t least,
                              std::uint64_t most) {
    const auto* field = find(key);
    if (!field) return false;
    bool sound = false;
    std::uint64_t value = 0;
    if (field->is_number_integer()) {  // of either signedness: values made by programs are often signed
        sound = field->is_number_unsigned() || field->get<std::int64_t>() >= 0;
        value = sound ? field->get<std::uint64_t>() : 0;
    } else if (field->is_number_float()) {
        // 1280.0 is what some languages make of 1280; beyond 2^53 a double is no longer sure of its integers.
        const auto real = field->get<double>();
        sound = real >= 0 && real <= 9007199254740992.0 && real == std::floor(real);
        if (sound) value = static_cast<std::uint64_t>(real);
    }
    if (!sound || value < least || value > most) {
        error(key, "expected a whole number from " + std::to_string(least) +
                       (most == UINT64_MAX ? std::string(" upwards") : " to " + std::to_string(most)));
        return false;
    }
    out = value;
    return true;
}

Expected<void> FieldReader::finishLenient() {
    if (error_) return tl::unexpected(*error_);
    return {};
}

Expected<void> FieldReader::finishStrict() {
    if (error_) return tl::unexpected(*error_);
    for (const auto& item : object_.items()) {
        const auto& key = item.key();
        if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
        // A key may be as long and odd as its sender likes; the path repeats a piece of it.
        constexpr std::size_t longestKey = 64;
        const auto at = path(std::string_view(key).substr(0, longestKey));
        return fail(code_, unknownName(at, key, known_), at);
    }
    return {};
}

}  // namespace scancast
