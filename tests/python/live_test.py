"""Live views against servers that lie, leave, and come back: each ends in a sentence or goes on, and none waits for ever."""
import contextlib
import json
import socket
import struct
import threading
import time
import unittest
import unittest.mock

import support
from frames_test import frame
from websocket_test import BINARY, CLOSE, TEXT, client_frames, close, server_frame, upgrade

import scancast
from scancast import live
from scancast._http import Transport
from scancast._rfc6455 import Message
from scancast.websocket import WebSocket


def text(message):
    return server_frame(TEXT, json.dumps(message).encode())


WELCOME = {"type": "welcome", "session": "s1", "resume": "r1", "resumed": False, "cloud": "town", "view": {"camera": {"eye": [0, 0, 9]}, "width": 64}, "seq": 0}


class Session:
    """One connection of a server that plays a part: what the client says is in `said`, as it comes."""

    def __init__(self, connection):
        self.connection = connection
        self.data = b""
        self.said = []

    def hear(self):
        """The next thing that the client says: a message, or the code of its close."""
        while True:
            found, self.data = client_frames(self.data, rest=True)
            self.said += found
            if self.said:
                kind, data = self.said.pop(0)
                if kind == CLOSE:
                    return struct.unpack_from(">H", data)[0]
                if kind == TEXT:
                    return json.loads(data)
                continue
            part = self.connection.recv(65536)
            if not part:
                return None
            self.data += part

    def until(self, kind):
        while True:
            message = self.hear()
            if not isinstance(message, dict) or message["type"] == kind:
                return message

    def send(self, *frames):
        self.connection.sendall(b"".join(frames))


@contextlib.contextmanager
def playing(*parts):
    """A server whose connections play these parts one after the other; the last one again and again."""
    left = list(parts)

    def answer(connection):
        upgrade(connection)
        (left.pop(0) if len(left) > 1 else left[0])(Session(connection))

    with support.lying(answer) as url:
        yield Transport(url, None, support.PATIENCE, None, 0.0)


def opened(transport, **options):
    return live.LiveView(transport, "town", {"width": 64, "height": 48}, **options)


def shows(number, seq, flags=6):
    return server_frame(BINARY, frame(number=number, seq=seq, flags=flags))


class Beginning(unittest.TestCase):
    def refused(self, kind, *frames):
        def part(session):
            session.hear()
            session.send(*frames)
            session.hear()
        with playing(part) as transport, self.assertRaises(kind) as caught:
            opened(transport)
        return caught.exception

    def test_what_is_no_welcome_is_none(self):
        self.refused(scancast.BadAnswer, server_frame(TEXT, b"no JSON"))
        self.refused(scancast.BadAnswer, server_frame(TEXT, b"[]"))
        self.refused(scancast.BadAnswer, server_frame(TEXT, b"[" * 100_000))
        self.refused(scancast.BadAnswer, shows(1, 0))
        self.refused(scancast.BadAnswer, server_frame(TEXT, b"\xff"))
        self.assertIn("later", str(self.refused(scancast.ConnectionFailed, close(1013, b"later"))))
        refusal = self.refused(scancast.NotFound, text({"type": "problem", "problem": {"status": 404, "detail": "There is no town."}}))
        self.assertEqual(str(refusal), "There is no town.")

    def test_strange_welcomes_do_no_harm(self):
        def part(session):
            session.hear()
            session.send(text({"type": "welcome", "view": 5, "seq": "x", "resume": []}), text({"type": "newer"}), shows(1, 0))
            session.until("never")
        with playing(part) as transport, opened(transport) as view:
            self.assertEqual(view.still().id, 1)

    def test_messages_without_end_do_not_prolong_the_wait_for_a_welcome(self):
        received = []

        def receive(socket_, wait=None):
            received.append(wait)
            self.assertLess(len(received), 1000, "it goes on and on")
            time.sleep(0.01)
            return Message(TEXT, '{"type": "newer"}')

        with support.lying(lambda connection: (upgrade(connection), Session(connection).until("never"))) as url:
            with unittest.mock.patch.object(WebSocket, "receive", receive), self.assertRaises(scancast.TimedOut):
                opened(Transport(url, None, 0.3, None, 0.0))

    def test_hello_says_what_is_wanted(self):
        heard = []

        def part(session):
            heard.append(session.hear())
            session.send(text(WELCOME))
            session.until("never")
        with playing(part) as transport:
            live.LiveView(transport, "town", {"width": 64, "height": 48, "camera": {"fov": 50}}, depth=True, fps=12).close()
        self.assertEqual(heard, [{"type": "hello", "cloud": "town", "width": 64, "height": 48, "depth": True, "fps": 12, "view": {"camera": {"fov": 50}}}])


