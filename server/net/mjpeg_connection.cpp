#include "server/net/mjpeg_connection.hpp"

#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/write.hpp>

#include "protocol/json_text.hpp"
#include "server/net/api/handler.hpp"
#include "server/net/api/mjpeg_request.hpp"
#include "server/net/session_host.hpp"
#include "server/net/write_watch.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// What the system keeps of unsent bytes is a queue, too.
constexpr int mostUnsent = 32 * 1024;
// That a client may send after its request, for nobody.
constexpr std::size_t mostIgnored = 64 * 1024;

std::string headText(const HttpResponse& response) {
    std::string text = fmt::format("HTTP/1.1 {} {}\r\n", response.status, reasonPhrase(response.status));
    for (const auto& [name, value] : response.headers) text += name + ": " + value + "\r\n";
    return text + "Connection: close\r\n";
}

std::string partHead(const FrameHeader& header) {
    return fmt::format(
        "Content-Type: image/jpeg\r\n"
        "Content-Length: {}\r\n"
        "Scancast-Frame: {}\r\n"
        "Scancast-Seq: {}\r\n"
        "Scancast-Kind: {}\r\n"
        "{}{}\r\n",
        header.pictureLength, header.frameId, header.seq,
        header.final   ? "final"
        : header.still ? "still"
                       : "moving",
        header.damaged ? "Scancast-Damaged: yes\r\n" : "", header.away ? "Scancast-Away: yes\r\n" : "");
}

class MjpegConnection final : public SessionHost {
  public:
    MjpegConnection(NetStream stream, HttpRequest request, Routed routed, NetContext& context,
                    RequestRecord record)
        : SessionHost(stream.get_executor(), context, routed.grant, std::move(record)),
          stream_(std::move(stream)),
          request_(std::move(request)),
          routed_(std::move(routed)),
          watch_(stream_.get_executor(), context.limits.leastRate),
          buffers_(context.memory.hold(MemoryUse::Connections, bytesOfConnection)) {}

    void run() {
        asio::dispatch(stream_.get_executor(), handler([](MjpegConnection& self) { self.begin(); }));
    }

    // ---- StreamPort

    // Nobody reads messages here; a problem matters while the answer has not begun.
    void sendText(std::string text) override {
        if (begun_) return;
        const auto message = parseServerMessage(text);
        if (!message) return;
        if (const auto* report = std::get_if<messages::ProblemReport>(&*message)) refused_ = report->problem;
    }

