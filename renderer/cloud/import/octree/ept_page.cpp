#include "renderer/cloud/import/octree/ept_page.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::uint32_t deepestKey = 31;
constexpr std::size_t mostEptNodes = 4'000'000;
constexpr std::uint64_t mostTilePoints = std::uint64_t(1) << 40;

/// The numbers of one page: {"0-0-0-0": 123, "1-0-0-0": -1}. What is anything else ends it, with a reason. Values are taken as
/// they come, so that a page takes no memory but its text.
class Page : public nlohmann::json_sax<nlohmann::json> {
  public:
    Page(const VoxelKey& root, EptPages& pages) : root_(root), pages_(pages) {}

    const std::string& reason() const { return reason_; }
    bool hasRoot() const { return hasRoot_; }

    bool start_object(std::size_t) override {
        return depth_++ == 0 || wrong("it holds an object within an object");
    }
    bool end_object() override { return true; }
    bool key(string_t& name) override {
        const auto found = parseVoxelKey(name);
        if (!found) return wrong(quotedText(name) + " is no node such as \"2-0-3-1\"");
        if (!isWithin(*found, root_))
            return wrong("the node " + text(*found) + " does not lie in " + text(root_));
        key_ = *found;
        return true;
    }
    bool number_unsigned(number_unsigned_t points) override {
        if (depth_ != 1) return wrong("it is no object");
        if (points > mostTilePoints)
            return wrong(
                fmt::format("the node {} has {} points: more than any real one", text(key_), points));
        if (pages_.nodes.size() == mostEptNodes)
            return wrong(fmt::format("there are more than {} nodes", grouped(mostEptNodes)));
        hasRoot_ = hasRoot_ || key_ == root_;
        pages_.nodes.push_back({key_, points});
        return true;
    }
    bool number_integer(number_integer_t number) override {
        if (depth_ != 1) return wrong("it is no object");
        if (number != -1) return wrong(fmt::format("the node {} has {} points", text(key_), number));
        if (key_ == root_) return wrong("the node " + text(key_) + " refers to this page itself: a circle");
        if (!pages_.known.insert(key_).second)
            return wrong("the page of " + text(key_) + " is referred to twice");
        pages_.ahead.push_back(key_);
        return true;
    }
    bool number_float(number_float_t, const string_t& word) override {
        return wrong(fmt::format("the node {} has {} points", text(key_), printableText(word, 40)));
    }
    bool null() override { return noNumber(); }
    bool boolean(bool) override { return noNumber(); }
    bool string(string_t&) override { return noNumber(); }
    bool binary(binary_t&) override { return noNumber(); }
    bool start_array(std::size_t) override { return noNumber(); }
    bool end_array() override { return true; }
    bool parse_error(std::size_t at, const std::string&, const nlohmann::detail::exception&) override {
        return wrong(fmt::format("it is not valid JSON at byte {}", grouped(at)));
    }

  private:
    bool noNumber() {
        return wrong(depth_ == 0 ? "it is no object" : "the node " + text(key_) + " has no number");
    }
    bool wrong(std::string reason) {
        if (reason_.empty()) reason_ = std::move(reason);
        return false;
    }

    const VoxelKey root_;
    EptPages& pages_;
    VoxelKey key_;
    int depth_ = 0;
    bool hasRoot_ = false;
    std::string reason_;
};

}  // namespace

std::optional<VoxelKey> parseVoxelKey(std::string_view text) {
    std::array<std::uint32_t, 4> numbers{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::size_t i = 0; i < 4; ++i) {
        if (i > 0 && (at == end || *at++ != '-')) return std::nullopt;
        const char* const begin = at;
        const auto [next, error] = std::from_chars(begin, end, numbers[i]);
        if (error != std::errc() || (*begin == '0' && next - begin > 1)) return std::nullopt;
        at = next;
    }
    const auto [depth, x, y, z] = numbers;
    if (at != end || depth > deepestKey) return std::nullopt;
    const auto side = std::uint64_t(1) << depth;
    if (x >= side || y >= side || z >= side) return std::nullopt;
    return VoxelKey{depth, x, y, z};
}

std::string text(const VoxelKey& key) {
    return fmt::format("{}-{}-{}-{}", key.depth, key.x, key.y, key.z);
}

bool isWithin(const VoxelKey& key, const VoxelKey& root) {
    if (key.depth < root.depth) return false;
    const auto below = key.depth - root.depth;
    return key.x >> below == root.x && key.y >> below == root.y && key.z >> below == root.z;
}

std::string eptPageName(const VoxelKey& root) {
    return "ept-hierarchy/" + text(root) + ".json";
}

Expected<void> parseEptPage(std::span<const std::byte> bytes, const VoxelKey& root, EptPages& pages) {
    Page page(root, pages);
    const auto* begin = reinterpret_cast<const char*>(bytes.data());
    const bool sound = nlohmann::json::sax_parse(begin, begin + bytes.size(), &page);
    if (!sound || !page.reason().empty())
        return fail(ErrorCode::Malformed, eptPageName(root) + ": " + page.reason());
    // A root without points may be left out; a page is there for what its own node has.
    if (!page.hasRoot() && root.depth > 0)
        return fail(ErrorCode::Malformed, eptPageName(root) + " has no number for the node " + text(root));
    return {};
}

}  // namespace scancast::import_octree
