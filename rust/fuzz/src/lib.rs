//! Shared by the fuzz targets: a small dialect with MAVLink 1 messages, MAVLink 2 messages and extension fields.

use mavstack_core::encode::{Sender, Version, encode};
use mavstack_core::layout::{Dialect, Field, FieldType, Layout};
use mavstack_core::signing::{Key, Policy, Signing};

/// The dialect of all targets.
#[must_use]
pub fn dialect() -> Dialect {
    let field = |name: &str, kind, array_length, offset| Field {
        name: name.into(),
        kind,
        array_length,
        offset,
        enumerated: false,
    };
    let layout = |id, name: &str, crc_extra, base_length, length, fields| Layout {
        id,
        name: name.into(),
        crc_extra,
        base_length,
        length,
        fields,
    };
    let text = vec![field("severity", FieldType::U8, 0, 0), field("text", FieldType::Char, 50, 1)];
    let numbers = vec![field("time", FieldType::U64, 0, 0), field("values", FieldType::F32, 4, 8)];
    Dialect::new(vec![
        layout(0, "HEARTBEAT", 50, 9, 9, vec![field("custom_mode", FieldType::U32, 0, 0)]),
        layout(253, "STATUSTEXT", 83, 51, 54, text),
        layout(350, "DEBUG_FLOAT_ARRAY", 232, 24, 24, numbers),
        layout(0x00FF_FFFF, "EMPTY", 1, 0, 0, vec![]),
    ])
    .expect("a valid dialect")
}

/// A stream composed from the fuzzer's bytes: valid packets (whose checksums it could not guess), timestamps, damaged
/// packets and plain bytes.
#[must_use]
pub fn stream(mut plan: &[u8], dialect: &Dialect) -> Vec<u8> {
    let mut out = Vec::new();
    let mut signer = Signing::new(Key::new([1; 32]), 0, 0, Policy::default());
    let mut packet = Vec::new();
    while let [operation, length, rest @ ..] = plan {
        let (content, later) = rest.split_at(rest.len().min(usize::from(*length)));
        plan = later;
        if operation & 0x80 == 0 {
            out.extend_from_slice(content);
            continue;
        }
        let layout = &dialect.layouts()[usize::from(operation & 3)];
        let mut payload = content.to_vec();
        payload.resize(usize::from(layout.length), 0);
        let version = if operation & 4 == 4 { Version::V1 } else { Version::V2 };
        let sender = Sender { system: 1, component: operation & 8, sequence: *length };
        let signing = (operation & 16 == 16).then_some((&mut signer, None));
        if encode(&mut packet, version, layout, &payload, sender, signing).is_err() {
            continue;
        }
        if operation & 32 == 32 {
            out.extend_from_slice(&1_700_000_000_000_000u64.to_be_bytes());
        }
        if let Some(byte) = packet.get_mut(usize::from(*length)).filter(|_| operation & 64 == 64) {
            *byte ^= operation;
        }
        out.extend_from_slice(&packet);
    }
    out
}
