"""The engine of Mavstack's router between ports, for the benchmark.

    python -m benchmarks.router.host LISTEN TO [--rules N] [--endpoints N]

It listens on a port of 127.0.0.1 and sends to another from `N` sockets, with `N` rules in each direction of
all endpoints. It runs until its standard input is closed.
"""

from __future__ import annotations

import argparse
import socket
import sys
from contextlib import ExitStack

from mavstack.dialects import ardupilotmega
from mavstack.router import RouterEngine, Rule, RuleSet

HOST = "127.0.0.1"
#: A rate that no load reaches, so that its bucket costs and drops nothing.
UNREACHED_RATE = 1e9
DEBUG_VECT = 250


def rule_set(count: int) -> RuleSet:
    """Return rules of all kinds, none of which drops the load."""
    commands = tuple(Rule("drop", commands=frozenset({number})) for number in range(count))
    rates = (Rule("pass", messages=frozenset({DEBUG_VECT}), rate=UNREACHED_RATE),) if count else ()
    systems = tuple(
        Rule("drop", messages=frozenset({number}), systems=frozenset({9})) for number in range(count)
    )
    return RuleSet(incoming=commands + rates, outgoing=systems)


def main() -> None:
    """Run the engine until standard input is closed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.router.host")
    parser.add_argument("listen", type=int)
    parser.add_argument("to", type=int)
    parser.add_argument("--rules", type=int, default=0)
    parser.add_argument("--endpoints", type=int, default=1)
    options = parser.parse_args()
    with RouterEngine(ardupilotmega) as engine, ExitStack() as sockets:
        ports = [options.listen, *[0] * options.endpoints]
        for index, port in enumerate(ports):
            bound = sockets.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            bound.bind((HOST, port))
            peer = (HOST, options.to) if index else None
            endpoint = engine.add_udp(bound.fileno(), name=f"endpoint {index}", peer=peer, start=False)
            engine.set_rules(endpoint, rule_set(options.rules))
            engine.start(endpoint)
        print("ready", flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
