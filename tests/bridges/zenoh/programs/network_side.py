"""One network: a router, simulated vehicles, and their gateway. `network_side NAME FIRST COUNT [PEER]`.

It prints "ready", and at the end of its input the commands that it sent to vehicles, by system id.
"""

from __future__ import annotations

import asyncio
import json
import sys
from collections import Counter
from typing import Any

import zenoh

from mavstack.bridges.core.zenoh_session import LEASE
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.zenoh.running import fleet

PORT = 7447
COMMAND_LONG, ARM_DISARM = 76, 400
#: Bytes of a COMMAND_LONG that is repeated: its confirmation is at the end, and zeros there are cut off.
FULL_SIZE = 33


def router(peers: list[str]) -> Any:
    config = zenoh.Config()
    values = {
        "mode": "router",
        "scouting/multicast/enabled": False,
        "listen/endpoints": [f"tcp/0.0.0.0:{PORT}"],
        "connect/endpoints": peers,
        "connect/exit_on_failure": False,
        "connect/timeout_ms": -1,
        "connect/retry": {"period_init_ms": 500, "period_max_ms": 1000, "period_increase_factor": 2},
        "transport/link/tx/lease": LEASE,
    }
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


async def serve(url: str, name: str, first: int, count: int) -> None:
    commands: Counter[int] = Counter()

    def count_sent(data: bytes) -> None:
        if (
            data[7] == COMMAND_LONG
            and int.from_bytes(data[38:40], "little") == ARM_DISARM
            and data[1] < FULL_SIZE
        ):
            commands[data[40]] += 1

    names = {first + number: f"{name}{number}" for number in range(count)}
    async with fleet(url, PORT, count=count, gateway=name, names=names) as (connection, _):
        for vehicle in connection.vehicles.values():
            await vehicle.wait_until_ready()
        connection._host.sent_listeners.append(count_sent)
        print("ready", flush=True)
        await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)
        print(json.dumps(commands), flush=True)


def main() -> None:
    name, first, count, *peers = sys.argv[1:]
    simulator = BackgroundSimulator("copter", count=0)
    for number in range(int(count)):
        simulator.simulation.add("copter", system=int(first) + number)
    with router(peers), simulator:
        asyncio.run(serve(simulator.url, name, int(first), int(count)))


if __name__ == "__main__":
    main()
