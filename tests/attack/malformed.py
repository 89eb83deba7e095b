"""Requests that nobody sends by mistake, six hundred and more: what an HTTP server, a JSON parser, a view and a WebSocket may
be given. Each says how it may be answered. All are made by rules, so that a new word of the view is attacked like the old ones."""
import itertools
import json
import socket
import struct
import time

import polite

REFUSED = set(range(400, 500)) | {501, 505}
FINE = {200, 202, 204, 206, 304}
PATIENCE = 10  # seconds for one answer

WORDS = ("width height eye target up fov projection viewHeight near far viewMatrix method color colormap range classes clip "
         "shading exposure light.ambient light.headlight light.sun light.sunlight light.shine light.occlusion light.shadow mirrors behindMirrors outliers background detail budget samples "
         "quality subsampling param.sizePx fps session nonsense").split()
VALUES = ["", "NaN", "inf", "-1e999", "1e400", "999999999999999999999", "-5", "0", "%00", "%ff%fe%fd", "1,2", ",,,", "null", "true",
          "[]", "%7B%7D", "a" * 3000, "%25n%25n", "..%2f..%2fetc%2fpasswd"]


class Case:
    """`send` is what goes over the wire; `allowed` statuses, where a connection that is closed instead is right, too."""

    def __init__(self, family, name, send, allowed=REFUSED, closes=True):
        self.family, self.name, self.send, self.allowed, self.closes = family, name, send, allowed, closes


def request(line, *headers, body=b"", host="127.0.0.1"):
    head = [line] + ([f"Host: {host}"] if host is not None else []) + list(headers)
    return "\r\n".join(head).encode("latin-1") + b"\r\n\r\n" + body


def posted(path, body, *headers):
    return request(f"POST {path} HTTP/1.1", "Content-Type: application/json", f"Content-Length: {len(body)}", *headers, body=body)


def views(cloud):
    snapshot = f"/api/v1/clouds/{cloud}/snapshot.jpg"
    for word, value in itertools.product(WORDS, VALUES):
        small = "" if word in ("width", "height") else "width=16&height=16&"
        yield Case("view words", f"{word}={value[:30]}", request(f"GET {snapshot}?{small}{word}={value} HTTP/1.1"), REFUSED | FINE)
    for query in ("?", "&&&", "==", "width", "width=1&width=2", "%", "%zz=1", "eye=1,2,3&target=1,2,3", "near=5&far=1",
                  "up=0,0,1&eye=0,0,9&target=0,0,0", "=" * 2000, "&".join(f"w{i}=1" for i in range(900))):
        yield Case("view words", query[:30], request(f"GET {snapshot}?{query} HTTP/1.1"), REFUSED | FINE)


def lines():
    for line in ("GET", "GET /", "GET / HTTP/0.9", "GET / HTTP/1.2", "GET / HTTP/2.0", "GET / HTTP/9.9", "GET / HTTP/1.1 extra", "GET  /  HTTP/1.1", "get / HTTP/1.1",
                 "\x00GET / HTTP/1.1", "GET /\x00 HTTP/1.1", "GET /\t HTTP/1.1", "GET http://evil/ HTTP/1.1", "GET //evil/ HTTP/1.1", "GET * HTTP/1.1",
                 "OPTIONS * HTTP/1.1", "CONNECT evil:443 HTTP/1.1", "TRACE / HTTP/1.1", "PRI * HTTP/2.0", "DELETE / HTTP/1.1", "PUT /healthz HTTP/1.1",
                 "PATCH /api/v1/clouds HTTP/1.1", "PROPFIND / HTTP/1.1", "A" * 5000 + " / HTTP/1.1", "GET /" + "a" * 20000 + " HTTP/1.1",
                 "GET /?" + "a=b&" * 5000 + " HTTP/1.1", " GET / HTTP/1.1", "HTTP/1.1 200 OK", "\x16\x03\x01\x02\x00\x01\x00", "SSH-2.0-x", "EHLO x"):
        yield Case("request lines", repr(line[:30]), request(line), REFUSED | FINE)


