// Facts' JSON, field by field, nothing of it believed. Pipeline: cloud file → **fields** → facts. Owned and used by one thread.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace scancast {

inline constexpr std::size_t longestFactsText = 65536;

inline nlohmann::json vectorJson(const glm::dvec3& v) {
    return nlohmann::json::array({v.x, v.y, v.z});
}

/// Takes fields out of an object and remembers the first that is not as it must be.
class FactsFields {
  public:
    FactsFields(const nlohmann::json& object, std::string where, std::string& fault)
        : object_(object), where_(std::move(where)), fault_(fault) {
        if (!object.is_object()) blame(where_, "is not an object");
    }

    void text(const char* key, std::string& into, std::size_t longest = longestFactsText) {
        const nlohmann::json* value = find(key);
        if (!value) return;
        if (!value->is_string() || value->get_ref<const std::string&>().size() > longest)
            return blame(key, "is not a text, or too long a one");
        into = value->get<std::string>();
    }
    void flag(const char* key, bool& into) {
        if (const nlohmann::json* value = find(key))
            value->is_boolean() ? void(into = value->get<bool>()) : blame(key, "is not true or false");
    }
    template <class T>
    void whole(const char* key, T& into, std::uint64_t largest = std::numeric_limits<T>::max()) {
        if (const nlohmann::json* value = find(key)) whole(*value, key, into, largest);
    }
    template <class T>
    void whole(const nlohmann::json& value, const std::string& key, T& into, std::uint64_t largest) {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() > largest)
            return blame(key, "is not a whole number in its range");
        into = T(value.get<std::uint64_t>());
    }
    void number(const char* key, double& into) {
        if (const nlohmann::json* value = find(key)) number(*value, key, into);
    }
    void vector(const char* key, glm::dvec3& into) {
        if (const nlohmann::json* value = list(key, 3))
            for (int a = 0; a < 3; ++a) number((*value)[std::size_t(a)], key, into[a]);
    }
    void unitVector(const char* key, glm::dvec3& into) {
        vector(key, into);
        if (!(std::abs(glm::length(into) - 1) <= 1e-6)) blame(key, "is not of unit length");
    }
    void bounds(const char* key, std::array<glm::dvec3, 2>& into) {
        const nlohmann::json* value = list(key, 2);
        if (!value) return;
        for (std::size_t end = 0; end < 2; ++end) {
            const nlohmann::json& corner = (*value)[end];
            if (!corner.is_array() || corner.size() != 3) return blame(key, "is not two corners");
            for (int a = 0; a < 3; ++a) number(corner[std::size_t(a)], key, into[end][a]);
        }
        for (int a = 0; a < 3; ++a)
            if (!(into[0][a] <= into[1][a])) blame(key, "is inside out");
    }
    void range(const char* key, std::array<double, 2>& into) {
        const nlohmann::json* value = list(key, 2);
        if (!value) return;
        for (std::size_t end = 0; end < 2; ++end) number((*value)[end], key, into[end]);
        if (into[0] > into[1]) blame(key, "is upside down");
    }
    template <class T, std::size_t N>
    void wholes(const char* key, std::array<T, N>& into) {
        if (const nlohmann::json* value = list(key, N))
            for (std::size_t i = 0; i < N; ++i)
                whole((*value)[i], key, into[i], std::numeric_limits<T>::max());
    }
    /// `size` = noSize: any number of members up to `most`.
    const nlohmann::json* list(const char* key, std::size_t size, std::size_t most = 0) {
        const nlohmann::json* value = find(key);
        if (!value) return nullptr;
        if (value->is_array() && (size != noSize ? value->size() == size : value->size() <= most))
            return value;
        blame(key, "is not a list of the right length");
        return nullptr;
    }
    const nlohmann::json* find(const char* key) {
        if (!object_.is_object()) return nullptr;
        const auto found = object_.find(key);
        if (found != object_.end()) return &*found;
        blame(key, "is missing");
        return nullptr;
    }
    bool has(const char* key) const { return object_.is_object() && object_.contains(key); }
    void blame(const std::string& key, const std::string& what) {
        if (fault_.empty()) fault_ = fmt::format("\"{}{}\" {}", where_, key, what);
    }
    std::string& fault() { return fault_; }
    std::string member(const char* key) const { return where_ + key + "."; }

    void number(const nlohmann::json& value, const std::string& key, double& into) {
        if (!value.is_number() || !std::isfinite(value.get<double>())) return blame(key, "is not a number");
        into = value.get<double>();
    }

    static constexpr std::size_t noSize = std::size_t(-1);

  private:
    const nlohmann::json& object_;
    std::string where_;
    std::string& fault_;
};

}  // namespace scancast
