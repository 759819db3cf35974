//! Shared by the tests: a dialect of the messages that routing knows, and packets of it.

use mavstack_core::encode::{Sender, Version, encode};
use mavstack_core::layout::{Dialect, Field, FieldType, Layout};
use mavstack_core::parser::{Packet, Parser};

fn field(name: &str, kind: FieldType, offset: u8) -> Field {
    Field { name: name.into(), kind, array_length: 0, offset, enumerated: false }
}

fn layout(id: u32, name: &str, crc_extra: u8, base_length: u8, fields: Vec<Field>) -> Layout {
    Layout { id, name: name.into(), crc_extra, base_length, length: base_length, fields }
}

/// HEARTBEAT, SYSTEM_TIME, COMMAND_INT, COMMAND_LONG, RADIO_STATUS and SETUP_SIGNING.
pub fn dialect() -> Dialect {
    let u8_at = |name: &str, offset| field(name, FieldType::U8, offset);
    let command =
        || vec![field("command", FieldType::U16, 28), u8_at("target_system", 30), u8_at("target_component", 31)];
    Dialect::new(vec![
        layout(0, "HEARTBEAT", 50, 9, vec![u8_at("type", 4)]),
        layout(2, "SYSTEM_TIME", 137, 12, vec![field("time_boot_ms", FieldType::U32, 8)]),
        layout(75, "COMMAND_INT", 158, 35, command()),
        layout(76, "COMMAND_LONG", 152, 33, command()),
        layout(109, "RADIO_STATUS", 185, 9, vec![u8_at("rssi", 4)]),
        layout(256, "SETUP_SIGNING", 71, 42, vec![u8_at("target_system", 40), u8_at("target_component", 41)]),
    ])
    .expect("a valid dialect")
}

/// The bytes of a packet of (system, component, sequence).
pub fn packet_bytes(id: u32, payload: &[u8], (system, component, sequence): (u8, u8, u8)) -> Vec<u8> {
    let dialect = dialect();
    let mut out = Vec::new();
    let layout = dialect.layout(id).expect("a message of the dialect");
    encode(&mut out, Version::V2, layout, payload, Sender { system, component, sequence }, None).expect("fits");
    out
}

/// The bytes of a COMMAND_LONG for a target.
pub fn command(target: (u8, u8), from: (u8, u8, u8)) -> Vec<u8> {
    let mut payload = [0; 33];
    payload[28] = 22;
    payload[30..32].copy_from_slice(&[target.0, target.1]);
    packet_bytes(76, &payload, from)
}

/// The bytes of a HEARTBEAT.
pub fn heartbeat(from: (u8, u8, u8)) -> Vec<u8> {
    packet_bytes(0, &[0, 0, 0, 0, 2, 3, 81, 3, 3], from)
}

/// Calls `use_packet` with the packet that `raw` is.
pub fn parse<T>(dialect: &Dialect, raw: &[u8], mut use_packet: impl FnMut(&Packet<'_>) -> T) -> T {
    let mut result = None;
    Parser::new(false).feed(dialect, raw, |packet| result = Some(use_packet(&packet)));
    result.expect("one packet")
}
