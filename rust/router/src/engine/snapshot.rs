//! Counters and routes of an engine at one moment.

use crate::counters::Counters;
use crate::endpoint::Endpoint;
use crate::event::EndpointNumber;
use crate::router::Router;
use crate::rules::{RuleCounters, Rules};
use mavstack_core::parser::Parser;
use mavstack_core::sequence::Source;
use mavstack_core::statistics::Statistics;
use std::collections::BTreeMap;
use std::net::SocketAddr;

/// The counters of one endpoint.
#[derive(Clone, Debug, Default)]
pub struct EndpointSnapshot {
    pub number: EndpointNumber,
    pub counters: Counters,
    /// Names and counters of the rules.
    pub incoming: Vec<(String, RuleCounters)>,
    pub outgoing: Vec<(String, RuleCounters)>,
    /// Received and sent packets by message id; `None`: of messages that the dialect lacks.
    pub messages: Vec<(Option<u32>, u64, u64)>,
    pub sources: BTreeMap<(u8, u8), SourceCounts>,
    /// Totals of the received bytes.
    pub totals: Statistics,
    /// Peers of a listening socket.
    pub peers: Vec<PeerSnapshot>,
    /// Packets or bytes that wait to be sent.
    pub queued: usize,
    pub radio_status: Vec<u8>,
}

/// One peer of a listening socket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeerSnapshot {
    pub address: SocketAddr,
    /// Seconds since it was heard.
    pub age: f64,
    /// Packets of it that were accepted.
    pub accepted: u64,
    /// Bytes outside packets; 0 where signatures are verified, since anyone can send such bytes in its name.
    pub bad_bytes: u64,
}

/// The counters of one source on one endpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SourceCounts {
    pub received: u64,
    pub bytes: u64,
    pub lost: u64,
    pub late: u64,
}

impl SourceCounts {
    fn add(&mut self, source: &Source) {
        self.received += source.received;
        self.bytes += source.bytes;
        self.lost += source.lost;
        self.late += source.late;
    }
}

/// A learned address and the endpoints that lead to it.
#[derive(Clone, Debug, PartialEq)]
pub struct RouteSnapshot {
    pub system: u8,
    pub component: u8,
    pub endpoints: Vec<EndpointNumber>,
    /// An authenticated sender holds the address.
    pub verified: bool,
    /// Several senders that are no redundant links claim it.
    pub contested: bool,
    /// Seconds since it was heard.
    pub age: f64,
}

/// The state of an engine.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    pub endpoints: Vec<EndpointSnapshot>,
    pub routes: Vec<RouteSnapshot>,
    /// Events dropped because the program did not take them.
    pub dropped_events: u64,
}

impl EndpointSnapshot {
    pub(super) fn new(endpoint: &Endpoint, router: &Router) -> Self {
        let rules = |rules: &Rules| rules.counters().map(|(name, counters)| (name.to_owned(), counters)).collect();
        let layouts = router.dialect().layouts();
        let id = |slot: Option<u16>| slot.map(|slot| layouts[usize::from(slot)].id);
        Self {
            number: endpoint.number,
            counters: endpoint.counters.clone(),
            incoming: rules(&endpoint.incoming),
            outgoing: rules(&endpoint.outgoing),
            messages: endpoint.messages().map(|(slot, received, sent)| (id(slot), received, sent)).collect(),
            radio_status: endpoint.radio_status.clone(),
            ..Self::default()
        }
    }

    /// Adds what the parser of one port counted.
    pub(super) fn add_parser(&mut self, parser: &Parser) {
        self.totals.add(parser.statistics());
        for (system, component, source) in parser.sources().all() {
            self.sources.entry((system, component)).or_default().add(&source);
        }
    }
}

/// The learned routes, with the numbers of endpoints.
pub(super) fn routes(router: &Router, now: u64) -> Vec<RouteSnapshot> {
    let claims = router.claims();
    let known =
        claims.addresses().into_iter().filter_map(|address| Some((address, claims.holder(address.0, address.1)?)));
    known
        .map(|((system, component), holder)| {
            let leading = claims.claims_on(system, component).filter(|claim| claim.leads);
            let mut endpoints: Vec<_> = leading.filter_map(|claim| router.number_of(claim.sender)).collect();
            endpoints.sort_unstable();
            endpoints.dedup();
            let age = now.saturating_sub(holder.heard_at) as f64 * 1e-6;
            let contested = claims.conflict(system, component).is_some();
            let verified = holder.authority.is_authenticated();
            RouteSnapshot { system, component, endpoints, verified, contested, age }
        })
        .collect()
}
