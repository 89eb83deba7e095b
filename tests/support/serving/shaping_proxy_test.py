"""The proxy carries what it is given, in order, whole, both ways, and no faster than the line; a clock of the
system's is asked for lower bounds only, which a slow machine cannot break."""
import os
import socket
import subprocess
import sys
import threading
import time
import unittest

PROXY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "shaping_proxy.py")


class Echo:
    """Sends back what it gets, then ends as its client did."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    @staticmethod
    def serve(connection):
        with connection:
            while piece := connection.recv(65536):
                connection.sendall(piece)


class ShapingProxy(unittest.TestCase):
    def setUp(self):
        self.echo = Echo()
        self.addCleanup(self.echo.listener.close)

    def proxy(self, *flags):
        process = subprocess.Popen([sys.executable, PROXY, "--to", f"127.0.0.1:{self.echo.port}", *flags],
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait, 20)
        self.addCleanup(process.terminate)
        return int(process.stdout.readline())

    def through(self, port, data):
        """The bytes that come back, and seconds until the first and the last of them."""
        back, first = b"", None
        start = time.monotonic()
        with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
            sender = threading.Thread(target=lambda: (connection.sendall(data), connection.shutdown(socket.SHUT_WR)))
            sender.start()
            while piece := connection.recv(65536):
                first = first or time.monotonic() - start
                back += piece
            sender.join()
        return back, first, time.monotonic() - start

    def test_brings_everything_no_faster_than_the_line(self):
        data = os.urandom(100_000)
        back, first, last = self.through(self.proxy("--kbit", "4000", "--delay-ms", "100"), data)
        self.assertEqual(back, data)
        self.assertGreaterEqual(first, 0.2)
        self.assertGreaterEqual(last, 0.2 + len(data) / 500_000)

    def test_what_waits_has_a_bound(self):
        port = self.proxy("--kbit", "80", "--queue-kb", "8")
        with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 16 * 1024)
            connection.settimeout(1)
            taken = 0
            with self.assertRaises(TimeoutError):  # 10 kB/s: what is taken at once is buffered, and that ends
                while taken < 50_000_000:
                    taken += connection.send(bytes(65536))
            self.assertLess(taken, 10_000_000)

    def test_a_server_that_is_not_there_is_an_end(self):
        with socket.create_server(("127.0.0.1", 0)) as nobody:
            self.echo.port = nobody.getsockname()[1]
        port = self.proxy("--kbit", "8000", "--delay-ms", "0")
        with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
            self.assertEqual(connection.recv(1), b"")


if __name__ == "__main__":
    unittest.main()
