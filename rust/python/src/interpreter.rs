//! The interpreter that imports the core.

use pyo3::exceptions::PyImportError;
use pyo3::{ffi, prelude::*};

/// The number of the interpreter in which a process starts.
const MAIN: i64 = 0;

/// Refuses the import in a sub-interpreter: classes and free lists exist once in a process, and belong to the main one.
pub fn require_main(_: Python<'_>) -> PyResult<()> {
    // SAFETY: the caller is attached to an interpreter, which both functions require.
    let number = unsafe { ffi::PyInterpreterState_GetID(ffi::PyInterpreterState_Get()) };
    if number == MAIN {
        return Ok(());
    }
    Err(PyImportError::new_err(format!(
        "importing mavstack failed: this is sub-interpreter {number}, and the core works in the main interpreter only; \
         import mavstack there, or in a process of its own"
    )))
}
