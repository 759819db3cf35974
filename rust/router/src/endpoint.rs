//! The configuration and the counters of one endpoint.

use crate::addressing::{Kind, Summary};
use crate::bucket::TokenBucket;
use crate::counters::{Cause, Counters};
use crate::event::EndpointNumber;
use crate::gateway::Gateway;
use crate::rules::Rules;
use mavstack_core::claims::Authority;
use mavstack_core::parser::Packet;

/// Seconds of its byte rate that an endpoint sends in a burst, and the shortest burst in bytes.
const BURST_TIME: f64 = 0.25;
const MIN_BURST: f64 = 1200.0;
/// The fraction of a burst that is kept for packets with a target, and for heartbeats.
const RESERVE: f64 = 0.25;

/// An endpoint: what applies to all packets of its ports.
#[derive(Debug)]
pub struct Endpoint {
    pub number: EndpointNumber,
    pub incoming: Rules,
    pub outgoing: Rules,
    /// Endpoints of one group are redundant links to the same place.
    pub group: Option<String>,
    /// Packets from it are dropped.
    pub listen_only: bool,
    /// It gets every accepted packet, and packets from it are dropped; see [`crate::router::Router::set_monitor`].
    pub(crate) monitor: bool,
    /// Packets from it and to it are dropped.
    pub paused: bool,
    pub gateway: Gateway,
    /// How the identity of its peer is proven; see [`crate::router::Router::set_authority`].
    pub(crate) authority: Authority,
    pub counters: Counters,
    /// The payload of the last RADIO_STATUS.
    pub radio_status: Vec<u8>,
    bucket: Option<TokenBucket>,
    /// Received and sent packets by slot of the dialect; the last entry counts messages that the dialect lacks.
    messages: Vec<(u64, u64)>,
}

impl Endpoint {
    /// Creates an endpoint that passes everything, for a dialect of `messages` messages.
    #[must_use]
    pub fn new(number: EndpointNumber, messages: usize) -> Self {
        Self {
            number,
            incoming: Rules::default(),
            outgoing: Rules::default(),
            group: None,
            listen_only: false,
            monitor: false,
            paused: false,
            gateway: Gateway::default(),
            authority: Authority::None,
            counters: Counters::default(),
            radio_status: Vec::new(),
            bucket: None,
            messages: vec![(0, 0); messages + 1],
        }
    }

    /// Limits the bytes per second to the endpoint; `None`: no limit.
    pub fn limit(&mut self, bytes_per_second: Option<f64>) {
        self.bucket = bytes_per_second.map(|rate| TokenBucket::new(rate, (rate * BURST_TIME).max(MIN_BURST)));
    }

    /// Returns the cause for which a packet from the endpoint goes nowhere, whatever the rules say.
    #[inline]
    pub(crate) fn keeps(&mut self, summary: &Summary, packet: &Packet<'_>) -> Option<Cause> {
        if self.paused {
            return Some(Cause::Paused);
        }
        match summary.kind {
            Kind::LinkStatus => {
                self.radio_status.clear();
                self.radio_status.extend_from_slice(packet.payload());
                Some(Cause::LinkStatus)
            }
            Kind::SigningKey => Some(Cause::SigningKey),
            _ => (self.listen_only || self.monitor).then_some(Cause::ListenOnly),
        }
    }

    /// True if both endpoints are redundant links of one group.
    #[inline]
    #[must_use]
    pub fn shares_group(&self, other: &Self) -> bool {
        self.group.is_some() && self.group == other.group
    }

    /// Takes the tokens for sending a packet of `length` bytes; returns whether there are enough.
    #[inline]
    pub fn has_tokens(&mut self, packet: &Summary, length: usize, now: u64) -> bool {
        let Some(bucket) = &mut self.bucket else {
            return true;
        };
        let reserve = if packet.is_urgent() { 0.0 } else { bucket.burst() * RESERVE };
        bucket.take(length as f64, reserve, now)
    }

    #[inline]
    pub(crate) fn count_received(&mut self, packet: &Summary, length: usize) {
        self.counters.received += 1;
        self.counters.received_bytes += length as u64;
        self.of_message(packet).0 += 1;
    }

    #[inline]
    pub(crate) fn count_sent(&mut self, packet: &Summary, length: usize) {
        self.counters.sent += 1;
        self.counters.sent_bytes += length as u64;
        self.of_message(packet).1 += 1;
    }

    #[inline]
    fn of_message(&mut self, packet: &Summary) -> &mut (u64, u64) {
        let last = self.messages.len() - 1;
        &mut self.messages[packet.slot.map_or(last, usize::from)]
    }

    /// Received and sent packets of each message that occurred, by slot; `None` for messages that the dialect lacks.
    pub fn messages(&self) -> impl Iterator<Item = (Option<u16>, u64, u64)> {
        let last = self.messages.len() - 1;
        let counted = self.messages.iter().enumerate().filter(|(_, counts)| **counts != (0, 0));
        counted.map(move |(slot, &(received, sent))| ((slot != last).then_some(slot as u16), received, sent))
    }
}
