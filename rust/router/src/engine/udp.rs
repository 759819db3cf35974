//! UDP endpoints: one fixed peer, or a listening socket whose senders are peers of their own.

use crate::engine::batch;
use crate::engine::datagrams::{BATCH, ReceiveBuffer, SendQueue, TURN_BYTES};
use crate::engine::peer_hasher::PeerHashers;
use crate::engine::peer_range::PeerRange;
use crate::engine::polling::REPORTS_WAITING;
use crate::ports::PortId;
use crate::router::{Origin, QueueFull};
use mio::net::UdpSocket;
use std::collections::{HashMap, HashSet};
use std::io;
use std::net::{IpAddr, SocketAddr};

/// Datagrams of a batch while few come.
const MIN_BATCH: usize = 8;
/// Microseconds since the last datagram after which the next one probably comes alone.
const ALONE_TIME: u64 = 200;

/// Microseconds of silence after which a peer with one datagram makes room for another.
const MIN_PEER_TIME: u64 = 1_000_000;

/// Peers with one datagram that get packets without a target. A flood from invented addresses would otherwise have each
/// packet sent to as many addresses as there may be peers.
pub const MAX_UNCONFIRMED: usize = 8;
/// Senders whose first packets wait for a decision, and microseconds for which they may.
const MAX_WAITING: usize = 64;
const MAX_WAITING_TIME: u64 = 5_000_000;
/// Microseconds of silence for which any peer is kept. Longer silence is allowed to a peer that was heard as long before:
/// datagrams with an invented sender must not have telemetry sent there for a minute.
const MIN_IDLE: u64 = 10_000_000;

/// The options of a UDP endpoint.
#[derive(Clone, Debug)]
pub struct UdpOptions {
    /// The only peer; `None`: every sender becomes a peer.
    pub peer: Option<SocketAddr>,
    /// Microseconds of silence after which a peer is removed.
    pub idle: u64,
    pub max_peers: usize,
    /// New peers get everything at once, whether they answer or not.
    pub trusts_senders: bool,
}

/// A sender to a listening socket.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct Peer {
    pub port: PortId,
    opened_at: u64,
    pub heard_at: u64,
    /// Datagrams came from it more than once.
    is_confirmed: bool,
    /// It gets packets without a target.
    pub is_hearing: bool,
    /// A packet of it was accepted.
    pub is_accepted: bool,
    /// Its signature was verified.
    is_verified: bool,
}

impl Peer {
    fn new(port: PortId, now: u64) -> Self {
        Self {
            port,
            opened_at: now,
            heard_at: now,
            is_confirmed: false,
            is_hearing: false,
            is_accepted: false,
            is_verified: false,
        }
    }
}

/// The result of looking a sender up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    Port(PortId),
    /// A peer that gets packets without a target from now on.
    Confirmed(PortId),
    /// A new sender, which becomes a peer if it sends a valid packet.
    New,
    Refused,
}

/// The result of accepting a sender as a peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepted {
    /// It was accepted before.
    Known,
    New,
    /// Another peer must make room.
    InPlaceOf(SocketAddr),
    /// The socket has as many peers as it may have.
    NoRoom,
}

/// A UDP socket with its peers. Times are monotonic, in microseconds.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct UdpLink {
    pub socket: UdpSocket,
    is_v6: bool,
    peer: Option<SocketAddr>,
    /// Senders other than the peer are accepted as the peer: its address stands for several.
    is_group: bool,
    is_connected: bool,
    idle: u64,
    max_peers: usize,
    pub trusts_senders: bool,
    /// Peers that are accepted; `None`: all.
    pub allowed: Option<Vec<PeerRange>>,
    /// Peers that are cut off for a time.
    pub blocked: HashSet<SocketAddr>,
    pub fixed: Option<PortId>,
    pub peers: HashMap<SocketAddr, Peer, PeerHashers>,
    pub queue: SendQueue,
    /// The system accepts no more datagrams.
    is_blocked: bool,
    /// Datagrams that are received at a time.
    batch: usize,
    received_at: u64,
    /// The system divides datagrams that are sent together.
    can_segment: bool,
    /// Datagrams that the system refused to send.
    pub refused: u64,
}

