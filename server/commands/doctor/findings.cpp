#include "server/commands/doctor/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/text/plain_text.hpp"

namespace scancast {

std::string_view name(Verdict verdict) {
    switch (verdict) {
        case Verdict::Ok:
            return "ok";
        case Verdict::Warning:
            return "warning";
        case Verdict::Fault:
            return "fault";
    }
    return "unknown";
}

bool Findings::sound() const {
    return std::ranges::none_of(all_, [](const Finding& one) { return one.verdict == Verdict::Fault; });
}

std::string Findings::text() const {
    std::string text;
    for (const Finding& one : all_) {
        text += fmt::format("{:<8} {:<13} {}\n", name(one.verdict), one.topic, one.text);
        if (!one.mend.empty()) text += fmt::format("{:<8} {:<13} -> {}\n", "", "", one.mend);
    }
    const auto faults = std::ranges::count(all_, Verdict::Fault, &Finding::verdict);
    const auto warnings = std::ranges::count(all_, Verdict::Warning, &Finding::verdict);
    if (faults > 0) return text + fmt::format("{} to mend, {} to know of.\n", faults, warnings);
    return text + (warnings > 0 ? fmt::format("Sound; {} to know of.\n", warnings) : "Sound.\n");
}

std::string Findings::json() const {
    using Json = nlohmann::ordered_json;
    Json list = Json::array();
    for (const Finding& one : all_) {
        Json entry{{"verdict", name(one.verdict)}, {"topic", one.topic}, {"text", one.text}};
        if (!one.mend.empty()) entry["mend"] = one.mend;
        list.push_back(std::move(entry));
    }
    const Json all{{"sound", sound()}, {"findings", std::move(list)}};
    return plainJson(all.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace scancast
