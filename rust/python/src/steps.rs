//! Telling Python about parts of a file that are done with.

use pyo3::prelude::*;
use std::ops::Range;

/// A function that is called with the beginning and the end of each part of a file that is done with.
pub struct Steps {
    size: usize,
    done: Option<Py<PyAny>>,
    failed: Option<PyErr>,
}

impl Steps {
    /// Creates steps of `size` bytes, or one step of all without `size`.
    pub fn new(size: Option<usize>, done: Option<Py<PyAny>>) -> Self {
        Self { size: size.unwrap_or(usize::MAX), done, failed: None }
    }

    pub fn size(&self) -> usize {
        self.size
    }

    /// Calls the function, without the interpreter lock held.
    pub fn done(&mut self, part: Range<usize>) {
        if let Some(done) = &self.done {
            let called = Python::attach(|py| done.call1(py, (part.start, part.end)).map(drop));
            self.failed = self.failed.take().or(called.err());
        }
    }

    /// Returns the first error of the function.
    pub fn finish(self) -> PyResult<()> {
        self.failed.map_or(Ok(()), Err)
    }
}
