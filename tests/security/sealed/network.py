"""Two tunnels and a network between them, in virtual time."""

from __future__ import annotations

import heapq
from random import Random

from mavstack.security.sealed import Responder, SealConfig, Tunnel

SHARED = SealConfig.shared(bytes(32))


class Network:
    """Loss, duplicates, delay and reordering between two ends, all from one seed."""

    def __init__(
        self,
        seed: int = 0,
        *,
        loss: float = 0.0,
        duplicate: float = 0.0,
        delay: float = 0.01,
        jitter: float = 0.0,
    ) -> None:
        self.random = Random(seed)
        self.loss, self.duplicate, self.delay, self.jitter = loss, duplicate, delay, jitter
        self.now = 0.0
        self.recorded: list[tuple[int, bytes]] = []  # receiver and datagram of all that was sent
        self.received: tuple[list[bytes], list[bytes]] = ([], [])
        self.ends: list[Tunnel] = []
        self._transit: list[tuple[float, int, int, bytes]] = []
        self._number = 0

    def client(self, config: SealConfig = SHARED) -> Tunnel:
        return Tunnel(config, initiates=True, random=self.random.randbytes)

    def server(self, config: SealConfig = SHARED) -> Tunnel:
        responder = Responder(config, self.random.randbytes)
        return Tunnel(
            config, initiates=False, responder=responder, address=b"client", random=self.random.randbytes
        )

    def both(self, config: SealConfig = SHARED) -> Tunnel:
        """Return an end of a serial link."""
        responder = Responder(config, self.random.randbytes)
        return Tunnel(config, initiates=True, responder=responder, random=self.random.randbytes)

    def send(self, sender: int, datagram: bytes) -> None:
        self.recorded.append((1 - sender, datagram))
        for _ in range(1 + (self.random.random() < self.duplicate)):
            if self.random.random() >= self.loss:
                self.inject(1 - sender, datagram, self.delay + self.random.random() * self.jitter)

    def inject(self, receiver: int, datagram: bytes, delay: float = 0.0) -> None:
        self._number += 1
        heapq.heappush(self._transit, (self.now + delay, self._number, receiver, datagram))

    def write(self, sender: int, content: bytes) -> bool:
        datagram = self.ends[sender].seal(content, self.now)
        if datagram:
            self.send(sender, datagram)
        return bool(datagram)

    def run(self, seconds: float, step: float = 0.1) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now = min(self.now + step, end)
            while self._transit and self._transit[0][0] <= self.now:
                _, _, receiver, datagram = heapq.heappop(self._transit)
                content = self.ends[receiver].receive(datagram, self.now)
                if content:
                    self.received[receiver].append(content)
                self.collect()
            for tunnel in self.ends:
                tunnel.handle_timeout(self.now)
            self.collect()

    def collect(self) -> None:
        for number, tunnel in enumerate(self.ends):
            for datagram in tunnel.datagrams_to_send():
                self.send(number, datagram)
