"""The WebSocket of client/python: RFC 6455 as a server may use it, and servers that do not keep to it."""
import random
import socket
import struct
import threading
import time
import unittest
import unittest.mock

import support

from scancast import _http, _rfc6455, errors, websocket
from scancast._rfc6455 import BINARY, CLOSE, CONTINUATION, PING, PONG, TEXT, FrameReader, Message, WebSocketError

LIMIT = 1 << 16


def server_frame(opcode, data, final=True, rsv=0, length=None, mask=False):
    """As a server writes it; `length` 2 or 8 bytes where another one is wanted than the shortest."""
    size = len(data)
    head = bytes([(0x80 if final else 0) | rsv << 4 | opcode])
    if length == 2 or (length is None and 126 <= size < 1 << 16):
        head += bytes([(0x80 if mask else 0) | 126]) + struct.pack(">H", size)
    elif length == 8 or size >= 1 << 16:
        head += bytes([(0x80 if mask else 0) | 127]) + struct.pack(">Q", size)
    else:
        head += bytes([(0x80 if mask else 0) | size])
    return head + (bytes(4) if mask else b"") + data


def close(code, reason=b""):
    return server_frame(CLOSE, struct.pack(">H", code) + reason)


def read_all(data, sizes=None):
    """The messages of `data`, fed in pieces."""
    reader, found, at = FrameReader(LIMIT), [], 0
    while at < len(data):
        size = sizes(len(data) - at) if sizes else len(data)
        found += reader.feed(data[at:at + size])
        at += size
    return found


