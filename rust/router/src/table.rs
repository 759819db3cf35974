//! The routes that were learned: on which ports each address was heard.
//!
//! Every packet teaches, not only heartbeats, since some sources never send one. System 0 is never learned. Component 0
//! stands for all components of its system, so it teaches the ports of the system but is no address of its own: a packet
//! for component 0, or for a component that was never heard, goes to every port on which its system was heard.
//!
//! An address that was verified by its signature on a port is reached over such ports alone; what other ports receive
//! from it is forged, or a copy. The table is bounded: if it is full, addresses heard for a moment only are forgotten
//! first, then silent ones, and verified ones last. A boot time that falls means that its sender rebooted: then its
//! routes are learned again.

use crate::ports::{PortId, PortSet};
use mavstack_core::sequence::SourceHasher;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;

/// Addresses in the table, and how many are forgotten at once when it is full.
pub const MAX_ADDRESSES: usize = 4096;
const FORGOTTEN_AT_ONCE: usize = 512;
/// Microseconds for which an address that was heard more than once is heard at least.
const MIN_HEARD: u64 = 1_000_000;
/// Milliseconds by which a boot time may fall without a reboot: packets of redundant links overtake each other.
const BOOT_TIME_SLACK: u32 = 2_000;

/// The ports of one address or of one system.
#[derive(Clone, Debug, Default)]
struct Ports {
    heard: PortSet,
    verified: PortSet,
}

impl Ports {
    fn reachable(&self) -> Option<&PortSet> {
        let ports = if self.verified.is_empty() { &self.heard } else { &self.verified };
        (!ports.is_empty()).then_some(ports)
    }
}

#[derive(Debug)]
struct Route {
    ports: Ports,
    first_at: u64,
    last_at: u64,
    boot_time: u32,
}

impl Route {
    fn removal_order(&self) -> (bool, bool, u64) {
        (!self.ports.verified.is_empty(), self.last_at - self.first_at >= MIN_HEARD, self.last_at)
    }
}

/// The result of learning from one packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learned {
    /// The address was heard on the port before, or cannot be learned.
    Known,
    /// The address is heard on the port for the first time.
    New,
    /// The address is verified on another port, and this packet is not: it is not to be trusted.
    Spoofed,
}

/// An address with the ports that lead to it, for display.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownAddress {
    pub system: u8,
    pub component: u8,
    pub ports: Vec<PortId>,
    pub verified: bool,
    /// Time in microseconds at which it was heard last.
    pub heard_at: u64,
}

/// All learned routes. Times are monotonic, in microseconds.
#[derive(Debug)]
pub struct Table {
    routes: HashMap<u16, Route, BuildHasherDefault<SourceHasher>>,
    systems: Vec<Ports>,
}

impl Default for Table {
    fn default() -> Self {
        Self { routes: HashMap::default(), systems: vec![Ports::default(); 256] }
    }
}

fn key(system: u8, component: u8) -> u16 {
    u16::from_be_bytes([system, component])
}

impl Table {
    /// Learns that an address was heard on a port; `verified`: by a packet with a valid signature.
    #[inline]
    pub fn learn(&mut self, system: u8, component: u8, port: PortId, verified: bool, now: u64) -> Learned {
        if system == 0 {
            return Learned::Known;
        }
        if let Some(route) = self.routes.get_mut(&key(system, component)) {
            let is_verified = route.ports.verified.contains(port);
            if !verified && !is_verified && !route.ports.verified.is_empty() {
                return Learned::Spoofed;
            }
            if route.ports.heard.contains(port) && (is_verified || !verified) {
                route.last_at = now;
                return Learned::Known;
            }
        }
        self.insert(system, component, port, verified, now);
        Learned::New
    }

