"""A TCP proxy with latency: what is sent is delivered so much later, in both directions, as over a long line; bandwidth is not limited.
It counts connections and bytes. Used as a module, or: latency_proxy.py TARGET_PORT MILLISECONDS_OF_A_ROUND_TRIP, which prints its port."""
import asyncio
import sys


class LatencyProxy:
    def __init__(self, target_port, round_trip_ms):
        self.target_port, self.delay = target_port, round_trip_ms / 2000
        self.connections = self.bytes_down = 0
        self.open = True  # False: nothing gets through, and nobody is told: a line that is cut
        self.refuse = False

    async def start(self):
        self.server = await asyncio.start_server(self._connection, "127.0.0.1", 0)
        return self.server.sockets[0].getsockname()[1]

    async def _connection(self, reader, writer):
        if self.refuse:
            writer.close()
            return
        self.connections += 1
        await asyncio.sleep(self.delay * 2)  # the handshake of TCP is one round trip; ours is on this machine
        try:
            there_reader, there_writer = await asyncio.open_connection("127.0.0.1", self.target_port)
        except OSError:
            writer.close()
            return
        await asyncio.gather(self._pump(reader, there_writer, False), self._pump(there_reader, writer, True))

    async def _pump(self, reader, writer, down):
        queue = asyncio.Queue()

        async def deliver():
            loop = asyncio.get_running_loop()
            while True:
                due, data = await queue.get()
                await asyncio.sleep(max(0, due - loop.time()))
                while not self.open:
                    await asyncio.sleep(0.02)
                if not data:
                    break
                writer.write(data)
                await writer.drain()
            writer.close()

        task = asyncio.create_task(deliver())
        try:
            while data := await reader.read(1 << 18):
                if down:
                    self.bytes_down += len(data)
                queue.put_nowait((asyncio.get_running_loop().time() + self.delay, data))
        except OSError:
            pass
        queue.put_nowait((0, b""))
        try:
            await task
        except OSError:
            pass


async def main():
    proxy = LatencyProxy(int(sys.argv[1]), float(sys.argv[2]))
    print(await proxy.start(), flush=True)
    await proxy.server.serve_forever()


if __name__ == "__main__":
    asyncio.run(main())
