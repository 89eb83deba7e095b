#include "tests/simulation/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <utility>
#include <variant>

#include "tests/simulation/simulated_clients.hpp"
#include "tests/simulation/simulated_clouds.hpp"
#include "tests/simulation/traced_client.hpp"

namespace scancast::simulation {
namespace {

// So that a trace takes milliseconds, whatever it says.
constexpr int mostLines = 400;
constexpr double longestWaitMs = 5000, mostMs = 30'000, patienceMs = 120'000;
constexpr int mostAtOnce = 50'000;  ///< events of one instant
constexpr double mostAfterwardsMs = 100;

std::string_view takeWord(std::string_view& line) {
    const std::string_view word = line.substr(0, line.find(' '));
    line.remove_prefix(std::min(line.size(), word.size() + 1));
    return word;
}

int takeNumber(std::string_view& line, int least, int most) {
    const std::string_view word = takeWord(line);
    int number = least;
    std::from_chars(word.data(), word.data() + word.size(), number);
    return std::clamp(number, least, most);
}

Machine machineOf(std::string_view& trace) {
    std::string_view line = trace.substr(0, trace.find('\n'));
    if (takeWord(line) != "machine") return {};
    Chance lots(std::uint64_t(takeNumber(line, 0, 1'000'000)));
    return someMachine(lots);
}

class Player {
  public:
    explicit Player(const Machine& machine)
        : server_(time_, chance_, machine),
          polite_(0, server_, time_, chance_, own_, metrics_, Link{}, Hand{20, 1000, 500, 960, 540, 2}) {}

    std::optional<std::string> play(std::string_view trace) {
        for (int lines = 0; !trace.empty() && lines < mostLines && passed_ < mostMs && !server_.violation();
             ++lines) {
            const std::string_view line = trace.substr(0, trace.find('\n'));
            trace.remove_prefix(std::min(trace.size(), line.size() + 1));
            happen(line);
            run(0);
        }
        end();
        return server_.violation();
    }

  private:
    struct Slot {
        std::shared_ptr<TracedClient> client;
        std::string session, token;  ///< that it was told last, by this connection or an earlier one
        Turns::SnapshotId snapshot = 0;
    };

    void run(double ms) {
        const Time end = time_.now() + milliseconds(ms);
        Time instant = time_.now();
        int atOnce = 0;
        while (!server_.violation() && time_.step(end)) {
            atOnce = time_.now() == instant ? atOnce + 1 : 0;
            instant = time_.now();
            if (atOnce > mostAtOnce) server_.violate("time stands still: something happens again and again");
        }
        if (time_.now() < end) {
            time_.at(end, [] {});
            time_.step(end);
        }
        passed_ += ms;
    }

    void happen(std::string_view line) {
        if (!line.empty() && line[0] >= '0' && line[0] < char('0' + slots_.size())) {
            Slot& slot = slots_[std::size_t(line[0] - '0')];
            takeWord(line);
            const std::string_view verb = takeWord(line);
            return ofClient(slot, verb, line);
        }
        const std::string_view verb = takeWord(line);
        if (verb == "wait") return run(takeNumber(line, 0, int(longestWaitMs)));
        if (verb == "lose") return server_.loseDevice();
        if (verb == "stall") return server_.stall(takeNumber(line, 0, 8000));
        if (verb == "remove") clouds_.remove();
        if (verb == "replace") clouds_.replace();
        if (verb == "loading" || verb == "still") clouds_.setLoading(verb == "loading");
        if (verb == "live" || verb == "still") clouds_.setLive(verb == "live");
        if (verb == "remove" || verb == "replace") sessions_.wakeAll();
    }

    void ofClient(Slot& slot, std::string_view verb, std::string_view rest) {
        if (verb == "connect" && (!slot.client || slot.client->gone()))
            slot.client =
                TracedClient::connect(++clients_, {server_, time_, clouds_, metrics_, sessions_, resumable_});
        if (verb == "picture") return askForPicture(slot, rest);
        if (verb == "gone") return giveUpPicture(slot);
        if (!slot.client) return;
        if (verb == "text") slot.client->say(withNames(rest));
        if (verb == "binary") slot.client->sayBinary();
        if (verb == "ack") slot.client->acknowledge();
        if (verb == "cut" || verb == "bye") slot.client->leave(verb == "bye");
        if (verb == "drive") drive(slot, withNames(rest));
        if (!slot.client->sessionId().empty()) slot.session = slot.client->sessionId();
        if (!slot.client->token().empty()) slot.token = slot.client->token();
    }

