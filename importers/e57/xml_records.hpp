// The XML that describes an E57 file, record by record: the root's children one after the other, and of its long lists -
// data3D (scans), images2D (pictures) - each entry, so that memory depends on the longest record and not on how many there
// are. Parsed by expat; a document type, and with it every entity of its own, is refused. Pure but for its two callbacks.
// Pipeline: pages → **XML records** → scan descriptions.
#pragma once

#include <charconv>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "protocol/error.hpp"

namespace scancast::import_e57 {

struct XmlElement {
    std::string name;  ///< with its prefix: whether that was declared is nobody's business here
    std::vector<std::pair<std::string, std::string>> attributes;
    std::string text;
    std::vector<XmlElement> children;

    /// The first of that name, or nullptr.
    const XmlElement* child(std::string_view childName) const;
    /// Its value; empty for none.
    std::string_view attribute(std::string_view attributeName) const;
};

/// Nothing at all is `otherwise`, as the standard says; nullopt for what is no number.
template <class T>
std::optional<T> numberIn(std::string_view text, T otherwise) {
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return otherwise;
    text = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
    if (text.front() == '+') text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}
/// Of a child that is a number by its type; nullopt if it is not there, or no number.
std::optional<double> valueOf(const XmlElement& parent, std::string_view name);

/// Called with the list's name ("data3D", "images2D") or nothing, and the record.
using XmlRecordVisitor = std::function<Expected<void>(std::string_view list, const XmlElement& record)>;
/// The next bytes; 0 at the end.
using XmlBytes = std::function<Expected<std::size_t>(std::span<std::byte> into)>;

inline constexpr std::size_t deepestXml = 32;
inline constexpr std::size_t mostRecordElements = 20'000;        ///< in one record
inline constexpr std::size_t mostRecordBytes = 4 * 1024 * 1024;  ///< of names, values and texts in one record

/// Elements of extensions (their name has a prefix) are left out, with all in them, except in a list of fields
/// (`prototype`). Errors, without the file's name: Malformed, with the line; ResourceLimit; the callbacks'.
Expected<void> readXmlRecords(const XmlBytes& bytes, const XmlRecordVisitor& visit);

}  // namespace scancast::import_e57
