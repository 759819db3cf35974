"""A second implementation of sealed links, slow and plain, written from the documents alone.

X25519 (RFC 7748), ChaCha20-Poly1305 (RFC 8439), HKDF and the two handshakes step by step. Only ML-KEM-768 is
taken from the library: its secret is recovered from the seed of the vectors.
"""

from __future__ import annotations

import hmac
import struct
from hashlib import sha256

from cryptography.hazmat.primitives.asymmetric.mlkem import MLKEM768PrivateKey

P = 2**255 - 19


def x25519(secret: bytes, public: bytes = bytes((9,)).ljust(32, b"\0")) -> bytes:
    scalar = int.from_bytes(secret, "little") & ~7 & (1 << 255) - 1 | 1 << 254
    x1 = int.from_bytes(public, "little") & (1 << 255) - 1
    x2, z2, x3, z3, swap = 1, 0, x1, 1, 0
    for position in range(254, -1, -1):
        bit = scalar >> position & 1
        if swap ^ bit:
            x2, x3, z2, z3 = x3, x2, z3, z2
        swap = bit
        a, b, c, d = x2 + z2, x2 - z2, x3 + z3, x3 - z3
        aa, bb, da, cb = a * a, b * b, d * a, c * b
        e = aa - bb
        x3, z3 = (da + cb) ** 2 % P, x1 * (da - cb) ** 2 % P
        x2, z2 = aa * bb % P, e * (aa + 121665 * e) % P
    if swap:
        x2, z2 = x3, z3
    return (x2 * pow(z2, P - 2, P) % P).to_bytes(32, "little")


def chacha20(key: bytes, counter: int, nonce: bytes) -> bytes:
    start = [*struct.unpack("<4I", b"expand 32-byte k"), *struct.unpack("<8I", key), counter]
    start += struct.unpack("<3I", nonce)
    state = list(start)

    def quarter(a, b, c, d):
        for left, right, rotation in ((a, (b, d), 16), (c, (d, b), 12), (a, (b, d), 8), (c, (d, b), 7)):
            state[left] = state[left] + state[right[0]] & 0xFFFFFFFF
            mixed = state[right[1]] ^ state[left]
            state[right[1]] = (mixed << rotation | mixed >> 32 - rotation) & 0xFFFFFFFF

    for _ in range(10):
        for column in range(4):
            quarter(column, column + 4, column + 8, column + 12)
        for column in range(4):
            quarter(column, (column + 1) % 4 + 4, (column + 2) % 4 + 8, (column + 3) % 4 + 12)
    return struct.pack("<16I", *((a + b) & 0xFFFFFFFF for a, b in zip(state, start, strict=True)))


def _tag(key: bytes, nonce: bytes, sealed: bytes, header: bytes) -> bytes:
    one_time = chacha20(key, 0, nonce)[:32]
    r = int.from_bytes(one_time[:16], "little") & 0x0FFFFFFC0FFFFFFC0FFFFFFC0FFFFFFF
    total = 0
    padded = header + bytes(-len(header) % 16) + sealed + bytes(-len(sealed) % 16)
    padded += struct.pack("<QQ", len(header), len(sealed))
    for start in range(0, len(padded), 16):
        total = (total + int.from_bytes(padded[start : start + 16] + b"\1", "little")) * r % (2**130 - 5)
    return ((total + int.from_bytes(one_time[16:], "little")) % 2**128).to_bytes(16, "little")


def seal(key: bytes, counter: int, plain: bytes, header: bytes) -> bytes:
    nonce = bytes(4) + struct.pack("<Q", counter)
    stream = b"".join(chacha20(key, 1 + block, nonce) for block in range(len(plain) // 64 + 1))
    sealed = bytes(a ^ b for a, b in zip(plain, stream, strict=False))
    return sealed + _tag(key, nonce, sealed, header)


def open_(key: bytes, counter: int, sealed: bytes, header: bytes) -> bytes:
    body = sealed[:-16]
    assert _tag(key, bytes(4) + struct.pack("<Q", counter), body, header) == sealed[-16:]
    return seal(key, counter, body, header)[:-16]


def hkdf(chain: bytes, secret: bytes, count: int) -> list[bytes]:
    key, outputs = hmac.digest(chain, secret, sha256), [b""]
    for number in range(count):
        outputs.append(hmac.digest(key, outputs[-1] + bytes((number + 1,)), sha256))
    return outputs[1:]


def transcript_keys(vector: dict[str, str]) -> tuple[bytes, bytes]:
    """Check both messages of a vector; return the keys of the initiator and of the responder for sending."""
    get = {name: bytes.fromhex(text) for name, text in vector.items() if name not in ("suite", "name")}
    name, (first, second) = vector["suite"].encode(), (get["first"], get["second"])
    hybrid, pinned = b"MLKEM" in name, b"_IK" in name
    h = ck = name.ljust(32, b"\0") if len(name) <= 32 else sha256(name).digest()
    h = sha256(h + get["prologue"]).digest()
    ei, er = get["initiator_ephemeral"], get["responder_ephemeral"]
    kem = MLKEM768PrivateKey.from_seed_bytes(get["kem_seed"]) if hybrid else None
    k, n = b"", 0

    def read(sealed: bytes) -> bytes:
        nonlocal h, n
        plain = open_(k, n, sealed, h) if k else sealed
        h, n = sha256(h + sealed).digest(), n + bool(k)
        return plain

    def mix(secret: bytes) -> None:
        nonlocal ck, k, n
        (ck, k), n = hkdf(ck, secret, 2), 0

    def mix_ephemeral(public: bytes) -> None:
        nonlocal h
        h = sha256(h + public).digest()
        if not pinned:
            mix(public)

    if pinned:
        si, sr = get["initiator_static"], get["responder_static"]
        h = sha256(h + x25519(sr)).digest()
    else:
        ck, mixed, k = hkdf(ck, get["shared_key"], 3)
        h = sha256(h + mixed).digest()
    assert first[:32] == x25519(ei)
    mix_ephemeral(first[:32])
    rest = first[32:]
    if kem is not None:
        size = 1184 + (0 if pinned else 16)
        assert read(rest[:size]) == kem.public_key().public_bytes_raw()
        rest = rest[size:]
    if pinned:
        mix(x25519(ei, x25519(sr)))
        assert read(rest[:48]) == x25519(si)
        rest = rest[48:]
        mix(x25519(si, x25519(sr)))
    assert read(rest) == b""
    assert second[:32] == x25519(er)
    mix_ephemeral(second[:32])
    mix(x25519(er, x25519(ei)))
    rest = second[32:]
    if kem is not None:
        mix(kem.decapsulate(read(rest[:1104])))
        rest = rest[1104:]
    if pinned:
        mix(x25519(er, x25519(si)))
    assert read(rest) == b""
    one, two = hkdf(ck, b"", 2)
    return one, two
