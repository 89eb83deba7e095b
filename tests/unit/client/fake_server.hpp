// A server that says what a test tells it to say, over real sockets on this machine. Serves one connection at
// a time on a thread of its own, unless its script says otherwise. Boost stays in the .cpp.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/cpp/server_url.hpp"

namespace scancast::client::test {

using Bytes = std::vector<std::uint8_t>;

struct FakeAnswer {
    int status = 200;
    std::string contentType = "application/json";
    std::string body;
    std::string etag;
};

/// The server's end of a WebSocket. Functions return false when the client is gone.
class FakePeer {
  public:
    virtual ~FakePeer() = default;
    virtual bool readText(std::string& text) = 0;
    virtual bool sendText(const std::string& text) = 0;
    virtual bool sendBinary(const Bytes& bytes) = 0;
    virtual void close(std::uint16_t code, const std::string& reason) = 0;
    virtual void ping() = 0;
    /// That the client has sent; 0 = none.
    virtual std::uint16_t closeCode() const = 0;
};

class FakeServer {
  public:
    struct Script {
        bool atOnce = false;  ///< connections are served beside each other, not one after the other
        /// By path without its query.
        std::map<std::string, FakeAnswer> answers;
        /// What a WebSocket session does; none = upgrades are answered as `answers` says, or 404.
        std::function<void(FakePeer&)> session;
        std::string subprotocol = "scancast.v1";
        /// Accepts connections and says nothing.
        bool silent = false;
        /// Sends just this and closes.
        std::string raw;
    };

    explicit FakeServer(Script script);
    ~FakeServer();

    ServerUrl url() const;
    std::string text() const { return "http://" + url().authority() + "/"; }
    /// Request lines and headers of every HTTP request so far: "GET /x HTTP/1.1\r\nHost: …".
    std::vector<std::string> requests() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// A port at which nobody listens.
ServerUrl nobodysUrl();

}  // namespace scancast::client::test
