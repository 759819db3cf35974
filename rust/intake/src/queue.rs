//! The packets and datagrams that wait for the program, in the order of their arrival.

use mavstack_core::header::Header;
use mavstack_core::parser::Packet;
use std::net::SocketAddr;

/// Longest sum of joined datagrams: a link may exceed the bound of its queue by as much.
const MAX_JOINED: usize = 1 << 11;
/// Packets and datagrams that wait at most, before a link is read by the program itself.
pub const MAX_WAITING: usize = 4096;

/// Consecutive packets of one channel.
#[derive(Debug)]
pub struct PacketRun {
    pub channel: u32,
    /// They were kept as latest packets already.
    pub is_kept: bool,
    bytes: Vec<u8>,
    headers: Vec<(Header, Option<u16>)>,
}

impl PacketRun {
    /// The packets, oldest first.
    pub fn packets(&self) -> impl Iterator<Item = Packet<'_>> {
        let mut start = 0;
        self.headers.iter().map(move |&(header, slot)| {
            let raw = &self.bytes[start..start + header.packet_length()];
            start += raw.len();
            Packet { raw, header, slot, timestamp: None }
        })
    }
}

/// Datagrams of a sender that the program parses itself; those that follow each other are joined.
#[derive(Debug)]
pub struct Datagrams {
    pub socket: u32,
    pub address: SocketAddr,
    pub data: Vec<u8>,
    pub count: usize,
    /// Time of arrival of the first one.
    pub at: f64,
}

#[derive(Debug)]
pub enum Item {
    Packets(PacketRun),
    Datagrams(Datagrams),
}

/// How soon the program has to look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Urgency {
    #[default]
    None,
    Soon,
    Now,
}

/// The packets and datagrams that wait.
#[derive(Debug, Default)]
pub struct Queue {
    items: Vec<Item>,
    count: usize,
    pub urgency: Urgency,
    /// The program was woken and did not take anything since.
    is_announced: bool,
    /// Sockets that the program must read itself, because it did not keep up.
    overloaded: Vec<u32>,
}

impl Queue {
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.count >= MAX_WAITING
    }

    pub fn push_packet(&mut self, channel: u32, packet: &Packet<'_>, is_kept: bool, urgency: Urgency) {
        self.count += 1;
        self.urgency = self.urgency.max(urgency);
        let header = (packet.header, packet.slot);
        if let Some(Item::Packets(run)) = self.items.last_mut()
            && (run.channel, run.is_kept) == (channel, is_kept)
        {
            run.bytes.extend_from_slice(packet.raw);
            run.headers.push(header);
            return;
        }
        let (bytes, headers) = (packet.raw.to_vec(), vec![header]);
        self.items.push(Item::Packets(PacketRun { channel, is_kept, bytes, headers }));
    }

    pub fn push_datagram(&mut self, socket: u32, address: SocketAddr, data: &[u8], now: f64) {
        self.count += 1;
        self.urgency = self.urgency.max(Urgency::Soon);
        if let Some(Item::Datagrams(last)) = self.items.last_mut()
            && (last.socket, last.address) == (socket, address)
            && last.data.len() + data.len() <= MAX_JOINED
        {
            last.data.extend_from_slice(data);
            last.count += 1;
            return;
        }
        self.items.push(Item::Datagrams(Datagrams { socket, address, data: data.to_vec(), count: 1, at: now }));
    }

    /// Returns whether datagrams of a sender wait.
    #[must_use]
    pub fn has_datagrams_of(&self, socket: u32, is_sender: impl Fn(SocketAddr) -> bool) -> bool {
        self.items
            .iter()
            .any(|item| matches!(item, Item::Datagrams(one) if one.socket == socket && is_sender(one.address)))
    }

    /// Notes that a socket is read no more.
    pub fn overload(&mut self, socket: u32) {
        self.overloaded.push(socket);
        self.urgency = Urgency::Now;
    }

    /// Returns whether the program must be woken now.
    pub fn announce(&mut self) -> bool {
        self.urgency > Urgency::None && !std::mem::replace(&mut self.is_announced, true)
    }

    /// Removes and returns what waits, and the sockets that the program must read itself from now on.
    pub fn take(&mut self) -> (Vec<Item>, Vec<u32>) {
        (self.count, self.urgency, self.is_announced) = (0, Urgency::None, false);
        (std::mem::take(&mut self.items), std::mem::take(&mut self.overloaded))
    }
}
