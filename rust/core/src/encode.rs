//! Packets from payloads.

use crate::crc;
use crate::header::{CHECKSUM, FLAG_SIGNED, HEADER_V2, MAGIC_V1, MAGIC_V2};
use crate::layout::{Layout, MAX_PAYLOAD};
use crate::signing::Signing;
use std::fmt;

/// Protocol version of a packet to encode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    V1,
    V2,
}

/// Ids of the sender of a packet, and its sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender {
    pub system: u8,
    pub component: u8,
    pub sequence: u8,
}

/// The reason why a message cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The message id does not fit the one byte of version 1.
    IdNeedsV2(u32),
    /// The signing clock has reached its last timestamp.
    ClockExhausted,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IdNeedsV2(id) => write!(formatter, "message id {id} is over 255 and needs MAVLink 2"),
            Self::ClockExhausted => formatter.write_str("the signing clock is at the end of its 48 bits"),
        }
    }
}

impl std::error::Error for EncodeError {}

/// Returns `payload` without its trailing zero bytes; the first byte is always kept.
#[inline]
#[must_use]
pub fn trimmed(payload: &[u8]) -> &[u8] {
    let last = payload.iter().rposition(|&byte| byte != 0).unwrap_or(0);
    payload.get(..=last).unwrap_or(payload)
}

/// Length of an unsigned packet of version 2 with the longest payload.
pub const MAX_UNSIGNED: usize = HEADER_V2 + MAX_PAYLOAD + CHECKSUM;

/// Writes the packet of version 2 with a trimmed `payload` to the start of `out`, without a signature; returns its length.
#[inline]
pub fn write_v2(
    out: &mut [u8; MAX_UNSIGNED],
    layout: &Layout,
    payload: &[u8],
    sender: Sender,
    incompat_flags: u8,
) -> usize {
    let Sender { system, component, sequence } = sender;
    let [a, b, c, _] = layout.id.to_le_bytes();
    let end = HEADER_V2 + payload.len();
    let header = [MAGIC_V2, payload.len() as u8, incompat_flags, 0, sequence, system, component, a, b, c];
    out[..HEADER_V2].copy_from_slice(&header);
    out[HEADER_V2..end].copy_from_slice(payload);
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &out[1..end]), layout.crc_extra);
    out[end..end + CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
    end + CHECKSUM
}

/// Replaces the content of `out` by the packet that carries `payload`, the full payload of `layout`'s message.
///
/// With `signing` the packet is signed (version 2 only: version 1 has no signature).
pub fn encode(
    out: &mut Vec<u8>,
    version: Version,
    layout: &Layout,
    payload: &[u8],
    sender: Sender,
    signing: Option<(&mut Signing, Option<u64>)>,
) -> Result<(), EncodeError> {
    out.clear();
    match version {
        Version::V1 => {
            let Sender { system, component, sequence } = sender;
            let id = u8::try_from(layout.id).map_err(|_| EncodeError::IdNeedsV2(layout.id))?;
            let payload = &payload[..usize::from(layout.base_length)];
            out.extend_from_slice(&[MAGIC_V1, payload.len() as u8, sequence, system, component, id]);
            out.extend_from_slice(payload);
            let checksum = crc::accumulate(crc::update(crc::INITIAL, &out[1..]), layout.crc_extra);
            out.extend_from_slice(&checksum.to_le_bytes());
        }
        Version::V2 => {
            let flags = if signing.is_some() { FLAG_SIGNED } else { 0 };
            let mut packet = [0; MAX_UNSIGNED];
            let length = write_v2(&mut packet, layout, trimmed(payload), sender, flags);
            out.extend_from_slice(&packet[..length]);
        }
    }
    if let (Version::V2, Some((signing, now))) = (version, signing) {
        signing.sign(out, now).map_err(|_| EncodeError::ClockExhausted)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::tests::dialect;

    const SENDER: Sender = Sender { system: 1, component: 2, sequence: 7 };

    #[test]
    fn trimming_keeps_the_first_byte() {
        assert_eq!(trimmed(&[0, 0, 0]), &[0]);
        assert_eq!(trimmed(&[1, 0, 2, 0]), &[1, 0, 2]);
        assert_eq!(trimmed(&[]), &[] as &[u8]);
    }

    #[test]
    fn version_1_leaves_extensions_out_and_never_trims() {
        let dialect = dialect();
        let mut out = Vec::new();
        let layout = dialect.layout(253).expect("STATUSTEXT");
        encode(&mut out, Version::V1, layout, &[0; 54], SENDER, None).expect("fits");
        assert_eq!(out.len(), 6 + 51 + 2);
        assert_eq!(&out[..6], &[0xFE, 51, 7, 1, 2, 253]);
    }

    #[test]
    fn version_1_refuses_ids_over_255() {
        let mut layout = dialect().layouts()[0].clone();
        layout.id = 256;
        let result = encode(&mut Vec::new(), Version::V1, &layout, &[0; 9], SENDER, None);
        assert_eq!(result, Err(EncodeError::IdNeedsV2(256)));
    }
}
