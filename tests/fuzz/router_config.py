"""Fuzz target of router configurations: any text is a configuration or raises one RouterConfigError.

TOML and the files of mavlink-router. Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys

import atheris

with atheris.instrument_imports(include=["mavstack.router"]):
    from mavstack.errors import RouterConfigError
    from mavstack.router.config import parse_config, toml_text
    from mavstack.router.mavlink_router_config import parse_mavlink_router_config

FRAGMENTS = [
    "[router]\n",
    "[endpoint.a]\n",
    "[endpoint.b.in]\n",
    "[endpoint.b.rates]\n",
    "[[firewall.rule]]\n",
    "url = 'udpin://127.0.0.1:1'\n",
    "record = 'x.tlog'\n",
    "rate = '20 kB/s'\n",
    "max_size = 5\n",
    "duplicate_window = 0.5\n",
    "control = true\n",
    "allow_messages = ['HEARTBEAT', 5]\n",
    "deny_systems = [1]\n",
    "ATTITUDE = 4\n",
    'x = """\n',
    "[General]\n",
    "[UdpEndpoint a]\n",
    "Mode = Server\nAddress = 1.2.3.4\n",
    "Port = 1\n",
    "BlockMsgIdIn = 1,2\n",
    "= {a = [1, {b = 2}]}\n",
    '"\n',
]


def read(data: bytes) -> None:
    """Read a text of fragments and other characters, and read back what is valid."""
    text = "".join(FRAGMENTS[byte] if byte < len(FRAGMENTS) else chr(byte) for byte in data)
    try:
        if data[-1:] == b"m":
            config = parse_mavlink_router_config(text, "router.toml").config
        else:
            config = parse_config(text, "router.toml")
    except RouterConfigError as error:
        if error.path != "router.toml":
            raise RuntimeError("the error does not name the file") from error
        return
    if parse_config(toml_text(config)) != config and config.firewall is None:
        raise RuntimeError(f"changed when read back: {config}")


if __name__ == "__main__":
    atheris.Setup(sys.argv, read)
    atheris.Fuzz()
