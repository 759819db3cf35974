//! Rules and addresses from Python.

use mavstack_router::engine::peer_range::PeerRange;
use mavstack_router::rules::{Action, Rule};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::net::{IpAddr, SocketAddr};

/// (action, messages, systems, components, target systems, commands, rate, name, dry run)
pub type RuleTuple = (String, Vec<u32>, Vec<u8>, Vec<u8>, Vec<u8>, Vec<u16>, Option<f64>, String, bool);
/// (network address, prefix length, first port, last port)
pub type PeerTuple = (String, u8, u16, u16);

pub fn action(name: &str) -> PyResult<Action> {
    match name {
        "pass" => Ok(Action::Pass),
        "drop" => Ok(Action::Drop),
        "inspect" => Ok(Action::Inspect),
        _ => Err(PyValueError::new_err(format!("an action must be pass, drop or inspect, got {name:?}"))),
    }
}

pub fn rules(tuples: Vec<RuleTuple>) -> PyResult<Vec<Rule>> {
    let rule = |(name_of_action, messages, systems, components, target_systems, commands, rate, name, dry_run)| {
        let name_of_action: String = name_of_action;
        let action = action(&name_of_action)?;
        Ok(Rule { action, messages, systems, components, target_systems, commands, rate, name, dry_run })
    };
    tuples.into_iter().map(rule).collect()
}

fn ip(host: &str) -> PyResult<IpAddr> {
    host.parse().map_err(|_| PyValueError::new_err(format!("{host:?} is not an IP address")))
}

pub fn address(host: &str, port: u16) -> PyResult<SocketAddr> {
    // The interface of a link-local address follows a percent sign.
    if let Ok(address) = format!("[{host}]:{port}").parse() {
        return Ok(address);
    }
    Ok(SocketAddr::new(ip(host)?, port))
}

pub fn peer_ranges(tuples: Vec<PeerTuple>) -> PyResult<Vec<PeerRange>> {
    let range = |(network, prefix, first, last): PeerTuple| {
        Ok(PeerRange { network: ip(&network)?, prefix, ports: first..=last })
    };
    tuples.into_iter().map(range).collect()
}
