//! Adding links to the engine's thread, starting and removing them.
//!
//! A link that is added has no ports, so nothing reaches it, and is not read, until it is started. Rules and keys that
//! are set before therefore apply to its first packet.

use crate::engine::links::Transport;
use crate::engine::queue::{Queue, QueueLink};
use crate::engine::stream::{Framing, RawStream, StreamLink};
use crate::engine::udp::{UdpLink, UdpOptions};
use crate::engine::worker::Worker;
use crate::event::{EndpointNumber, Event};
use crate::ports::PortId;
use mavstack_core::parser::Parser;
use std::net::SocketAddr;
use std::sync::Arc;

impl Worker {
    pub(super) fn add_udp(&mut self, number: EndpointNumber, socket: mio::net::UdpSocket, options: UdpOptions) {
        match UdpLink::new(socket, options) {
            Ok(udp) => self.add(number, Transport::Udp(udp)),
            Err(error) => self.report_closed(number, error.to_string()),
        }
    }

    pub(super) fn add_stream(&mut self, number: EndpointNumber, stream: RawStream, framing: Framing, limit: usize) {
        self.add(number, Transport::Stream(StreamLink::new(stream, 0, framing, limit)));
    }

    pub(super) fn add_queue(&mut self, number: EndpointNumber, queue: Arc<Queue>) {
        self.add(number, Transport::Queue(QueueLink::new(queue)));
    }

    fn add(&mut self, number: EndpointNumber, transport: Transport) {
        let endpoint = self.router.add_endpoint(number);
        let index = self.links.insert(number, endpoint, transport);
        self.numbers.insert(number, index);
    }

    /// Opens the port of a link and begins to read it. One that was started before has no effect.
    pub(super) fn start(&mut self, number: EndpointNumber) {
        let Some(&index) = self.numbers.get(&number) else {
            return;
        };
        if std::mem::replace(&mut self.links.all[index].is_started, true) {
            return;
        }
        if !self.open_own_port(index) {
            return self.remove(number, Some("the router has too many endpoints and peers".into()));
        }
        if let Err(error) = self.poll.register(&mut self.links.all[index], index) {
            return self.remove(number, Some(error.to_string()));
        }
        self.mark_ready(index);
    }

    /// Opens the port of a link that has one from the start; returns whether there was room.
    fn open_own_port(&mut self, index: usize) -> bool {
        let destination = match &self.links.all[index].transport {
            Transport::Udp(udp) if !udp.has_peer() => return true,
            Transport::Udp(udp) => udp.destination(),
            _ => None,
        };
        let Some(opened) = self.open_port(index, destination) else {
            return false;
        };
        match &mut self.links.all[index].transport {
            Transport::Udp(udp) => udp.fixed = Some(opened),
            Transport::Stream(stream) => stream.port = opened,
            Transport::Queue(queue) => queue.port = opened,
        }
        true
    }

    /// Adds a port to a link; `None`: there are too many.
    fn open_port(&mut self, index: usize, address: Option<SocketAddr>) -> Option<PortId> {
        let port = self.router.add_port(self.links.all[index].endpoint)?;
        self.connect_port(port, index, address);
        Some(port)
    }

    /// Adds the port of a sender that is not known; `None`: there are too many.
    pub(super) fn open_peer(&mut self, index: usize, address: SocketAddr) -> Option<PortId> {
        let port = self.router.add_peer(self.links.all[index].endpoint, address)?;
        self.connect_port(port, index, Some(address));
        self.links.limit(port);
        Some(port)
    }

    fn connect_port(&mut self, port: PortId, index: usize, address: Option<SocketAddr>) {
        self.links.connect_port(port, index, address);
        if self.parsers.len() <= port {
            self.parsers.resize_with(port + 1, || None);
        }
        self.parsers[port] = Some(Parser::new(false));
    }

    pub(super) fn close_port(&mut self, port: PortId) {
        self.router.remove_port(port);
        self.links.disconnect_port(port);
        self.parsers[port] = None;
    }

    fn report_closed(&mut self, endpoint: EndpointNumber, reason: String) {
        self.router.events.push(Event::Closed { endpoint, reason });
    }

    /// Removes an endpoint; with a reason, that is reported.
    pub(super) fn remove(&mut self, number: EndpointNumber, reason: Option<String>) {
        let Some(index) = self.numbers.remove(&number) else {
            return;
        };
        for port in self.links.ports_of(index) {
            self.close_port(port);
        }
        if let Some(mut link) = self.links.all.try_remove(index) {
            self.poll.deregister(&mut link);
            self.router.remove_endpoint(link.endpoint);
            if let Transport::Queue(queue) = &link.transport {
                queue.shared.close();
            }
        }
        self.ready.retain(|&ready| ready != index);
        if let Some(reason) = reason {
            self.report_closed(number, reason);
        }
    }
}
