//! Packets that wait for a decision of the program.

use super::{Passing, Router, Sink, Time};
use crate::counters::Cause;
use crate::event::Event;
use crate::held::Held;
use crate::ports::{MAX_PORTS, PortId};

impl Router {
    /// Keeps a packet until the program decides about it.
    #[cold]
    pub(super) fn hold(&mut self, from: PortId, port: PortId, outgoing: bool, passing: &Passing<'_>, time: Time) {
        let raw = passing.packet.raw.to_vec();
        let endpoint = self.endpoint_of(port).number;
        let (peer, verified) = (self.ports[from].peer, passing.admission.verified);
        let to = port;
        let (from, port) = (self.ports[from].serial, self.ports[port].serial);
        let held = Held { from, port, outgoing, admission: passing.admission, raw: raw.clone(), at: time.now };
        let (token, expired) = self.held.insert(held);
        for held in expired {
            if let Some(port) = self.port_with_serial(held.port) {
                self.endpoint_of(port).counters.drop_packet(Cause::NotInspected);
            }
        }
        match token {
            Some(token) => self.events.push(Event::Inspect { token, endpoint, outgoing, peer, verified, packet: raw }),
            None => self.endpoint_of(to).counters.drop_packet(Cause::NotInspected),
        }
    }

    pub(super) fn port_with_serial(&self, serial: u64) -> Option<PortId> {
        let port = (serial % MAX_PORTS as u64) as usize;
        self.ports.get(port).is_some_and(|found| found.serial == serial).then_some(port)
    }

    /// Passes or drops a held packet; a token that is not known has no effect. A packet that waited for too long is
    /// dropped: a command must not reach its vehicle long after it was given.
    pub fn decide(&mut self, token: u64, passed: bool, time: Time, sink: &mut impl Sink) {
        let Some(held) = self.held.remove(token) else {
            return;
        };
        let (Some(from), Some(port)) = (self.port_with_serial(held.from), self.port_with_serial(held.port)) else {
            return;
        };
        let endpoint = self.endpoint_of(port);
        let cause = if held.is_expired(time.now) {
            Some(Cause::NotInspected)
        } else if !passed {
            Some(Cause::Inspected)
        } else {
            endpoint.paused.then_some(Cause::Paused)
        };
        if let Some(cause) = cause {
            return endpoint.counters.drop_packet(cause);
        }
        let Some(packet) = held.packet(&self.dialect) else {
            return;
        };
        let summary = self.addressing.summary(&packet);
        let passing = Passing { packet: &packet, summary, admission: held.admission };
        if held.outgoing {
            self.send(from, port, &passing, time, sink);
        } else {
            self.accept(from, &passing, time, sink);
        }
    }
}