impl UdpLink {
    /// Creates a link; a socket with an ordinary peer is connected to it.
    pub fn new(socket: UdpSocket, options: UdpOptions) -> io::Result<Self> {
        let is_group = options.peer.is_some_and(|peer| match peer.ip() {
            IpAddr::V4(v4) => v4.is_multicast() || v4.octets()[3] == 255,
            IpAddr::V6(v6) => v6.is_multicast(),
        });
        let is_connected = match options.peer {
            Some(peer) if !is_group => socket.connect(peer).is_ok(),
            _ => false,
        };
        batch::accept_joined(&socket);
        Ok(Self {
            is_v6: socket.local_addr()?.is_ipv6(),
            socket,
            peer: options.peer,
            is_group,
            is_connected,
            idle: options.idle,
            max_peers: options.max_peers,
            trusts_senders: options.trusts_senders,
            allowed: None,
            blocked: HashSet::new(),
            fixed: None,
            peers: HashMap::default(),
            queue: SendQueue::default(),
            is_blocked: false,
            batch: MIN_BATCH,
            received_at: 0,
            can_segment: true,
            refused: 0,
        })
    }

    /// Receives a datagram that probably comes alone, or a batch; returns whether more may be waiting that are not reported.
    pub fn receive(&mut self, batches: &mut batch::Batches, buffer: &mut ReceiveBuffer, now: u64) -> io::Result<bool> {
        let silence = now.saturating_sub(std::mem::replace(&mut self.received_at, now));
        if REPORTS_WAITING && silence >= ALONE_TIME {
            batch::receive_one(&self.socket, buffer)?;
            return Ok(false);
        }
        batches.receive(&self.socket, self.is_v6, self.batch, buffer)?;
        let count = buffer.received.len();
        let is_full = count == self.batch;
        let bytes = buffer.received.iter().map(|(length, _)| length).sum::<usize>();
        self.batch = match count {
            _ if bytes > TURN_BYTES => (count * TURN_BYTES / bytes).max(1),
            _ if is_full => (2 * self.batch).min(BATCH),
            // The preparation of a batch costs time, also for what does not come.
            _ if count < self.batch / 4 => (self.batch / 2).max(MIN_BATCH.min(self.batch)),
            _ => self.batch,
        };
        Ok(is_full)
    }

    /// Sends a packet that came alone, or adds it to the queue; returns whether the link is to be flushed.
    ///
    /// The queue would cost it as much as the rest of its way.
    #[inline]
    pub fn send_alone(
        &mut self,
        packet: &[u8],
        address: Option<SocketAddr>,
        origin: Origin,
    ) -> Result<bool, QueueFull> {
        if self.queue.is_empty() && !self.is_blocked {
            match batch::send_one(&self.socket, packet, address) {
                Ok(()) => return Ok(false),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
                // It may belong to an earlier datagram of a connected socket; this one is not sent either way.
                Err(_) => {
                    self.refused += 1;
                    return Ok(true);
                }
            }
        }
        self.send(packet, address, origin).map(|()| true)
    }

    /// Adds a packet to the queue, which is sent first if it is full.
    #[inline]
    pub fn send(&mut self, packet: &[u8], address: Option<SocketAddr>, origin: Origin) -> Result<(), QueueFull> {
        let added = self.queue.push(packet, address, origin);
        if added.is_err() && !self.is_blocked && !self.flush() {
            return self.queue.push(packet, address, origin);
        }
        added
    }

    /// Returns the port of a sender, and notes that it was heard.
    #[inline]
    pub fn sender(&mut self, address: SocketAddr, now: u64) -> Sender {
        if let Some(fixed) = self.fixed {
            let is_peer = self.is_connected || self.is_group || self.peer == Some(address);
            return if is_peer && self.allows(&address) { Sender::Port(fixed) } else { Sender::Refused };
        }
        if !self.blocked.is_empty() && self.blocked.contains(&address) {
            return Sender::Refused;
        }
        if let Some(peer) = self.peers.get_mut(&address) {
            peer.is_confirmed |= now > peer.opened_at;
            peer.heard_at = now;
            if peer.is_confirmed && peer.is_accepted && !peer.is_hearing {
                peer.is_hearing = true;
                return Sender::Confirmed(peer.port);
            }
            return Sender::Port(peer.port);
        }
        if self.allows(&address) { Sender::New } else { Sender::Refused }
    }

    #[inline]
    fn allows(&self, address: &SocketAddr) -> bool {
        let is_allowed = self.allowed.as_ref().is_none_or(|ranges| ranges.iter().any(|range| range.contains(address)));
        is_allowed && (self.blocked.is_empty() || !self.blocked.contains(address))
    }

    /// Returns a sender that must make room for another one whose packets wait for a decision.
    #[must_use]
    pub fn make_room_to_wait(&self) -> Option<SocketAddr> {
        let waiting = || self.peers.iter().filter(|(_, peer)| !peer.is_accepted);
        let is_full = waiting().count() >= MAX_WAITING;
        is_full.then(|| waiting().min_by_key(|(_, peer)| peer.heard_at).map(|(address, _)| *address)).flatten()
    }

