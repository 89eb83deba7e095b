"""What deploy/ offers does what its README says: nginx takes the file, passes pages and streams on and keeps floods away,
systemd takes the unit, man pages and completions have all that --help says, what the container's build reads is there.

    deploy_test.py FOLDER_OF_THE_PROGRAMS
"""
import http.server
import json
import os
import re
import shutil
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
sys.path.insert(0, os.path.join(ROOT, "deploy", "manual"))
import help_text
import make_manual
import serving

PROGRAMS = os.path.abspath(sys.argv.pop())
PATIENCE = 60  # seconds; only what hangs takes so long


def text_of(*path):
    with open(os.path.join(ROOT, *path)) as file:
        return file.read()


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def packages(name):
    """Of deploy/packages/NAME.txt: package and the command that stands for it, if one does."""
    lines = [line.split() for line in text_of("deploy", "packages", name + ".txt").splitlines()]
    return {line[0]: line[1] if len(line) > 1 else None for line in lines if line and not line[0].startswith("#")}


class Echo(http.server.BaseHTTPRequestHandler):
    """In Scancast's place: answers with the head that reached it."""

    def do_GET(self):
        body = str(self.headers).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *arguments):
        pass


class Replica(Echo):
    """One of several in Scancast's place: answers with its number; one that leaves refuses new streams."""

    def do_GET(self):
        body = str(self.number).encode()
        self.send_response(503 if self.leaves and self.path.endswith("/stream") else 200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


class SignedIn(http.server.BaseHTTPRequestHandler):
    """In oauth2-proxy's place: who has the cookie is signed in. Keeps the heads of all that it was asked."""
    heads = []

    def do_GET(self):
        SignedIn.heads.append((self.path, str(self.headers)))
        known = "_oauth2_proxy=good" in self.headers.get("Cookie", "")
        status = (202 if known else 401) if self.path == "/oauth2/auth" else 200
        self.send_response(status)
        self.send_header("Content-Length", "7")
        self.end_headers()
        self.wfile.write(b"sign in")

    def log_message(self, *arguments):
        pass


class Nginx(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.include = None
        self.replicas = []

    def serve(self):
        scan, log = os.path.join(self.folder, "ball.las"), open(os.path.join(self.folder, "log"), "w")
        self.addCleanup(log.close)
        run(os.path.join(PROGRAMS, "scancast"), "generate", "sphere", "--points", "20000", "-o", scan, "--quiet")
        self.server = serving.Server(os.path.join(PROGRAMS, "scancast"), scan, 8, log, "--trusted-proxy", "127.0.0.1",
                                     "--max-connections-per-address", "2")
        self.addCleanup(self.server.stop)

    def configuration(self, upstream, port, plain):
        """The file with the lines changed that it says are to be changed, in a nginx that needs nothing of the system."""
        key, certificate = os.path.join(self.folder, "key.pem"), os.path.join(self.folder, "certificate.pem")
        run("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-subj",
            "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout", key, "-out", certificate)
        text = text_of("deploy", "nginx", "scancast.conf")
        for pattern, value in ((" 127.0.0.1:8080", " %s:%d" % upstream),
                               ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
                               ("listen 80;", f"listen 127.0.0.1:{plain};"),
                               ("/etc/ssl/scans.example.org.pem", certificate),
                               ("/etc/ssl/private/scans.example.org.key", key)):
            self.assertEqual(text.count(pattern), 1, f"{pattern} stands in the file once")
            text = text.replace(pattern, value)
        text = text.replace("server_name scans.example.org", "server_name localhost")
        line = "# include /etc/nginx/scancast-oauth2-proxy.conf;"
        self.assertEqual(text.count(line), 1)
        if self.include:
            text = text.replace(line, f"include {self.include};")
        before = self.with_replicas() if self.replicas else ""
        if self.replicas:
            text = self.without_upstream(text)
        site, main = os.path.join(self.folder, "site.conf"), os.path.join(self.folder, "nginx.conf")
        with open(site, "w") as file:
            file.write(text)
        temporary = "".join(f"{kind}_temp_path {self.folder}/{kind};\n" for kind in
                            ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(main, "w") as file:
            file.write(f"daemon off;\nmaster_process off;\npid {self.folder}/pid;\nerror_log {self.folder}/errors;\n"
                       f"events {{}}\nhttp {{\naccess_log off;\n{temporary}{before}include {site};\n}}\n")
        self.certificate = certificate
        return main

    def without_upstream(self, text):
        """scancast.conf as replicas.conf wants it changed."""
        text, blocks = re.subn(r"upstream scancast \{.*?\n\}\n", "", text, flags=re.S)
        self.assertEqual(blocks, 1)
        line = "# include /etc/nginx/scancast-replicas-server.conf;"
        self.assertEqual(text.count(line), 1)
        return text.replace(line, f"include {os.path.join(ROOT, 'deploy', 'nginx', 'replicas-server.conf')};")

    def with_replicas(self):
        """What replicas.conf has for the level above, with these replicas in it."""
        text, lines = re.subn(r"\n    server 10\.0\.0\.\d+:8080", lambda line: line[0], text_of("deploy", "nginx", "replicas.conf"))
        self.assertEqual(lines, len(self.replicas))
        for number, (host, port) in enumerate(self.replicas):
            text = text.replace(f"server 10.0.0.{11 + number}:8080", f"server {host}:{port}")
        path = os.path.join(self.folder, "replicas.conf")
        with open(path, "w") as file:
            file.write(text)
        return f"include {path};\n"

    def sign_in_by(self, proxy, token):
        """Has the site's file include oauth2-proxy.conf, with the lines changed that it says are to be changed."""
        text = text_of("deploy", "nginx", "oauth2-proxy.conf")
        path, secret = os.path.join(self.folder, "oauth2-proxy.conf"), os.path.join(self.folder, "token.conf")
        self.assertEqual(text.count("proxy_pass http://127.0.0.1:4180;"), 2)
        text = text.replace("http://127.0.0.1:4180;", "http://%s:%d;" % proxy)
        self.assertEqual(text.count("include /etc/nginx/scancast-token.conf;"), 1)
        text = text.replace("/etc/nginx/scancast-token.conf", secret)
        self.assertIn('#     proxy_set_header Authorization "Bearer THE-TOKEN";\n', text)
        with open(path, "w") as file:
            file.write(text)
        with open(secret, "w") as file:
            file.write(f'proxy_set_header Authorization "Bearer {token}";\n')
        self.include = path

    def start(self, upstream):
        """nginx before that address; returns the URLs of both its servers, https first."""
        nginx = shutil.which("nginx") or "/usr/sbin/nginx"
        port, plain = free_port(), free_port()
        main = self.configuration(upstream, port, plain)
        run(nginx, "-t", "-c", main, "-p", self.folder)
        process = subprocess.Popen([nginx, "-c", main, "-p", self.folder])
        self.addCleanup(process.wait, 30)
        self.addCleanup(process.terminate)
        url = f"https://localhost:{port}"
        patient_until = time.monotonic() + PATIENCE
        while subprocess.run(["curl", "-s", "--cacert", self.certificate, url + "/healthz"],
                             stdout=subprocess.DEVNULL).returncode:
            self.assertLess(time.monotonic(), patient_until, "nginx answers")
            self.assertIsNone(process.poll(), "nginx runs")
            time.sleep(0.1)
        return url, f"http://localhost:{plain}"

    def test_a_browser_stays_with_its_replica_until_that_is_gone(self):
        servers = []
        for number in range(3):
            servers.append(http.server.ThreadingHTTPServer(("127.0.0.1", 0), type("Numbered", (Replica,), {"number": number, "leaves": False})))
            threading.Thread(target=servers[-1].serve_forever, daemon=True).start()
            self.addCleanup(servers[-1].server_close)
            self.addCleanup(servers[-1].shutdown)
        self.replicas = [server.server_address for server in servers]
        url, _ = self.start(self.replicas[0])

        def ask(path, cookie=None):
            """Which replica answered, and the cookie that came with it."""
            done = run("curl", "-s", "-i", "--http1.1", "--cacert", self.certificate, *(["-b", cookie] if cookie else []), url + path)
            self.assertRegex(done, r"^HTTP/1\.1 200 ")
            found = re.search(r"^set-cookie: (scancast_replica=[0-9a-f]{32});([^\r\n]*)", done, re.M | re.I)
            return int(done.strip()[-1]), found and found[1], found and found[2]

        met = {}
        for _ in range(24):
            replica, cookie, how = ask("/")
            self.assertEqual({part.strip() for part in how.split(";")}, {"Path=/", "HttpOnly", "SameSite=Lax", "Secure"})
            met.setdefault(replica, cookie)
        self.assertEqual(set(met), {0, 1, 2}, "by lot, all have somebody")
        for replica, cookie in met.items():
            for path in ("/", "/api/v1/stream", "/api/v1/clouds", "/stream"):
                self.assertEqual(ask(path, cookie), (replica, None, None), "the same one, and no second cookie")
        replica, cookie, _ = ask("/", "scancast_replica=of-somebody-else")
        self.assertTrue(cookie, "what is no number of ours is replaced")

        # One that drains refuses streams, which go elsewhere, and answers everything else.
        servers[0].RequestHandlerClass.leaves = True
        self.assertIn(ask("/api/v1/stream", met[0])[0], {1, 2})
        servers[0].RequestHandlerClass.leaves = False
        # One that is gone is asked for nothing, and nobody else moves.
        servers[1].shutdown()
        servers[1].server_close()
        self.assertIn(ask("/", met[1])[0], {0, 2})
        self.assertEqual(ask("/", met[2])[0], 2)

    def test_what_scancast_hears_of_a_client_is_what_nginx_saw(self):
        upstream = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Echo)
        threading.Thread(target=upstream.serve_forever, daemon=True).start()
        self.addCleanup(upstream.server_close)
        self.addCleanup(upstream.shutdown)
        url, plain = self.start(upstream.server_address)
        get = ("curl", "-sS", "--cacert", self.certificate)
        head = run(*get, "-H", "X-Forwarded-For: 6.6.6.6", "-H", "Forwarded: for=6.6.6.6", "-H", "X-Forwarded-Proto: http",
                   url + "/")
        self.assertNotIn("6.6.6.6", head, "a client says what it likes of itself")
        told = dict(re.findall(r"^(\S+): (.*?)\r?$", head, re.M))
        self.assertEqual(told.get("X-Forwarded-For"), "127.0.0.1")
        self.assertEqual(told.get("X-Forwarded-Proto"), "https")
        self.assertEqual(told.get("Host"), url.removeprefix("https://"))
        self.assertIn("strict-transport-security: max-age=", run(*get, "-D", "-", "-o", os.devnull, url + "/").lower())
        redirect = run("curl", "-sS", "-D", "-", "-o", os.devnull, plain + "/clouds?a=b")
        self.assertIn("308 ", redirect)
        self.assertIn("Location: https://localhost/clouds?a=b", redirect)
        # A flood is answered by nginx; who asks as pages do is not refused.
        patient_until = time.monotonic() + PATIENCE
        codes = ("curl", "-s", "--cacert", self.certificate, "-o", os.devnull, "-w", "%{http_code}\n")
        statuses = run(*codes, url + "/[1-40]").split()
        self.assertEqual(set(statuses), {"200"})
        while "429" not in statuses:
            self.assertLess(time.monotonic(), patient_until, "floods are refused")
            statuses = run(*codes, url + "/[1-300]").split()
        self.assertLessEqual(set(statuses), {"200", "429"})

    def test_pages_pictures_and_streams_are_passed_on(self):
        self.serve()
        url, _ = self.start(self.server.address)
        get = ("curl", "-sS", "--fail", "--cacert", self.certificate)
        self.assertIn("<html", run(*get, url + "/"))
        self.assertIn('"ball"', run(*get, url + "/api/v1/clouds"))
        pictures = os.path.join(self.folder, "pictures")
        run(os.path.join(PROGRAMS, "scancast-client"), "orbit", url, "--ca-file", self.certificate, "--frames", "4", "--width",
            "160", "--height", "120", "-o", pictures)
        found = [name for _, _, names in os.walk(self.folder) for name in names if name.endswith(".jpg")]
        self.assertEqual(len(found), 4, "frames came through the WebSocket")
        self.assertIn(b"Scancast-Kind: final", self.stream(url + f"/api/v1/clouds/{self.server.cloud}/stream.mjpg?width=160"))

        # Clients are told apart by what nginx says of them, whatever they say themselves: who has his share of streams has
        # no more, others have theirs. Each address of the loopback network is another client.
        streaming = url + f"/api/v1/clouds/{self.server.cloud}/stream.mjpg?width=160"
        for _ in range(2):
            self.assertIn(b"Scancast-Kind: ", self.stream(streaming, b"Scancast-Kind: ", "127.0.0.9", keep=True))
        for client, says, expected in (("127.0.0.9", "127.0.0.10", "429"), ("127.0.0.10", "127.0.0.9", "200")):
            status = run("curl", "-sS", "-o", os.devnull, "-w", "%{http_code}", "--cacert", self.certificate, "--interface", client,
                         "-H", f"X-Forwarded-For: {says}", "-H", f"Forwarded: for={says}", url + "/healthz")
            self.assertEqual(status, expected, client)

    def test_who_has_signed_in_needs_no_token(self):
        tokens, scan = os.path.join(self.folder, "tokens"), os.path.join(self.folder, "ball.las")
        program = os.path.join(PROGRAMS, "scancast")
        run(program, "generate", "sphere", "--points", "20000", "-o", scan, "--quiet")
        line, other = run(program, "token", "nginx"), run(program, "token", "somebody")
        with open(os.open(tokens, os.O_WRONLY | os.O_CREAT, 0o600), "w") as file:
            file.write(line + other)
        with open(os.path.join(self.folder, "log"), "w") as log:
            server = subprocess.Popen([program, "serve", scan, "--port", "0", "--auth-token-file", tokens, "--trusted-proxy",
                                       "127.0.0.1"], stdout=subprocess.PIPE, stderr=log, text=True)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.wait, 30)
        self.addCleanup(server.terminate)
        address = "127.0.0.1", int(re.search(r"http://127.0.0.1:(\d+)", server.stdout.readline())[1])
        proxy = http.server.ThreadingHTTPServer(("127.0.0.1", 0), SignedIn)
        threading.Thread(target=proxy.serve_forever, daemon=True).start()
        self.addCleanup(proxy.server_close)
        self.addCleanup(proxy.shutdown)
        self.sign_in_by(proxy.server_address, line.split()[1])
        url, _ = self.start(address)

        def ask(path, *more):
            shown = run("curl", "-sS", "--cacert", self.certificate, "-D", "-", "--max-time", str(PATIENCE), *more, url + path)
            return int(shown.split()[1]), shown

        cookie = ("-H", "Cookie: _oauth2_proxy=good")
        patient_until = time.monotonic() + PATIENCE
        while ask("/readyz", *cookie)[0] != 200:
            self.assertLess(time.monotonic(), patient_until, "the cloud is there")
            time.sleep(0.1)
        for path in ("/", "/main.js", "/openapi.json"):
            status, shown = ask(path)
            self.assertEqual(status, 302, path)
            self.assertRegex(shown, r"(?i)location: \S*/oauth2/sign_in\?rd=" + path)
            self.assertEqual(ask(path, *cookie)[0], 200, path)
        self.assertIn("sign in", ask("/oauth2/sign_in?rd=/")[1])
        self.assertEqual(ask("/healthz")[0], 200)
        for path in ("/api/v1/clouds", "/api/v1/clouds/ball/snapshot.jpg?width=32&height=16", "/api/v1/stream"):
            self.assertEqual(ask(path, "-o", os.devnull)[0], 401, path)
            # Neither a cookie that is none nor somebody's own token gets past.
            self.assertEqual(ask(path, "-o", os.devnull, "-H", "Cookie: _oauth2_proxy=bad", "-H",
                                 "Authorization: Bearer " + other.split()[1])[0], 401, path)
        self.assertIn('"ball"', ask("/api/v1/clouds", *cookie, "-H", "Authorization: Bearer what-a-client-says")[1])
        self.assertEqual(ask("/api/v1/clouds/ball/snapshot.jpg?width=32&height=16", "-o", os.devnull, *cookie)[0], 200)
        self.assertEqual(ask("/api/v1/sessions", "-o", os.devnull, *cookie)[0], 403, "who has signed in does not administer")
        # A WebSocket, as a page without a token opens it.
        port = int(url.rsplit(":", 1)[1])
        trusting = ssl.create_default_context(cafile=self.certificate)
        with socket.create_connection(("127.0.0.1", port), PATIENCE) as plain, \
                trusting.wrap_socket(plain, server_hostname="localhost") as opening:
            opening.sendall((f"GET /api/v1/stream HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                             "Sec-WebSocket-Protocol: scancast.v1\r\nCookie: _oauth2_proxy=good\r\n\r\n").encode())
            self.assertIn(b" 101 ", opening.makefile("rb").readline())
        self.assertNotIn(line.split()[1], str(SignedIn.heads), "oauth2-proxy never sees Scancast's token")

    def stream(self, url, until=b"Scancast-Kind: final", client="127.0.0.3", keep=False):
        """An MJPEG stream up to its final still: nothing may be held back, since nothing comes behind it."""
        process = subprocess.Popen(["curl", "-sSN", "--fail", "--cacert", self.certificate, "--max-time", str(PATIENCE), "--interface",
                                    client, url], stdout=subprocess.PIPE)

        def end():  # again does no harm
            process.kill()
            process.wait()
            process.stdout.close()

        self.addCleanup(end)
        seen = b""
        while until not in seen and (some := process.stdout.read1(65536)):
            seen += some
        if not keep:
            end()
        return seen


class Systemd(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.unit = os.path.join(folder.name, "scancast.service")
        text = text_of("deploy", "systemd", "scancast.service")
        self.assertEqual(text.count("/usr/bin/scancast "), 1)
        with open(self.unit, "w") as file:
            file.write(text.replace("/usr/bin/scancast ", os.path.join(PROGRAMS, "scancast") + " "))

    def test_the_unit_is_sound(self):
        said = run("systemd-analyze", "verify", "--man=no", self.unit)
        self.assertNotIn("scancast.service", said, "not even a warning")

    def test_the_user_is_the_one_that_is_made(self):
        made = re.search(r"^u (\S+) - ", text_of("deploy", "systemd", "sysusers.conf"), re.M)
        self.assertIn(f"\nUser={made.group(1)}\n", text_of("deploy", "systemd", "scancast.service"))
        with tempfile.TemporaryDirectory() as root:
            os.mkdir(os.path.join(root, "etc"))
            run("systemd-sysusers", f"--root={root}", os.path.join(ROOT, "deploy", "systemd", "sysusers.conf"))
            with open(os.path.join(root, "etc", "passwd")) as users:
                self.assertIn(f"{made.group(1)}:", users.read())

    def test_the_unit_is_hardened(self):
        run("systemd-analyze", "security", "--offline=true", "--threshold=20", self.unit)

    def test_settings_are_flags_that_there_are(self):
        flags = run(os.path.join(PROGRAMS, "scancast"), "serve", "--help")
        named = re.findall(r"^#?(SCANCAST_[A-Z_]+)=", text_of("deploy", "systemd", "scancast.env"), re.M)
        named += re.findall(r"(SCANCAST_[A-Z_]+)=", text_of("deploy", "systemd", "scancast.service"))
        named += re.findall(r"(SCANCAST_[A-Z_]+)=", text_of("deploy", "container", "Containerfile"))
        self.assertGreater(len(named), 8)
        for name in set(named) - {"SCANCAST_CLOUDS", "SCANCAST_TESTS", "SCANCAST_UNITY", "SCANCAST_IMPORT_PCL"}:
            self.assertIn(name, flags)


class Manual(unittest.TestCase):
    """Against the programs' own words, read here in another way than by deploy/manual."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.said = {}  # ("scancast", "serve"): what its --help says
        for program in ("scancast", "scancast-client"):
            path = os.path.join(PROGRAMS, program)
            make_manual.main("1.2.3", cls.folder, path)
            cls.said[program, ""] = run(path, "--help")
            listed = cls.said[program, ""].split("Subcommands:\n")[1].split("\n\n")[0]
            for word in re.findall(r"^  ([a-z][a-z-]+) ", listed, re.M):
                cls.said[program, word] = run(path, word, "--help")

    def read(self, *path):
        with open(os.path.join(self.folder, *path), encoding="utf-8") as file:
            return file.read()

    @staticmethod
    def flags(said):
        lines = re.findall(r"^  (-\S+)", said, re.M)
        return [flag for line in lines for flag in line.split(",")]

    def test_every_subcommand_has_a_page_with_every_flag(self):
        self.assertGreater(len(self.said), 12)
        for (program, word), said in self.said.items():
            name = f"{program}-{word}" if word else program
            page = self.read("man1", name + ".1")
            self.assertIn("1.2.3", page)
            self.assertGreater(len(self.flags(said)), 0, name)
            for flag in self.flags(said):
                self.assertIn(f"\\fB{flag}\\fR".replace("-", "\\-"), page, name)
            for variable in re.findall(r"\(Env:(\w+)\)", said):
                self.assertIn(variable, page, name)
            for word in re.findall(r"[A-Za-z]{4,}", said.split("\n\n", 1)[1]):
                if word not in ("Positionals", "REQUIRED", "Excludes", "Needs", "UINT", "FLOAT", "Options", "TEXT"):
                    self.assertIn(word.lower(), page.lower(), f"{name} has every word of the help")

    def test_man_takes_the_pages(self):
        if not shutil.which("groff"):
            self.skipTest("groff is not installed")
        for name in sorted(os.listdir(os.path.join(self.folder, "man1"))):
            path = os.path.join(self.folder, "man1", name)
            done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z", "-k", path], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)

    def test_completions_know_every_flag_and_bash_completes(self):
        for (program, word), said in self.said.items():
            for flag in self.flags(said):
                for file in (("bash", program), ("zsh", "_" + program)):
                    self.assertRegex(self.read(*file), rf"{flag}\b", file)
                short = f"-l {flag[2:]} " if flag.startswith("--") else f"-s {flag[1:]} "
                self.assertIn(short, self.read("fish", program + ".fish"))
            script = os.path.join(self.folder, "bash", program)
            for typed in {flag for flag in self.flags(said) if flag.startswith("--")}:
                self.assertIn(typed, self.complete(script, program, word, typed) if word == "serve" else typed)
        script = os.path.join(self.folder, "bash", "scancast")
        self.assertEqual(self.complete(script, "scancast", "serve", "--backend", ""), ["auto", "cpu", "egl", "osmesa"])
        self.assertEqual(self.complete(script, "scancast", "in"), ["ingest", "info"])
        self.assertEqual(self.complete(script, "scancast", "info", "--points"), [], "another command's")

    def complete(self, script, *words):
        """What bash offers for the last of the words."""
        typed = [word for word in words if word or word is words[-1]]
        return subprocess.run(["bash", "-c", '. "$1"; shift; compopt() { :; }; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                               '"_${1//-/_}"; printf "%s\n" "${COMPREPLY[@]}"', "bash", script, *typed],
                              capture_output=True, text=True, check=True).stdout.split()

    def test_what_is_read_of_a_help_is_what_it_says(self):
        read = help_text.parse("scan draw", "Draws.\nUsage: /x/scan draw [OPTIONS] file\n\nPositionals:\n"
                               "  file TEXT REQUIRED          The scan\n\nOptions:\n"
                               "  -o,--output FILE            Where\n                              to\n"
                               "  --port PORT:INT in [0 - 9]=8 (Env:SCAN_PORT)\n                              The port\n"
                               "  --behind-mirrors true|false Just fits\n"
                               "  --live NAME=PATH ...        Pairs\n\nExamples:\n  scan draw a\n")
        output, port, mirrors, live = read.options
        self.assertEqual((output.names, output.value, output.lines), (["-o", "--output"], "FILE", ["Where", "to"]))
        self.assertEqual((port.value, port.allowed, port.default, port.environment, port.lines),
                         ("PORT", "in [0 - 9]", "8", "SCAN_PORT", ["The port"]))
        self.assertEqual((mirrors.choices(), mirrors.lines), (["true", "false"], ["Just fits"]))
        self.assertEqual((live.value, live.default), ("NAME=PATH", ""))
        self.assertEqual((read.usage, read.arguments[0].notes, read.footer),
                         ("[OPTIONS] file", ["required"], ["Examples:", "  scan draw a"]))
        with self.assertRaisesRegex(ValueError, "Usage"):
            help_text.parse("scan", "nothing of the kind")


class Container(unittest.TestCase):
    text = text_of("deploy", "container", "Containerfile")

    def test_what_is_copied_is_there(self):
        copied = re.findall(r"^COPY (?!--from)(.+) \S+$", self.text, re.M)
        self.assertGreater(len(copied), 1)
        for names in copied:
            for name in names.split():
                self.assertTrue(os.path.exists(os.path.join(ROOT, name)), name)

    def test_the_health_check_tells_a_ready_server_from_none(self):
        check = json.loads(re.search(r"^HEALTHCHECK.*\\\n\s+CMD (\[.*\])$", self.text, re.M).group(1))
        statuses = iter([200, 503])

        class Ready(Echo):
            def do_GET(self):
                self.send_response(next(statuses) if self.path == "/readyz" else 404)
                self.end_headers()

        with http.server.HTTPServer(("127.0.0.1", 0), Ready) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            environment = dict(os.environ, SCANCAST_PORT=str(server.server_port))
            for healthy in (True, False):
                self.assertEqual(subprocess.run(check, env=environment, timeout=PATIENCE).returncode == 0, healthy)
            server.shutdown()
        environment["SCANCAST_PORT"] = str(free_port())
        nobody = subprocess.run(check, env=environment, timeout=PATIENCE, stderr=subprocess.DEVNULL)
        self.assertNotEqual(nobody.returncode, 0)

    def test_what_it_copies_and_composes_is_not_ignored(self):
        ignored = [line for line in text_of(".containerignore").split("\n") if line and not line.startswith("#")]
        for name in ("deploy/packages/build.txt", "server/main.cpp", "docs/info.md"):
            for pattern in ignored:
                self.assertFalse(name == pattern or name.startswith(pattern + "/"), f"{pattern} hides {name}")
        compose = text_of("deploy", "container", "compose.yaml")
        for path in re.findall(r"- (\.\./[^:]+):", compose):
            self.assertTrue(os.path.isfile(os.path.join(ROOT, "deploy", "container", path)), path)
        for _, target in re.findall(r"- (\./tls/\S+?):(\S+):ro", compose):
            self.assertIn(target + ";", text_of("deploy", "nginx", "scancast.conf"), "nginx finds it where its file says")

    def test_packages_exist(self):
        for name in ("build", "package"):
            shown = run("apt-cache", "show", "--no-all-versions", *packages(name))
            self.assertEqual(set(re.findall(r"^Package: (\S+)$", shown, re.M)), set(packages(name)))


if __name__ == "__main__":
    unittest.main()