class GoingOn(unittest.TestCase):
    def test_each_frame_is_acknowledged_and_only_the_newest_is_given(self):
        acknowledged = []

        def part(session):
            session.hear()
            session.send(text(WELCOME), *[shows(i, 0, flags=1) for i in (1, 2, 3)], shows(4, 0))
            for _ in range(4):
                acknowledged.append(session.until("ack")["frame"])
            session.until("never")
        with playing(part) as transport, opened(transport) as view:
            support.wait_until(lambda: len(acknowledged) == 4 and view._newest == 4, "frames are not acknowledged")
            self.assertEqual(view.frame().id, 4)
            self.assertEqual(view.skipped, 3)
            with self.assertRaises(scancast.TimedOut):
                view.frame(timeout=0.05)
        self.assertEqual(acknowledged, [1, 2, 3, 4])

    def test_frames_that_are_none_end_it(self):
        for wrong in (server_frame(BINARY, b"nonsense"), server_frame(3, b""), server_frame(TEXT, b"{")):
            def part(session, wrong=wrong):
                session.hear()
                session.send(text(WELCOME), wrong)
                session.until("never")
            with playing(part) as transport, opened(transport) as view:
                with self.assertRaises(scancast.BadAnswer):
                    view.frame()
                with self.assertRaises(scancast.BadAnswer):
                    view.view(fov=3)

    def test_a_refused_view_is_raised_once_and_the_view_goes_on(self):
        def part(session):
            session.hear()
            session.send(text(WELCOME))
            seq = session.until("view")["seq"]
            session.send(text({"type": "problem", "seq": seq, "problem": {"status": 422, "detail": "fov is wrong"}}))
            session.send(shows(1, session.until("view")["seq"]))
            session.until("never")
        with playing(part) as transport, opened(transport) as view:
            with self.assertRaisesRegex(scancast.Impossible, "fov is wrong"):
                view.still(fov=-1)
            self.assertEqual(view.still(fov=50).id, 1)
            self.assertEqual(view._wanted.view["camera"]["fov"], 50)

    def test_picks_are_answered_by_their_numbers(self):
        def part(session):
            session.hear()
            session.send(text(WELCOME))
            first, second = sorted((session.until("pick"), session.until("pick")), key=lambda pick: pick["x"])  # two threads say them
            point = {"position": [1, 2, 3], "precision": [0, 0, 0], "depth": 1, "distance": 0}
            session.send(text({"type": "picked", "seq": second["seq"], "point": None}), text({"type": "picked", "seq": 999, "point": None}),
                         text({"type": "picked", "seq": first["seq"], "point": point}))
            session.until("never")
        with playing(part) as transport, opened(transport) as view:
            found = {}
            threads = []
            for x in (1, 2):
                threads.append(threading.Thread(target=lambda x=x: found.__setitem__(x, view.pick(x, 0))))
                threads[-1].start()
                support.wait_until(lambda: len(view._picks) == len(threads), "nothing is asked")
            for thread in threads:
                thread.join(support.PATIENCE)
            self.assertEqual((found[1].position, found[2]), ((1.0, 2.0, 3.0), None))
            self.assertEqual(view._picks, {})

    def test_it_comes_back_with_what_was_wanted(self):
        heard = []

        def first(session):
            session.hear()
            session.send(text(WELCOME), shows(1, 0))
            session.until("view")
            session.connection.shutdown(socket.SHUT_RDWR)

        def second(session):
            hello = session.hear()
            heard.append(hello)
            session.send(text({**WELCOME, "resumed": True, "resume": "r2", "view": hello["view"], "seq": hello["seq"]}), shows(hello["frame"] + 1, hello["seq"]))
            session.until("never")

        with playing(first, second) as transport, opened(transport) as view:
            view.still()
            self.assertEqual(view.still(fov=33).id, 2)
            self.assertEqual(view._resume, "r2")
        self.assertEqual({name: heard[0][name] for name in ("resume", "seq", "frame", "cloud", "width")},
                         {"resume": "r1", "seq": 1, "frame": 1, "cloud": "town", "width": 64})
        self.assertEqual(heard[0]["view"]["camera"], {"eye": [0, 0, 9], "fov": 33})

    def test_a_server_that_remembers_nothing_begins_again(self):
        taken = threading.Event()

        def first(session):
            session.hear()
            session.send(text(WELCOME), shows(1, 0))
            session.until("ack")
            taken.wait(support.PATIENCE)
            session.connection.shutdown(socket.SHUT_RDWR)

        def second(session):
            hello = session.hear()
            session.send(text({**WELCOME, "session": "s2", "view": hello["view"], "seq": hello["seq"]}), shows(1, hello["seq"]))
            session.until("never")

        with playing(first, second) as transport, opened(transport) as view:
            self.assertEqual(view.frame().id, 1)
            taken.set()
            self.assertEqual(view.frame().id, 1, "the first one of another session")
            self.assertEqual(view.session, "s2")

    def test_a_server_that_remembers_less_is_told_again(self):
        heard = []

        def first(session):
            session.hear()
            session.send(text(WELCOME))
            session.until("view")
            session.connection.shutdown(socket.SHUT_RDWR)

        def second(session):
            session.hear()
            session.send(text({**WELCOME, "resumed": True}))
            heard.append(session.until("view"))
            session.send(shows(1, heard[0]["seq"]))
            session.until("never")

        with playing(first, second) as transport, opened(transport) as view:
            self.assertEqual(view.still(fov=33).seq, 1)
        self.assertEqual(heard[0]["camera"]["fov"], 33)

    def test_it_goes_where_a_server_that_leaves_sends_it(self):
        ends = []

        def first(session):
            session.hear()
            session.send(text(WELCOME), text({"type": "drain", "afterMilliseconds": 20, "withinMilliseconds": 5000}))
            while not isinstance(ends[-1] if ends else None, int):
                ends.append(session.hear())

        def second(session):
            session.hear()
            session.send(text({**WELCOME, "resumed": True}), shows(5, 0))
            session.until("never")

        listeners = []  # two servers at once: the second connection comes before the first one ends

        def answer(connection):
            copy = connection.dup()
            listeners.append(copy)
            part = (first, second)[min(1, len(listeners) - 1)]

            def play():
                with copy, contextlib.suppress(OSError):
                    upgrade(copy)
                    part(Session(copy))
            threading.Thread(target=play, daemon=True).start()

        with support.lying(answer) as url, opened(Transport(url, None, support.PATIENCE, None, 0.0)) as view:
            self.assertEqual(view.still().id, 5)
            support.wait_until(lambda: ends and ends[-1] == 1000, "the first connection is not ended politely")

    def test_a_server_that_leaves_at_no_time_stays(self):
        for never in (10**400, 10**300, 1e999, float("nan")):
            def part(session, never=never):
                session.hear()
                session.send(text(WELCOME), text({"type": "drain", "afterMilliseconds": never}), shows(1, 0))
                session.until("never")
            with playing(part) as transport, opened(transport) as view:
                self.assertEqual(view.still().id, 1)

    def test_it_does_not_come_back_where_that_makes_no_sense(self):
        def part(session):
            session.hear()
            session.send(text(WELCOME), close(1008, b"your time is over"))
            session.hear()
        with playing(part) as transport, opened(transport) as view:
            with self.assertRaisesRegex(scancast.ConnectionFailed, "your time is over"):
                view.still()

    def test_closing_is_polite_and_ends_who_waits(self):
        said = []

        def part(session):
            session.hear()
            session.send(text(WELCOME))
            said.append(session.hear())
        with playing(part) as transport:
            view = opened(transport)
            ended = []
            waiting = threading.Thread(target=lambda: ended.append(list(view)))
            waiting.start()
            view.close()
            view.close()
            waiting.join(support.PATIENCE)
        self.assertEqual((ended, said), ([[]], [1000]))
        self.assertFalse(view._thread.is_alive())


if __name__ == "__main__":
    unittest.main()
