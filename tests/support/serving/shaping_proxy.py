#!/usr/bin/python3
"""A slow line before a server: bandwidth and delay both ways, and a queue with a bound, as a modem has.

    tests/support/serving/shaping_proxy.py --to 127.0.0.1:8080 [--port 0] [--kbit 2000] [--delay-ms 50] [--queue-kb 64]

Listens on 127.0.0.1, prints the port, and serves until it is ended. All connections share the line. A byte waits for
those before it, takes its time on the line, then the delay; what has not been taken from its sender waits there.
"""
import argparse
import asyncio
import contextlib
import socket

PIECE = 1460  # bytes, as a packet


class Line:
    """One direction. Times are the event loop's clock."""

    def __init__(self, bytes_per_second, delay, queue_bytes):
        self.bytes_per_second, self.delay, self.queue_bytes = bytes_per_second, delay, queue_bytes
        self.free_at = 0.0  # when the last byte in the queue has been sent

    async def send(self, count):
        """Waits for room in the queue; returns when these bytes arrive at the other end."""
        loop = asyncio.get_running_loop()
        while True:
            excess = (self.free_at - loop.time()) * self.bytes_per_second - self.queue_bytes
            if excess <= 0:
                break
            await asyncio.sleep(excess / self.bytes_per_second)
        self.free_at = max(self.free_at, loop.time()) + count / self.bytes_per_second
        return self.free_at + self.delay


async def pump(reader, writer, line):
    """Carries one direction of one connection, in order, its end included."""
    loop = asyncio.get_running_loop()
    on_the_way = asyncio.Queue()

    async def deliver():
        while True:
            arrival, piece = await on_the_way.get()
            await asyncio.sleep(max(0.0, arrival - loop.time()))
            if not piece:
                return
            writer.write(piece)
            await writer.drain()

    delivery = asyncio.create_task(deliver())
    try:
        while not delivery.done():
            piece = await reader.read(PIECE)
            on_the_way.put_nowait((await line.send(len(piece)), piece))
            if not piece:
                break
        await delivery
    except (ConnectionError, OSError):
        pass
    finally:
        delivery.cancel()
        with contextlib.suppress(ConnectionError, OSError, RuntimeError):
            writer.write_eof()


def small_buffers(connection):
    """Buffers of the system would be a second queue, without a bound of ours."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16 * 1024)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


async def serve(to, port, bytes_per_second, delay, queue_bytes, ready):
    """Runs until it is cancelled; calls ready(port) when it listens."""
    up, down = (Line(bytes_per_second, delay, queue_bytes) for _ in range(2))

    async def accepted(client_reader, client_writer):
        connection = socket.socket()
        small_buffers(connection)
        connection.setblocking(False)
        try:
            await asyncio.get_running_loop().sock_connect(connection, to)
            reader, writer = await asyncio.open_connection(sock=connection, limit=PIECE)
        except OSError:
            connection.close()
            client_writer.close()
            return
        try:
            await asyncio.gather(pump(client_reader, writer, up), pump(reader, client_writer, down))
        finally:
            for end in (writer, client_writer):
                end.close()

    listener = socket.socket()
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    small_buffers(listener)
    listener.bind(("127.0.0.1", port))
    server = await asyncio.start_server(accepted, sock=listener, limit=PIECE)
    ready(listener.getsockname()[1])
    async with server:
        await server.serve_forever()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", required=True, help="HOST:PORT of the server")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--kbit", type=float, default=2000, help="bandwidth of each direction, kbit/s")
    parser.add_argument("--delay-ms", type=float, default=50, help="one way")
    parser.add_argument("--queue-kb", type=float, default=64, help="bytes that may wait for the line, in kB")
    arguments = parser.parse_args()
    host, port = arguments.to.rsplit(":", 1)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(serve((host, int(port)), arguments.port, arguments.kbit * 125, arguments.delay_ms / 1000,
                          arguments.queue_kb * 1000, lambda listening: print(listening, flush=True)))


if __name__ == "__main__":
    main()
