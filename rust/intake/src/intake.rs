//! The state of the input, without sockets and clocks: times are seconds of the program's clock.

use crate::channel::{Activity, Boot, Channel, SharedParser, Source};
use crate::fields::{Continuity, Fields};
use crate::messages::{Interest, KeyMap, Messages};
use crate::queue::{Item, PacketRun, Queue, Takers, Urgency};
use mavstack_core::layout::Dialect;
use mavstack_core::parser::Packet;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, PoisonError};

/// The sender of a channel's datagrams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Peer {
    Address(SocketAddr),
    /// Any port of a host.
    Host(IpAddr),
}

impl Peer {
    fn is_sender(&self, address: SocketAddr) -> bool {
        match self {
            Self::Address(own) => *own == address,
            Self::Host(host) => *host == address.ip(),
        }
    }
}

/// The input of one node.
#[derive(Debug)]
pub struct Intake {
    dialect: Arc<Dialect>,
    fields: Fields,
    pub messages: Messages,
    pub queue: Queue,
    channels: KeyMap<u32, Channel>,
    peers: HashMap<(u32, Peer), u32>,
    /// The last sender that was looked up, with its channel: most datagrams come from the same one as that before.
    last: Option<(u32, SocketAddr, u32)>,
}

impl Intake {
    #[must_use]
    pub fn new(dialect: Arc<Dialect>, fields: Fields) -> Self {
        let (channels, peers) = (KeyMap::default(), HashMap::new());
        Self { dialect, fields, messages: Messages::default(), queue: Queue::default(), channels, peers, last: None }
    }

    /// Receives a datagram.
    pub fn receive(&mut self, socket: u32, address: SocketAddr, data: &[u8], now: f64) {
        match self.channel_of(socket, address) {
            Some(channel) => {
                self.read(channel, data, now);
            }
            None => self.queue.push_datagram(socket, address, data, now),
        }
    }

    #[inline]
    fn channel_of(&mut self, socket: u32, address: SocketAddr) -> Option<u32> {
        if let Some((_, _, channel)) = self.last.filter(|last| (last.0, last.1) == (socket, address)) {
            return Some(channel);
        }
        let known = self.peers.get(&(socket, Peer::Address(address)));
        let known = known.or_else(|| self.peers.get(&(socket, Peer::Host(address.ip())))).copied();
        self.last = known.map(|channel| (socket, address, channel));
        known
    }

    /// Receives bytes of a channel; returns the number of packets.
    pub fn read(&mut self, number: u32, data: &[u8], now: f64) -> usize {
        let mut count = 0;
        let Self { channels, messages, queue, dialect, fields, .. } = self;
        let Some(channel) = channels.get_mut(&number) else {
            return 0;
        };
        let Channel { parser, sources, activity } = channel;
        activity.bytes += data.len() as u64;
        activity.datagrams += 1;
        activity.received_at = now;
        parser.lock().unwrap_or_else(PoisonError::into_inner).feed(dialect, data, |packet| {
            activity.valid_at = now;
            count += 1;
            let header = packet.header;
            let granted = sources.get_mut(&(header.system, header.component)).filter(|_| !header.signed());
            match granted {
                Some(source) => Sorter { fields, messages, queue }.sort(number, source, &packet, now),
                None => queue.push_whole(number, &packet, now),
            }
        });
        count
    }

    /// Lets the intake parse what a sender sends, from the oldest of its datagrams that wait for the program.
    pub fn attach(&mut self, channel: u32, socket: u32, peer: Peer, parser: SharedParser) {
        self.peers.insert((socket, peer), channel);
        self.last = None;
        self.attach_fed(channel, parser);
        let is_of_peer =
            |item: &Item| matches!(item, Item::Datagrams(one) if one.socket == socket && peer.is_sender(one.address));
        for item in self.queue.remove_all(is_of_peer) {
            match item {
                Item::Datagrams(one) if one.socket == socket && peer.is_sender(one.address) => {
                    self.read(channel, &one.data, one.at);
                    self.count_datagrams(channel, one.count - 1);
                }
                other => self.queue.restore(other),
            }
        }
    }

    fn count_datagrams(&mut self, channel: u32, count: usize) {
        if let Some(known) = self.channels.get_mut(&channel) {
            known.activity.datagrams += count as u64;
        }
    }

    /// Lets the intake parse what `feed` or `read` give it, which come from a stream.
    pub fn attach_fed(&mut self, channel: u32, parser: SharedParser) {
        self.channels.insert(channel, Channel { parser, sources: KeyMap::default(), activity: Activity::default() });
    }

    /// Parses bytes that the program received on a channel, and counted; returns whether a packet in them is valid.
    pub fn feed(&mut self, channel: u32, data: &[u8], now: f64) -> bool {
        let before = self.channels.get(&channel).map(|known| known.activity);
        self.read(channel, data, now);
        let Some((known, before)) = self.channels.get_mut(&channel).zip(before) else {
            return false;
        };
        let after = std::mem::replace(&mut known.activity, before);
        after.valid_at > before.valid_at
    }

    /// Gives the datagrams of a channel to the program from now on; returns what was received since the last look.
    pub fn detach(&mut self, channel: u32) -> Activity {
        self.peers.retain(|_, number| *number != channel);
        self.last = None;
        self.channels.remove(&channel).map(|removed| removed.activity).unwrap_or_default()
    }