class Reading(unittest.TestCase):
    SOUND = [
        (server_frame(TEXT, b"{}"), [Message(TEXT, "{}")]),
        (server_frame(BINARY, bytes(range(256)) * 3), [Message(BINARY, bytes(range(256)) * 3)]),
        (server_frame(BINARY, b"x" * LIMIT), [Message(BINARY, b"x" * LIMIT)]),
        (server_frame(TEXT, b""), [Message(TEXT, "")]),
        (server_frame(TEXT, "é".encode()[:1], final=False) + server_frame(CONTINUATION, "é".encode()[1:]), [Message(TEXT, "é")]),
        (server_frame(BINARY, b"a", final=False) + server_frame(PING, b"p") + server_frame(CONTINUATION, b"", final=False)
         + server_frame(CONTINUATION, b"b"), [Message(PING, b"p"), Message(BINARY, b"ab")]),
        (server_frame(PONG, b"x" * 125), [Message(PONG, b"x" * 125)]),
        (server_frame(CLOSE, b""), [Message(CLOSE, (1005, ""))]),
        (server_frame(TEXT, b"a") + close(1001, "schön".encode()) + server_frame(TEXT, b"after"), [Message(TEXT, "a"), Message(CLOSE, (1001, "schön"))]),
    ]
    BROKEN = [
        (1002, server_frame(TEXT, b"a", rsv=4), "an extension"), (1002, server_frame(3, b""), "an unknown opcode"),
        (1002, server_frame(11, b""), "an unknown control"), (1002, server_frame(TEXT, b"a", mask=True), "a mask"),
        (1002, server_frame(PING, b"a", final=False), "a ping in pieces"), (1002, server_frame(PING, b"a" * 126), "a long ping"),
        (1002, server_frame(CONTINUATION, b"a"), "what goes on without a beginning"),
        (1002, server_frame(TEXT, b"a", final=False) + server_frame(TEXT, b"b"), "a message within a message"),
        (1002, server_frame(TEXT, b"a", length=2), "a length longer than it is"), (1002, server_frame(TEXT, b"a" * 200, length=8), "the same with 8 bytes"),
        (1002, b"\x82\x7f\xff\xff\xff\xff\xff\xff\xff\xff", "a length of 2^64"), (1009, b"\x82\x7f\x7f\xff\xff\xff\xff\xff\xff\xff", "of 2^63"),
        (1009, server_frame(BINARY, b"x" * (LIMIT + 1)), "one byte too much"),
        (1009, server_frame(BINARY, b"x" * LIMIT, final=False) + server_frame(CONTINUATION, b"y"), "one too much in pieces"),
        (1007, server_frame(TEXT, b"\xff"), "no UTF-8"), (1007, server_frame(TEXT, b"\xed\xa0\x80"), "half a surrogate"),
        (1007, server_frame(TEXT, b"a\xc3", final=False) + server_frame(CONTINUATION, b"("), "no UTF-8 in pieces"),
        (1002, server_frame(CLOSE, b"\x03"), "half a code"), (1002, close(999), "a code below 1000"), (1002, close(1005), "a code that is never sent"),
        (1002, close(5000), "a code above 4999"), (1007, close(1000, b"\xff"), "a reason that is no UTF-8"),
    ]

    def test_messages_are_what_was_sent_however_it_is_cut(self):
        for data, expected in self.SOUND:
            self.assertEqual(read_all(data), expected)
            pieces = (lambda left: 1) if len(data) < 2000 else (lambda left: 777)
            self.assertEqual(read_all(data, pieces), expected)

    def test_what_breaks_the_protocol_is_refused_with_its_code(self):
        for code, data, what in self.BROKEN:
            for sizes in (None, lambda left: 1 if left < 300 else 997):
                with self.assertRaises(WebSocketError, msg=what) as caught:
                    read_all(data, sizes)
                self.assertEqual(caught.exception.code, code, what)

    def test_what_came_before_is_not_lost(self):
        with self.assertRaises(WebSocketError) as caught:
            read_all(server_frame(TEXT, b"sound") + server_frame(3, b""))
        self.assertEqual(caught.exception.before, [Message(TEXT, "sound")])

    def test_nothing_is_kept_of_what_is_too_long(self):
        reader = FrameReader(LIMIT)
        with self.assertRaises(WebSocketError):
            reader.feed(b"\x82\x7f" + struct.pack(">Q", 1 << 40))
        with self.assertRaises(WebSocketError):
            reader.feed(b"more")
        self.assertLess(len(reader._buffer), 64)

    def test_text_has_a_bound_of_its_own(self):
        for data, fits in ((server_frame(TEXT, b"x" * 100), True), (server_frame(TEXT, b"x" * 101), False), (server_frame(BINARY, b"x" * 101), True),
                           (server_frame(TEXT, b"x" * 60, final=False) + server_frame(CONTINUATION, b"x" * 41), False)):
            reader = FrameReader(LIMIT, 100)
            if fits:
                self.assertEqual(len(reader.feed(data)), 1)
            else:
                self.assertRaises(WebSocketError, reader.feed, data)

    def test_any_bytes_make_messages_or_an_error_and_the_same_in_pieces(self):
        generator = random.Random(20)
        sound = [data[:3000] for data, _ in self.SOUND] + [data[:3000] for _, data, _ in self.BROKEN]
        for data in support.mutations(sound, generator, 3000):
            outcomes = []
            for sizes in (None, lambda left: generator.randint(1, 40)):
                reader, found, at, code = FrameReader(LIMIT), [], 0, 0
                try:
                    while at < len(data):
                        size = sizes(len(data) - at) if sizes else len(data)
                        found += reader.feed(data[at:at + size])
                        at += size
                except WebSocketError as error:
                    found, code = found + error.before, error.code
                outcomes.append((found, code))
            self.assertEqual(*outcomes, data)


class Writing(unittest.TestCase):
    def test_frames_are_masked_and_as_long_as_they_say(self):
        for size in (0, 1, 125, 126, 65535, 65536):
            data = random.Random(size).randbytes(size)
            made = _rfc6455.frame(BINARY, data, b"\x01\x02\x03\x04")
            self.assertEqual(made[0], 0x82)
            self.assertTrue(made[1] & 0x80)
            head = {126: 4, 127: 10}.get(made[1] & 0x7F, 2)
            self.assertEqual(made[head:head + 4], b"\x01\x02\x03\x04")
            self.assertEqual(bytes(value ^ (i % 4 + 1) for i, value in enumerate(made[head + 4:])), data)

    def test_a_token_as_a_subprotocol_is_what_pages_offer(self):
        self.assertEqual(_rfc6455.token_subprotocol("a>b?c"), "base64url.bearer.authorization.YT5iP2M")


