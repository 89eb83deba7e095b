#include "importers/e57/xml_records.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <array>
#include <memory>
#include <optional>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

struct ParserEnd {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};

/// What expat's callbacks share. An exception - memory that runs out - leaves through expat, which is not used after it.
class RecordParser {
  public:
    explicit RecordParser(const XmlRecordVisitor& visit) : visit_(visit), parser_(XML_ParserCreate(nullptr)) {
        if (!parser_) return;
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(
            parser_.get(),
            [](void* self, const XML_Char* name, const XML_Char** attributes) {
                static_cast<RecordParser*>(self)->begin(name, attributes);
            },
            [](void* self, const XML_Char*) { static_cast<RecordParser*>(self)->end(); });
        XML_SetCharacterDataHandler(parser_.get(), [](void* self, const XML_Char* text, int count) {
            static_cast<RecordParser*>(self)->text({text, static_cast<std::size_t>(count)});
        });
        XML_SetStartDoctypeDeclHandler(
            parser_.get(), [](void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
                static_cast<RecordParser*>(self)->stop(ErrorCode::Malformed,
                                                       "it has a document type, which no E57 file has");
            });
    }

    /// False once the root element has ended: what follows is padding.
    Expected<bool> take(std::span<const std::byte> bytes, bool last) {
        if (!parser_) return fail(ErrorCode::ResourceLimit, "there is no memory for its description");
        const auto status = XML_Parse(parser_.get(), reinterpret_cast<const char*>(bytes.data()),
                                      static_cast<int>(bytes.size()), last ? 1 : 0);
        if (error_) return tl::unexpected<Error>(*error_);
        if (ended_) return false;
        if (status == XML_STATUS_OK) return true;
        return fail(ErrorCode::Malformed,
                    where() + std::string(XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }

  private:
    std::string where() const {
        return fmt::format("its description (XML) is wrong in line {}: ",
                           grouped(XML_GetCurrentLineNumber(parser_.get())));
    }
    void stop(ErrorCode code, const std::string& reason) {
        if (!error_) error_ = Error{code, where() + reason, {}};
        XML_StopParser(parser_.get(), XML_FALSE);
    }
    bool over() const { return error_.has_value() || ended_; }

    void begin(std::string_view name, const XML_Char** attributes);
    void end();
    void text(std::string_view more);
    bool isList(std::string_view name) const { return name == "data3D" || name == "images2D"; }
    bool spend(std::size_t bytes) {
        bytes_ += bytes;
        if (bytes_ <= mostRecordBytes && elements_ <= mostRecordElements) return true;
        stop(ErrorCode::ResourceLimit, "one scan or picture has a longer description than any needs");
        return false;
    }

    const XmlRecordVisitor& visit_;
    std::unique_ptr<XML_ParserStruct, ParserEnd> parser_;
    std::optional<Error> error_;
    bool ended_ = false;
    std::size_t depth_ = 0;    ///< of open elements
    std::size_t skipped_ = 0;  ///< depth of the outermost open element that is left out; 0 = none
    std::string list_;         ///< the list that is open
    /// The record that is open, and in it the elements that are: each is moved into its parent when it ends.
    std::vector<XmlElement> open_;
    std::size_t elements_ = 0, bytes_ = 0;  ///< in the record
};

void RecordParser::begin(std::string_view name, const XML_Char** attributes) {
    if (over()) return;
    if (++depth_ > deepestXml) return stop(ErrorCode::Malformed, "elements lie too deep in each other");
    if (skipped_ > 0) return;
    if (depth_ == 1) {
        if (!name.ends_with("e57Root"))
            stop(ErrorCode::Malformed, "the first element is " + quotedText(name) + ", not \"e57Root\"");
        return;
    }
    if (depth_ == 2 && isList(name)) {
        list_ = name;
        return;
    }
    const bool isField = !open_.empty() && open_.back().name == "prototype";
    if (name.find(':') != std::string_view::npos && !isField) {
        skipped_ = depth_;
        return;
    }
    if (open_.empty()) elements_ = bytes_ = 0;
    ++elements_;
    if (!spend(name.size())) return;
    XmlElement element;
    element.name = name;
    for (; *attributes != nullptr; attributes += 2) {
        const std::string_view key(attributes[0]), value(attributes[1]);
        if (!spend(key.size() + value.size())) return;
        element.attributes.emplace_back(key, value);
    }
    open_.push_back(std::move(element));
}

void RecordParser::text(std::string_view more) {
    if (over() || skipped_ > 0 || open_.empty() || !open_.back().children.empty()) return;
    if (spend(more.size())) open_.back().text += more;
}

void RecordParser::end() {
    if (over()) return;
    const auto depth = depth_--;
    if (skipped_ > 0) {
        if (depth == skipped_) skipped_ = 0;
        return;
    }
    if (depth == 1) {
        ended_ = true;
        XML_StopParser(parser_.get(), XML_FALSE);
        return;
    }
    if (open_.empty()) {
        list_.clear();
        return;
    }
    auto element = std::move(open_.back());
    open_.pop_back();
    if (!open_.empty()) {
        open_.back().children.push_back(std::move(element));
        return;
    }
    if (auto ok = visit_(list_, element); !ok) {
        error_ = ok.error();
        XML_StopParser(parser_.get(), XML_FALSE);
    }
}

}  // namespace

const XmlElement* XmlElement::child(std::string_view childName) const {
    for (const auto& one : children)
        if (one.name == childName) return &one;
    return nullptr;
}

std::string_view XmlElement::attribute(std::string_view attributeName) const {
    for (const auto& [key, value] : attributes)
        if (key == attributeName) return value;
    return {};
}

std::optional<double> valueOf(const XmlElement& parent, std::string_view name) {
    const auto* const element = parent.child(name);
    if (element == nullptr) return std::nullopt;
    const auto value = numberIn<double>(element->text, 0.0);
    if (!value || element->attribute("type") != "ScaledInteger") return value;
    const auto scale = numberIn<double>(element->attribute("scale"), 1.0);
    const auto offset = numberIn<double>(element->attribute("offset"), 0.0);
    if (!scale || !offset) return std::nullopt;
    return *value * *scale + *offset;
}

Expected<void> readXmlRecords(const XmlBytes& bytes, const XmlRecordVisitor& visit) {
    RecordParser parser(visit);
    std::array<std::byte, 16384> buffer{};
    for (;;) {
        const auto got = bytes(buffer);
        if (!got) return passOn(got);
        const auto goesOn = parser.take(std::span(buffer).first(*got), *got == 0);
        if (!goesOn) return passOn(goesOn);
        if (!*goesOn) return {};
        if (*got == 0) return fail(ErrorCode::Malformed, "its description (XML) has no end");
    }
}

}  // namespace scancast::import_e57
