//! The endpoints and ports of the router.

use super::{Evidence, Port, Router, Stage};
use crate::endpoint::Endpoint;
use crate::event::EndpointNumber;
use crate::ports::{MAX_PORTS, PortId};
use mavstack_core::claims::{Authority, Claims};
use std::net::SocketAddr;

impl Router {
    /// Adds an endpoint without ports, and returns its index.
    pub fn add_endpoint(&mut self, number: EndpointNumber) -> usize {
        self.endpoints.insert(Endpoint::new(number, self.dialect.layouts().len()))
    }

    /// Adds a port to an endpoint; `None`: there are too many.
    pub fn add_port(&mut self, endpoint: usize) -> Option<PortId> {
        let port = self.insert_port(endpoint, Stage::Proven, None)?;
        self.set_hearing(port, true);
        Some(port)
    }

    /// Adds the port of a peer that is not known, and gets nothing until a packet of it is accepted.
    pub fn add_peer(&mut self, endpoint: usize, address: SocketAddr) -> Option<PortId> {
        self.insert_port(endpoint, Stage::Refused, Some(address))
    }

    /// Returns whether the endpoint of a port verifies signatures.
    #[must_use]
    pub fn is_verifying(&self, port: PortId) -> bool {
        let endpoint = self.endpoint_index(port).and_then(|index| self.endpoints.get(index));
        endpoint.is_some_and(|endpoint| endpoint.gateway.incoming.is_some())
    }

    /// Number of accepted packets of a port.
    #[must_use]
    pub fn accepted(&self, port: PortId) -> u64 {
        self.ports.get(port).map_or(0, |port| port.accepted)
    }

    fn insert_port(&mut self, endpoint: usize, stage: Stage, peer: Option<SocketAddr>) -> Option<PortId> {
        if self.ports.len() >= MAX_PORTS {
            return None;
        }
        self.serials += 1;
        let port =
            self.ports.insert(Port { endpoint, stage, peer, accepted: 0, serial: self.serials * MAX_PORTS as u64 });
        self.ports[port].serial += port as u64;
        Some(port)
    }

    /// Returns whether packets of peers that are not proven showed something.
    #[inline]
    #[must_use]
    pub fn has_progress(&self) -> bool {
        !self.progress.is_empty()
    }

    /// Takes what the packets of peers that are not proven showed.
    pub fn take_progress(&mut self) -> Vec<(PortId, Evidence)> {
        std::mem::take(&mut self.progress)
    }

    /// Returns whether a peer has progress that was not taken, or a packet that waits for a decision.
    #[must_use]
    pub fn is_in_progress(&self, port: PortId) -> bool {
        let serial = self.ports.get(port).map(|port| port.serial);
        self.progress.iter().any(|(known, _)| *known == port)
            || serial.is_some_and(|serial| self.held.is_waiting(serial))
    }

    /// The stage of a port.
    #[must_use]
    pub fn stage(&self, port: PortId) -> Option<Stage> {
        self.ports.get(port).map(|port| port.stage)
    }

    /// Sets the stage of a peer; returns whether it is a later one than before.
    pub fn set_stage(&mut self, port: PortId, stage: Stage) -> bool {
        let known = self.ports.get_mut(port).filter(|known| known.stage < stage);
        known.map(|known| known.stage = stage).is_some()
    }

    /// Sends packets without a target to a port, or no longer. A port of a monitor gets all packets.
    pub fn set_hearing(&mut self, port: PortId, is_hearing: bool) {
        let is_monitor = self.endpoint_of(port).monitor;
        if is_monitor {
            self.monitors.insert(port);
        } else if is_hearing {
            self.open.insert(port);
        } else {
            self.open.remove(port);
        }
    }

    /// Makes an endpoint a monitor, or an ordinary endpoint again, with what it taught forgotten.
    pub fn set_monitor(&mut self, endpoint: usize, monitor: bool) {
        let Some(known) = self.endpoints.get_mut(endpoint) else {
            return;
        };
        if std::mem::replace(&mut known.monitor, monitor) == monitor {
            return;
        }
        let ports = self.ports.iter().filter(|(_, port)| port.endpoint == endpoint).map(|(port, _)| port);
        for port in ports.collect::<Vec<_>>() {
            self.open.remove(port);
            self.monitors.remove(port);
            self.claims.remove(port);
            self.set_hearing(port, true);
        }
    }

    pub fn remove_port(&mut self, port: PortId) {
        if self.ports.try_remove(port).is_some() {
            self.open.remove(port);
            self.monitors.remove(port);
            self.claims.remove(port);
            self.progress.retain(|(known, _)| *known != port);
        }
    }

    /// Removes an endpoint whose ports were removed.
    pub fn remove_endpoint(&mut self, endpoint: usize) -> Option<Endpoint> {
        self.endpoints.try_remove(endpoint)
    }

    #[must_use]
    pub fn endpoint(&self, endpoint: usize) -> Option<&Endpoint> {
        self.endpoints.get(endpoint)
    }

    pub fn endpoint_mut(&mut self, endpoint: usize) -> Option<&mut Endpoint> {
        self.endpoints.get_mut(endpoint)
    }

    /// Forgets what authenticated the claims of an endpoint's ports.
    pub fn unverify(&mut self, endpoint: usize) {
        for (port, _) in self.ports.iter().filter(|(_, port)| port.endpoint == endpoint) {
            self.claims.withdraw(port);
        }
    }

    /// Sets how the identity of the peer of an endpoint is proven; what an earlier identity claimed is withdrawn.
    pub fn set_authority(&mut self, endpoint: usize, authority: Authority) {
        if let Some(known) = self.endpoints.get_mut(endpoint)
            && std::mem::replace(&mut known.authority, authority) != authority
        {
            self.unverify(endpoint);
        }
    }

    /// Ends the conflicts that nothing contradicted for a time.
    pub fn end_conflicts(&mut self, now: u64) {
        self.claims.end_conflicts(now);
    }

    #[must_use]
    pub fn claims(&self) -> &Claims {
        &self.claims
    }

    /// The index of the endpoint of a port.
    #[must_use]
    pub fn endpoint_index(&self, port: PortId) -> Option<usize> {
        self.ports.get(port).map(|port| port.endpoint)
    }

    /// The number of the endpoint of a port.
    #[must_use]
    pub fn number_of(&self, port: PortId) -> Option<EndpointNumber> {
        self.endpoint_index(port).and_then(|index| self.endpoints.get(index)).map(|endpoint| endpoint.number)
    }
}
