//! Python interface of signing. The key can be set but never read.

use crate::buffers::Bytes;
use crate::errors::SigningError;
use crate::statistics::Refusals;
use mavstack_core::signing::{self as core, EPOCH, Key, MAX_TIMESTAMP, Policy, UNITS_PER_SECOND};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::time::{SystemTime, UNIX_EPOCH};

/// Signing state of one link: signs sent packets and verifies received ones.
///
/// The parser and the encoder of the link share one object. Refused packets are counted in `refusals`. All links of
/// one key must share their clock and their streams (`for_link`), or a packet accepted on one link can be replayed on
/// another.
///
/// Args:
///     key: The 32 bytes of the key.
///     link_id: Id of the link in signatures, 0 to 255.
///     timestamp: Initial clock in 10 us since 2015-01-01 UTC: the `timestamp` stored by the last run, or 0.
///     accept_unsigned: Accept all unsigned packets.
///     unsigned_ids: Message ids accepted unsigned, such as that of RADIO_STATUS.
///     max_behind: Maximum age in seconds of the first packet of a stream.
///     max_ahead: Maximum lead in seconds of a packet over the clock.
///     reorder_slack: Maximum lag in seconds of a reordered packet behind the newest of its stream; 0 refuses all.
///     max_streams: Maximum number of streams (link id, system, component); a full table forgets streams whose packets
///         would be refused by `max_behind`.
///
/// Raises:
///     SigningError: The key does not have 32 bytes, or the timestamp does not fit 48 bits.
#[pyclass(module = "mavstack._core")]
pub struct Signing {
    pub core: core::Signing,
}

/// Converts a Unix time in seconds to a signing timestamp; times before 2015 become 0.
pub fn timestamp(now: Option<f64>) -> PyResult<Option<u64>> {
    let Some(now) = now else {
        return Ok(None);
    };
    let units = (now - EPOCH as f64) * UNITS_PER_SECOND as f64;
    if !units.is_finite() || units > MAX_TIMESTAMP as f64 {
        return Err(SigningError::new_err(format!(
            "{now} is not a valid time for signing: it must be a Unix time in seconds before the year 2104"
        )));
    }
    Ok(Some(units.max(0.0) as u64))
}

/// Returns the time from which the lead of a packet is measured: `now`, or else the system's clock, if it is set.
pub fn latest(now: Option<u64>) -> Option<u64> {
    now.or_else(|| {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).ok()?;
        let units = since_1970.as_micros().checked_sub(u128::from(EPOCH) * 1_000_000)? / 10;
        u64::try_from(units).ok()
    })
}

fn fits(timestamp: u64) -> PyResult<u64> {
    if timestamp > MAX_TIMESTAMP {
        return Err(SigningError::new_err(format!("a signing timestamp must fit 48 bits, got {timestamp}")));
    }
    Ok(timestamp)
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
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of the Python class")]
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
            .map_err(|_| SigningError::new_err(format!("a signing key must have 32 bytes, got {}", key.len())))?;
        fits(timestamp)?;
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

    /// Id of the link in signatures.
    #[getter]
    fn link_id(&self) -> u8 {
        self.core.link_id()
    }

    /// Newest timestamp sent or accepted, in 10 us since 2015-01-01 UTC: store it for the next run.
    #[getter]
    fn timestamp(&self) -> u64 {
        self.core.clock()
    }

    /// Number of known streams (link id, system, component) of all links.
    #[getter]
    fn streams(&self) -> usize {
        self.core.streams()
    }

    /// Newest timestamp of each stream (link id, system, component): store them for the next run.
    #[getter]
    fn stream_timestamps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let timestamps = PyDict::new(py);
        for (id, newest) in self.core.newest() {
            timestamps.set_item(id, newest)?;
        }
        Ok(timestamps)
    }

    /// Create the signing state of another link of the same key, with the same policy, clock and streams.
    ///
    /// Args:
    ///     link_id: Id of the other link in signatures, 0 to 255.
    ///
    /// Returns:
    ///     The signing state of the other link; a packet accepted by one of them is a replay for all others.
    fn for_link(&self, link_id: u8) -> Self {
        Self { core: self.core.for_link(link_id) }
    }

    /// Advance the clock of all links of the key; an older timestamp has no effect.
    ///
    /// Args:
    ///     timestamp: A trusted timestamp in 10 us since 2015-01-01 UTC, such as the one that came with the key.
    ///
    /// Raises:
    ///     SigningError: The timestamp does not fit 48 bits.
    fn advance(&mut self, timestamp: u64) -> PyResult<()> {
        self.core.advance(fits(timestamp)?);
        Ok(())
    }

    /// Restore the streams of the last run, so that its packets are refused as replays.
    ///
    /// Args:
    ///     stream_timestamps: Newest timestamp of each stream, as in the attribute of the last run.
    ///     floor: Timestamp up to which packets of all streams are refused.
    ///
    /// Raises:
    ///     SigningError: A timestamp does not fit 48 bits.
    #[pyo3(signature = (stream_timestamps, *, floor = 0))]
    fn restore(&mut self, stream_timestamps: BTreeMap<(u8, u8, u8), u64>, floor: u64) -> PyResult<()> {
        for &timestamp in stream_timestamps.values().chain([&floor]) {
            fits(timestamp)?;
        }
        self.core.restore(stream_timestamps, floor);
        Ok(())
    }

    /// Number of refused packets, by reason.
    #[getter]
    fn refusals(&self) -> Refusals {
        self.core.refusals().into()
    }

    fn __repr__(&self) -> String {
        format!("<Signing link_id={} streams={}>", self.core.link_id(), self.core.streams())
    }
}
