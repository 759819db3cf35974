"""Sign sent packets, and refuse forged, replayed and unsigned ones."""

import time

import mavstack
from mavstack.dialects import common

key = mavstack.SigningKey.from_passphrase("correct horse battery staple")
now = time.time()

sender = mavstack.Encoder(system=255, component=190, signing=key.signing(link_id=1))
signed = sender.encode(common.CommandLong(target_system=1, command=common.MavCmd.COMPONENT_ARM_DISARM), now)
unsigned = mavstack.encode(common.Heartbeat(), system=255, component=190)
forged = bytearray(signed)
forged[-1] ^= 1

receiver = key.signing()
parser = mavstack.Parser(common, signing=receiver)
for packet in parser.feed(signed + unsigned + forged + signed, now):
    print("accepted:", packet, packet.message.command)
print("refused: ", receiver.refusals)
