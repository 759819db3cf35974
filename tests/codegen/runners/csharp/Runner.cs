// Runs the conformance corpus through a generated library: the protocol is in conformance/README.md.

using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Text;
using Mavlink.Common;

internal static class Runner
{
    private static readonly StringBuilder Output = new StringBuilder();

    private static void Main()
    {
        for (string line = Console.In.ReadLine(); line != null; line = Console.In.ReadLine())
        {
            Run(line.Split(' '));
        }

        using (Stream output = Console.OpenStandardOutput())
        {
            byte[] bytes = Encoding.ASCII.GetBytes(Output.ToString());
            output.Write(bytes, 0, bytes.Length);
        }
    }

    private static void Run(string[] words)
    {
        byte[] key = words[1] == "-" ? null : Bytes(words[1]);
        long now = words[2] == "-" ? 0 : long.Parse(words[2]);
        var parser = new Parser(key == null ? null : new Signing(key, 0, now, () => now));
        parser.Feed(Bytes(words[3]));
        Packet packet;
        while (parser.TryRead(out packet))
        {
            Print(packet, key);
        }

        Counters counters = parser.Counters;
        Output.Append("end ").Append(words[0]).Append(" good=").Append(counters.Good);
        Output.Append(" bad_crc=").Append(counters.BadCrc).Append(" bad_signature=").Append(counters.BadSignature);
        Output.Append(" unknown=").Append(counters.Unknown).Append('\n');
    }

    private static void Print(Packet packet, byte[] key)
    {
        MessageInfo info = packet.Message.Info;
        var header = new object[]
        {
            "packet", info.Name, info.Id, packet.Version, packet.Sequence, packet.SystemId, packet.ComponentId,
            packet.IsSigned ? 1 : 0,
        };
        Output.Append(string.Join(" ", header));
        for (int i = 0; i < info.Fields.Count; i++)
        {
            Output.Append(' ').Append(info.Fields[i].Name).Append('=');
            Hex(Value(info.Fields[i], packet.Message.GetValue(i)));
        }

        var encoder = new PacketEncoder(packet.SystemId, packet.ComponentId)
        {
            Version = packet.Version,
            Sequence = packet.Sequence,
            Signing = packet.IsSigned && key != null
                ? new Signing(key, packet.LinkId, packet.Timestamp - 1, () => 0) : null,
        };
        Output.Append("\npacked ").Append(info.Name).Append(' ');
        Hex(encoder.Encode(packet.Message));
        Output.Append('\n');
        Check(packet.Message, info);
    }

    // What no corpus shows: the table of messages, equality, text, and the reader.
    private static void Check(Message message, MessageInfo info)
    {
        Message other = Dialect.Create(info.Id);
        bool equal = message.ToPayload().SequenceEqual(other.ToPayload());
        var stream = new MemoryStream(new PacketEncoder(1, 1).Encode(message));
        if (Dialect.Info(info.Id) != info || message.Equals(other) != equal || !message.Equals((object)message)
            || !message.ToString().StartsWith(info.Name) || !Dialect.Ids.Contains(info.Id)
            || !message.Equals(new PacketReader(stream).ReadAsync().Result.Message))
        {
            throw new InvalidOperationException(info.Name);
        }
    }

    private static byte[] Value(FieldInfo field, object value)
    {
        int size = Size(field.Type);
        if (field.Type == FieldType.Char)
        {
            byte[] text = Encoding.UTF8.GetBytes((string)value);
            return text.Concat(new byte[Math.Max(field.Length, 1) - text.Length]).ToArray();
        }

        IEnumerable<object> values = field.Length == 0 ? new[] { value } : ((Array)value).Cast<object>();
        return values.SelectMany(item => Little(item, size)).ToArray();
    }

    private static IEnumerable<byte> Little(object value, int size)
    {
        if (value is Enum)
        {
            value = Convert.ChangeType(value, Enum.GetUnderlyingType(value.GetType()));
        }

        if (value is float)
        {
            return BitConverter.GetBytes((float)value);
        }

        if (value is double)
        {
            return BitConverter.GetBytes((double)value);
        }

        ulong bits = value is sbyte || value is short || value is int || value is long
            ? unchecked((ulong)Convert.ToInt64(value)) : Convert.ToUInt64(value);
        return BitConverter.GetBytes(bits).Take(size);
    }

    private static int Size(FieldType type)
    {
        return new[] { 1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 }[(int)type];
    }

    private static void Hex(byte[] bytes)
    {
        foreach (byte value in bytes)
        {
            Output.Append("0123456789abcdef"[value >> 4]).Append("0123456789abcdef"[value & 15]);
        }
    }

    private static byte[] Bytes(string hex)
    {
        return Enumerable.Range(0, hex.Length / 2).Select(i => Convert.ToByte(hex.Substring(2 * i, 2), 16)).ToArray();
    }
}
