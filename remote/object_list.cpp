#include "remote/object_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace scancast {
namespace {

constexpr std::size_t deepest = 16, mostObjects = 1000, longestText = 8192, longestState = 256,
                      longestName = 64;

bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

bool isNameChar(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == ':';
}

void appendUtf8(std::string& text, std::uint32_t c) {
    const auto tail = [&](unsigned shift) { text += char(0x80U | ((c >> shift) & 0x3fU)); };
    if (c < 0x80) {
        text += char(c);
    } else if (c < 0x800) {
        text += char(0xc0U | (c >> 6));
        tail(0);
    } else if (c < 0x10000) {
        text += char(0xe0U | (c >> 12));
        tail(6), tail(0);
    } else {
        text += char(0xf0U | (c >> 18));
        tail(12), tail(6), tail(0);
    }
}

/// What stands between & and ;. nullopt: none that XML has by itself.
std::optional<std::uint32_t> characterOf(std::string_view entity) {
    constexpr std::array<std::pair<std::string_view, char>, 5> names{
        {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
    for (const auto& [name, character] : names)
        if (entity == name) return std::uint32_t(character);
    if (!entity.starts_with('#')) return std::nullopt;
    entity.remove_prefix(1);
    const bool isHex = entity.starts_with('x');
    if (isHex) entity.remove_prefix(1);
    std::uint32_t number = 0;
    const auto [end, error] =
        std::from_chars(entity.data(), entity.data() + entity.size(), number, isHex ? 16 : 10);
    const bool isScalar = number > 0 && number <= 0x10ffff && (number < 0xd800 || number > 0xdfff);
    if (error != std::errc() || end != entity.data() + entity.size() || !isScalar) return std::nullopt;
    return number;
}

/// Reads elements and their text; attributes, which say nothing here, are passed over.
class PageReader {
  public:
    explicit PageReader(std::string_view xml) : xml_(xml) {}

    Expected<ObjectPage> read() {
        passBlanks();
        if (xml_.substr(at_).starts_with("<?") && !passTo("?>")) return malformed("ends in its first line");
        passBlanks();
        while (at_ < xml_.size() && !isOver_) {
            const bool sound = xml_[at_] == '<' ? readTag() : readText();
            if (!sound) return malformed(why_);
        }
        passBlanks();
        if (!isOver_ || at_ < xml_.size())
            return malformed(isOver_ ? "goes on behind its end" : "ends too early");
        if (truncated_.empty()) return malformed("does not say whether there is more");
        if (isTruncated_ == page_.next.empty())
            return malformed(isTruncated_ ? "says that there is more, and not how to ask for it"
                                          : "says that there is no more, and how to ask for it");
        return std::move(page_);
    }

  private:
    tl::unexpected<Error> malformed(std::string_view what) const {
        return fail(ErrorCode::Malformed, fmt::format("its list of objects {} (byte {})", what, at_));
    }
    bool refuse(std::string_view why) {
        why_ = why;
        return false;
    }
    void passBlanks() {
        while (at_ < xml_.size() && isBlank(xml_[at_])) ++at_;
    }
    bool passTo(std::string_view end) {
        const auto found = xml_.find(end, at_);
        if (found == xml_.npos) return false;
        at_ = found + end.size();
        return true;
    }

    bool readTag() {
        ++at_;
        const bool closes = at_ < xml_.size() && xml_[at_] == '/';
        if (closes) ++at_;
        const std::size_t start = at_;
        while (at_ < xml_.size() && isNameChar(xml_[at_])) ++at_;
        const std::string_view name = xml_.substr(start, at_ - start);
        if (name.empty() || name.size() > longestName) return refuse("has a tag that is none");
        bool isEmpty = false;
        if (closes)
            passBlanks();
        else if (!passAttributes(isEmpty))
            return false;
        if (at_ >= xml_.size() || xml_[at_] != '>') return refuse("has a tag without an end");
        ++at_;
        if (closes) return close(name);
        return open(name) && (!isEmpty || close(name));
    }

    bool passAttributes(bool& isEmpty) {
        while (at_ < xml_.size() && xml_[at_] != '>') {
            const char c = xml_[at_];
            if (c == '<') return refuse("has a tag within a tag");
            if (c == '/') {
                isEmpty = true;
                ++at_;
                return at_ < xml_.size() && xml_[at_] == '>' ? true : refuse("has a tag without an end");
            }
            ++at_;
            if (c != '"' && c != '\'') continue;
            if (!passTo(std::string_view(&c, 1))) return refuse("has an attribute without an end");
        }
        return true;
    }

    bool readText() {
        const std::size_t end = std::min(xml_.find('<', at_), xml_.size());
        const std::string* const into = wanted();
        const bool isWanted = into != nullptr;
        const std::size_t longest = into == &key_ || into == &page_.next ? longestText : longestState;
        while (at_ < end) {
            std::string_view rest = xml_.substr(at_, end - at_);
            std::uint32_t character = 0;
            std::size_t length = 1;
            if (rest.front() == '&') {
                const auto semicolon = rest.substr(0, 12).find(';');
                const auto found =
                    semicolon == rest.npos ? std::nullopt : characterOf(rest.substr(1, semicolon - 1));
                if (!found) return refuse("has an entity that is none of XML's own");
                character = *found;
                length = semicolon + 1;
            }
            if (depth_ == 0) return refuse("has text outside of its elements");
            if (isWanted) {
                if (text_.size() >= longest) return refuse("has a text that is too long");
                if (rest.front() == '&')
                    appendUtf8(text_, character);
                else
                    text_ += rest.front();
            }
            at_ += length;
        }
        return true;
    }

    /// Where the text of the element that is open goes; nullptr: nowhere.
    std::string* wanted() {
        if (depth_ == 2 && path_[1] == "NextContinuationToken") return &page_.next;
        if (depth_ == 2 && path_[1] == "IsTruncated") return &truncated_;
        if (depth_ != 3 || path_[1] != "Contents") return nullptr;
        if (path_[2] == "Key") return &key_;
        if (path_[2] == "ETag") return &etag_;
        if (path_[2] == "Size") return &size_;
        if (path_[2] == "LastModified") return &modified_;
        return nullptr;
    }

    bool open(std::string_view name) {
        if (depth_ == 0 && name != "ListBucketResult") return refuse("is none of S3's");
        if (depth_ == deepest) return refuse("is too deep");
        path_[depth_++] = name;
        text_.clear();
        if (depth_ == 2 && name == "Contents")
            for (std::string* part : {&key_, &etag_, &size_, &modified_}) part->clear();
        return true;
    }

    bool close(std::string_view name) {
        if (depth_ == 0 || path_[depth_ - 1] != name) return refuse("closes what is not open");
        if (std::string* into = wanted()) *into = std::exchange(text_, {});
        if (depth_ == 2 && name == "Contents" && !addObject()) return false;
        if (depth_ == 2 && name == "IsTruncated") {
            if (truncated_ != "true" && truncated_ != "false")
                return refuse("does not say whether there is more");
            isTruncated_ = truncated_ == "true";
        }
        isOver_ = --depth_ == 0;
        text_.clear();
        return true;
    }

    bool addObject() {
        if (key_.empty()) return refuse("has an object without a key");
        if (page_.objects.size() == mostObjects) return refuse("has more objects than a page may");
        page_.objects.push_back({key_, fmt::format("{}\n{}\n{}", etag_, size_, modified_)});
        return true;
    }

    const std::string_view xml_;
    std::size_t at_ = 0;
    std::array<std::string_view, deepest> path_{};
    std::size_t depth_ = 0;
    bool isOver_ = false, isTruncated_ = false;
    std::string text_, key_, etag_, size_, modified_, truncated_;
    std::string_view why_;
    ObjectPage page_;
};

}  // namespace

Expected<ObjectPage> parseObjectPage(std::string_view xml) {
    return PageReader(xml).read();
}

}  // namespace scancast
