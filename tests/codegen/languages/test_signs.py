"""Negative values of signed fields with an enum keep their sign where enums are integers of their own."""

from __future__ import annotations

import subprocess

import pytest

from mavstack import encode
from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect
from tests.codegen.languages.test_csharp import compile_library, compile_program
from tests.codegen.languages.test_go import run_go
from tests.codegen.rust_crates import cargo, write_crate, write_program

pytestmark = pytest.mark.interop

#: One enum of signed and unsigned fields of all widths, single and in arrays; its entries are positive.
KINDS = ("int8_t", "int16_t", "int32_t", "uint8_t")
FIELDS = "".join(
    f'<field type="{kind}" name="{kind[:-2]}_one" enum="MODE">x</field>'
    f'<field type="{kind}[2]" name="{kind[:-2]}_many" enum="MODE">x</field>'
    for kind in KINDS
)
DIALECT = Dialect.from_xml(
    f"""<mavlink><enums><enum name="MODE"><entry name="MODE_A" value="0"/><entry name="MODE_B" value="1"/>
    </enum></enums><messages><message id="9" name="SIGNS">{FIELDS}</message></messages></mavlink>"""
)
VALUES = {"int8_t": -33, "int16_t": -20000, "int32_t": -2000000000, "uint8_t": 200}
MESSAGE = DIALECT["SIGNS"](
    **{f"{kind[:-2]}_one": value for kind, value in VALUES.items()},
    **{f"{kind[:-2]}_many": (value, -1 if value < 0 else 255) for kind, value in VALUES.items()},
)
PACKET = encode(MESSAGE, system=1, component=1)
BYTES = ", ".join(map(str, PACKET))
EXPECTED = "".join(f"{value} {-1 if value < 0 else 255}\n" for value in VALUES.values()) + "again\n"

GO = """package main

import (
	"bytes"
	"fmt"

	mavlink "example.com/mavlink/DIALECT"
)

func main() {
	data := []byte{BYTES}
	var parser mavlink.Parser
	parser.Feed(data)
	packet, _ := parser.Next()
	message := packet.Message.(*mavlink.Signs)
	fmt.Println(int64(message.Int8One), int64(message.Int8Many[1]))
	fmt.Println(int64(message.Int16One), int64(message.Int16Many[1]))
	fmt.Println(int64(message.Int32One), int64(message.Int32Many[1]))
	fmt.Println(int64(message.Uint8One), int64(message.Uint8Many[1]))
	encoder := mavlink.Encoder{SystemID: 1, ComponentID: 1}
	again, _ := encoder.AppendPacket(nil, message)
	if bytes.Equal(again, data) {
		fmt.Println("again")
	}
}
"""
RUST = """use CRATE::{Encoder, Message, Parser};

fn main() {
    let data: &[u8] = &[BYTES];
    for packet in Parser::new().push(data) {
        if let Some(Message::Signs(message)) = packet.message() {
            println!("{} {}", i64::from(message.int8_one.0), i64::from(message.int8_many[1].0));
            println!("{} {}", i64::from(message.int16_one.0), i64::from(message.int16_many[1].0));
            println!("{} {}", i64::from(message.int32_one.0), i64::from(message.int32_many[1].0));
            println!("{} {}", i64::from(message.uint8_one.0), i64::from(message.uint8_many[1].0));
            if Encoder::new(1, 1).encode(&message).unwrap().as_bytes() == data {
                println!("again");
            }
        }
    }
}
"""
CSHARP = """using System;
using System.Linq;
using Mavlink.DIALECT;

internal static class Signed
{
    private static void Main()
    {
        var data = new byte[] { BYTES };
        var parser = new Parser();
        parser.Feed(data);
        parser.TryRead(out Packet packet);
        var message = (Signs)packet.Message;
        Console.WriteLine((long)message.Int8One + " " + (long)message.Int8Many[1]);
        Console.WriteLine((long)message.Int16One + " " + (long)message.Int16Many[1]);
        Console.WriteLine((long)message.Int32One + " " + (long)message.Int32Many[1]);
        Console.WriteLine((long)message.Uint8One + " " + (long)message.Uint8Many[1]);
        if (new PacketEncoder(1, 1).Encode(message).SequenceEqual(data))
        {
            Console.WriteLine("again");
        }
    }
}
"""


def test_go(tmp_path):
    write_files(generate(make_library(DIALECT), "go"), tmp_path)
    lines = (tmp_path / "go.mod").read_text().splitlines()
    module = next(line.split()[1] for line in lines if line.startswith("module"))
    (tmp_path / "signs").mkdir()
    program = GO.replace("example.com/mavlink/DIALECT", module).replace("BYTES", BYTES)
    (tmp_path / "signs" / "main.go").write_text(program)
    run_go(tmp_path, "build", "-o", str(tmp_path / "program"), "./signs")
    assert subprocess.check_output([tmp_path / "program"], text=True) == EXPECTED


def test_rust(tmp_path):
    crate = write_crate(make_library(DIALECT), tmp_path)
    source = RUST.replace("CRATE", crate.name.replace("-", "_")).replace("BYTES", BYTES)
    cargo(write_program(crate, source), "build")
    assert subprocess.check_output([tmp_path / "target/debug/runner"], text=True) == EXPECTED


def test_csharp(tmp_path):
    write_files(generate(make_library(DIALECT), "csharp"), tmp_path / "library")
    text = next((tmp_path / "library").rglob("*.cs")).read_text("utf-8")
    namespace = text.partition("namespace Mavlink.")[2].split()[0]
    source = tmp_path / "signs.cs"
    source.write_text(CSHARP.replace("DIALECT", namespace).replace("BYTES", BYTES))
    program = compile_program(compile_library(tmp_path / "library"), source)
    assert subprocess.check_output(program, text=True) == EXPECTED
