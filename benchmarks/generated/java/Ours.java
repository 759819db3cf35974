// Parses a flight and encodes attitudes with the library of `mav gen java`; prints seconds per message.

import java.nio.file.Files;
import java.nio.file.Paths;
import mavlink.ardupilotmega.Packet;
import mavlink.ardupilotmega.PacketEncoder;
import mavlink.ardupilotmega.Parser;
import mavlink.ardupilotmega.messages.Attitude;

public final class Ours {
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
        for (int start = 0; start < data.length; start += 16384) {
            parser.feed(data, start, Math.min(16384, data.length - start));
            for (Packet packet = parser.next(); packet != null; packet = parser.next()) {
                count++;
                if (packet.message instanceof Attitude) {
                    sum += ((Attitude) packet.message).roll;
                }
            }
        }
        return Double.isNaN(sum) ? 0 : count;
    }

    private static int encode(int count) {
        PacketEncoder encoder = new PacketEncoder(1, 1);
        byte[] packet = new byte[PacketEncoder.MAX_PACKET_LENGTH];
        Attitude attitude = new Attitude();
        int length = 0;
        for (int i = 0; i < count; i++) {
            attitude.timeBootMs = i;
            attitude.roll = 0.5f + i;
            attitude.yawspeed = 1.5f;
            length += encoder.encode(attitude, packet, 0);
        }
        return length > 0 ? count : 0;
    }
}
