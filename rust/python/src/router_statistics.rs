//! Statistics of the router as dictionaries.

use mavstack_router::counters::{Cause, Counters};
use mavstack_router::engine::snapshot::{EndpointSnapshot, Snapshot};
use mavstack_router::rules::RuleCounters;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// The statistics of an engine.
pub struct Statistics<'a>(pub &'a Snapshot);

fn causes<'py>(py: Python<'py>, counters: &Counters) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (cause, name) in Cause::ALL {
        let count = counters.dropped(cause);
        if count > 0 {
            dict.set_item(name, count)?;
        }
    }
    Ok(dict)
}

fn rules(rules: &[(String, RuleCounters)]) -> Vec<(&str, u64, u64)> {
    rules.iter().map(|(name, counters)| (name.as_str(), counters.matched, counters.dropped)).collect()
}

fn endpoint<'py>(py: Python<'py>, endpoint: &EndpointSnapshot) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let counters = &endpoint.counters;
    dict.set_item("received", counters.received)?;
    dict.set_item("received_bytes", counters.received_bytes)?;
    dict.set_item("sent", counters.sent)?;
    dict.set_item("sent_bytes", counters.sent_bytes)?;
    dict.set_item("dropped", causes(py, counters)?)?;
    dict.set_item("incoming_rules", rules(&endpoint.incoming))?;
    dict.set_item("outgoing_rules", rules(&endpoint.outgoing))?;
    let messages = PyDict::new(py);
    for (id, received, sent) in &endpoint.messages {
        messages.set_item(id, (received, sent))?;
    }
    dict.set_item("messages", messages)?;
    let sources = PyDict::new(py);
    for (source, counts) in &endpoint.sources {
        sources.set_item(source, (counts.received, counts.bytes, counts.lost, counts.late))?;
    }
    dict.set_item("sources", sources)?;
    dict.set_item("bad_bytes", endpoint.totals.bad_bytes)?;
    dict.set_item("bad_crc", endpoint.totals.bad_checksum)?;
    dict.set_item("unknown", endpoint.totals.unknown)?;
    dict.set_item("queued", endpoint.queued)?;
    let peers = endpoint
        .peers
        .iter()
        .map(|peer| (peer.address.ip().to_string(), peer.address.port(), peer.age, peer.accepted, peer.bad_bytes));
    dict.set_item("peers", peers.collect::<Vec<_>>())?;
    let status = &endpoint.radio_status;
    dict.set_item("radio_status", (!status.is_empty()).then(|| PyBytes::new(py, status)))?;
    Ok(dict)
}

impl Statistics<'_> {
    pub fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dict = PyDict::new(py);
        let endpoints = PyDict::new(py);
        for snapshot in &self.0.endpoints {
            endpoints.set_item(snapshot.number, endpoint(py, snapshot)?)?;
        }
        dict.set_item("endpoints", endpoints)?;
        let routes = self.0.routes.iter();
        let routes = routes.map(|route| {
            let (endpoints, verified, contested) = (route.endpoints.clone(), route.verified, route.contested);
            (route.system, route.component, endpoints, verified, contested, route.age)
        });
        dict.set_item("routes", routes.collect::<Vec<_>>())?;
        dict.set_item("dropped_events", self.0.dropped_events)?;
        Ok(dict.into_any())
    }
}
