// Runs the conformance corpus through a generated library: the protocol is in conformance/README.md.

import mavlink.common.Counters;
import mavlink.common.Dialect;
import mavlink.common.FieldInfo;
import mavlink.common.FieldType;
import mavlink.common.Message;
import mavlink.common.MessageInfo;
import mavlink.common.Packet;
import mavlink.common.PacketEncoder;
import mavlink.common.Parser;
import mavlink.common.Signing;
import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.PrintStream;
import java.lang.reflect.Array;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;
import java.util.Arrays;

final class Runner {
    private final StringBuilder out = new StringBuilder();

    public static void main(String[] arguments) throws IOException {
        BufferedReader input = new BufferedReader(new InputStreamReader(System.in, StandardCharsets.US_ASCII));
        PrintStream output = new PrintStream(System.out, false, "US-ASCII");
        for (String line = input.readLine(); line != null; line = input.readLine()) {
            Runner runner = new Runner();
            runner.run(line.split(" "));
            output.append(runner.out);
        }
        output.flush();
    }

    private void run(String[] words) {
        String name = words[0];
        byte[] key = words[1].equals("-") ? null : bytes(words[1]);
        long now = words[2].equals("-") ? 0 : Long.parseLong(words[2]);
        Parser parser = new Parser(key == null ? null : new Signing(key, 0, now, () -> now));
        parser.feed(bytes(words.length > 3 ? words[3] : ""), packet -> print(packet, key));
        Counters counters = parser.counters();
        out.append("end ").append(name).append(" good=").append(counters.good);
        out.append(" bad_crc=").append(counters.badCrc).append(" bad_signature=").append(counters.badSignature);
        out.append(" unknown=").append(counters.unknown).append('\n');
    }

    private void print(Packet packet, byte[] key) {
        MessageInfo info = packet.message.info();
        out.append("packet ").append(info.name).append(' ').append(info.id).append(' ').append(packet.version);
        out.append(' ').append(packet.sequence).append(' ').append(packet.systemId).append(' ');
        out.append(packet.componentId).append(' ').append(packet.signed ? 1 : 0);
        for (int i = 0; i < info.fields.size(); i++) {
            out.append(' ').append(info.fields.get(i).name).append('=');
            hex(value(info.fields.get(i), packet.message.get(i)));
        }
        out.append("\npacked ").append(info.name).append(' ');
        hex(packed(packet, key));
        out.append('\n');
        check(packet.message, info);
    }

    private static byte[] packed(Packet packet, byte[] key) {
        PacketEncoder encoder = new PacketEncoder(packet.systemId, packet.componentId);
        encoder.version(packet.version).sequence(packet.sequence);
        if (packet.signed && key != null) {
            encoder.signing(new Signing(key, packet.linkId, packet.timestamp - 1, () -> 0));
        }
        return encoder.encode(packet.message);
    }

    /** What no corpus shows: the table of messages, and equality. */
    private static void check(Message message, MessageInfo info) {
        Message other = Dialect.create(info.id);
        if (Dialect.info(info.id) != info || other.info() != info || !message.equals(message) || info.length < 1
                || message.equals(other) != Arrays.equals(message.payload(), other.payload())
                || !message.toString().startsWith(info.name)) {
            throw new AssertionError(info.name);
        }
    }

    private static byte[] value(FieldInfo field, Object value) {
        int count = Math.max(field.length, 1);
        ByteBuffer bytes = ByteBuffer.allocate(count * field.type.size).order(ByteOrder.LITTLE_ENDIAN);
        if (field.type == FieldType.CHAR) {
            bytes.put(((String) value).getBytes(StandardCharsets.UTF_8));
        } else if (field.length == 0) {
            put(bytes, field.type, (Number) value);
        } else {
            for (int i = 0; i < count; i++) {
                put(bytes, field.type, (Number) Array.get(value, i));
            }
        }
        return bytes.array();
    }

    private static void put(ByteBuffer bytes, FieldType type, Number value) {
        if (type == FieldType.FLOAT) {
            bytes.putFloat(value.floatValue());
        } else if (type == FieldType.DOUBLE) {
            bytes.putDouble(value.doubleValue());
        } else {
            for (int i = 0; i < type.size; i++) {
                bytes.put((byte) (value.longValue() >> 8 * i));
            }
        }
    }

    private void hex(byte[] bytes) {
        for (byte value : bytes) {
            out.append(Character.forDigit(value >> 4 & 0xF, 16)).append(Character.forDigit(value & 0xF, 16));
        }
    }

    private static byte[] bytes(String hex) {
        byte[] bytes = new byte[hex.length() / 2];
        for (int i = 0; i < bytes.length; i++) {
            bytes[i] = (byte) Integer.parseInt(hex.substring(2 * i, 2 * i + 2), 16);
        }
        return bytes;
    }
}