    // Its hello never asks for depth.
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                   std::shared_ptr<const Bytes>) override {
        if (!listening()) return;
        if (writing_ && context_.memory.streamsAreFull()) return endSlowReader();
        next_ = Part{partHead(header), std::move(picture), header.frameId};
        if (!writing_) writeNext();
    }

    void close(CloseCode code, std::string reason) override {
        if (closing_) return;
        endsBecause(fmt::format("closed {}: {}", int(code), reason));
        closing_ = true;
        next_.reset();
        if (!writing_) finish();
    }

  private:
    struct Part {
        std::string head;
        std::shared_ptr<const Bytes> picture;
        std::uint64_t frame = 0;
    };

    std::shared_ptr<MjpegConnection> self() {
        return std::static_pointer_cast<MjpegConnection>(shared_from_this());
    }
    bool listening() const override { return !gone_ && !closing_; }
    void cut() override { stream_.tcp().close(); }
    void giveUp() noexcept override { gone_ = true; }
    template <class Work>
    Handler<MjpegConnection, Work> handler(Work work) {
        return {self(), std::move(work)};
    }

    void endSlowReader() {
        context_.metrics.slowReaderEnded();
        endsBecause("read too slowly");
        gone_ = true;
        leave();
        cut();
    }

    void begin() {
        auto asked = mjpegRequest(request_, routed_, clouds(), context_.limits.maxPixels);
        if (!asked) return refuse(std::move(asked.error()));
        SessionOptions options;
        options.window = 1;
        options.endsWithLeader = true;
        if (context_.api.leaving())
            return refuse(problemOf(503, "The server is shutting down; try again later."));
        if (!openSession(ClientKind::Mjpeg, std::move(options)))
            return refuse(problemOf(503, "All sessions are taken; try again later."));
        if (session()->closed()) return;  // its token was withdrawn at this very moment
        session()->text(printMessage(ClientMessage(asked->hello)), Clock::now());
        if (!session()->greeted()) return refuse(std::move(refused_));
        if (asked->view) {
            if (auto shown = session()->change(*asked->view, Clock::now()); !shown)
                return refuse(std::move(shown.error()));
        }
        begun_ = true;
        setUpSocket();
        keepTime();
        read();
        writeHead(*asked);
    }

    void setUpSocket() {
        const int socket = stream_.tcp().socket().native_handle();
        const auto set = [socket](int level, int option, int value) {
            ::setsockopt(socket, level, option, &value, sizeof value);
        };
        set(IPPROTO_TCP, TCP_NOTSENT_LOWAT, mostUnsent);
        // After the final still nothing is sent for hours: a client that lost its power is found out all the
        // same.
        set(SOL_SOCKET, SO_KEEPALIVE, 1);
        set(IPPROTO_TCP, TCP_KEEPIDLE, 20);
        set(IPPROTO_TCP, TCP_KEEPINTVL, 10);
        set(IPPROTO_TCP, TCP_KEEPCNT, 2);
    }

    void writeHead(const MjpegRequest& asked) {
        HttpResponse response;
        response.set("Content-Type", std::string(mjpegMediaType))
            .set("Cache-Control", "no-store")
            .set("Scancast-Session", sessionId())
            .set("X-Accel-Buffering", "no");
        sayMethod(response, asked);
        context_.api.complete(request_, pattern(routed_.route), response);
        text_ = headText(response) + "\r\n--scancast\r\n";
        write(asio::buffer(text_), std::nullopt);
    }

    // The delimiter follows its picture at once: browsers show a part when they see its end.
    void writeNext() {
        part_ = std::move(*next_);
        next_.reset();
        static constexpr std::string_view delimiter = "\r\n--scancast\r\n";
        write(std::array<asio::const_buffer, 3>{asio::buffer(part_.head), asio::buffer(*part_.picture),
                                                asio::buffer(delimiter)},
              part_.frame);
    }

    template <class Buffers>
    void write(const Buffers& buffers, std::optional<std::uint64_t> frame) {
        writing_ = true;
        if (watch_.begin(stream_.tcp().socket().native_handle(), weak_from_this(),
                         [this] { endSlowReader(); }))
            stream_.tcp().expires_never();
        else
            stream_.tcp().expires_after(context_.limits.writeTimeout +
                                        std::chrono::seconds(asio::buffer_size(buffers) / 65536));
        asio::async_write(stream_, buffers,
                          handler([frame](MjpegConnection& self, error_code ec, std::size_t bytes) {
                              self.count(bytes, !ec && frame);
                              self.onWritten(ec, frame);
                          }));
    }

    void onWritten(error_code ec, std::optional<std::uint64_t> frame) {
        writing_ = false;
        watch_.end();
        part_ = {};
        if (ec) {
            endsBecause("left");
            gone_ = true;
            leave();
            return cut();
        }
        if (frame && listening()) {
            session()->text(printMessage(ClientMessage(messages::Ack{*frame})), Clock::now());
            keepTime();
        }
        if (writing_) return;
        if (next_) return writeNext();
        if (closing_) finish();
    }

    // What a client sends now is for nobody; its end is the end of the stream.
    void read() {
        stream_.tcp()
            .expires_never();  // writes have deadlines; a view may stand still, and its client be silent
        stream_.async_read_some(asio::buffer(ignored_), handler([](MjpegConnection& self, error_code ec,
                                                                   std::size_t n) { self.onRead(ec, n); }));
    }

    void onRead(error_code ec, std::size_t bytes) {
        ignoredBytes_ += bytes;
        if (!ec && ignoredBytes_ <= mostIgnored) return read();
        endsBecause(ec ? "left" : "sent more than a request");
        gone_ = true;
        leave();
        cut();
    }

    void finish() {
        stream_.tcp().expires_after(context_.limits.closeTimeout);
        stream_.goodbye(sharedHandler(self(), [](MjpegConnection& self, error_code) { self.cut(); }));
    }

    void refuse(Problem problem) {
        closing_ = true;
        refused(problem.status);
        problem.instance = routed_.path;
        HttpResponse response = problemResponse(problem);
        context_.api.complete(request_, pattern(routed_.route), response);
        text_ = headText(response) + fmt::format("Content-Length: {}\r\n\r\n", response.text.size()) +
                response.text;
        stream_.tcp().expires_after(context_.limits.writeTimeout);
        asio::async_write(stream_, asio::buffer(text_),
                          handler([](MjpegConnection& self, error_code ec, std::size_t bytes) {
                              self.count(bytes, false);
                              if (!ec) self.finish();
                          }));
    }

    NetStream stream_;
    const HttpRequest request_;
    const Routed routed_;
    WriteWatch watch_;
    const TransientMemory::Hold buffers_;
    std::string text_;
    Part part_;                 ///< being written
    std::optional<Part> next_;  ///< waits for the head to be written
    Problem refused_;
    std::array<char, 512> ignored_{};
    std::size_t ignoredBytes_ = 0;
    bool begun_ = false, writing_ = false, closing_ = false, gone_ = false;
};

}  // namespace

void startMjpeg(NetStream stream, HttpRequest request, Routed routed, NetContext& context,
                ConnectionRegister::Place place, RequestRecord record) {
    constexpr int ok = 200;
    record.status = ok;
    const auto connection = std::make_shared<MjpegConnection>(std::move(stream), std::move(request),
                                                              std::move(routed), context, std::move(record));
    connection->take(std::move(place));
    connection->run();
}

}  // namespace scancast
