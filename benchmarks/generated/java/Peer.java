// Parses a flight and encodes attitudes with mavgen's Java; prints seconds per message.

import com.MAVLink.MAVLinkPacket;
import com.MAVLink.Messages.MAVLinkMessage;
import com.MAVLink.Parser;
import com.MAVLink.common.msg_attitude;
import java.nio.file.Files;
import java.nio.file.Paths;

public final class Peer {
    public static void main(String[] arguments) throws Exception {
        byte[] data = Files.readAllBytes(Paths.get(arguments[1]));
        int count = Integer.parseInt(arguments[2]);
        boolean parses = arguments[0].equals("parse");
        System.out.println(Passes.median(() -> parses ? parse(data) : encode(count), count));
    }

    private static int parse(byte[] data) {
        Parser parser = new Parser();
        int count = 0;
        double sum = 0;
        for (byte value : data) {
            MAVLinkPacket packet = parser.mavlink_parse_char(value & 0xFF);
            if (packet != null) {
                count++;
                MAVLinkMessage message = packet.unpack();
                if (message instanceof msg_attitude) {
                    sum += ((msg_attitude) message).roll;
                }
            }
        }
        return Double.isNaN(sum) ? 0 : count;
    }

    private static int encode(int count) {
        msg_attitude attitude = new msg_attitude();
        attitude.isMavlink2 = true;
        int length = 0;
        for (int i = 0; i < count; i++) {
            attitude.time_boot_ms = i;
            attitude.roll = 0.5f + i;
            attitude.yawspeed = 1.5f;
            MAVLinkPacket packet = attitude.pack();
            packet.seq = i & 0xFF;
            length += packet.encodePacket().length;
        }
        return length > 0 ? count : 0;
    }
}
