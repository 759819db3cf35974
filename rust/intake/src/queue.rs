//! The packets and datagrams that wait for the program, in the order of their arrival.

use mavstack_core::header::Header;
use mavstack_core::parser::Packet;
use std::collections::VecDeque;
use std::net::SocketAddr;

/// Longest sum of joined datagrams: a link may exceed the bound of its queue by as much.
const MAX_JOINED: usize = 1 << 11;
/// Packets and datagrams that wait at most, before a link is read by the program itself.
pub const MAX_WAITING: usize = 8192;

/// Packets that the program takes at once at most, about: its decisions about them count for those that come meanwhile.
pub const MAX_TAKEN: usize = 512;
/// Packets of a run.
const MAX_RUN: usize = 128;

/// Consecutive packets of one channel.
#[derive(Debug)]
pub struct PacketRun {
    pub channel: u32,
    /// They were kept as latest packets already.
    pub is_kept: bool,
    /// Time of arrival of the last one.
    pub at: f64,
    bytes: Vec<u8>,
    headers: Vec<(Header, Option<u16>, Takers)>,
}

/// The parts of the program that take a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Takers {
    pub engine: bool,
    pub listeners: bool,
}

impl Takers {
    pub const ALL: Self = Self { engine: true, listeners: true };
}

impl PacketRun {
    /// The packets, oldest first, and who takes them.
    pub fn packets(&self) -> impl Iterator<Item = (Packet<'_>, Takers)> {
        let mut start = 0;
        self.headers.iter().map(move |&(header, slot, takers)| {
            let raw = &self.bytes[start..start + header.packet_length()];
            start += raw.len();
            (Packet { raw, header, slot, timestamp: None }, takers)
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

impl Item {
    fn count(&self) -> usize {
        match self {
            Self::Packets(run) => run.headers.len(),
            Self::Datagrams(datagrams) => datagrams.count,
        }
    }
}

/// How soon the program has to look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Urgency {
    #[default]
    None,
    /// After a long rest too.
    Soon,
    /// After a short rest at most: a part of the program handles each packet.
    Prompt,
    Now,
}

/// The packets and datagrams that wait.
#[derive(Debug, Default)]
pub struct Queue {
    items: VecDeque<Item>,
    count: usize,
    pub urgency: Urgency,
    /// The urgency of the packets since the last call of `take_fresh`.
    fresh: Urgency,
    /// The program was woken and did not take anything since.
    is_announced: bool,
    /// Sockets that the program must read itself, because it did not keep up.
    overloaded: Vec<u32>,
    /// Streams that ended, with the number of the error; 0: without one.
    ended: Vec<(u32, i32)>,
    /// Streams were not read since the last `take`.
    has_blocked: bool,
}

/// The items that the program takes at once.
#[derive(Debug, Default)]
pub struct Taken {
    pub items: Vec<Item>,
    /// Sockets that the program must read itself from now on.
    pub overloaded: Vec<u32>,
    /// Streams that ended, all of whose packets were taken.
    pub ended: Vec<(u32, i32)>,
    /// Streams were not read because too much waited.
    pub had_blocked: bool,
}

impl Queue {
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.count >= MAX_WAITING
    }

    /// Returns whether streams must not be read until the program takes something.
    pub fn blocks_streams(&mut self) -> bool {
        self.has_blocked |= self.is_full();
        self.is_full()
    }

    /// Adds a packet that was kept as a latest packet, for those who take it.
    pub fn push_kept(&mut self, channel: u32, packet: &Packet<'_>, takers: Takers, urgency: Urgency, now: f64) {
        self.note(1, urgency);
        self.push_packet(channel, packet, true, takers, now);
    }

    /// Adds a packet of which the program must find out who takes it.
    pub fn push_whole(&mut self, channel: u32, packet: &Packet<'_>, now: f64) {
        self.note(1, Urgency::Prompt);
        self.push_packet(channel, packet, false, Takers::ALL, now);
    }

    fn note(&mut self, count: usize, urgency: Urgency) {
        self.count += count;
        self.urgency = self.urgency.max(urgency);
        self.fresh = self.fresh.max(urgency);
    }

    fn push_packet(&mut self, channel: u32, packet: &Packet<'_>, is_kept: bool, takers: Takers, now: f64) {
        let header = (packet.header, packet.slot, takers);
        if let Some(Item::Packets(run)) = self.items.back_mut()
            && (run.channel, run.is_kept) == (channel, is_kept)
            && run.headers.len() < MAX_RUN
        {
            run.bytes.extend_from_slice(packet.raw);
            run.headers.push(header);
            run.at = now;
            return;
        }
        let (bytes, headers) = (packet.raw.to_vec(), vec![header]);
        self.items.push_back(Item::Packets(PacketRun { channel, is_kept, at: now, bytes, headers }));
    }

    pub fn push_datagram(&mut self, socket: u32, address: SocketAddr, data: &[u8], now: f64) {
        self.note(1, Urgency::Prompt);
        if let Some(Item::Datagrams(last)) = self.items.back_mut()
            && (last.socket, last.address) == (socket, address)
            && last.data.len() + data.len() <= MAX_JOINED
        {
            last.data.extend_from_slice(data);
            last.count += 1;
            return;
        }
        self.items.push_back(Item::Datagrams(Datagrams { socket, address, data: data.to_vec(), count: 1, at: now }));
    }

    /// Removes and returns everything that waits, if a part of it is concerned; `restore` puts the rest back.
    pub fn remove_all(&mut self, is_concerned: impl Fn(&Item) -> bool) -> VecDeque<Item> {
        if !self.items.iter().any(is_concerned) {
            return VecDeque::new();
        }
        self.count = 0;
        std::mem::take(&mut self.items)
    }

    /// Puts an item that was removed to the end.
    pub fn restore(&mut self, item: Item) {
        self.count += item.count();
        self.items.push_back(item);
    }

    /// Notes that a socket is read no more.
    pub fn overload(&mut self, socket: u32) {
        self.overloaded.push(socket);
        self.urgency = Urgency::Now;
    }

    /// Notes that a stream ended.
    pub fn end(&mut self, number: u32, error: i32) {
        self.ended.push((number, error));
        self.urgency = Urgency::Now;
    }

    /// Returns the urgency of the packets since the last call.
    pub fn take_fresh(&mut self) -> Urgency {
        std::mem::take(&mut self.fresh)
    }

    /// Returns whether the program must be woken now.
    pub fn announce(&mut self) -> bool {
        self.urgency > Urgency::None && !std::mem::replace(&mut self.is_announced, true)
    }

    /// Removes and returns the first of what waits, and the sockets and streams that are read no more.
    pub fn take(&mut self) -> Taken {
        let (mut items, mut count) = (Vec::new(), 0);
        while count < MAX_TAKEN
            && let Some(item) = self.items.pop_front()
        {
            count += item.count();
            items.push(item);
        }
        self.count -= count;
        self.is_announced = self.is_waiting();
        let (mut overloaded, mut ended) = (Vec::new(), Vec::new());
        if !self.is_announced {
            self.urgency = Urgency::None;
            // After the last packet: what the program reads itself from then on is newer.
            (overloaded, ended) = (std::mem::take(&mut self.overloaded), std::mem::take(&mut self.ended));
        }
        let had_blocked = std::mem::take(&mut self.has_blocked);
        Taken { items, overloaded, ended, had_blocked }
    }

    /// Drops everything that waits.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Returns whether something is left.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        !self.items.is_empty()
    }
}