    #[cold]
    fn insert(&mut self, system: u8, component: u8, port: PortId, verified: bool, now: u64) {
        let key = key(system, component);
        if !self.routes.contains_key(&key) && self.routes.len() >= MAX_ADDRESSES {
            self.make_room();
        }
        let new = || Route { ports: Ports::default(), first_at: now, last_at: now, boot_time: 0 };
        let route = self.routes.entry(key).or_insert_with(new);
        route.last_at = now;
        if verified {
            if route.ports.verified.is_empty() {
                route.ports.heard.clear();
            }
            route.ports.verified.insert(port);
            route.ports.heard.insert(port);
            self.update_system(system);
        } else {
            route.ports.heard.insert(port);
            self.systems[usize::from(system)].heard.insert(port);
        }
    }

    /// Records the boot time that an address sent on a port, in milliseconds.
    ///
    /// Returns whether it rebooted; then it is known on that port alone.
    pub fn note_boot_time(&mut self, system: u8, component: u8, port: PortId, boot_time: u32) -> bool {
        let Some(route) = self.routes.get_mut(&key(system, component)) else {
            return false;
        };
        let rebooted = boot_time.saturating_add(BOOT_TIME_SLACK) < route.boot_time;
        route.boot_time = if rebooted { boot_time } else { boot_time.max(route.boot_time) };
        if rebooted && route.ports.verified.is_empty() {
            route.ports.heard.clear();
            route.ports.heard.insert(port);
            self.update_system(system);
        }
        rebooted
    }

    /// Returns the ports that lead to a target, whose system is not 0; `None`: its system was never heard.
    #[inline]
    #[must_use]
    pub fn ports_to(&self, system: u8, component: u8) -> Option<&PortSet> {
        let route = if component == 0 { None } else { self.routes.get(&key(system, component)) };
        let found = route.and_then(|route| route.ports.reachable());
        found.or_else(|| self.systems[usize::from(system)].reachable())
    }

    /// Forgets a removed port.
    pub fn remove_port(&mut self, port: PortId) {
        self.retain(|route| {
            route.ports.heard.remove(port);
            route.ports.verified.remove(port);
            !route.ports.heard.is_empty()
        });
    }

    /// Forgets on a port what its signatures verified: it verifies no longer, or with another key.
    pub fn unverify(&mut self, port: PortId) {
        self.retain(|route| {
            route.ports.verified.remove(port);
            true
        });
    }

    fn retain(&mut self, mut keep: impl FnMut(&mut Route) -> bool) {
        self.routes.retain(|_, route| keep(route));
        self.update_systems();
    }

    fn make_room(&mut self) {
        let mut order: Vec<_> = self.routes.iter().map(|(&key, route)| (route.removal_order(), key)).collect();
        order.select_nth_unstable(FORGOTTEN_AT_ONCE);
        for &(_, key) in &order[..FORGOTTEN_AT_ONCE] {
            self.routes.remove(&key);
        }
        self.update_systems();
    }

    fn update_systems(&mut self) {
        self.systems.fill(Ports::default());
        for (key, route) in &self.routes {
            let system = &mut self.systems[usize::from(key >> 8)];
            system.heard.extend(&route.ports.heard);
            system.verified.extend(&route.ports.verified);
        }
    }

    fn update_system(&mut self, system: u8) {
        let mut ports = Ports::default();
        for component in 0..=u8::MAX {
            if let Some(route) = self.routes.get(&key(system, component)) {
                ports.heard.extend(&route.ports.heard);
                ports.verified.extend(&route.ports.verified);
            }
        }
        self.systems[usize::from(system)] = ports;
    }

    /// All known addresses, ordered by their ids.
    #[must_use]
    pub fn addresses(&self) -> Vec<KnownAddress> {
        let mut addresses: Vec<_> = self
            .routes
            .iter()
            .map(|(&key, route)| {
                let [system, component] = key.to_be_bytes();
                let ports = route.ports.reachable().map_or_else(Vec::new, |ports| ports.iter().collect());
                let verified = !route.ports.verified.is_empty();
                KnownAddress { system, component, ports, verified, heard_at: route.last_at }
            })
            .collect();
        addresses.sort_unstable_by_key(|address| (address.system, address.component));
        addresses
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
