//! The router without sockets, threads and clocks: packets come in, and go out to a [`Sink`].
//!
//! A packet is forwarded as the developer guide asks: one without a target to all other ports, one with a target to the
//! ports on which the target was heard, and never back to the port from which it came. Bytes are not changed, except
//! where an endpoint verifies or makes signatures. Packets whose message is not known have no known target and go to
//! all. RADIO_STATUS and SETUP_SIGNING stay on their link.
//!
//! Endpoints of one group are redundant links to the same place: packets are not forwarded from one to another, and the
//! copies that they deliver are dropped. A packet that comes back over a redundant path, because it was sent to the port
//! on which it arrives, is reported and dropped, and teaches nothing.
//!
//! A port is a sender, and each packet is a claim on its address (see [`mavstack_core::claims`]). Only a sender that holds
//! an address, or shares it, gets the packets for it: naming oneself as a vehicle leads nothing astray. Packets of a
//! contested claim are forwarded, and reported as a conflict if it lasts; those from an address that an authenticated
//! sender holds are dropped.
//!
//! A monitor gets every accepted packet, whatever its target. It is never a route, and nothing comes from it.

use crate::addressing::{Addressing, Summary};
use crate::counters::Cause;
use crate::duplicates::Duplicates;
use crate::endpoint::Endpoint;
use crate::event::{EndpointNumber, Events, Notice};
use crate::gateway::{Admission, rewrite};
use crate::held::HeldPackets;
use crate::ports::{MAX_PORTS, PortId, PortSet};
use crate::rules::{Rules, Verdict};
use mavstack_core::claims::{Claims, Paths, Standing};
use mavstack_core::layout::Dialect;
use mavstack_core::parser::Packet;
use slab::Slab;
use std::net::SocketAddr;
use std::sync::Arc;

mod holding;
mod learning;
mod members;

/// Microseconds within which a packet that comes back is recognised, and a copy on a link of its group.
const COPY_WINDOW: u64 = 1_000_000;

/// The current time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Time {
    /// Monotonic, in microseconds.
    pub now: u64,
    /// As a signing timestamp.
    pub signing: u64,
}

/// The reason why a packet cannot be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueFull;

/// The reason why a packet is not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsent {
    QueueFull,
    /// The peer answered nothing so far, and got as much as it may get.
    Unanswered,
}

impl From<QueueFull> for Unsent {
    fn from(_: QueueFull) -> Self {
        Self::QueueFull
    }
}

/// The endpoint that a packet came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Its index.
    pub endpoint: usize,
    /// The packet has a target, or is a heartbeat.
    pub is_urgent: bool,
}

/// Where packets go to.
pub trait Sink {
    /// Sends the bytes of one packet to a port.
    fn send(&mut self, port: PortId, packet: &[u8], origin: Origin) -> Result<(), Unsent>;
}

/// The conclusion from a packet of a peer that is not proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// It was accepted.
    Accepted,
    /// It may answer something that was sent to the peer.
    Answered,
    /// Its signature is valid.
    Verified,
}

/// The stage of a peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// No packet of it was accepted: it gets nothing.
    Refused,
    /// It gets only urgent packets, in proportion to its own, since its address may be invented.
    Accepted,
    /// It answered something, or has a key.
    Proven,
}

/// A place that packets come from and go to.
#[derive(Clone, Copy, Debug)]
struct Port {
    endpoint: usize,
    stage: Stage,
    /// The remote address, of a peer of a listening socket.
    peer: Option<SocketAddr>,
    /// Packets of it that were accepted.
    accepted: u64,
    /// Never used again, unlike the index.
    serial: u64,
}

/// The ports as senders: those of one endpoint are peers of one socket, and a group has redundant links.
struct Senders<'a> {
    ports: &'a Slab<Port>,
    endpoints: &'a Slab<Endpoint>,
}

impl Paths for Senders<'_> {
    fn place(&self, sender: PortId) -> usize {
        self.ports.get(sender).map_or(usize::MAX, |port| port.endpoint)
    }

    fn shares_group(&self, one: PortId, other: PortId) -> bool {
        let endpoint = |port| self.ports.get(port).and_then(|port| self.endpoints.get(port.endpoint));
        endpoint(one).zip(endpoint(other)).is_some_and(|(one, other)| one.shares_group(other))
    }
}

/// A packet on its way through the router.
struct Passing<'a> {
    packet: &'a Packet<'a>,
    summary: Summary,
    admission: Admission,
}

