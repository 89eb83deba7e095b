// A small HTTP server of one object, or of some, that does what a test tells it to do wrong. Threads of its own, one for each connection; gone
// with the object. *Thread safety*: every function may be called from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace scancast::test {

class RangeServer {
  public:
    enum class Does : std::uint8_t {
        Well,
        Hangs,   ///< up at once, without an answer
        Silent,  ///< and the connection stays
        Drips,   ///< a byte every 20 ms
        Answers503,
        Answers404,
        Answers403,   ///< with an error of S3
        SendsAll,     ///< 200
        SendsOthers,  ///< another range than was asked for
        SendsMore,    ///< without a length, and more than was asked for
        SendsLess,    ///< and says that it is all
        BreaksOff,    ///< in the middle
        Compresses,
        Redirects,  ///< to /moved
    };
    using Script = std::function<Does(int request)>;

    explicit RangeServer(std::string content);
    ~RangeServer();
    RangeServer(const RangeServer&) = delete;
    RangeServer& operator=(const RangeServer&) = delete;

    std::string url(const std::string& path = "/cloud.scan") const;
    void script(Script script);
    /// The object is another one from now on.
    void replace(std::string content, std::string etag);
    /// Other objects, by their paths: "/town/ept-data/0-0-0-0.bin". From now on what is neither one of them nor at `path` is not there.
    void others(std::string path, std::map<std::string, std::string> contents);
    /// One of them is refused, whatever the script says.
    void refuse(std::string path);
    /// How often a path was asked for.
    int requests(const std::string& path) const;
    /// Connections are closed as they come, and those that there are, too.
    void goAway(bool away) { away_ = away; }
    int requests() const { return requests_; }
    std::string lastHead() const;

  private:
    void accept();
    void serve(int connection);
    std::string answer(const std::string& head, bool& close, bool& drips);

    int listener_ = -1;
    std::uint16_t port_ = 0;
    std::atomic<bool> stopping_{false}, away_{false};
    std::atomic<int> requests_{0};
    mutable std::mutex mutex_;  // guards what follows
    std::string content_, etag_ = "\"first\"", head_;
    std::string path_, refused_;
    std::map<std::string, std::string> others_;
    std::map<std::string, int> asked_;
    Script script_;
    std::vector<int> connections_;
    std::vector<std::thread> threads_;
    std::thread acceptor_;
};

}  // namespace scancast::test
