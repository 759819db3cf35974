// Runs the conformance corpus through a generated library: the protocol is in conformance/README.md.
package main

import (
	"bufio"
	"bytes"
	"encoding/binary"
	"encoding/hex"
	"fmt"
	"os"
	"reflect"
	"strconv"
	"strings"

	mavlink "example.com/mavlink/common"
)

func main() {
	input := bufio.NewScanner(os.Stdin)
	input.Buffer(nil, 1<<24)
	output := bufio.NewWriter(os.Stdout)
	defer output.Flush()
	for input.Scan() {
		run(strings.Split(input.Text(), " "), output)
	}
}

func run(words []string, output *bufio.Writer) {
	var parser mavlink.Parser
	key := bytesOf(words[1])
	if words[1] != "-" {
		now, _ := strconv.ParseUint(words[2], 10, 64)
		parser.Signer = signer(key, 0, now, now)
	} else {
		key = nil
	}
	parser.Feed(bytesOf(words[3]))
	for {
		packet, found := parser.Next()
		if !found {
			break
		}
		print(&packet, key, output)
	}
	counters := parser.Counters
	fmt.Fprintf(output, "end %s good=%d bad_crc=%d bad_signature=%d unknown=%d\n",
		words[0], counters.Good, counters.BadCRC, counters.BadSignature, counters.Unknown)
}

func signer(key []byte, linkID uint8, timestamp, now uint64) *mavlink.Signer {
	made := mavlink.NewSigner([32]byte(key), linkID, timestamp)
	made.Clock = func() uint64 { return now }
	return made
}

func print(packet *mavlink.Packet, key []byte, output *bufio.Writer) {
	info := packet.Message.MessageInfo()
	signed := 0
	if packet.Signed {
		signed = 1
	}
	fmt.Fprintf(output, "packet %s %d %d %d %d %d %d", info.Name, info.ID, packet.Version, packet.Sequence,
		packet.SystemID, packet.ComponentID, signed)
	for i := range info.Fields {
		value := valueOf(&info.Fields[i], packet.Message.FieldValue(i))
		fmt.Fprintf(output, " %s=%x", info.Fields[i].Name, value)
	}
	encoder := mavlink.Encoder{
		SystemID:    packet.SystemID,
		ComponentID: packet.ComponentID,
		Sequence:    packet.Sequence,
		Version1:    packet.Version == 1,
	}
	if packet.Signed && key != nil {
		encoder.Signer = signer(key, packet.LinkID, packet.Timestamp-1, 0)
	}
	packed, err := encoder.AppendPacket(nil, packet.Message)
	if err != nil {
		panic(err)
	}
	fmt.Fprintf(output, "\npacked %s %x\n", info.Name, packed)
	check(packet.Message, info)
}

// check covers what no corpus shows: the table of messages, equality and text.
func check(message mavlink.Message, info *mavlink.MessageInfo) {
	text := fmt.Sprint(message)
	if mavlink.Info(info.ID) != info || !strings.HasPrefix(text, info.Name+" {") || info.New().MessageInfo() != info {
		panic(info.Name)
	}
	if !mavlink.Equal(message, message) || len(mavlink.Messages()) == 0 {
		panic(info.Name)
	}
}

// valueOf returns the little-endian bytes of a value.
func valueOf(field *mavlink.FieldInfo, value any) []byte {
	size := max(field.Length, 1) * field.Type.Size()
	if text, ok := value.(string); ok {
		return append([]byte(text), make([]byte, size-len(text))...)
	}
	if reflect.ValueOf(value).Kind() == reflect.Array && reflect.TypeOf(value).Len() != field.Length {
		panic(field.Name)
	}
	var buffer bytes.Buffer
	if err := binary.Write(&buffer, binary.LittleEndian, value); err != nil {
		panic(err)
	}
	raw := buffer.Bytes()
	if field.Enum == "" || len(raw) == size {
		return raw
	}
	return narrow(raw, max(field.Length, 1), field.Type.Size())
}

// narrow keeps the lower bytes of each element: an enum has more bytes than its field.
func narrow(raw []byte, count, size int) []byte {
	wide, kept := len(raw)/count, []byte(nil)
	for i := 0; i < count; i++ {
		kept = append(kept, raw[wide*i:wide*i+size]...)
	}
	return kept
}

func bytesOf(text string) []byte {
	decoded, _ := hex.DecodeString(text)
	return decoded
}
