// Parses a flight and encodes attitudes with gomavlib; prints seconds per message.
package main

import (
	"bytes"
	"fmt"
	"io"
	"os"
	"strconv"
	"time"

	"github.com/bluenviron/gomavlib/v3/pkg/dialect"
	"github.com/bluenviron/gomavlib/v3/pkg/dialects/ardupilotmega"
	"github.com/bluenviron/gomavlib/v3/pkg/frame"
)

func main() {
	data, err := os.ReadFile(os.Args[2])
	if err != nil {
		panic(err)
	}
	count, _ := strconv.Atoi(os.Args[3])
	messages := &dialect.ReadWriter{Dialect: ardupilotmega.Dialect}
	if err := messages.Initialize(); err != nil {
		panic(err)
	}
	start, done := time.Now(), 0
	if os.Args[1] == "parse" {
		done = parse(data, messages)
	} else {
		done = encode(count, messages)
	}
	if done != count {
		panic(fmt.Sprintf("counted %d of %d messages", done, count))
	}
	fmt.Println(time.Since(start).Seconds() / float64(count))
}

func parse(data []byte, messages *dialect.ReadWriter) (count int) {
	reader := &frame.Reader{ByteReader: bytes.NewReader(data), DialectRW: messages}
	if err := reader.Initialize(); err != nil {
		panic(err)
	}
	sum := float32(0)
	for {
		received, err := reader.Read()
		if err != nil {
			if err != io.EOF {
				fmt.Fprintln(os.Stderr, err)
			}
			return count
		}
		count++
		if attitude, ok := received.GetMessage().(*ardupilotmega.MessageAttitude); ok {
			sum += attitude.Roll
		}
	}
}

func encode(count int, messages *dialect.ReadWriter) int {
	writer := &frame.Writer{ByteWriter: io.Discard, DialectRW: messages, OutVersion: frame.V2, OutSystemID: 1}
	if err := writer.Initialize(); err != nil {
		panic(err)
	}
	attitude := &ardupilotmega.MessageAttitude{Yawspeed: 1.5}
	for i := 0; i < count; i++ {
		attitude.TimeBootMs = uint32(i)
		attitude.Roll = 0.5 + float32(i)
		if err := writer.WriteMessage(attitude); err != nil {
			panic(err)
		}
	}
	return count
}
