#include "renderer/cloud/import/wkt.hpp"

#include <algorithm>

namespace scancast {

namespace {

constexpr int deepest = 16;
constexpr std::size_t mostParts = 10000;

bool isSpace(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool isWord(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '+' || c == '-' || c == ':';
}

class Parser {
  public:
    explicit Parser(std::string_view text) : text_(text) {}

    bool node(WktNode& out, int depth) {
        out.keyword = word();
        for (char& c : out.keyword)
            if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
        if (out.keyword.empty() || depth > deepest || !open()) return false;
        do {
            if (++parts_ > mostParts || !part(out, depth)) return false;
        } while (take(','));
        return take(close_.back()) && (close_.pop_back(), true);
    }

    bool atEnd() {
        skip();
        return text_.empty();
    }

  private:
    /// A text, a number, a word or a node.
    bool part(WktNode& out, int depth) {
        skip();
        if (text_.starts_with('"')) return quoted(out.values.emplace_back());
        const auto before = text_;
        const auto plain = word();
        if (plain.empty()) return false;
        skip();
        if (!text_.starts_with('[') && !text_.starts_with('(')) {
            out.values.push_back(plain);
            return true;
        }
        text_ = before;
        return node(out.nodes.emplace_back(), depth + 1);
    }

    /// Two quotation marks inside a text are one.
    bool quoted(std::string& out) {
        text_.remove_prefix(1);
        for (;;) {
            const auto end = text_.find('"');
            if (end == text_.npos) return false;
            out += text_.substr(0, end);
            text_.remove_prefix(end + 1);
            if (!text_.starts_with('"')) return true;
            out += '"';
            text_.remove_prefix(1);
        }
    }

    std::string word() {
        skip();
        const auto end = std::find_if_not(text_.begin(), text_.end(), isWord);
        std::string result(text_.begin(), end);
        text_.remove_prefix(result.size());
        return result;
    }

    bool open() {
        if (take('[')) return close_.push_back(']'), true;
        if (take('(')) return close_.push_back(')'), true;
        return false;
    }

    bool take(char c) {
        skip();
        if (!text_.starts_with(c)) return false;
        text_.remove_prefix(1);
        return true;
    }

    void skip() {
        while (!text_.empty() && isSpace(text_.front())) text_.remove_prefix(1);
    }

    std::string_view text_;
    std::string close_;  ///< the brackets that are open
    std::size_t parts_ = 0;
};

}  // namespace

const WktNode* WktNode::find(std::initializer_list<std::string_view> keywords) const {
    const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const WktNode& node) {
        return std::find(keywords.begin(), keywords.end(), node.keyword) != keywords.end();
    });
    return found == nodes.end() ? nullptr : &*found;
}

std::optional<WktNode> parseWkt(std::string_view text) {
    Parser parser(text);
    WktNode root;
    if (!parser.node(root, 1) || !parser.atEnd()) return std::nullopt;
    return root;
}

}  // namespace scancast