    /// Returns what was received on a channel since the last call.
    pub fn take_activity(&mut self, channel: u32) -> Activity {
        self.channels.get_mut(&channel).map(|known| std::mem::take(&mut known.activity)).unwrap_or_default()
    }

    /// Lets packets of a source on a channel be kept from the program, from the oldest one that waits for it.
    pub fn grant(&mut self, channel: u32, source: (u8, u8)) -> bool {
        let Some(known) = self.channels.get_mut(&channel) else {
            return false;
        };
        if let Entry::Vacant(entry) = known.sources.entry(source) {
            entry.insert(Source::default());
            let is_whole = |item: &Item| matches!(item, Item::Packets(run) if !run.is_kept && run.channel == channel);
            for item in self.queue.remove_all(is_whole) {
                match item {
                    Item::Packets(run) if !run.is_kept && run.channel == channel => self.sift(&run, source),
                    other => self.queue.restore(other),
                }
            }
        }
        true
    }

    /// Keeps the packets of a source, which was granted now, in a run of packets that were not kept.
    fn sift(&mut self, run: &PacketRun, source: (u8, u8)) {
        let Self { channels, messages, queue, fields, .. } = self;
        let mut state = channels.get_mut(&run.channel).and_then(|known| known.sources.get_mut(&source));
        for (packet, _) in run.packets() {
            let header = packet.header;
            let is_granted = (header.system, header.component) == source && !header.signed();
            match state.as_mut().filter(|_| is_granted) {
                Some(state) => Sorter { fields, messages, queue }.sort(run.channel, state, &packet, run.at),
                None => queue.push_whole(run.channel, &packet, run.at),
            }
        }
    }

    /// Drops the packets that wait although the program decided meanwhile that no part of it takes them.
    pub fn drop_unwanted(&mut self) {
        let Self { messages, queue, .. } = self;
        for item in queue.remove_all(|item| matches!(item, Item::Packets(run) if run.is_kept)) {
            match item {
                Item::Packets(run) if run.is_kept => {
                    for (packet, takers) in run.packets().filter(|(packet, _)| !messages.is_unwanted(&packet.header)) {
                        queue.push_kept(run.channel, &packet, takers, Urgency::Prompt, run.at);
                    }
                }
                other => queue.restore(other),
            }
        }
    }

    /// Gives every packet of a source to the program again; returns its states on the channels.
    pub fn revoke(&mut self, source: (u8, u8)) -> Vec<(u32, Source)> {
        let channels = self.channels.iter_mut();
        channels.filter_map(|(&number, known)| Some((number, known.sources.remove(&source)?))).collect()
    }

    /// Gives every packet to the program again.
    pub fn revoke_all(&mut self) {
        self.channels.values_mut().for_each(|known| known.sources.clear());
    }

    /// Sets the boot time that the next packets of a source on a channel will have; `None`: it is not known.
    pub fn expect_boot(&mut self, channel: u32, source: (u8, u8), boot: Option<Boot>) {
        if let Some(known) = self.channels.get_mut(&channel).and_then(|known| known.sources.get_mut(&source)) {
            known.boot = boot;
        }
    }

    /// Returns the boot time that the next packets of a source on a channel will have.
    #[must_use]
    pub fn boot(&self, channel: u32, source: (u8, u8)) -> Option<Boot> {
        self.channels.get(&channel)?.sources.get(&source)?.boot
    }

    /// The granted sources of all channels.
    pub fn sources(&self) -> impl Iterator<Item = (u32, (u8, u8), Source)> {
        let of_channel = |(&number, known): (&u32, &Channel)| {
            known.sources.iter().map(move |(&source, &state)| (number, source, state)).collect::<Vec<_>>()
        };
        self.channels.iter().flat_map(of_channel)
    }
}

/// The parts of an intake that decide about a packet of a granted source.
struct Sorter<'a> {
    fields: &'a Fields,
    messages: &'a mut Messages,
    queue: &'a mut Queue,
}

impl Sorter<'_> {
    /// Keeps a packet, and queues it if a part of the program takes it.
    #[inline]
    fn sort(self, channel: u32, source: &mut Source, packet: &Packet<'_>, now: f64) {
        let header = packet.header;
        source.heard_at = now;
        let decision = self.messages.keep(packet, now);
        let urgency = match decision.interest {
            Interest::Nothing => Urgency::None,
            Interest::NewBoot => match self.fields.compare(source, packet, now) {
                Continuity::Continues => Urgency::None,
                Continuity::Deviates => Urgency::Prompt,
            },
            Interest::Soon => Urgency::Soon,
            Interest::Unknown => {
                self.messages.ask((header.system, header.component), header.message_id);
                Urgency::Now
            }
            Interest::Asked | Interest::Now => Urgency::Now,
        };
        let is_listened = decision.is_listened || decision.interest == Interest::Unknown;
        let takers = Takers { engine: urgency > Urgency::None, listeners: is_listened };
        if takers.engine || takers.listeners {
            let urgency = if is_listened { urgency.max(Urgency::Prompt) } else { urgency };
            self.queue.push_kept(channel, packet, takers, urgency, now);
        }
    }
}
