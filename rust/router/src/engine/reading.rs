//! Reading from links: one batch of each that has something, and the admission of new peers.

use crate::counters::Cause;
use crate::engine::batch::Batches;
use crate::engine::datagrams::{ReceiveBuffer, TURN_BYTES};
use crate::engine::links::Transport;
use crate::engine::polling::REPORTS_WAITING;
use crate::engine::udp::{Accepted, Sender};
use crate::engine::worker::Worker;
use crate::event::{EndpointNumber, Event};
use crate::ports::PortId;
use crate::router::{Evidence, Stage, Time};
use mavstack_core::header::{CHECKSUM, HEADER_V2, SIGNATURE};
use mavstack_core::parser::Parser;
use std::io;
use std::net::SocketAddr;

/// The most bytes of a packet around its payload.
const FRAME: usize = HEADER_V2 + CHECKSUM + SIGNATURE;

/// Memory for reading.
#[derive(Default)]
pub struct Reading {
    buffer: ReceiveBuffer,
    batches: Batches,
    /// The content of frames, or of a queue.
    content: Vec<u8>,
}

/// The state of a link after one batch.
#[derive(Debug)]
enum Progress {
    /// More may be waiting.
    More,
    Drained,
    Ended(String),
}

impl Worker {
    /// Takes the links that may have something to read, and what the program pushed to them.
    pub(super) fn take_ready(&mut self) -> Vec<usize> {
        self.spare.clear();
        let ready = std::mem::replace(&mut self.ready, std::mem::take(&mut self.spare));
        for &index in &ready {
            if let Some(link) = self.links.all.get_mut(index) {
                link.is_ready = false;
                if let Transport::Queue(queue) = &mut link.transport {
                    queue.collect();
                }
            }
        }
        ready
    }

    /// Reads one batch from each of these links.
    pub(super) fn read_links(&mut self, ready: &[usize], time: Time) {
        for &index in ready {
            let Some(link) = self.links.all.get(index).filter(|link| link.is_started) else {
                continue;
            };
            let number = link.number;
            let is_closing = link.is_closing;
            self.links.is_alone = ready.len() == 1;
            match self.read_link(index, time) {
                Progress::More => self.mark_ready(index),
                Progress::Drained if is_closing => self.remove(number, None),
                Progress::Drained => {}
                Progress::Ended(reason) => self.remove(number, Some(reason)),
            }
        }
        self.links.is_alone = false;
    }

    fn read_link(&mut self, index: usize, time: Time) -> Progress {
        let mut reading = self.reading.take().unwrap_or_default();
        let progress = match &self.links.all[index].transport {
            Transport::Udp(_) => self.read_datagrams(index, &mut reading, time),
            Transport::Stream(_) => self.read_stream(index, &mut reading, time),
            Transport::Queue(_) => self.read_queue(index, &mut reading, time),
        };
        self.reading = Some(reading);
        progress
    }

    fn read_datagrams(&mut self, index: usize, reading: &mut Reading, time: Time) -> Progress {
        let Transport::Udp(udp) = &mut self.links.all[index].transport else {
            return Progress::Drained;
        };
        let more = match udp.receive(&mut reading.batches, &mut reading.buffer, time.now) {
            Ok(more) => more,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Progress::Drained,
            // An unreachable peer may become reachable.
            Err(_) => return if REPORTS_WAITING { Progress::Drained } else { Progress::More },
        };
        self.datagrams += reading.buffer.received.len();
        self.links.is_alone &= reading.buffer.received.len() == 1;
        // Datagrams of one sender mostly come together.
        let mut last = None;
        for number in 0..reading.buffer.received.len() {
            let (datagram, address) = reading.buffer.datagram(number);
            match last {
                Some((sender, port)) if sender == address => {
                    self.links.earn(port, datagram.len());
                    self.feed(port, datagram, time);
                }
                _ => last = self.receive_datagram(index, datagram, address, time).map(|port| (address, port)),
            }
        }
        if more { Progress::More } else { Progress::Drained }
    }

    /// Routes the packets of a datagram; returns the port of its sender.
    #[inline]
    fn receive_datagram(&mut self, index: usize, datagram: &[u8], address: SocketAddr, time: Time) -> Option<PortId> {
        let Transport::Udp(udp) = &mut self.links.all[index].transport else {
            return None;
        };
        let port = match udp.sender(address, time.now) {
            Sender::Port(port) => port,
            Sender::Confirmed(port) => {
                self.router.set_hearing(port, true);
                port
            }
            Sender::Refused => {
                self.count(index, Cause::OtherPeer);
                return None;
            }
            Sender::New => self.admit_peer(index, datagram, address, time.now)?,
        };
        self.links.earn(port, datagram.len());
        self.feed(port, datagram, time);
        if self.router.stage(port) == Some(Stage::Refused) && !self.router.is_in_progress(port) {
            self.close_peer(index, address); // a refused sender is no peer
            return None;
        }
        Some(port)
    }

