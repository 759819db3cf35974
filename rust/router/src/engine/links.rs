//! The links of the endpoints, and the sink that the router sends to.

use crate::engine::queue::QueueLink;
use crate::engine::stream::StreamLink;
use crate::engine::udp::UdpLink;
use crate::event::EndpointNumber;
use crate::ports::PortId;
use crate::router::{Origin, QueueFull, Sink, Unsent};
use slab::Slab;
use std::net::SocketAddr;

/// Bytes that a peer which answered nothing may get for each byte that it sent, as in QUIC (RFC 9000, 8.1).
pub const AMPLIFICATION: usize = 3;

/// The transport of one endpoint.
#[derive(Debug)]
pub enum Transport {
    Udp(UdpLink),
    Stream(StreamLink),
    Queue(QueueLink),
}

/// One endpoint's link.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct Link {
    pub number: EndpointNumber,
    /// Index of the endpoint in the router.
    pub endpoint: usize,
    pub transport: Transport,
    /// It has its ports, and is read.
    pub is_started: bool,
    /// It is removed when it is read to its end.
    pub is_closing: bool,
    /// It is in the list of links that may have something to read.
    pub is_ready: bool,
    /// It is in the list of links with something to send.
    is_dirty: bool,
    /// Something became readable for the program.
    pub became_readable: bool,
    /// The transport accepts no more bytes until it is writable again.
    pub is_blocked: bool,
}

/// Where packets for a port go to.
#[derive(Clone, Copy, Debug)]
struct Destination {
    link: usize,
    address: Option<SocketAddr>,
    /// The bytes that a peer which answered nothing so far may get; `None`: any number.
    allowance: Option<Allowance>,
}

/// The bytes that a peer may get before it answers: an invented sender must not have more sent to its victim.
#[derive(Clone, Copy, Debug, Default)]
struct Allowance {
    bytes: usize,
    has_sent: bool,
}

/// All links.
#[derive(Debug, Default)]
pub struct Links {
    pub all: Slab<Link>,
    ports: Vec<Option<Destination>>,
    dirty: Vec<usize>,
    /// The packet that is routed came alone in this turn: no other is sent with it.
    pub is_alone: bool,
}

impl Links {
    pub fn insert(&mut self, number: EndpointNumber, endpoint: usize, transport: Transport) -> usize {
        self.all.insert(Link {
            number,
            endpoint,
            transport,
            is_started: false,
            is_closing: false,
            is_ready: false,
            is_dirty: false,
            became_readable: false,
            is_blocked: false,
        })
    }

    pub fn connect_port(&mut self, port: PortId, link: usize, address: Option<SocketAddr>) {
        if self.ports.len() <= port {
            self.ports.resize(port + 1, None);
        }
        self.ports[port] = Some(Destination { link, address, allowance: None });
    }

    /// Limits what a new peer gets, until [`Links::lift`].
    pub fn limit(&mut self, port: PortId) {
        if let Some(Some(place)) = self.ports.get_mut(port) {
            place.allowance = Some(Allowance::default());
        }
    }

    /// Notes that a peer sent a datagram.
    #[inline]
    pub fn earn(&mut self, port: PortId, bytes: usize) {
        if let Some(Some(Destination { allowance: Some(allowance), .. })) = self.ports.get_mut(port) {
            allowance.bytes += AMPLIFICATION * bytes;
        }
    }

    /// Returns whether something was sent to a new peer that it could answer.
    #[must_use]
    pub fn has_sent(&self, port: PortId) -> bool {
        let place = self.ports.get(port).copied().flatten();
        place.is_some_and(|place| place.allowance.is_none_or(|allowance| allowance.has_sent))
    }

    /// Ends the limit of a peer.
    pub fn lift(&mut self, port: PortId) {
        if let Some(Some(place)) = self.ports.get_mut(port) {
            place.allowance = None;
        }
    }

    /// The link and the address of a peer.
    #[must_use]
    pub fn peer_of(&self, port: PortId) -> Option<(usize, SocketAddr)> {
        let place = self.ports.get(port).copied().flatten()?;
        Some((place.link, place.address?))
    }

    pub fn disconnect_port(&mut self, port: PortId) {
        if let Some(known) = self.ports.get_mut(port) {
            *known = None;
        }
    }

    /// The ports of a link.
    #[must_use]
    pub fn ports_of(&self, link: usize) -> Vec<PortId> {
        let is_of = |place: &Option<Destination>| place.is_some_and(|place| place.link == link);
        self.ports.iter().enumerate().filter(|(_, place)| is_of(place)).map(|(port, _)| port).collect()
    }

    /// Takes the links with something to send.
    pub fn take_dirty(&mut self) -> Vec<usize> {
        let dirty = std::mem::take(&mut self.dirty);
        for &link in &dirty {
            if let Some(link) = self.all.get_mut(link) {
                link.is_dirty = false;
            }
        }
        dirty
    }

    /// Returns the memory of a list from [`Links::take_dirty`].
    pub fn return_dirty(&mut self, mut dirty: Vec<usize>) {
        if self.dirty.is_empty() {
            dirty.clear();
            self.dirty = dirty;
        }
    }
}

impl Sink for Links {
    #[inline]
    fn send(&mut self, port: PortId, packet: &[u8], origin: Origin) -> Result<(), Unsent> {
        let place = self.ports.get_mut(port).and_then(Option::as_mut).ok_or(QueueFull)?;
        if let Some(allowance) = &mut place.allowance {
            if !origin.is_urgent || packet.len() > allowance.bytes {
                return Err(Unsent::Unanswered);
            }
            *allowance = Allowance { bytes: allowance.bytes - packet.len(), has_sent: true };
        }
        let link = self.all.get_mut(place.link).ok_or(QueueFull)?;
        match &mut link.transport {
            Transport::Udp(udp) if self.is_alone => {
                if !udp.send_alone(packet, place.address, origin)? {
                    return Ok(());
                }
            }
            Transport::Udp(udp) => udp.send(packet, place.address, origin)?,
            Transport::Stream(stream) => stream.send(packet, origin)?,
            Transport::Queue(queue) => {
                link.became_readable |= queue.shared.send(packet, origin)?;
            }
        }
        if !link.is_dirty {
            link.is_dirty = true;
            self.dirty.push(place.link);
        }
        Ok(())
    }
}
