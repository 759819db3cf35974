//! Signing state of one link, as Python sees it. The key goes in and never comes out.

use crate::buffers::Bytes;
use crate::errors::SigningError;
use crate::statistics::Refusals;
use mavstack_core::signing::{self as core, EPOCH, Key, MAX_TIMESTAMP, Policy, UNITS_PER_SECOND};
use pyo3::prelude::*;

/// Signs what is sent on a link and judges what is received.
#[pyclass(module = "mavstack._core")]
pub struct Signing {
    pub core: core::Signing,
}

/// The timestamp of a Unix time in seconds, if given; before 2015 it is 0.
pub fn timestamp(now: Option<f64>) -> PyResult<Option<u64>> {
    let Some(now) = now else {
        return Ok(None);
    };
    let units = (now - EPOCH as f64) * UNITS_PER_SECOND as f64;
    if !units.is_finite() || units > MAX_TIMESTAMP as f64 {
        return Err(SigningError::new_err(format!("{now} is not a Unix time that signing can count")));
    }
    Ok(Some(units.max(0.0) as u64))
}

fn units(seconds: f64) -> u64 {
    (seconds.max(0.0) * UNITS_PER_SECOND as f64) as u64
}

#[pymethods]
impl Signing {
    #[new]
    #[pyo3(signature = (
        key, link_id = 0, *, timestamp = 0, accept_unsigned = false, unsigned_ids = Vec::new(),
        max_behind = 60.0, max_ahead = 86400.0, reorder_slack = 0.0, max_streams = 1024
    ))]
    #[expect(clippy::too_many_arguments, reason = "each is one keyword of the Python class")]
    fn new(
        key: Bytes<'_>,
        link_id: u8,
        timestamp: u64,
        accept_unsigned: bool,
        unsigned_ids: Vec<u32>,
        max_behind: f64,
        max_ahead: f64,
        reorder_slack: f64,
        max_streams: usize,
    ) -> PyResult<Self> {
        let key: [u8; 32] = (*key)
            .try_into()
            .map_err(|_| SigningError::new_err(format!("a signing key has 32 bytes, not {}", key.len())))?;
        if timestamp > MAX_TIMESTAMP {
            return Err(SigningError::new_err(format!("a signing timestamp has 48 bits; {timestamp} has more")));
        }
        let policy = Policy {
            accept_unsigned,
            unsigned_ids,
            max_behind: units(max_behind),
            max_ahead: units(max_ahead),
            reorder_slack: units(reorder_slack),
            max_streams,
        };
        Ok(Self { core: core::Signing::new(Key::new(key), link_id, timestamp, policy) })
    }

    #[getter]
    fn link_id(&self) -> u8 {
        self.core.link_id()
    }

    /// Newest timestamp signed or accepted: persist it, and start the next run with it.
    #[getter]
    fn timestamp(&self) -> u64 {
        self.core.clock()
    }

    /// Number of streams followed.
    #[getter]
    fn streams(&self) -> usize {
        self.core.streams()
    }

    /// Packets refused, by reason.
    #[getter]
    fn refusals(&self) -> Refusals {
        self.core.refusals().into()
    }

    fn __repr__(&self) -> String {
        format!("<Signing link_id={} streams={}>", self.core.link_id(), self.core.streams())
    }
}
