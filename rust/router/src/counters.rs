//! Counters: no packet is dropped without being counted.

use mavstack_core::signing::Refusal;

/// The reason why a packet was not forwarded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// By a rule or the default of the endpoint that it came from.
    RuleIn,
    /// By a rule or the default of the endpoint that it was for.
    RuleOut,
    /// By the byte rate of the endpoint that it was for.
    Rate,
    /// The queue of the endpoint that it was for was full.
    FullQueue,
    /// The system refused to send it.
    NotSent,
    Duplicate,
    /// The router's own packet, which came back.
    Loop,
    /// Its target was never heard.
    NoRoute,
    /// RADIO_STATUS, about the link on which it came.
    LinkStatus,
    /// SETUP_SIGNING.
    SigningKey,
    ListenOnly,
    Paused,
    /// From an address that is verified on another link.
    Spoofed,
    Unsigned,
    Forged,
    Replayed,
    Stale,
    Future,
    TooManyStreams,
    /// Inspected, and dropped by the program.
    Inspected,
    /// The program did not decide in time, or had too many packets to decide about.
    NotInspected,
    /// A datagram of a sender that is not the peer, or not allowed.
    OtherPeer,
    /// A datagram of a new peer, of which there are too many.
    TooManyPeers,
    /// For a new peer that answered nothing so far.
    Unanswered,
}

impl Cause {
    /// All causes with their names in statistics.
    pub const ALL: [(Self, &'static str); 24] = [
        (Self::RuleIn, "rule_in"),
        (Self::RuleOut, "rule_out"),
        (Self::Rate, "rate"),
        (Self::FullQueue, "full_queue"),
        (Self::NotSent, "not_sent"),
        (Self::Duplicate, "duplicate"),
        (Self::Loop, "loop"),
        (Self::NoRoute, "no_route"),
        (Self::LinkStatus, "link_status"),
        (Self::SigningKey, "signing_key"),
        (Self::ListenOnly, "listen_only"),
        (Self::Paused, "paused"),
        (Self::Spoofed, "spoofed"),
        (Self::Unsigned, "unsigned"),
        (Self::Forged, "forged"),
        (Self::Replayed, "replayed"),
        (Self::Stale, "stale"),
        (Self::Future, "future"),
        (Self::TooManyStreams, "too_many_streams"),
        (Self::Inspected, "inspected"),
        (Self::NotInspected, "not_inspected"),
        (Self::OtherPeer, "other_peer"),
        (Self::TooManyPeers, "too_many_peers"),
        (Self::Unanswered, "unanswered"),
    ];

    /// The name in statistics.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

impl From<Refusal> for Cause {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Unsigned => Self::Unsigned,
            Refusal::Forged => Self::Forged,
            Refusal::Replayed => Self::Replayed,
            Refusal::Stale => Self::Stale,
            Refusal::Future => Self::Future,
            Refusal::TooManyStreams => Self::TooManyStreams,
        }
    }
}

/// Counters of one endpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    pub received: u64,
    pub received_bytes: u64,
    pub sent: u64,
    pub sent_bytes: u64,
    pub dropped: [u64; Cause::ALL.len()],
}

impl Counters {
    #[inline]
    pub fn drop_packet(&mut self, cause: Cause) {
        self.dropped[cause as usize] += 1;
    }

    /// Number of packets that were dropped for a cause.
    #[must_use]
    pub fn dropped(&self, cause: Cause) -> u64 {
        self.dropped[cause as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_listed_in_their_order() {
        for (index, (cause, name)) in Cause::ALL.into_iter().enumerate() {
            assert_eq!((cause as usize, cause.name()), (index, name));
        }
    }
}
