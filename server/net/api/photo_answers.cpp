#include "server/net/api/photo_answers.hpp"

#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "protocol/nearest_name.hpp"
#include "server/base/faults.hpp"
#include "server/net/api/negotiate.hpp"

namespace scancast {
namespace {

constexpr std::size_t mostPhotosWaiting = 64;
constexpr std::size_t mostPhotoTags = 2 * mostPhotos;

/// Bytes of one answer, counted as long as it is being sent.
struct CountedPhoto {
    std::vector<std::byte> bytes;
    TransientMemory::Hold hold;
    WorkBudget::Ticket kept;
};

/// It came from outside: browsers take it for a picture of that type, and for nothing that could run.
HttpResponse photoHead(Photo::Format format, const std::string& tag) {
    HttpResponse response;
    response.set("Content-Type", std::string(mediaType(format)))
        .set("ETag", tag)
        .set("Cache-Control", "no-cache")
        .set("Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'; sandbox");
    return response;
}

}  // namespace

tl::expected<const Photo*, Problem> photoOfNumber(const Cloud& cloud, std::string_view number) {
    std::size_t index = 0;
    const auto [end, wrong] = std::from_chars(number.data(), number.data() + number.size(), index);
    const bool isNumber = wrong == std::errc() && std::to_string(index) == number;
    if (isNumber && index < cloud.photos.size()) return &cloud.photos[index];
    const std::size_t count = cloud.photos.size();
    return tl::unexpected(
        problemOf(404, count == 0 ? std::string("The scan of this cloud brought no photos along.")
                                  : fmt::format("{} is no photo of this cloud: {}.", quoteText(number),
                                                count == 1 ? "its only one is 0"
                                                           : fmt::format("they are 0 to {}", count - 1))));
}

struct PhotoAnswers::Asked {
    std::shared_ptr<const PhotoBytes> data;
    Photo::Format format;
    std::uint64_t bytes;
    bool isHead;
    std::string ifNoneMatch, path;
    WorkBudget::Ticket kept;
    Respond respond;

    /// 304, or what a HEAD gets; nullopt where the bytes are wanted.
    std::optional<HttpResponse> withoutBody(const std::string& tag) const {
        HttpResponse response = photoHead(format, tag);
        if (matchesAny(ifNoneMatch, tag))
            response.status = 304;
        else if (isHead)
            response.bodyBytes = bytes;
        else
            return std::nullopt;
        return response;
    }
};

PhotoAnswers::PhotoAnswers(const Admission& admission, TransientMemory memory)
    : admission_(admission), memory_(std::move(memory)), worker_(mostPhotosWaiting) {}

void PhotoAnswers::answer(const HttpRequest& request, const Routed& routed,
                          const std::shared_ptr<const Cloud>& cloud, Respond respond,
                          std::stop_token gone) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        respond(problemResponse(problem));
    };
    const auto found = photoOfNumber(*cloud, routed.n);
    if (!found) return refuse(found.error());
    const Photo& photo = **found;
    if (!accepts(request.header("accept"), mediaType(photo.format)))
        return refuse(problemOf(406, fmt::format("This photo is {}, which the Accept header rules out.",
                                                 mediaType(photo.format))));
    if (!photo.data)
        return refuse(problemOf(503, "This photo is still being read from its scan; ask again in a moment."));
    Asked asked{
        photo.data,  photo.format, photo.bytes, request.method == "HEAD", request.header("if-none-match"),
        routed.path, {},           respond};
    if (const auto tag = knownTag(photo.data))
        if (auto response = asked.withoutBody(*tag)) return respond(std::move(*response));
    auto kept = admission_.keep(request.client, photo.bytes);
    if (!kept) return refuse(std::move(kept.error()));
    asked.kept = std::move(*kept);
    const bool posted =
        worker_.post([this, asked = std::move(asked), gone = std::move(gone)](const std::stop_token&) {
            if (!gone.stop_requested()) read(asked);
        });
    if (!posted) refuse(problemOf(503, "Too many photos are waiting to be read; ask again in a moment."));
}

void PhotoAnswers::read(const Asked& asked) const {
    auto answered = contained("Reading a photo", [&]() -> Expected<HttpResponse> {
        TransientMemory::Hold hold = memory_.hold(MemoryUse::Answers, asked.bytes);
        auto bytes = asked.data->read();
        if (!bytes) return passOn(bytes);
        hold.resize(bytes->capacity());
        const std::string tag = contentTag({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
        keepTag(asked.data, tag);
        if (auto response = asked.withoutBody(tag)) return std::move(*response);
        HttpResponse response = photoHead(asked.format, tag);
        const auto counted =
            std::make_shared<CountedPhoto>(CountedPhoto{std::move(*bytes), std::move(hold), asked.kept});
        response.photo = {counted, &counted->bytes};
        return response;
    });
    if (answered) return asked.respond(std::move(*answered));
    const Error& error = answered.error();
    const bool isOfFile = error.code == ErrorCode::Io || error.code == ErrorCode::Malformed ||
                          error.code == ErrorCode::Truncated;
    if (!isOfFile) return asked.respond(problemResponse(problemOf(error, asked.path)));
    // It is not the request that is malformed; and where the file lies is for who runs this server.
    reportFault(error);
    asked.respond(problemResponse(problemOf(500,
                                            "This photo cannot be read: what it is kept in is damaged, or "
                                            "out of reach. The server's log says more.",
                                            asked.path)));
}

std::optional<std::string> PhotoAnswers::knownTag(const std::shared_ptr<const PhotoBytes>& data) const {
    const std::lock_guard lock(mutex_);
    const auto at = tags_.find(data.get());
    // An address may have been another's; while that one's owner lives it is not.
    if (at == tags_.end() || at->second.of.lock() != data) return std::nullopt;
    return at->second.text;
}

void PhotoAnswers::keepTag(const std::shared_ptr<const PhotoBytes>& data, const std::string& tag) const {
    const std::lock_guard lock(mutex_);
    std::erase_if(tags_, [](const auto& one) { return one.second.of.expired(); });
    if (tags_.size() >= mostPhotoTags) tags_.clear();
    tags_.insert_or_assign(data.get(), Tag{data, tag});
}

}  // namespace scancast