def headers():
    for name, header in {
            "no host": None, "two hosts": ("Host: 127.0.0.1",), "evil host": "evil.example", "host with port": "127.0.0.1:99999", "host with path": "127.0.0.1/x",
            "empty host": "", "host of zeros": "\x00", "host too long": "a" * 9000}.items():
        if header is None or isinstance(header, str):
            yield Case("headers", name, request("GET /api/v1/clouds HTTP/1.1", host=header), REFUSED | FINE)
        else:
            yield Case("headers", name, request("GET /api/v1/clouds HTTP/1.1", *header))
    for header in ("Origin: null", "Origin: http://evil.example", "Origin: http://127.0.0.1@evil", "Origin: \x01", "Sec-Fetch-Site: cross-site", "Cookie: " + "a" * 12000,
                   "X: " + "a" * 20000, "No colon here", ": no name", "Na me: x", "Name : x", "\tfolded", "X: \x00", "X: \x7f", "If-None-Match: " + '"a",' * 3000,
                   "Accept: " + "a/b," * 3000, "Accept: ;;;q=nan", "Accept: */*;q=1e999", "Authorization: Bearer", "Authorization: Bearer " + "a" * 9000, "Authorization: Basic YTpi",
                   "Authorization: Bearer \xff\xfe", "Range: bytes=0-999999999999", "Expect: 999-nothing", "Connection: close, keep-alive, upgrade", "Upgrade: h2c",
                   "TE: trailers", "Max-Forwards: -1", "Accept-Encoding: " + "gzip," * 1000):
        yield Case("headers", header[:30], request("GET /api/v1/clouds HTTP/1.1", header), REFUSED | FINE)
    yield Case("headers", "a thousand", request("GET /api/v1/clouds HTTP/1.1", *(f"X{i}: y" for i in range(1000))), REFUSED | FINE)


def framing(cloud):
    path = f"/api/v1/clouds/{cloud}/snapshot"
    json_type = "Content-Type: application/json"
    for name, more, body in (
            ("two lengths", ("Content-Length: 2", "Content-Length: 3"), b"{}"), ("length and chunks", ("Content-Length: 2", "Transfer-Encoding: chunked"), b"0\r\n\r\n"),
            ("negative length", ("Content-Length: -1",), b""), ("length of letters", ("Content-Length: two",), b"{}"), ("plus sign", ("Content-Length: +2",), b"{}"),
            ("hex length", ("Content-Length: 0x2",), b"{}"), ("huge length", ("Content-Length: 99999999999999999999",), b""), ("large length", ("Content-Length: 999999999",), b"{}"),
            ("twice chunked", ("Transfer-Encoding: chunked, chunked",), b"0\r\n\r\n"), ("gzip chunked", ("Transfer-Encoding: gzip, chunked",), b"0\r\n\r\n"),
            ("identity", ("Transfer-Encoding: identity",), b""), ("xchunked", ("Transfer-Encoding: xchunked",), b""), ("space before colon", ("Transfer-Encoding : chunked",), b"0\r\n\r\n"),
            ("chunk size of letters", ("Transfer-Encoding: chunked",), b"zz\r\n\r\n"), ("huge chunk", ("Transfer-Encoding: chunked",), b"ffffffffffffffff\r\n"),
            ("negative chunk", ("Transfer-Encoding: chunked",), b"-1\r\n"), ("long chunk extension", ("Transfer-Encoding: chunked",), b"2;" + b"a" * 30000 + b"\r\n{}\r\n0\r\n\r\n"),
            ("wrong type", ("Content-Type: text/plain", "Content-Length: 2"), b"{}"), ("no type", ("Content-Length: 2",), b"{}")):
        kind = () if name in ("wrong type", "no type") else (json_type,)
        yield Case("framing", name, request(f"POST {path} HTTP/1.1", *kind, *more, body=body), REFUSED | FINE)
    for size in (65 * 1024, 1024 * 1024):
        yield Case("framing", f"a body of {size}", posted(path, b"{" + b" " * size + b"}"))


def paths(cloud):
    for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd", "/%252e%252e/", "/./", "//", "/a//b", "/index.html%00.js", "/main.js/", "/MAIN.JS", "/%", "/%zz",
                 "/%00", "/\\..\\", "/api", "/api/", "/api/v1", "/api/v2/clouds", "/api/v1/clouds/", "/api/v1/clouds/nothing", "/api/v1/clouds/%00", "/api/v1/clouds/" + "a" * 4000,
                 "/api/v1/clouds/..", "/api/v1/clouds/%2e%2e/snapshot.jpg", f"/api/v1/clouds/{cloud}/", f"/api/v1/clouds/{cloud}/snapshot.gif", f"/api/v1/clouds/{cloud}/snapshot.jpg/x",
                 f"/api/v1/clouds/{cloud}/snapshot.jpg%00", f"/api/v1/clouds/{cloud}%2fsnapshot.jpg", "/api/v1/sessions/nobody/view", "/api/v1/sessions/%2f/view", "/.git/config", "/.env", "/server-status",
                 "/wp-login.php", "/cgi-bin/sh", "/metrics/", "/healthz/x", "/openapi.yaml", "/favicon.ico/../main.js", "/?", "/#", "/;x=1"):
        yield Case("paths", path[:30], request(f"GET {path} HTTP/1.1"), REFUSED | FINE)


