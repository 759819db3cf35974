//! Signatures at the border of an endpoint: verified and removed where packets come in, made where they leave.
//!
//! A packet without a signature to remove or to make is forwarded as it came. Any other keeps its ids, its sequence
//! number and its payload; its signature flag changes, and therefore its checksum. A MAVLink 1 packet cannot be signed,
//! so it becomes a MAVLink 2 packet where signatures are made.

use mavstack_core::crc;
use mavstack_core::encode::trimmed;
use mavstack_core::header::{FLAG_SIGNED, MAGIC_V2};
use mavstack_core::parser::Packet;
use mavstack_core::signing::{Refusal, Signing};

/// The signing of one endpoint.
#[derive(Debug, Default)]
pub struct Gateway {
    /// Verifies packets from the endpoint.
    pub incoming: Option<Signing>,
    /// Signs packets to the endpoint.
    pub outgoing: Option<Signing>,
    /// Ids of messages that are accepted unsigned, in addition to those of `incoming`.
    pub allow_unsigned: Vec<u32>,
    /// Remove the signatures that `incoming` verified.
    pub strip: bool,
}

/// The result of verifying a packet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Admission {
    /// Its signature is valid.
    pub verified: bool,
    /// Its signature is removed.
    pub strip: bool,
    /// Its source may be learned.
    pub teaches: bool,
}

impl Gateway {
    /// Verifies a packet from the endpoint; `now` is the current time as a signing timestamp.
    #[inline]
    pub fn admit(&mut self, packet: &Packet<'_>, now: u64) -> Result<Admission, Refusal> {
        let Some(signing) = &mut self.incoming else {
            return Ok(Admission { teaches: true, ..Admission::default() });
        };
        let signed = packet.header.signed();
        if !signed && self.allow_unsigned.contains(&packet.header.message_id) {
            return Ok(Admission::default());
        }
        signing.check(packet, Some(now))?;
        Ok(Admission { verified: signed, strip: signed && self.strip, teaches: signed })
    }
}

/// Replaces the content of `out` by a packet with its signature removed or, with `signing`, made again.
///
/// Returns false if nothing changes or, with `signing`, if the signing clock is at its end.
pub fn rewrite(out: &mut Vec<u8>, packet: &Packet<'_>, signing: Option<&mut Signing>, now: u64) -> bool {
    let header = &packet.header;
    if signing.is_none() && !header.signed() {
        return false;
    }
    let Some(crc_extra) = crc_extra(packet) else {
        return false;
    };
    out.clear();
    let flags = (header.incompat_flags & !FLAG_SIGNED) | if signing.is_some() { FLAG_SIGNED } else { 0 };
    // Version 1 payloads are not trimmed; those of version 2 stay as they are.
    let payload = if header.version == 1 { trimmed(packet.payload()) } else { packet.payload() };
    let [a, b, c, _] = header.message_id.to_le_bytes();
    out.extend_from_slice(&[MAGIC_V2, payload.len() as u8, flags, header.compat_flags, header.sequence]);
    out.extend_from_slice(&[header.system, header.component, a, b, c]);
    out.extend_from_slice(payload);
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &out[1..]), crc_extra);
    out.extend_from_slice(&checksum.to_le_bytes());
    signing.is_none_or(|signing| signing.sign(out, Some(now)).is_ok())
}

/// The CRC_EXTRA of a valid packet, which follows from its checksum: its message need not be known.
fn crc_extra(packet: &Packet<'_>) -> Option<u8> {
    let end = packet.header.payload().end;
    let received = u16::from_le_bytes([*packet.raw.get(end)?, *packet.raw.get(end + 1)?]);
    crc::solve_extra(crc::update(crc::INITIAL, &packet.raw[1..end]), received)
}

#[cfg(test)]
#[path = "gateway_tests.rs"]
mod tests;
