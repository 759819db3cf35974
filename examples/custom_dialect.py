"""Use a dialect of your own beside the official ones, with no code generated and nothing compiled."""

import tempfile
from pathlib import Path

import mavstack
from mavstack.dialects import common

DEFINITION = """
<mavlink>
  <include>common.xml</include>
  <messages>
    <message id="53000" name="SPRAYER_STATUS">
      <description>Reports how full the tank is and how fast it empties.</description>
      <field type="float" name="level" units="%">Fill of the tank.</field>
      <field type="float" name="flow" units="l/min">Flow through all nozzles.</field>
      <field type="uint8_t[4]" name="nozzles">Opening of each nozzle.</field>
    </message>
  </messages>
</mavlink>
"""

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "sprayer.xml"
    path.write_text(DEFINITION, "utf-8")
    sprayer = mavstack.Dialect.from_xml(path)

    status = sprayer["SPRAYER_STATUS"](level=62.5, flow=1.2, nozzles=[255, 255, 0, 0])
    encoder = mavstack.Encoder(system=1, component=158)
    stream = encoder.encode(status) + encoder.encode(common.Heartbeat(type=common.MavType.QUADROTOR))

    # A parser with the dialect reads the message; a parser without it still returns the packet.
    for packet in mavstack.Parser(sprayer).feed(stream):
        print(packet, packet.message)
    for packet in mavstack.Parser(common).feed(stream):
        print(packet, f"{len(packet.payload)} bytes of payload")
