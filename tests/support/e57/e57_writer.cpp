#include "tests/support/e57/e57_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <span>
#include <sstream>

#include "importers/e57/crc32c.hpp"

namespace scancast::test {

namespace {

constexpr std::size_t pageContent = 1020;
constexpr std::size_t mostOfAPacket = 60000;

template <class T>
std::string bytesOfValue(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

std::string checksum(std::string_view content) {
    const auto crc =
        import_e57::crc32cByTable(std::as_bytes(std::span<const char>(content.data(), content.size())));
    std::string bytes = bytesOfValue(crc);
    return {bytes.rbegin(), bytes.rend()};
}

std::uint64_t physical(std::uint64_t logical) {
    return logical / pageContent * 1024 + logical % pageContent;
}

std::string text(double value) {
    std::array<char, 40> digits{};
    std::snprintf(digits.data(), digits.size(), "%.17g", value);
    return digits.data();
}

/// Bits behind each other, lowest first; whole bytes leave.
class BitQueue {
  public:
    void push(std::uint64_t value, unsigned bits, std::string& bytes) {
        waiting_ |= static_cast<unsigned __int128>(value) << count_;
        for (count_ += bits; count_ >= 8; count_ -= 8, waiting_ >>= 8)
            bytes += static_cast<char>(static_cast<std::uint8_t>(waiting_));
    }
    void flush(std::string& bytes) {
        if (count_ > 0) bytes += static_cast<char>(static_cast<std::uint8_t>(waiting_));
        count_ = 0;
        waiting_ = 0;
    }

  private:
    unsigned __int128 waiting_ = 0;
    unsigned count_ = 0;
};

std::string fieldXml(const E57Field& field) {
    switch (field.kind) {
        case E57Field::Kind::Single:
            return "<" + field.name + " type=\"Float\" precision=\"single\"/>\n";
        case E57Field::Kind::Double:
            return "<" + field.name + " type=\"Float\"/>\n";
        default:
            break;
    }
    std::string xml = "<" + field.name + " type=\"";
    xml += field.kind == E57Field::Kind::Integer ? "Integer" : "ScaledInteger";
    xml += "\" minimum=\"" + std::to_string(field.minimum) + "\" maximum=\"" + std::to_string(field.maximum) +
           "\"";
    if (field.kind == E57Field::Kind::Scaled)
        xml += " scale=\"" + text(field.scale) + "\" offset=\"" + text(field.offset) + "\"";
    return xml + "/>\n";
}

}  // namespace

E57Field E57Field::integer(std::string name, std::int64_t minimum, std::int64_t maximum) {
    return {.name = std::move(name), .kind = Kind::Integer, .minimum = minimum, .maximum = maximum};
}

E57Field E57Field::scaled(std::string name, std::int64_t minimum, std::int64_t maximum, double scale,
                          double offset) {
    return {.name = std::move(name),
            .kind = Kind::Scaled,
            .minimum = minimum,
            .maximum = maximum,
            .scale = scale,
            .offset = offset};
}

unsigned E57Field::bits() const {
    if (kind == Kind::Single) return 32;
    if (kind == Kind::Double) return 64;
    unsigned bits = 0;
    for (auto range = static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum); range > 0;
         range >>= 1)
        ++bits;
    return bits;
}

E57Writer::E57Writer(std::iostream& out) : out_(out) {
    append(std::string(48, '\0'));
}

void E57Writer::writePage(std::uint64_t page, std::string content) {
    content.resize(pageContent);
    content += checksum(content);
    out_.seekp(static_cast<std::streamoff>(page * 1024));
    out_.write(content.data(), static_cast<std::streamsize>(content.size()));
}

void E57Writer::append(std::string_view bytes) {
    while (!bytes.empty()) {
        const auto count = std::min(bytes.size(), pageContent - page_.size());
        page_ += bytes.substr(0, count);
        bytes.remove_prefix(count);
        if (page_.size() < pageContent) return;
        writePage(pages_++, std::move(page_));
        page_.clear();
    }
}

void E57Writer::patch(std::uint64_t logical, std::string_view bytes) {
    for (const char byte : bytes) {
        const auto page = logical / pageContent;
        const auto at = static_cast<std::size_t>(logical++ % pageContent);
        if (page == pages_) {
            page_[at] = byte;
            continue;
        }
        std::string content(pageContent, '\0');
        out_.seekg(static_cast<std::streamoff>(page * 1024));
        out_.read(content.data(), pageContent);
        content[at] = byte;
        writePage(page, std::move(content));
    }
}

void E57Writer::writePacket(std::vector<std::string>& pending, const E57Scan& scan) {
    std::string lengths, content;
    for (auto& stream : pending) {
        auto count = stream.size();
        if (scan.oddPackets) count = std::min<std::size_t>(count, random_() % 700);
        if (scan.streamByStream) count = content.empty() ? std::min<std::size_t>(count, 30'000) : 0;
        lengths += bytesOfValue(static_cast<std::uint16_t>(count));
        content += stream.substr(0, count);
        stream.erase(0, count);
    }
    std::string packet("\x01\x00\x00\x00", 4);
    packet += bytesOfValue(static_cast<std::uint16_t>(pending.size()));
    packet += lengths + content;
    packet.resize((packet.size() + 3) / 4 * 4);
    packet.replace(2, 2, bytesOfValue(static_cast<std::uint16_t>(packet.size() - 1)));
    append(packet);
    if (!scan.oddPackets) return;
    if (random_() % 3 == 0) append(std::string("\x02\x00\x0b\x00\xff\xff\xff\xff\xff\xff\xff\xff", 12));
    if (random_() % 3 == 0) append(std::string("\x00\x00\x0f\x00", 4) + std::string(12, '\0'));
}

std::string E57Writer::add(const E57Scan& scan) {
    const auto begin = pages_ * pageContent + page_.size();
    append(std::string(32, '\0'));
    const auto first = pages_ * pageContent + page_.size();
    unsigned recordBits = 0;
    std::string prototype;
    for (const auto& field : scan.fields) {
        recordBits += field.bits();
        prototype += fieldXml(field);
    }
    const auto block = std::max<std::uint64_t>(1, mostOfAPacket * 7 / std::max(1U, recordBits) / 2);
    std::vector<BitQueue> queues(scan.fields.size());
    std::vector<std::string> pending(scan.fields.size());
    const auto waits = [&] {
        return std::any_of(pending.begin(), pending.end(),
                           [](const auto& stream) { return !stream.empty(); });
    };
    for (std::uint64_t at = 0; at < scan.records; at += block) {
        const auto end = std::min(scan.records, at + block);
        for (std::size_t f = 0; f < scan.fields.size(); ++f) {
            const auto& field = scan.fields[f];
            for (auto record = at; record < end; ++record) {
                if (field.kind == E57Field::Kind::Single)
                    pending[f] += bytesOfValue(static_cast<float>(scan.real(record, f)));
                else if (field.kind == E57Field::Kind::Double)
                    pending[f] += bytesOfValue(scan.real(record, f));
                else
                    queues[f].push(static_cast<std::uint64_t>(scan.raw(record, f)) -
                                       static_cast<std::uint64_t>(field.minimum),
                                   field.bits(), pending[f]);
            }
            if (end == scan.records) queues[f].flush(pending[f]);
        }
        if (!scan.streamByStream) writePacket(pending, scan);
        while (end == scan.records && waits()) writePacket(pending, scan);
    }
    std::string head("\x01\0\0\0\0\0\0\0", 8);
    head += bytesOfValue(pages_ * pageContent + page_.size() - begin);
    head += bytesOfValue(physical(first));
    head += bytesOfValue(std::uint64_t(0));
    patch(begin, head);
    scans_ += "<vectorChild type=\"Structure\">\n<guid type=\"String\">" + std::to_string(begin) +
              "</guid>\n" + scan.xml + "<points type=\"CompressedVector\" fileOffset=\"" +
              std::to_string(physical(begin)) + "\" recordCount=\"" + std::to_string(scan.records) +
              "\">\n<prototype type=\"Structure\">\n" + prototype +
              "</prototype>\n</points>\n</vectorChild>\n";
    return std::to_string(begin);
}

std::uint64_t E57Writer::addBlob(std::string_view bytes) {
    const auto begin = pages_ * pageContent + page_.size();
    append(std::string(8, '\0') + bytesOfValue(std::uint64_t((16 + bytes.size() + 3) / 4 * 4)));
    append(bytes);
    append(std::string((4 - bytes.size() % 4) % 4, '\0'));
    return physical(begin);
}

void E57Writer::finish(const std::string& root) {
    finishWith(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
        "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">\n<formatName type=\"String\">ASTM E57 3D "
        "Imaging Data "
        "File</formatName>\n<guid type=\"String\">57</guid>\n<versionMajor "
        "type=\"Integer\">1</versionMajor>\n"
        "<versionMinor type=\"Integer\"/>\n<data3D type=\"Vector\">\n" +
        scans_ + "</data3D>\n" + root +
        (root.find("<images2D") == std::string::npos ? "<images2D type=\"Vector\"/>\n" : "") +
        "</e57Root>\n");
}

void E57Writer::finishWith(const std::string& xml) {
    const auto at = pages_ * pageContent + page_.size();
    append(xml);
    if (!page_.empty()) append(std::string(pageContent - page_.size(), '\0'));
    std::string head = "ASTM-E57";
    head += bytesOfValue(std::uint32_t(1)) + bytesOfValue(std::uint32_t(0)) + bytesOfValue(pages_ * 1024) +
            bytesOfValue(physical(at)) + bytesOfValue(std::uint64_t(xml.size())) +
            bytesOfValue(std::uint64_t(1024));
    patch(0, head);
    out_.flush();
}

std::string e57Pose(double w, double x, double y, double z, double tx, double ty, double tz) {
    const auto number = [](const char* name, double value) {
        return std::string("<") + name + " type=\"Float\">" + text(value) + "</" + name + ">";
    };
    return "<pose type=\"Structure\"><rotation type=\"Structure\">" + number("w", w) + number("x", x) +
           number("y", y) + number("z", z) + "</rotation><translation type=\"Structure\">" + number("x", tx) +
           number("y", ty) + number("z", tz) + "</translation></pose>\n";
}

std::string e57Blob(const char* element, std::uint64_t offset, std::size_t bytes) {
    return std::string("<") + element + " type=\"Blob\" fileOffset=\"" + std::to_string(offset) +
           "\" length=\"" + std::to_string(bytes) + "\"/>";
}

std::string e57Photo(const std::string& element, const std::string& blob, const std::string& inside,
                     const std::string& beside) {
    return "<vectorChild type=\"Structure\">" + beside + "<" + element + " type=\"Structure\">" + blob +
           inside + "</" + element + "></vectorChild>\n";
}

std::string e57File(const std::vector<E57Scan>& scans, const std::string& root) {
    std::stringstream out(std::ios::in | std::ios::out | std::ios::binary);
    E57Writer writer(out);
    for (const auto& scan : scans) writer.add(scan);
    writer.finish(root);
    return out.str();
}

void sealPages(std::string& file) {
    for (std::size_t at = 0; at + 1024 <= file.size(); at += 1024)
        file.replace(at + pageContent, 4, checksum(std::string_view(file).substr(at, pageContent)));
}

}  // namespace scancast::test