def bodies(cloud):
    snapshot, pick, measure = (f"/api/v1/clouds/{cloud}/{route}" for route in ("snapshot", "pick", "measure"))
    odd = [b"", b"{", b"}", b"[]", b"null", b"0", b'"x"', b"{}{}", b'{"a":}', b"{'a': 1}", b'{"width": 1e999}', b'{"width": NaN}', b'{"width": "16"}', b'{"width": -1}', b'{"width": 1.5}',
           b'{"width": 16, "width": 17}', b'{"camera": 1}', b'{"camera": {"eye": [1, 2]}}', b'{"camera": {"eye": [1, 2, "3"]}}', b'{"camera": {"eye": [1e308, 1e308, 1e308]}}',
           b'{"camera": {"fov": 0}}', b'{"camera": {"fov": 180}}', b'{"camera": {"viewMatrix": [0]}}', b'{"camera": {"viewMatrix": [0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]}}', b'{"param": {"sizePx": []}}', b'{"method": {}}',
           b'{"method": "\\u0000"}', b'{"\\ud800": 1}', b"\xff\xfe{}", b"\xef\xbb\xbf{}", b'{"classes": [999]}', b'{"clip": {"min": [1,1,1], "max": [0,0,0]}}', b'{"range": [1]}', b'{"__proto__": {}}',
           b"[" * 5000, b'{"a":' * 3000 + b"1" + b"}" * 3000, b'{"camera": ' * 500 + b"1" + b"}" * 500, b'{"x": "' + b"a" * 60000 + b'"}', b"{" + b",".join(b'"k%d": 1' % i for i in range(4000)) + b"}"]
    for body in odd:
        yield Case("bodies", f"snapshot {body[:24]!r}", posted(snapshot, body), REFUSED | FINE)
        yield Case("bodies", f"pick {body[:24]!r}", posted(pick, body), REFUSED | FINE)
        yield Case("bodies", f"measure {body[:24]!r}", posted(measure, body), REFUSED | FINE)
    for point in ('{"x": -1, "y": 0}', '{"x": 1e9, "y": 0}', '{"x": "a", "y": 0}', '{"x": 0}', '{"x": null, "y": 0}', '{"x": 0, "y": 0, "view": 7}', '{"x": 0, "y": 0, "view": {"width": 99999}}'):
        yield Case("bodies", f"pick {point}", posted(pick, point.encode()), REFUSED | FINE)
    corner = "[0, 0, 0], [1e12, 0, 0], [1e12, 1e12, 0]"
    for what in ('"volume"', f'"volume", "points": [{corner}]', f'"volume", "points": [{corner}], "cell": 1e-12', f'"volume", "points": [{corner}], "cell": 1e11, "base": -1e12',
                 '"cylinder", "points": [[0, 0, 0]], "within": 1e12', '"circle", "points": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]', '"sphere", "points": [[0, 0, 0]], "within": 1e-12',
                 '"area", "points": [' + ", ".join("[%d, %d, 0]" % (i % 7, i % 5) for i in range(1000)) + "]", '"distance", "points": [[1e999, 0, 0], [0, 0, 0]]'):
        yield Case("bodies", f"measure {what[:40]}", posted(measure, ('{"measure": ' + what + "}").encode()), REFUSED | FINE)
    for path in ("/api/v1/clouds", "/api/v1/sessions/nobody/view"):
        for body in (b"{}", b'{"path": "../../etc/passwd"}', b'{"path": "http://evil/"}', b'{"path": "/dev/zero"}', b"[]"):
            yield Case("bodies", f"{path} {body[:24]!r}", posted(path, body))


def upgrades():
    right = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
             "Sec-WebSocket-Protocol": "scancast.v1"}
    for header, value in itertools.product(right, (None, "", "nonsense", "a" * 5000, "\x00", "13, 13")):
        changed = {**right, header: value}
        listed = [f"{name}: {text}" for name, text in changed.items() if text is not None]
        yield Case("upgrades", f"{header}: {str(value)[:20]}", request("GET /api/v1/stream HTTP/1.1", *listed), REFUSED | FINE | {101})
    for path in ("/", "/api/v1/clouds", "/api/v1/stream/x", "/api/v1/stream?x=1"):
        yield Case("upgrades", path, request(f"GET {path} HTTP/1.1", *(f"{n}: {v}" for n, v in right.items())), REFUSED | FINE | {101})


def answer(address, case):
    """None when that was right, else what was not."""
    try:
        with socket.create_connection(address, PATIENCE) as connection:
            connection.settimeout(PATIENCE)
            try:
                connection.sendall(case.send)
                connection.shutdown(socket.SHUT_WR) if case.closes and b"HTTP/1." not in case.send[:9000] else None
                head = connection.recv(4096)
            except (ConnectionError, BrokenPipeError):
                return None  # it has heard enough
            if not head:
                return None
            if not head.startswith(b"HTTP/1."):
                return f"answered with {head[:40]!r}"
            status = int(head.split(b" ", 2)[1])
            return None if status in case.allowed else f"answered {status}"
    except TimeoutError:
        return f"no answer in {PATIENCE} s"


