// Parses a flight and encodes attitudes with the library of `mav gen go`; prints seconds per message.
package main

import (
	"bytes"
	"fmt"
	"io"
	"os"
	"strconv"
	"time"

	mavlink "example.com/mavlink/ardupilotmega"
)

func main() {
	data, err := os.ReadFile(os.Args[2])
	if err != nil {
		panic(err)
	}
	count, _ := strconv.Atoi(os.Args[3])
	start, done := time.Now(), 0
	if os.Args[1] == "parse" {
		done = parse(data)
	} else {
		done = encode(count)
	}
	if done != count {
		panic(fmt.Sprintf("counted %d of %d messages", done, count))
	}
	fmt.Println(time.Since(start).Seconds() / float64(count))
}

func parse(data []byte) (count int) {
	reader, sum := mavlink.NewReader(bytes.NewReader(data)), float32(0)
	for {
		packet, err := reader.ReadPacket()
		if err != nil {
			return count
		}
		count++
		if attitude, ok := packet.Message.(*mavlink.Attitude); ok {
			sum += attitude.Roll
		}
	}
}

func encode(count int) int {
	writer := mavlink.NewWriter(io.Discard, 1, 1)
	attitude := &mavlink.Attitude{Yawspeed: 1.5}
	for i := 0; i < count; i++ {
		attitude.TimeBootMs = uint32(i)
		attitude.Roll = 0.5 + float32(i)
		if err := writer.WriteMessage(attitude); err != nil {
			panic(err)
		}
	}
	return count
}
