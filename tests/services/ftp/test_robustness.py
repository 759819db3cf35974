"""Random bytes from the wire never raise."""

from __future__ import annotations

from random import Random

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.services.ftp import FtpClient, FtpPayload, FtpServer, MemoryStore, Opcode
from tests.services.ftp.test_pitfalls import DATA, asked, reply
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, random_message, sent_by


@given(st.integers(0, 2**32), st.integers(0, 20))
def test_garbage_never_raises(seed, opcode) -> None:
    random = Random(seed)
    server = FtpServer(VEHICLE, MemoryStore({"f": DATA}))
    client = FtpClient(GROUND, VEHICLE)
    client.download("f", START, timeout=5)
    client.list_directory("d", START, timeout=5)
    for _ in range(10):
        message = random_message(common.FileTransferProtocol, random)
        payload = bytearray(message.payload)
        payload[3] = random.choice([opcode, 128, 129])
        payload[5] = random.choice([3, 4, 5, 15])
        payload[:2] = (
            random.choice(asked(client) or [FtpPayload(0, 0)])
            .numbered(random.randrange(65536))
            .to_bytes()[:2]
        )
        for service, source in ((server, VEHICLE), (client, VEHICLE)):
            deliver(service, common.FileTransferProtocol(payload=bytes(payload)), source, START)
            sent_by(service, START)


@given(st.data())
def test_answers_of_any_content_never_raise(data) -> None:
    client = FtpClient(GROUND, VEHICLE)
    client.download("f", START, timeout=5)
    for _ in range(6):
        for request in asked(client):
            content = data.draw(st.binary(max_size=239))
            opcode = data.draw(st.sampled_from([Opcode.ACK, Opcode.NAK]))
            reply(client, request, content, opcode=opcode, session=data.draw(st.integers(0, 2)))