def http_cases(cloud):
    return list(itertools.chain(views(cloud), lines(), headers(), framing(cloud), paths(cloud), bodies(cloud), upgrades()))


def socket_cases():
    """(name, what to do with a WebSocket that has said hello, or has not)."""
    def raw(data):
        return lambda stream: stream.socket.sendall(data)

    def frame(opcode, payload=b"", **how):
        return lambda stream: stream.send(opcode, payload, **how)

    def said(message):
        return lambda stream: stream.send(1, message if isinstance(message, bytes) else json.dumps(message).encode())

    cases = [("unmasked", frame(1, b"{}", masked=False)), ("reserved bits", raw(b"\xf1\x80\0\0\0\0")), ("a frame of 2^63", frame(1, b"", length=1 << 63)), ("of 2^31", frame(1, b"", length=1 << 31)),
             ("of 65 KiB", frame(1, b"a" * 66000)), ("continuation of nothing", frame(0, b"x")), ("text in text", lambda s: (s.send(1, b"{", fin=False), s.send(1, b"}"))),
             ("ten thousand fragments", lambda s: [s.send(0 if i else 1, b"x", fin=False) for i in range(10000)]), ("binary", frame(2, b"\0" * 64)), ("a long ping", frame(9, b"a" * 126)),
             ("a split ping", frame(9, b"a", fin=False)), ("pings", lambda s: [s.send(9, b"ping") for _ in range(2000)]), ("pongs", lambda s: [s.send(10, b"pong") for _ in range(2000)]),
             ("half a frame", raw(b"\x81")), ("half a length", raw(b"\x81\xfe\x01")), ("HTTP again", raw(b"GET / HTTP/1.1\r\n\r\n")), ("zeros", raw(b"\0" * 4096)), ("close twice", lambda s: (s.send(8, b""), s.send(8, b"")))]
    cases += [(f"close {code}", frame(8, struct.pack(">H", code) + b"x")) for code in (0, 999, 1000, 1004, 1005, 1006, 1015, 2999, 4999, 65535)]
    cases += [("close of one byte", frame(8, b"x")), ("close with bad text", frame(8, struct.pack(">H", 1000) + b"\xff\xff"))]
    cases += [(f"opcode {code}", frame(code, b"x")) for code in (3, 4, 5, 6, 7, 11, 12, 13, 14, 15)]
    cases += [(f"says {text[:24]!r}", said(text)) for text in (
        b"", b"{", b"[]", b"null", b"\xff\xfe", b'{"type": 7}', b'{"type": "nothing"}', b'{"type": "view"}', b'{"type": "view", "seq": -1}', b'{"type": "view", "seq": 1e99}', b'{"type": "view", "seq": "1"}',
        b'{"type": "view", "seq": 1, "width": 999999}', b'{"type": "view", "seq": 1, "camera": []}', b'{"type": "view", "seq": 1, "camera": {"eye": [0,0,0], "target": [0,0,0]}}', b'{"type": "ack"}',
        b'{"type": "ack", "frame": 999999999}', b'{"type": "ack", "frame": -1}', b'{"type": "pick", "seq": 1, "x": 1e9, "y": 0}', b'{"type": "ping", "id": "' + b"a" * 9000 + b'"}', b'{"type": "hello", "width": 0}',
        b'{"type": "hello", "width": 1e9}', b'{"type": "hello", "fps": 0}', b'{"type": "hello", "cloud": "' + b"../" * 500 + b'"}', b'{"type": "hello", "resume": "' + b"a" * 4000 + b'"}',
        b'{"type": "hello", "follow": "nobody"}', b'{"type": "quality", "fps": -1}', b'{"type": "quality", "minResolution": 9}', b"[" * 60000)]
    return cases


def bother(address, act, greeted):
    """None, or what was wrong: the server may answer, close, or take no notice; it must not hang on a goodbye."""
    try:
        stream = polite.WebSocket(address, timeout=PATIENCE)
        try:
            if stream.status != 101:
                return f"the upgrade was answered {stream.status}"
            if greeted:
                stream.say(type="hello", width=64, height=48)
            act(stream)
            stream.send(8, struct.pack(">H", 1000))
            stream.socket.shutdown(socket.SHUT_WR)
            end = time.monotonic() + PATIENCE
            while time.monotonic() < end:
                stream.receive()
            return f"the connection is still open {PATIENCE} s after its end"
        finally:
            stream.close()
    except TimeoutError:
        return f"nothing in {PATIENCE} s"
    except (ConnectionError, BrokenPipeError, OSError):
        return None
