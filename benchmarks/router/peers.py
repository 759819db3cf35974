"""The routers of the benchmark, as commands: ours, and those of other projects that are given."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping, Sequence
    from pathlib import Path

HOST = "127.0.0.1"
LISTEN, TO = 21_000, 21_001
RULES = 50
FIREWALL = """
[endpoint.in]
url = "udpin://{host}:{listen}"
[endpoint.out]
url = "udpout://{host}:{to}"
[firewall]
default = "deny"
[[firewall.rule]]
name = "no reboot"
commands = ["PREFLIGHT_REBOOT_SHUTDOWN"]
action = "deny"
[[firewall.rule]]
name = "vehicle"
endpoints = ["in"]
from = ["127.0.0.0/8"]
systems = [1]
[[firewall.rule]]
name = "ground"
endpoints = ["out"]
from = ["127.0.0.0/8"]
systems = [255]
[firewall.detector.floods]
max_packets = 10000000
"""


@dataclass(frozen=True, slots=True)
class Router:
    """A router and how much of the load it gets.

    Attributes:
        command: The command that runs it between `LISTEN` and `TO`.
        share: Part of the packets of a turn that slow routers get.
    """

    command: Sequence[str]
    share: float = 1.0


def routers(options: argparse.Namespace, load: Path, endpoints: int) -> Mapping[str, Router]:
    """Return the routers that can join so many endpoints.

    Args:
        options: The options of the command line.
        load: The program of the load.
        endpoints: Number of endpoints that each packet goes to.
    """
    host = [sys.executable, "-m", "benchmarks.router.host", str(LISTEN), str(TO)]
    found = {"mavstack": Router([*host, "--endpoints", str(endpoints)])}
    if endpoints == 1:
        firewall = load.parent / "router-firewall.toml"
        firewall.write_text(FIREWALL.format(host=HOST, listen=LISTEN, to=TO), "utf-8")
        found = {
            "bare relay": Router([str(load), "relay", str(LISTEN), str(TO)]),
            **found,
            f"mavstack, {RULES} rules each way": Router([*host, "--rules", str(RULES)]),
            "mav route with firewall": Router([sys.executable, "-m", "mavstack", "route", str(firewall)]),
        }
    if options.mavlink_router:
        out = [word for _ in range(endpoints) for word in ("-e", f"{HOST}:{TO}")]
        found["mavlink-router"] = Router([options.mavlink_router, "-t", "0", *out, f"{HOST}:{LISTEN}"])
    if options.mavp2p:
        out = [f"udpc:{HOST}:{TO}"] * endpoints
        found["mavp2p"] = Router([options.mavp2p, "--hb-disable", f"udps:{HOST}:{LISTEN}", *out], 0.3)
    if options.mavproxy and endpoints == 1:
        links = [f"--master=udpin:{HOST}:{LISTEN}", f"--out=udpout:{HOST}:{TO}"]
        quiet = ["--daemon", "--non-interactive", "--state-basedir=/tmp", "--default-modules=link"]
        found["MAVProxy"] = Router([options.mavproxy, *links, *quiet], 0.05)
    return found