    /// Gives a new sender a port, if its datagram has a valid packet; it is a peer when a packet of it is accepted.
    #[cold]
    fn admit_peer(&mut self, index: usize, datagram: &[u8], address: SocketAddr, now: u64) -> Option<PortId> {
        let mut packets = 0;
        Parser::new(false).feed(self.router.dialect(), datagram, |_| packets += 1);
        if packets == 0 {
            self.count(index, Cause::OtherPeer);
            return None;
        }
        let Transport::Udp(udp) = &self.links.all[index].transport else {
            return None;
        };
        if let Some(waiting) = udp.make_room_to_wait() {
            self.close_peer(index, waiting);
        }
        let Some(port) = self.open_peer(index, address) else {
            self.count(index, Cause::TooManyPeers);
            return None;
        };
        if let Transport::Udp(udp) = &mut self.links.all[index].transport {
            udp.add_peer(address, port, now);
        }
        Some(port)
    }

    /// Gives the peers what they may get since their packets were accepted, or answered something.
    pub(super) fn note_progress(&mut self, now: u64) {
        if !self.router.has_progress() {
            return;
        }
        for (port, evidence) in self.router.take_progress() {
            let Some((index, address)) = self.links.peer_of(port) else {
                continue;
            };
            self.accept_peer(index, address, evidence == Evidence::Verified, now);
            let trusts_senders = matches!(&self.links.all[index].transport, Transport::Udp(udp) if udp.trusts_senders);
            let is_proven = match evidence {
                Evidence::Verified => true,
                Evidence::Answered => trusts_senders || self.links.has_sent(port),
                Evidence::Accepted => trusts_senders,
            };
            if is_proven {
                self.links.lift(port);
            }
            self.router.set_stage(port, if is_proven { Stage::Proven } else { Stage::Accepted });
        }
    }

    /// Makes a sender a peer, of which a packet was accepted, if there is room.
    fn accept_peer(&mut self, index: usize, address: SocketAddr, is_verified: bool, now: u64) {
        let Transport::Udp(udp) = &mut self.links.all[index].transport else {
            return;
        };
        let room = udp.accept(&address, is_verified, now);
        match room {
            Accepted::Known => return,
            Accepted::NoRoom => {
                self.count(index, Cause::TooManyPeers);
                return self.close_peer(index, address);
            }
            Accepted::InPlaceOf(silent) => self.close_peer(index, silent),
            Accepted::New => {}
        }
        let link = &mut self.links.all[index];
        if let Transport::Udp(udp) = &link.transport
            && let Some(peer) = udp.peers.get(&address)
        {
            self.router.set_hearing(peer.port, peer.is_hearing);
        }
        self.router.events.push(Event::PeerOpened { endpoint: link.number, address });
    }

    pub(super) fn close_peer(&mut self, index: usize, address: SocketAddr) {
        let link = &mut self.links.all[index];
        let Transport::Udp(udp) = &mut link.transport else {
            return;
        };
        if let Some(peer) = udp.remove_peer(&address) {
            if peer.is_accepted {
                self.router.events.push(Event::PeerClosed { endpoint: link.number, address });
            }
            self.close_port(peer.port);
        }
    }

    fn count(&mut self, index: usize, cause: Cause) {
        if let Some(endpoint) = self.router.endpoint_mut(self.links.all[index].endpoint) {
            endpoint.counters.drop_packet(cause);
        }
    }

    fn read_stream(&mut self, index: usize, reading: &mut Reading, time: Time) -> Progress {
        let Transport::Stream(stream) = &mut self.links.all[index].transport else {
            return Progress::Drained;
        };
        let length = match stream.read(reading.buffer.stream()) {
            Ok(0) => return Progress::Ended("the other side closed it".into()),
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Progress::Drained,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return Progress::More,
            Err(error) => return Progress::Ended(error.to_string()),
        };
        let (port, received) = (stream.port, reading.buffer.first(length));
        reading.content.clear();
        match stream.decode(received, &mut reading.content) {
            Err(reason) => return Progress::Ended(reason),
            Ok(true) => self.feed(port, &reading.content, time),
            Ok(false) => self.feed(port, received, time),
        }
        // A terminal may return less than it has.
        Progress::More
    }

    /// Removes an endpoint, a queue after what the program pushed to it is routed.
    pub(super) fn remove_read(&mut self, number: EndpointNumber) {
        let Some(&index) = self.numbers.get(&number) else {
            return;
        };
        let link = &mut self.links.all[index];
        if let Transport::Queue(queue) = &mut link.transport
            && link.is_started
        {
            queue.collect();
            let time = self.time();
            if matches!(self.read_link(index, time), Progress::More) {
                self.links.all[index].is_closing = true;
                return self.mark_ready(index);
            }
        }
        self.remove(number, None);
    }

    fn read_queue(&mut self, index: usize, reading: &mut Reading, time: Time) -> Progress {
        let Transport::Queue(queue) = &mut self.links.all[index].transport else {
            return Progress::Drained;
        };
        reading.content.clear();
        let (port, more) = (queue.port, queue.read(TURN_BYTES, &mut reading.content));
        self.feed(port, &reading.content, time);
        if more { Progress::More } else { Progress::Drained }
    }

    /// Routes the packets in received bytes.
    #[inline]
    fn feed(&mut self, port: PortId, data: &[u8], time: Time) {
        let (router, links) = (&mut self.router, &mut self.links);
        // The second byte is the length of the payload in both versions.
        links.is_alone &= data.get(1).is_some_and(|&length| data.len() <= usize::from(length) + FRAME);
        if let Some(parser) = &mut self.parsers[port] {
            parser.feed(&self.dialect, data, |packet| router.route(port, &packet, time, links));
        }
    }
}