def upgrade(connection, accept=None, protocol="scancast.v1", more=""):
    head = support.request_head(connection).decode()
    key = next(line.split(": ")[1] for line in head.split("\r\n") if line.startswith("Sec-WebSocket-Key"))
    connection.sendall((f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                        f"Sec-WebSocket-Accept: {accept or _rfc6455.accept_key(key)}\r\nSec-WebSocket-Protocol: {protocol}\r\n{more}\r\n").encode())
    return head


def connect(url, timeout=5.0, **options):
    address, _ = _http.parse_url(url)
    return websocket.WebSocket.connect(address, "/x", subprotocol="scancast.v1", token=None, context=None, timeout=timeout, limit=LIMIT, **options)


class Connecting(unittest.TestCase):
    def refused(self, answer, kind, timeout=5.0):
        with support.lying(answer) as url:
            with self.assertRaises(kind) as caught:
                connect(url, timeout)
            return caught.exception

    def test_what_is_no_websocket_of_ours_is_refused(self):
        self.refused(lambda c: upgrade(c, accept="x" * 28), errors.BadAnswer)
        self.refused(lambda c: upgrade(c, protocol="other"), errors.BadAnswer)
        self.refused(lambda c: upgrade(c, more="Sec-WebSocket-Extensions: permessage-deflate\r\n"), errors.BadAnswer)
        for text in (b"SSH-2.0-x\r\n\r\n", b"HTTP/1.1 101\r\n\r\n", b"HTTP/1.1 1x1 no\r\n\r\n", b"HTTP/1.1 101 a\r\nno colon\r\n\r\n", b"\r\n\r\n", b""):
            self.refused(lambda c, text=text: (support.request_head(c), c.sendall(text)), errors.BadAnswer)
        endless = self.refused(lambda c: (support.request_head(c), [c.sendall(b"a" * 4096) for _ in range(1000)]), errors.ScancastError)
        self.assertIsInstance(endless, errors.BadAnswer)

    def test_who_says_nothing_is_not_waited_for(self):
        hang = threading.Event()
        start = time.monotonic()
        error = self.refused(lambda c: hang.wait(0.6), errors.TimedOut, timeout=0.2)
        self.assertIn("in time", str(error))
        self.assertLess(time.monotonic() - start, 30)

    def test_a_refusal_is_the_problem_that_it_says(self):
        body = b'{"type": "urn:scancast:problem:unavailable", "status": 503, "detail": "It leaves."}'
        error = self.refused(lambda c: (support.request_head(c), c.sendall(
            b"HTTP/1.1 503 x\r\nContent-Type: application/problem+json\r\nRetry-After: 3\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body))),
            errors.Unavailable)
        self.assertEqual((str(error), error.retry_after), ("It leaves.", 3.0))
        lie = self.refused(lambda c: (support.request_head(c), c.sendall(b"HTTP/1.1 404 x\r\nContent-Length: 99999999999999\r\n\r\nno")), errors.NotFound)
        self.assertIn("is it a Scancast server?", str(lie))

    def test_a_refusal_that_comes_byte_by_byte_is_not_waited_for(self):
        finished = []

        def serve(connection):
            support.request_head(connection)
            connection.sendall(b"HTTP/1.1 404 x\r\nContent-Length: 1000\r\n\r\n")
            for _ in range(1000):
                connection.sendall(b"x")
                time.sleep(0.02)
            finished.append(True)

        with unittest.mock.patch.object(websocket, "_REFUSAL_SECONDS", 0.1):
            self.refused(serve, errors.NotFound, timeout=support.PATIENCE)
        self.assertEqual(finished, [])

    def test_pings_without_end_do_not_prolong_a_wait(self):
        reads = []

        def read(until):
            reads.append(until)
            self.assertLess(len(reads), 1000, "it goes on and on")
            time.sleep(0.01)
            return server_frame(PING, b"still there")

        with support.lying(lambda connection: (upgrade(connection), connection.recv(1))) as url:
            socket_ = connect(url)
            with unittest.mock.patch.object(socket_, "_read", read), unittest.mock.patch.object(socket_, "_send") as send:
                self.assertIsNone(socket_.receive(0.1))
            self.assertEqual(send.call_count, len(reads), "each is answered")
            socket_.drop()

    def test_pings_are_answered_and_closes_too(self):
        heard = {}

        def serve(connection):
            upgrade(connection)
            connection.sendall(server_frame(PING, b"are you there") + server_frame(TEXT, b"hello") + close(1001, b"bye"))
            data = b""
            while True:
                part = connection.recv(4096)
                if not part:
                    break
                data += part
            heard["frames"] = client_frames(data)

        with support.lying(serve) as url:
            socket_ = connect(url)
            self.assertEqual(socket_.receive(5), Message(TEXT, "hello"))
            self.assertEqual(socket_.receive(5), Message(CLOSE, (1001, "bye")))
            with self.assertRaises(errors.ConnectionFailed):
                socket_.receive(5)
            socket_.drop()
        self.assertEqual(heard["frames"], [(PONG, b"are you there"), (CLOSE, struct.pack(">H", 1001))])

    def test_who_breaks_the_protocol_is_told_by_which_code(self):
        heard = {}

        def serve(connection):
            upgrade(connection)
            connection.sendall(server_frame(TEXT, b"first") + server_frame(TEXT, b"\xff"))
            heard["frames"] = client_frames(connection.recv(4096))

        with support.lying(serve) as url:
            socket_ = connect(url)
            self.assertEqual(socket_.receive(5), Message(TEXT, "first"))
            with self.assertRaises(WebSocketError):
                socket_.receive(5)
            time.sleep(0.05)
            socket_.drop()
        self.assertEqual(heard["frames"][0][1][:2], struct.pack(">H", 1007))

    def test_many_threads_may_send_and_each_message_stays_whole(self):
        total, heard = 8 * 50, []

        def serve(connection):
            upgrade(connection)
            data = b""
            while len(heard) < total:
                part = connection.recv(1 << 16)
                if not part:
                    return
                data += part
                found = client_frames(data, rest=True)
                heard.extend(found[0])
                data = found[1]

        with support.lying(serve) as url:
            socket_ = connect(url)
            texts = [[f"{who} " + "x" * (97 * i % 5000) for i in range(50)] for who in range(8)]
            threads = [threading.Thread(target=lambda mine=mine: [socket_.send_text(text) for text in mine]) for mine in texts]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            end = time.monotonic() + support.PATIENCE
            while len(heard) < total and time.monotonic() < end:
                time.sleep(0.01)
            socket_.drop()
        self.assertEqual(sorted(data.decode() for _, data in heard), sorted(text for mine in texts for text in mine))

    def test_who_does_not_read_does_not_block_for_ever(self):
        hang = threading.Event()
        with support.lying(lambda c: (c.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096), upgrade(c), hang.wait(10))) as url:
            socket_ = connect(url, timeout=0.3)
            with self.assertRaises(errors.TimedOut):
                for _ in range(1000):
                    socket_.send_text("x" * 65536)
            socket_.drop()
            hang.set()


def client_frames(data, rest=False):
    """What a client sent: (opcode, payload), unmasked."""
    found, at = [], 0
    while at + 2 <= len(data):
        size, head = data[at + 1] & 0x7F, 2
        if size == 126 and at + 4 <= len(data):
            size, head = struct.unpack_from(">H", data, at + 2)[0], 4
        elif size == 127 and at + 10 <= len(data):
            size, head = struct.unpack_from(">Q", data, at + 2)[0], 10
        elif size > 125:
            break
        if at + head + 4 + size > len(data):
            break
        assert data[at + 1] & 0x80, "a client's frame without a mask"
        mask = data[at + head:at + head + 4]
        found.append((data[at] & 15, _rfc6455.masked(data[at + head + 4:at + head + 4 + size], mask)))
        at += head + 4 + size
    return (found, data[at:]) if rest else found


if __name__ == "__main__":
    unittest.main()
