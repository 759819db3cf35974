// The conformance runner of gomavlib, with its own definitions of common.
package main

import (
	"bufio"
	"bytes"
	"encoding/binary"
	"encoding/hex"
	"fmt"
	"io"
	"os"
	"reflect"
	"regexp"
	"strconv"
	"strings"

	"github.com/bluenviron/gomavlib/v3/pkg/dialect"
	"github.com/bluenviron/gomavlib/v3/pkg/dialects/common"
	"github.com/bluenviron/gomavlib/v3/pkg/frame"
	"github.com/bluenviron/gomavlib/v3/pkg/message"
)

var (
	messages = dialect.ReadWriter{Dialect: common.Dialect}
	upper    = regexp.MustCompile("([A-Z])")
	sizes    = map[string]int{"int8": 1, "uint8": 1, "uint16": 2, "uint32": 4, "int32": 4, "uint64": 8}
)

func main() {
	if err := messages.Initialize(); err != nil {
		panic(err)
	}
	input := bufio.NewScanner(os.Stdin)
	input.Buffer(nil, 1<<24)
	output := bufio.NewWriter(os.Stdout)
	defer output.Flush()
	for input.Scan() {
		run(strings.Split(input.Text(), " "), output)
	}
}

func run(words []string, output *bufio.Writer) {
	data, _ := hex.DecodeString(words[3])
	reader := frame.Reader{ByteReader: bytes.NewReader(data), DialectRW: &messages}
	if words[1] != "-" {
		key, _ := hex.DecodeString(words[1])
		reader.InKey = frame.NewV2Key(key)
	}
	if err := reader.Initialize(); err != nil {
		panic(err)
	}
	for {
		packet, err := reader.Read()
		if err == io.EOF {
			break
		}
		if err == nil {
			show(packet, reader.InKey, output)
		}
	}
	fmt.Fprintf(output, "end %s\n", words[0])
}

func show(packet frame.Frame, key *frame.V2Key, output *bufio.Writer) {
	known := messages.GetMessage(packet.GetMessage().GetID())
	if known == nil {
		return
	}
	version, signed := 1, 0
	v2, isV2 := packet.(*frame.V2Frame)
	if isV2 {
		version = 2
		if v2.IsSigned() {
			signed = 1
		}
	}
	name := strings.TrimPrefix(reflect.TypeOf(packet.GetMessage()).Elem().Name(), "Message")
	name = strings.ToUpper(upper.ReplaceAllString(name, "_${1}")[1:])
	fmt.Fprintf(output, "packet %s %d %d %d %d %d %d%s\n", name, packet.GetMessage().GetID(), version,
		packet.GetSequenceNumber(), packet.GetSystemID(), packet.GetComponentID(), signed, fields(packet.GetMessage()))
	fmt.Fprintf(output, "packed %s %x\n", name, packed(packet, known, key))
}

func fields(of message.Message) string {
	var text strings.Builder
	value := reflect.ValueOf(of).Elem()
	for i := 0; i < value.NumField(); i++ {
		field := value.Type().Field(i)
		name := field.Tag.Get("mavname")
		if name == "" {
			name = strings.ToLower(upper.ReplaceAllString(field.Name, "_${1}")[1:])
		}
		fmt.Fprintf(&text, " %s=%x", name, bytesOf(value.Field(i), field.Tag))
	}
	return text.String()
}

// bytesOf returns the little-endian bytes of a value; an enum has more bytes than its field.
func bytesOf(value reflect.Value, tag reflect.StructTag) []byte {
	if value.Kind() == reflect.String {
		length, err := strconv.Atoi(tag.Get("mavlen"))
		if err != nil {
			length = 1
		}
		return append([]byte(value.String()), make([]byte, length)...)[:length]
	}
	var raw bytes.Buffer
	if err := binary.Write(&raw, binary.LittleEndian, value.Interface()); err != nil {
		panic(err)
	}
	size, isEnum := sizes[tag.Get("mavenum")]
	if !isEnum {
		return raw.Bytes()
	}
	var kept []byte
	for start := 0; start < raw.Len(); start += 8 {
		kept = append(kept, raw.Bytes()[start:start+size]...)
	}
	return kept
}

func packed(packet frame.Frame, known *message.ReadWriter, key *frame.V2Key) []byte {
	switch packet := packet.(type) {
	case *frame.V1Frame:
		packet.Message = known.Write(packet.Message, false)
		packet.Checksum = packet.GenerateChecksum(known.CRCExtra())
	case *frame.V2Frame:
		packet.Message = known.Write(packet.Message, true)
		packet.CompatibilityFlag = 0
		if key == nil {
			packet.IncompatibilityFlag, packet.Signature = 0, nil
		}
		packet.Checksum = packet.GenerateChecksum(known.CRCExtra())
		if packet.Signature != nil {
			packet.Signature = packet.GenerateSignature(key)
		}
	}
	var data bytes.Buffer
	writer := frame.Writer{ByteWriter: &data, DialectRW: &messages, OutVersion: frame.V2, OutSystemID: 1}
	if err := writer.Initialize(); err != nil {
		panic(err)
	}
	if err := writer.Write(packet); err != nil {
		panic(err)
	}
	return data.Bytes()
}
