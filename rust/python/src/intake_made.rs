//! The objects of latest packets: one for each packet, until the next one of its source and message is asked for.

use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// System, component and message id.
type Key = (u8, u8, u32);
/// Objects, with the numbers of their packets.
type Made = HashMap<Key, (u64, Py<PyAny>)>;

/// The objects. None is dropped with the lock: it may run a finalizer of the program.
#[derive(Default)]
pub struct MadePackets(Mutex<Made>);

impl MadePackets {
    fn lock(&self) -> MutexGuard<'_, Made> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the object of a packet with a number, if it was made.
    pub fn find<'py>(&self, py: Python<'py>, key: Key, number: u64) -> Option<Bound<'py, PyAny>> {
        let made = self.lock();
        made.get(&key).filter(|(known, _)| *known == number).map(|(_, made)| made.bind(py).clone())
    }

    /// Keeps the object of a packet in place of the one before.
    pub fn keep(&self, key: Key, number: u64, made: &Bound<'_, PyAny>) {
        let before = self.lock().insert(key, (number, made.clone().unbind()));
        drop(before);
    }

    /// Forgets the objects of a system.
    pub fn clear(&self, system: u8) {
        let cleared: Made = self.lock().extract_if(|key, _| key.0 == system).collect();
        drop(cleared);
    }
}
