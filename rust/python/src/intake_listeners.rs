//! The listeners of a node that the core calls.

use crate::packet;
use mavstack_intake::messages::{KeyMap, key, matches};
use pyo3::exceptions::PyException;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use std::sync::{Mutex, MutexGuard, PoisonError};

type Table = KeyMap<u64, Py<PyTuple>>;

/// The functions of the listeners of each source and message.
#[derive(Default)]
pub struct Listeners(Mutex<Table>);

impl Listeners {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn set(&self, key: u64, functions: Bound<'_, PyTuple>) {
        let before = self.table().insert(key, functions.unbind());
        drop(before); // without the lock: it may run a finalizer of the program
    }

    /// Forgets the listeners of a message (`None`: all messages) of a system (0: all systems).
    pub fn forget(&self, message_id: Option<u32>, system: u8) {
        let forgotten: Vec<_> = self.table().extract_if(|&key, _| matches(key, message_id, system)).collect();
        drop(forgotten); // as above
    }

    /// Calls the listeners of packets, which `find` returns if they are not known, and `fail` with each exception.
    pub fn deliver(
        &self,
        packets: &Bound<'_, PyList>,
        find: &Bound<'_, PyAny>,
        fail: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let py = packets.py();
        for packet in packets {
            let key = packet::with_parts(&packet, |header, _| key(header.system, header.component, header.message_id))?;
            let known = self.table().get(&key).map(|known| known.clone_ref(py));
            let functions = match known {
                Some(functions) => functions.into_bound(py),
                None => find.call1((&packet,))?.cast_into()?,
            };
            functions.iter().try_for_each(|function| call(&function, &packet, fail))?;
        }
        Ok(())
    }
}

/// Calls a function with a packet, and another one with the exception that it raises.
fn call(function: &Bound<'_, PyAny>, packet: &Bound<'_, PyAny>, fail: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = packet.py();
    // SAFETY: both objects are held, and the list of arguments ends with null. Other than `call1`, it needs no tuple.
    let result = unsafe {
        let end = std::ptr::null_mut::<ffi::PyObject>();
        let result = ffi::PyObject_CallFunctionObjArgs(function.as_ptr(), packet.as_ptr(), end);
        Bound::from_owned_ptr_or_err(py, result)
    };
    match result {
        Ok(_) => Ok(()),
        Err(error) if error.is_instance_of::<PyException>(py) => fail.call1((error,)).map(drop),
        Err(error) => Err(error),
    }
}
