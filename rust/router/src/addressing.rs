//! The fields of a payload that routing reads: target, command, boot time.

use mavstack_core::layout::{Dialect, FieldType, Layout};
use mavstack_core::parser::Packet;

const HEARTBEAT: u32 = 0;
const RADIO_STATUS: u32 = 109;
const RADIO: u32 = 166;
const SETUP_SIGNING: u32 = 256;
const SYSTEM_TIME: u32 = 2;
/// MAV_TYPE_GCS.
const STATION_TYPE: u8 = 6;
/// COMMAND_INT and COMMAND_LONG.
pub const COMMAND_IDS: [u32; 2] = [75, 76];

/// The treatment of a message by the router.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    #[default]
    Ordinary,
    /// RADIO_STATUS: about the link on which it came, and of no use on another.
    LinkStatus,
    /// SETUP_SIGNING: carries a key in the clear, and never leaves the link on which it came.
    SigningKey,
    /// SYSTEM_TIME: its boot time falls when its sender reboots.
    BootTime,
    /// HEARTBEAT: ground stations may share an address.
    Heartbeat,
}

/// Positions of the fields of one message that routing reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Fields {
    kind: Kind,
    target_system: Option<u8>,
    target_component: Option<u8>,
    command: Option<u8>,
    boot_time: Option<u8>,
    vehicle_type: Option<u8>,
    /// It has one of these fields, unlike most telemetry.
    is_read: bool,
}

impl Fields {
    fn of(layout: &Layout) -> Self {
        let offset = |name: &str, kind: FieldType| {
            let field = layout.fields.iter().find(|field| field.name == name && field.array_length == 0);
            field.filter(|field| field.kind == kind).map(|field| field.offset)
        };
        let kind = match (layout.id, layout.name.as_str()) {
            (RADIO_STATUS, "RADIO_STATUS") | (RADIO, "RADIO") => Kind::LinkStatus,
            (SETUP_SIGNING, "SETUP_SIGNING") => Kind::SigningKey,
            (SYSTEM_TIME, "SYSTEM_TIME") => Kind::BootTime,
            (HEARTBEAT, "HEARTBEAT") => Kind::Heartbeat,
            _ => Kind::Ordinary,
        };
        let command = COMMAND_IDS.contains(&layout.id).then(|| offset("command", FieldType::U16));
        let fields = Self {
            kind,
            target_system: offset("target_system", FieldType::U8),
            target_component: offset("target_component", FieldType::U8),
            command: command.flatten(),
            boot_time: offset("time_boot_ms", FieldType::U32).filter(|_| kind == Kind::BootTime),
            vehicle_type: offset("type", FieldType::U8).filter(|_| kind == Kind::Heartbeat),
            is_read: false,
        };
        Self { is_read: fields != Self { kind, ..Self::default() }, ..fields }
    }

    /// Adds the fields of a packet to its ids. Bytes that were trimmed from its payload are zero.
    fn read(&self, packet: &Packet<'_>, ids: Summary) -> Summary {
        let payload = packet.payload();
        let byte = |offset: u8| payload.get(usize::from(offset)).copied().unwrap_or(0);
        let boot_time = |at| u32::from_le_bytes([byte(at), byte(at + 1), byte(at + 2), byte(at + 3)]);
        Summary {
            target_system: self.target_system.map_or(0, byte),
            target_component: self.target_component.map_or(0, byte),
            command: self.command.map(|offset| u16::from_le_bytes([byte(offset), byte(offset + 1)])),
            boot_time: self.boot_time.map(boot_time),
            is_station: self.vehicle_type.is_some_and(|at| byte(at) == STATION_TYPE),
            ..ids
        }
    }

    /// The fields of a message that the dialect lacks: nothing but its id is known.
    fn of_unknown(message_id: u32) -> Self {
        let kind = match message_id {
            RADIO_STATUS | RADIO => Kind::LinkStatus,
            SETUP_SIGNING => Kind::SigningKey,
            _ => Kind::Ordinary,
        };
        Self { kind, ..Self::default() }
    }
}

/// Ids and fields of one packet, for routing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    pub message_id: u32,
    pub slot: Option<u16>,
    pub kind: Kind,
    pub system: u8,
    pub component: u8,
    /// Zero if the message has no target.
    pub target_system: u8,
    pub target_component: u8,
    /// The command of a COMMAND_LONG or COMMAND_INT.
    pub command: Option<u16>,
    /// The boot time of a SYSTEM_TIME in milliseconds.
    pub boot_time: Option<u32>,
    /// A HEARTBEAT of type MAV_TYPE_GCS.
    pub is_station: bool,
}

impl Summary {
    /// True if the packet has a target or is a heartbeat: slow links keep a reserve for such packets.
    #[inline]
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        self.target_system != 0 || self.message_id == HEARTBEAT
    }
}

/// The fields of all messages of a dialect.
#[derive(Debug)]
pub struct Addressing {
    fields: Vec<Fields>,
}

impl Addressing {
    #[must_use]
    pub fn new(dialect: &Dialect) -> Self {
        Self { fields: dialect.layouts().iter().map(Fields::of).collect() }
    }

    /// Summarises a packet.
    #[inline]
    #[must_use]
    pub fn summary(&self, packet: &Packet<'_>) -> Summary {
        let header = &packet.header;
        let fields = match packet.slot {
            Some(slot) => self.fields[usize::from(slot)],
            None => Fields::of_unknown(header.message_id),
        };
        let summary = Summary {
            message_id: header.message_id,
            slot: packet.slot,
            kind: fields.kind,
            system: header.system,
            component: header.component,
            ..Summary::default()
        };
        if fields.is_read { fields.read(packet, summary) } else { summary }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{dialect, packet_bytes, parse};

    fn summary(raw: &[u8]) -> Summary {
        let dialect = dialect();
        parse(&dialect, raw, |packet| Addressing::new(&dialect).summary(packet))
    }

    #[test]
    fn targets_and_commands_are_read_and_trimmed_bytes_are_zero() {
        let mut payload = [0; 33];
        payload[28..30].copy_from_slice(&400u16.to_le_bytes());
        payload[30..32].copy_from_slice(&[2, 190]);
        let read = summary(&packet_bytes(76, &payload, (255, 190, 0)));
        assert_eq!((read.target_system, read.target_component, read.command), (2, 190, Some(400)));
        payload[31] = 0;
        let read = summary(&packet_bytes(76, &payload, (255, 190, 0)));
        assert_eq!((read.target_system, read.target_component), (2, 0));
        let read = summary(&packet_bytes(0, &[0; 9], (1, 1, 0)));
        assert_eq!((read.target_system, read.command, read.kind), (0, None, Kind::Heartbeat));
    }

    #[test]
    fn messages_of_one_link_are_recognised() {
        assert_eq!(summary(&packet_bytes(109, &[1; 9], (51, 68, 0))).kind, Kind::LinkStatus);
        assert_eq!(summary(&packet_bytes(256, &[1; 42], (255, 190, 0))).kind, Kind::SigningKey);
        let mut payload = [0; 12];
        payload[8..].copy_from_slice(&70_000u32.to_le_bytes());
        assert_eq!(summary(&packet_bytes(2, &payload, (1, 1, 0))).boot_time, Some(70_000));
    }
}
