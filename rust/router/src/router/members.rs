//! The endpoints and ports of the router.

use super::{Port, Router};
use crate::endpoint::Endpoint;
use crate::event::EndpointNumber;
use crate::ports::{MAX_PORTS, PortId};
use crate::table::Table;

impl Router {
    /// Adds an endpoint without ports, and returns its index.
    pub fn add_endpoint(&mut self, number: EndpointNumber) -> usize {
        self.endpoints.insert(Endpoint::new(number, self.dialect.layouts().len()))
    }

    /// Adds a port to an endpoint; `None`: there are too many.
    pub fn add_port(&mut self, endpoint: usize) -> Option<PortId> {
        if self.ports.len() >= MAX_PORTS {
            return None;
        }
        self.serials += 1;
        let port = self.ports.insert(Port { endpoint, serial: self.serials * MAX_PORTS as u64 });
        self.ports[port].serial += port as u64;
        self.set_hearing(port, true);
        Some(port)
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
            self.table.remove_port(port);
            self.set_hearing(port, true);
        }
    }

    pub fn remove_port(&mut self, port: PortId) {
        if self.ports.try_remove(port).is_some() {
            self.open.remove(port);
            self.monitors.remove(port);
            self.table.remove_port(port);
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

    /// Forgets the routes that an endpoint's signatures verified.
    pub fn unverify(&mut self, endpoint: usize) {
        for (port, _) in self.ports.iter().filter(|(_, port)| port.endpoint == endpoint) {
            self.table.unverify(port);
        }
    }

    #[must_use]
    pub fn table(&self) -> &Table {
        &self.table
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