/// The state of the router.
#[derive(Debug)]
pub struct Router {
    dialect: Arc<Dialect>,
    addressing: Addressing,
    endpoints: Slab<Endpoint>,
    ports: Slab<Port>,
    /// The ports that packets without a target go to.
    open: PortSet,
    /// The ports of monitors, which get every accepted packet.
    monitors: PortSet,
    serials: u64,
    claims: Claims,
    duplicates: Duplicates,
    duplicate_window: u64,
    held: HeldPackets,
    /// Kept between packets, so that none allocates memory.
    outputs: Vec<PortId>,
    rewritten: Vec<u8>,
    /// The ports of peers that may be at a later stage now.
    progress: Vec<(PortId, Evidence)>,
    pub events: Events,
}

impl Router {
    /// Creates a router; copies of a packet on any other port are dropped within `duplicate_window` microseconds.
    #[must_use]
    pub fn new(dialect: Arc<Dialect>, duplicate_window: u64) -> Self {
        Self {
            addressing: Addressing::new(&dialect),
            dialect,
            endpoints: Slab::new(),
            ports: Slab::new(),
            open: PortSet::default(),
            monitors: PortSet::default(),
            serials: 0,
            claims: Claims::default(),
            duplicates: Duplicates::default(),
            duplicate_window,
            held: HeldPackets::default(),
            outputs: Vec::new(),
            rewritten: Vec::new(),
            progress: Vec::new(),
            events: Events::default(),
        }
    }

    #[must_use]
    pub fn dialect(&self) -> &Arc<Dialect> {
        &self.dialect
    }

    /// Routes a packet that was received on a port.
    pub fn route(&mut self, from: PortId, packet: &Packet<'_>, time: Time, sink: &mut impl Sink) {
        let summary = self.addressing.summary(packet);
        let endpoint = &mut self.endpoints[self.ports[from].endpoint];
        endpoint.count_received(&summary, packet.raw.len());
        if let Some(cause) = endpoint.keeps(&summary, packet) {
            endpoint.counters.drop_packet(cause);
            if cause == Cause::SigningKey {
                self.notice(from, Notice::SigningKey, &summary, time);
            }
            return;
        }
        let admission = match endpoint.gateway.admit(packet, time.signing) {
            Ok(admission) => admission,
            Err(refusal) => {
                let cause = Cause::from(refusal);
                return self.drop_received(from, cause, Notice::Refused(cause.name()), &summary, time);
            }
        };
        let number = endpoint.number;
        let events = &mut self.events;
        match decide(&mut endpoint.incoming, number, false, &summary, time.now, events) {
            Verdict::Pass => self.accept(from, &Passing { packet, summary, admission }, time, sink),
            Verdict::Drop(_) => endpoint.counters.drop_packet(Cause::RuleIn),
            Verdict::Inspect => self.hold(from, from, false, &Passing { packet, summary, admission }, time),
        }
    }

    /// Accepts a packet that the incoming rules pass.
    fn accept(&mut self, from: PortId, passing: &Passing<'_>, time: Time, sink: &mut impl Sink) {
        let summary = &passing.summary;
        self.ports[from].accepted += 1;
        let copy = self.copy_of(from, passing, time);
        if copy == Some(Cause::Loop) {
            return self.drop_received(from, Cause::Loop, Notice::Loop, summary, time);
        }
        if passing.admission.teaches {
            match self.hear(from, passing, time) {
                Standing::Outranked => {
                    self.duplicates.forget(passing.packet.raw, self.ports[from].serial);
                    return self.drop_received(from, Cause::Spoofed, Notice::Spoofed, summary, time);
                }
                Standing::Held | Standing::New => {}
                standing => self.note_other(from, standing, passing, time),
            }
            if self.ports[from].stage != Stage::Proven {
                self.advance(from, passing);
            }
            if copy.is_none() {
                self.learn(from, summary, time);
            }
        }
        if let Some(cause) = copy {
            self.endpoint_of(from).counters.drop_packet(cause);
        } else {
            self.forward(from, passing, time, sink);
        }
    }

    /// Returns the cause for which a copy of an earlier packet is dropped; `None`: it is none, or is not dropped.
    fn copy_of(&mut self, from: PortId, passing: &Passing<'_>, time: Time) -> Option<Cause> {
        let serial = self.ports[from].serial;
        let window = self.duplicate_window.max(COPY_WINDOW);
        let (first, age) = self.duplicates.record(passing.packet.raw, serial, window, time.now)?;
        let first = self.ports.get(first as usize % MAX_PORTS).filter(|port| port.serial as u32 == first)?;
        let (first, here) = (&self.endpoints[first.endpoint], &self.endpoints[self.ports[from].endpoint]);
        let targets = self.targets(&passing.summary);
        if first.shares_group(here) {
            Some(Cause::Duplicate)
        } else if targets.is_some_and(|ports| ports.contains(from)) {
            Some(Cause::Loop)
        } else {
            (age <= self.duplicate_window).then_some(Cause::Duplicate)
        }
    }

