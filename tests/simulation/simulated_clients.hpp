// Who asks: viewers, each a real stream session (server/stream/session.hpp) at the end of a link with
// bandwidth, delay and an end; and clients that fetch pictures, and sometimes do not wait for them. A viewer
// moves its camera for a while, rests for a while, reads slowly at times, and may lose its connection. What it
// must see is checked where it sees it.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "server/stream/session.hpp"
#include "tests/simulation/simulated_server.hpp"

namespace scancast::simulation {

struct Link {
    double delayMs = 20;         ///< one way
    double bytesPerMs = 5000;    ///< towards the client
    double pausesPerMinute = 0;  ///< of the client's reading, half a second or so each
    double cutsPerMinute = 0;    ///< the connection is lost, and another made a second later
};

struct Hand {
    double viewsPerSecond = 40;
    double movesMs = 3000, restsMs = 2000;  ///< on the average
    int width = 960, height = 540;
    int samples = 4;  ///< of its stills
};

class SimulatedViewer final : public StreamPort {
  public:
    SimulatedViewer(int number, SimulatedServer& server, VirtualTime& time, Chance& chance,
                    const StreamWorld& world, Metrics& metrics, const Link& link, const Hand& hand);
    ~SimulatedViewer() override;

    /// From now on it rests, reads, and stays.
    void calmDown() { calm_ = true; }
    /// Whether it sees what it asked for last, as it is to be seen.
    bool satisfied() const { return !session_ || (seenFinal_ && seenSeq_ == seq_); }
    std::string state() const;
    double longestGapMs() const { return longestGap_; }
    std::uint64_t frames() const { return frames_; }

    void sendText(std::string text) override;
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                   std::shared_ptr<const Bytes> depth) override;
    void order(std::uint64_t number, PictureOrder order) override;
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override;
    void pick(std::uint64_t, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>, double,
              double) override {}
    void abandon() override { server_.abandon(mailbox_); }
    void close(CloseCode, std::string reason) override;
    std::function<void()> onTaken() override {
        return [] {};
    }

  private:
    void connect();
    void disconnect();
    void move();
    void rest();
    void sendView();
    void later(std::function<void()> work);
    void inSession(const std::function<void()>& work);
    PictureDone doneFor(std::uint64_t number);
    void arrived(const FrameHeader& header);

    const int number_;
    SimulatedServer& server_;
    VirtualTime& time_;
    Chance& chance_;
    const StreamWorld& world_;
    Metrics& metrics_;
    const Link link_;
    const Hand hand_;

    std::optional<StreamSession> session_;
    Turns::ParticipantId mailbox_ = 0;
    std::uint64_t connection_ = 0;  ///< counts them: what belongs to an earlier one is void
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
    Time linkFree_{}, readsFrom_{}, timer_ = Time::max();
    bool calm_ = false, moving_ = false;
    Time movesUntil_{};
    std::uint64_t seq_ = 0, seenSeq_ = 0, frames_ = 0;
    bool seenFinal_ = false;
    std::optional<Time> lastMoving_;
    double longestGap_ = 0;
};

struct Appetite {
    std::string client;
    double pauseMs = 100;  ///< between a picture and asking for the next, on the average
    int width = 1920, height = 1080, samples = 4;
    bool png = false;
    double impatience = 0.1;  ///< share of pictures that are not waited for
};

/// Asks for one picture after another.
class SimulatedFetcher {
  public:
    SimulatedFetcher(int number, SimulatedServer& server, VirtualTime& time, Chance& chance,
                     std::shared_ptr<const Cloud> cloud, const Appetite& appetite);
    /// From now on it asks for nothing more.
    void calmDown() { calm_ = true; }

  private:
    void ask();

    const int number_;
    SimulatedServer& server_;
    VirtualTime& time_;
    Chance& chance_;
    const std::shared_ptr<const Cloud> cloud_;
    const Appetite appetite_;
    std::uint64_t asked_ = 0;
    bool calm_ = false;
    std::uint64_t waitsFor_ = 0;
};

}  // namespace scancast::simulation