    /// Accepts a sender as a peer, if there is room: a verified one replaces any other that is not.
    pub fn accept(&mut self, address: &SocketAddr, is_verified: bool, now: u64) -> Accepted {
        match self.peers.get_mut(address) {
            None => return Accepted::NoRoom,
            Some(peer) => {
                peer.is_verified |= is_verified;
                if peer.is_accepted {
                    return Accepted::Known;
                }
            }
        }
        let unconfirmed = self.peers.values().filter(|peer| peer.is_hearing && !peer.is_confirmed).count();
        let room = self.room(address, is_verified, now);
        let Some(peer) = self.peers.get_mut(address) else {
            return Accepted::NoRoom;
        };
        if room != Accepted::NoRoom {
            peer.is_accepted = true;
            peer.is_hearing = peer.is_confirmed || unconfirmed < MAX_UNCONFIRMED;
        }
        room
    }

    fn room(&self, address: &SocketAddr, is_verified: bool, now: u64) -> Accepted {
        let accepted = || self.peers.iter().filter(|(_, peer)| peer.is_accepted);
        if accepted().count() < self.max_peers {
            return Accepted::New;
        }
        let is_weak = |peer: &Peer| !peer.is_verified && (is_verified || !peer.is_confirmed || self.is_idle(peer, now));
        let weakest = accepted().filter(|(_, peer)| is_weak(peer)).min_by_key(|(_, peer)| peer.heard_at);
        match weakest {
            Some((address, peer)) if is_verified || peer.heard_at + MIN_PEER_TIME <= now => {
                Accepted::InPlaceOf(*address)
            }
            _ => self.excess(address.ip()).map_or(Accepted::NoRoom, Accepted::InPlaceOf),
        }
    }

    /// Returns the unverified peer, silent for longest, of the address that has more than half of the places, for a
    /// peer of another address.
    fn excess(&self, newcomer: IpAddr) -> Option<SocketAddr> {
        let mut counts = HashMap::new();
        for (address, _) in self.peers.iter().filter(|(_, peer)| peer.is_accepted) {
            *counts.entry(address.ip()).or_insert(0_usize) += 1;
        }
        let (largest, count) = counts.into_iter().max_by_key(|&(_, count)| count)?;
        if largest == newcomer || count <= self.max_peers / 2 {
            return None;
        }
        let of_largest =
            |(address, peer): &(&SocketAddr, &Peer)| address.ip() == largest && peer.is_accepted && !peer.is_verified;
        self.peers.iter().filter(of_largest).min_by_key(|(_, peer)| peer.heard_at).map(|(address, _)| *address)
    }

    fn is_idle(&self, peer: &Peer, now: u64) -> bool {
        let idle = (peer.heard_at - peer.opened_at).max(MIN_IDLE).min(self.idle);
        now.saturating_sub(peer.heard_at) >= idle
    }

    /// Adds a sender, which is no peer before a packet of it is accepted.
    pub fn add_peer(&mut self, address: SocketAddr, port: PortId, now: u64) {
        self.peers.insert(address, Peer::new(port, now));
    }

    pub fn remove_peer(&mut self, address: &SocketAddr) -> Option<Peer> {
        self.peers.remove(address)
    }

    /// The peers that are silent for too long, or no longer allowed.
    #[must_use]
    pub fn expired(&self, now: u64) -> Vec<SocketAddr> {
        let is_refused = |peer: &Peer| !peer.is_accepted && now.saturating_sub(peer.opened_at) >= MAX_WAITING_TIME;
        let is_expired = |(address, peer): &(&SocketAddr, &Peer)| {
            self.is_idle(peer, now) || is_refused(peer) || !self.allows(address)
        };
        self.peers.iter().filter(is_expired).map(|(address, _)| *address).collect()
    }

    /// Returns whether there is one peer only, which is known from the start.
    #[must_use]
    pub fn has_peer(&self) -> bool {
        self.peer.is_some()
    }

    /// The address to send to for a port of the link.
    #[must_use]
    pub fn destination(&self) -> Option<SocketAddr> {
        if self.is_connected { None } else { self.peer }
    }

    /// Sends what waits; returns whether the system accepts no more.
    pub fn flush(&mut self) -> bool {
        self.is_blocked = false;
        while !self.queue.is_empty() {
            match batch::send(&self.socket, &self.queue, &mut self.can_segment) {
                Ok(count) => self.queue.remove(count.max(1)),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    self.is_blocked = true;
                    break;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                // An error belongs to the first datagram, or to an earlier one of a connected socket.
                Err(_) => {
                    self.queue.remove(1);
                    self.refused += 1;
                }
            }
        }
        self.is_blocked
    }
}

#[cfg(test)]
#[path = "udp_tests.rs"]
mod tests;