    /// The ports that a packet is for; `None`: its target was never heard.
    #[inline]
    fn targets(&self, summary: &Summary) -> Option<&PortSet> {
        match summary.target_system {
            0 => Some(&self.open),
            system => self.claims.routes(system, summary.target_component),
        }
    }

    fn forward(&mut self, from: PortId, passing: &Passing<'_>, time: Time, sink: &mut impl Sink) {
        let source = self.ports[from].endpoint;
        let mut outputs = std::mem::take(&mut self.outputs);
        outputs.clear();
        match self.targets(&passing.summary) {
            Some(targets) => targets.append_to(&mut outputs),
            None => self.endpoint_of(from).counters.drop_packet(Cause::NoRoute),
        }
        self.monitors.append_to(&mut outputs);
        for &port in outputs.iter().filter(|&&port| port != from) {
            let index = self.ports[port].endpoint;
            if self.endpoints[index].group.is_some() && self.endpoints[index].shares_group(&self.endpoints[source]) {
                continue;
            }
            let endpoint = &mut self.endpoints[index];
            if endpoint.paused {
                endpoint.counters.drop_packet(Cause::Paused);
                continue;
            }
            let number = endpoint.number;
            let events = &mut self.events;
            match decide(&mut endpoint.outgoing, number, true, &passing.summary, time.now, events) {
                Verdict::Pass => self.send(from, port, passing, time, sink),
                Verdict::Drop(_) => endpoint.counters.drop_packet(Cause::RuleOut),
                Verdict::Inspect => self.hold(from, port, true, passing, time),
            }
        }
        self.outputs = outputs;
    }

    /// Sends a packet that the outgoing rules pass.
    #[inline]
    fn send(&mut self, from: PortId, port: PortId, passing: &Passing<'_>, time: Time, sink: &mut impl Sink) {
        let source = self.ports[from].endpoint;
        let endpoint = &mut self.endpoints[self.ports[port].endpoint];
        let (packet, summary) = (passing.packet, &passing.summary);
        if !endpoint.has_tokens(summary, packet.raw.len(), time.now) {
            return endpoint.counters.drop_packet(Cause::Rate);
        }
        let mut bytes = packet.raw;
        if endpoint.gateway.outgoing.is_some() || passing.admission.strip {
            let signing = endpoint.gateway.outgoing.as_mut();
            if !rewrite(&mut self.rewritten, packet, signing, time.signing) {
                return endpoint.counters.drop_packet(Cause::NotSent);
            }
            bytes = &self.rewritten;
        }
        let origin = Origin { endpoint: source, is_urgent: summary.is_urgent() };
        match sink.send(port, bytes, origin) {
            Ok(()) => endpoint.count_sent(summary, bytes.len()),
            Err(Unsent::QueueFull) => endpoint.counters.drop_packet(Cause::FullQueue),
            Err(Unsent::Unanswered) => endpoint.counters.drop_packet(Cause::Unanswered),
        }
    }

    fn endpoint_of(&mut self, port: PortId) -> &mut Endpoint {
        &mut self.endpoints[self.ports[port].endpoint]
    }

    #[cold]
    fn drop_received(&mut self, from: PortId, cause: Cause, notice: Notice, summary: &Summary, time: Time) {
        self.endpoint_of(from).counters.drop_packet(cause);
        self.notice(from, notice, summary, time);
    }

    fn notice(&mut self, from: PortId, notice: Notice, summary: &Summary, time: Time) {
        let number = self.endpoint_of(from).number;
        self.events.notice(number, notice, (summary.system, summary.component), summary.message_id, time.now);
    }
}

/// Decides about a packet by the rules of one direction, if there are any, and reports drops.
#[inline]
fn decide(
    rules: &mut Rules,
    endpoint: EndpointNumber,
    outgoing: bool,
    packet: &Summary,
    now: u64,
    events: &mut Events,
) -> Verdict {
    if rules.pass_all() { Verdict::Pass } else { apply(rules, endpoint, outgoing, packet, now, events) }
}

#[inline(never)]
fn apply(
    rules: &mut Rules,
    endpoint: EndpointNumber,
    outgoing: bool,
    packet: &Summary,
    now: u64,
    events: &mut Events,
) -> Verdict {
    let mut dry = None;
    let verdict = rules.decide(packet, now, |index| dry = dry.or(Some(index)));
    let dropped = if let Verdict::Drop(index) = verdict { index } else { None };
    for (index, dry_run) in dry.map(|index| (index, true)).into_iter().chain(dropped.map(|index| (index, false))) {
        if let Some(name) = rules.name_to_report(index, now) {
            let notice = Notice::Rule { index, name: name.to_owned(), outgoing, dry_run };
            events.notice(endpoint, notice, (packet.system, packet.component), packet.message_id, now);
        }
    }
    verdict
}

#[cfg(test)]
#[path = "router_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "router_claims_tests.rs"]
mod claims_tests;