    void drive(const Slot& slot, const std::string& text) {
        const auto message = parseClientMessage(text);
        const auto* change = message ? std::get_if<messages::ViewChange>(&*message) : nullptr;
        const auto session = sessions_.find(slot.session);
        if (change != nullptr && session)
            session->changeView(*change, [](const tl::expected<SharedView, Problem>&) {});
    }

    void askForPicture(Slot& slot, std::string_view rest) {
        PictureOrder order;
        order.cloud = *own_.cloud("");
        order.client = fmt::format("client {}", &slot - slots_.data());
        order.view.width = takeNumber(rest, 1, 1024);
        order.view.height = takeNumber(rest, 1, 1024);
        order.view.quality.samples = takeNumber(rest, 1, 64);
        order.view.camera.eye.x = 1e9 + double(++pictures_);
        const auto mine = std::make_shared<Turns::SnapshotId>(0);
        *mine = server_.snapshot(std::move(order), [&slot, mine](const Expected<EncodedPicture>&) {
            if (slot.snapshot == *mine) slot.snapshot = 0;
        });
        slot.snapshot = *mine;
    }

    void giveUpPicture(Slot& slot) {
        const auto snapshot = std::exchange(slot.snapshot, 0);
        if (snapshot == 0) return;
        server_.abandonSnapshot(snapshot);
        time_.after(mostAfterwardsMs, [this, snapshot] {
            if (server_.worksOn(snapshot)) server_.violate("work goes on for a client that has gone");
        });
    }

    /// $session1, $resume1, $frame1.
    std::string withNames(std::string_view text) const {
        std::string out;
        while (!text.empty()) {
            const auto found =
                std::ranges::find_if(names_, [&](const auto& name) { return text.starts_with(name.first); });
            const std::size_t length = found == names_.end() ? 0 : found->first.size();
            const bool known = length > 0 && text.size() > length && text[length] >= '0' &&
                               text[length] < char('0' + slots_.size());
            if (known) out += found->second(slots_[std::size_t(text[length] - '0')]);
            if (!known) out += text.front();
            text.remove_prefix(known ? length + 1 : 1);
        }
        return out;
    }

    // All of them go; then the server must come to rest, and the polite viewer to see what it asked for.
    void end() {
        for (Slot& slot : slots_)
            if (slot.client) slot.client->leave(false);
        server_.calmDown();
        polite_.calmDown();
        run(patienceMs);
        if (!server_.idle()) server_.violate("two minutes after everything, something is still being made");
        if (!polite_.satisfied()) server_.violate(polite_.state());
        if (!sessions_.list().empty()) server_.violate("a session is left in the register");
        if (resumable_.size() > std::size_t(clients_))
            server_.violate("more sessions may be resumed than there were");
    }

    VirtualTime time_;
    Chance chance_{1};
    Metrics metrics_{"trace"};
    const SimulatedClouds own_;  ///< of the polite viewer and of pictures: nothing happens to it
    SimulatedClouds clouds_;
    SessionRegister sessions_;
    ResumeStore resumable_;
    std::array<Slot, 8> slots_;  // what the server has not answered by its end is answered then
    SimulatedServer server_;
    SimulatedViewer polite_;
    int clients_ = 0;
    std::uint64_t pictures_ = 0;
    double passed_ = 0;

    using Told = std::string (*)(const Slot&);
    static constexpr std::array<std::pair<std::string_view, Told>, 3> names_{{
        {"$session", [](const Slot& slot) { return slot.session; }},
        {"$resume", [](const Slot& slot) { return slot.token; }},
        {"$frame",
         [](const Slot& slot) { return std::to_string(slot.client ? slot.client->lastFrame() : 0); }},
    }};
};

}  // namespace

std::optional<std::string> playTrace(std::string_view trace) {
    const Machine machine = machineOf(trace);
    return std::make_unique<Player>(machine)->play(trace);
}

}  // namespace scancast::simulation
