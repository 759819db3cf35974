"""A station beside a router: it follows the fleet, and arms and disarms vehicles. `network_station`.

Lines of its input are commands: "tokens N" waits until N vehicles are there and prints the seconds, "frames
NAME" waits for a packet of a vehicle, "arm NAME…" sends commands that it repeats until they are answered.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

import zenoh

from mavstack.bridges.core.zenoh_session import SessionOptions

TIMEOUT = 60.0
ATTEMPT_TIMEOUT = 3.0


class Station:
    def __init__(self) -> None:
        config = zenoh.Config()
        for key, value in SessionOptions().values().items():
            config.insert_json5(key, json.dumps(value))
        self.session = zenoh.open(config)
        self.alive: set[str] = set()
        self.frames: dict[str, int] = {}
        self.changed = threading.Condition()
        self.session.liveliness().declare_subscriber("mavstack/*/alive/*", self.on_token, history=True)
        self.session.declare_subscriber("mavstack/*/frame/out", self.on_frame)

    def on_token(self, sample: Any) -> None:
        with self.changed:
            found = sample.kind == zenoh.SampleKind.PUT
            (self.alive.add if found else self.alive.discard)(str(sample.key_expr).split("/")[1])
            self.changed.notify_all()

    def on_frame(self, sample: Any) -> None:
        with self.changed:
            name = str(sample.key_expr).split("/")[1]
            self.frames[name] = self.frames.get(name, 0) + 1
            self.changed.notify_all()

    def tokens(self, count: str) -> float:
        start = time.monotonic()
        with self.changed:
            assert self.changed.wait_for(lambda: len(self.alive) == int(count), TIMEOUT), sorted(self.alive)
        return time.monotonic() - start

    def wait_for_frames(self, *names: str) -> float:
        start = time.monotonic()
        with self.changed:
            self.frames.clear()
            assert self.changed.wait_for(lambda: set(names) <= self.frames.keys(), TIMEOUT), self.frames
        return time.monotonic() - start

    def arm(self, *names: str) -> dict[str, Any]:
        """Send each command until it is answered, with one id; return the attempts and the answers."""
        found: dict[str, Any] = {}

        def run(name: str) -> None:
            key = f"mavstack/{name}/command/arm?id=arm-{name}"
            for attempt in range(1, 20):
                start = time.monotonic()
                replies = list(self.session.get(key, payload=b"", timeout=ATTEMPT_TIMEOUT))
                if replies and replies[0].ok is not None:
                    found[name] = [attempt, json.loads(bytes(replies[0].ok.payload))["ok"]]
                    return
                time.sleep(max(0.0, 1.0 - (time.monotonic() - start)))

        threads = [threading.Thread(target=run, args=(name,)) for name in names]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(TIMEOUT)
        return found


def main() -> None:
    station = Station()
    print(json.dumps("ready"), flush=True)
    calls: dict[str, Any] = {"tokens": station.tokens, "frames": station.wait_for_frames, "arm": station.arm}
    for line in sys.stdin:
        name, *words = line.split()
        print(json.dumps(calls[name](*words)), flush=True)


if __name__ == "__main__":
    main()
