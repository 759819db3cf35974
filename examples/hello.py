"""Encode a packet, find it in a stream of bytes, read its message."""

import mavstack
from mavstack.dialects import common

data = mavstack.encode(common.Attitude(roll=0.1, yaw=-1.5), system=1, component=1, sequence=7)

parser = mavstack.Parser(common)
for packet in parser.feed(b"noise" + data):
    match packet.message:
        case common.Attitude(roll=roll, yaw=yaw):
            print(f"system {packet.system}: roll {roll:.2f} rad, yaw {yaw:.2f} rad")

print(f"{parser.statistics.packets} packet, {parser.statistics.bad_bytes} bytes of noise")
