//! Guards of mapped files: a page that cannot be read (SIGBUS) is replaced by zeros and reported, and ends no process.
//!
//! The kernel raises SIGBUS in the thread that reads a mapped byte if the disk fails, or if the file was truncated. The
//! handler finds the guarded mapping of the address, replaces the whole mapping by zeros, marks the guard, and returns,
//! so that the reader continues. Its result is worth nothing, and the owner of the guard asks for the mark before it
//! uses the result. All other SIGBUS signals go to the handler that was installed before.

use crate::memory::{require_read_only, shared};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;

#[cfg(not(unix))]
use without_signals as signals;

/// Keeps a failing disk under a mapped file from ending the process.
///
/// While the guard exists, a byte that the disk does not deliver (an error of the disk, a truncated file) reads as zero, as
/// do all bytes of the mapping from then on, and `failed` becomes true.
///
/// Args:
///     data: The mapped file, a read-only `mmap.mmap` of the beginning of a file; it stays mapped as long as the guard.
///
/// Raises:
///     BufferError: The buffer is writable.
///     OSError: The handler of the signal cannot be installed.
#[pyclass(frozen, module = "mavstack._core")]
pub struct MappingGuard {
    registration: signals::Registration,
    _data: PyBuffer<u8>,
}

#[pymethods]
impl MappingGuard {
    #[new]
    fn new(data: PyBuffer<u8>) -> PyResult<Self> {
        require_read_only(&data)?;
        // SAFETY: the slice is not read; only its address and its size are used.
        let bytes = unsafe { shared(&data) }?;
        let registration = signals::Registration::new(bytes.as_ptr().addr(), bytes.len())?;
        Ok(Self { registration, _data: data })
    }

    /// True if a byte of the mapping could not be read; all bytes are zeros since then.
    #[getter]
    fn failed(&self) -> bool {
        self.registration.failed()
    }
}

#[cfg(unix)]
mod signals {
    use std::io;
    use std::mem::MaybeUninit;
    use std::ptr::null_mut;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicUsize, Ordering};

    /// Value of `start` without a mapping: no address is as large.
    const FREE: usize = usize::MAX;

    /// One mapping. Entries are used again, and never freed: the handler may look at them at any time.
    struct Entry {
        start: AtomicUsize,
        size: AtomicUsize,
        failed: AtomicBool,
        next: Option<&'static Entry>,
    }

    /// The newest entry. The handler takes no lock, so that it can interrupt any thread.
    static ENTRIES: AtomicPtr<Entry> = AtomicPtr::new(null_mut());
    static PREVIOUS: AtomicPtr<libc::sigaction> = AtomicPtr::new(null_mut());
    static PASSED_ON: AtomicBool = AtomicBool::new(false);
    static CHANGES: Mutex<()> = Mutex::new(());

    fn entries() -> impl Iterator<Item = &'static Entry> {
        // SAFETY: the pointer is null or comes from `Box::leak`.
        let newest = unsafe { ENTRIES.load(Ordering::Acquire).as_ref() };
        std::iter::successors(newest, |entry: &&'static Entry| entry.next)
    }

    /// An entry of the list, until it is dropped.
    pub struct Registration(&'static Entry);

    impl Registration {
        pub fn new(start: usize, size: usize) -> io::Result<Self> {
            let _changes = CHANGES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            install()?;
            let free = entries().find(|entry| entry.start.load(Ordering::Acquire) == FREE);
            let entry = free.unwrap_or_else(add);
            entry.failed.store(false, Ordering::Relaxed);
            entry.size.store(size, Ordering::Relaxed);
            entry.start.store(start, Ordering::Release);
            Ok(Self(entry))
        }

        pub fn failed(&self) -> bool {
            self.0.failed.load(Ordering::Acquire)
        }
    }

    impl Drop for Registration {
        fn drop(&mut self) {
            self.0.start.store(FREE, Ordering::Release);
        }
    }

    fn add() -> &'static Entry {
        let entry = Box::leak(Box::new(Entry {
            start: AtomicUsize::new(FREE),
            size: AtomicUsize::new(0),
            failed: AtomicBool::new(false),
            next: entries().next(),
        }));
        ENTRIES.store(entry, Ordering::Release);
        entry
    }

    /// Installs the handler, also where another library has replaced it since.
    fn install() -> io::Result<()> {
        let handler: extern "C" fn(libc::c_int, *mut libc::siginfo_t, *mut libc::c_void) = handle;
        let mut current = MaybeUninit::<libc::sigaction>::zeroed();
        // SAFETY: both structures are valid, and the handler has the signature that SA_SIGINFO asks for.
        unsafe {
            if libc::sigaction(libc::SIGBUS, std::ptr::null(), current.as_mut_ptr()) != 0 {
                return Err(io::Error::last_os_error());
            }
            let current = current.assume_init();
            if current.sa_sigaction == handler as libc::sighandler_t {
                return Ok(());
            }
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = handler as libc::sighandler_t;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigemptyset(&raw mut action.sa_mask);
            // Leaked, like the entries: the handler may be reading the one before.
            PREVIOUS.store(Box::leak(Box::new(current)), Ordering::Release);
            if libc::sigaction(libc::SIGBUS, &raw const action, null_mut()) != 0 {
                return Err(io::Error::last_os_error());
            }
        }
        Ok(())
    }

    /// Replaces the mapping that failed, or leaves the signal to the handler before. Only async-signal-safe calls.
    extern "C" fn handle(_signal: libc::c_int, information: *mut libc::siginfo_t, _context: *mut libc::c_void) {
        // SAFETY: the kernel passes a valid structure to a handler with SA_SIGINFO.
        let (address, from_kernel) = unsafe { ((*information).si_addr().addr(), (*information).si_code > 0) };
        if !(from_kernel && replace(address)) {
            pass_on();
        }
    }

    fn replace(address: usize) -> bool {
        for entry in entries() {
            let start = entry.start.load(Ordering::Acquire);
            let size = entry.size.load(Ordering::Relaxed);
            if start != FREE && (start..start.saturating_add(size)).contains(&address) {
                entry.failed.store(true, Ordering::Release);
                return replace_by_zeros(start, size);
            }
        }
        false
    }

    fn replace_by_zeros(start: usize, size: usize) -> bool {
        let flags = libc::MAP_PRIVATE | libc::MAP_ANON | libc::MAP_FIXED;
        // SAFETY: the guard keeps the mapping, which Python cannot write to; it is replaced in one step.
        let result =
            unsafe { libc::mmap(std::ptr::with_exposed_provenance_mut(start), size, libc::PROT_READ, flags, -1, 0) };
        result != libc::MAP_FAILED
    }

    /// Restores the handler before, which the instruction that failed raises again; a second time, the default.
    fn pass_on() {
        let previous = PREVIOUS.load(Ordering::Acquire);
        // SAFETY: the structures are valid, and `sigaction` may be called by a handler.
        unsafe {
            if PASSED_ON.swap(true, Ordering::AcqRel) || previous.is_null() {
                libc::signal(libc::SIGBUS, libc::SIG_DFL);
            } else {
                libc::sigaction(libc::SIGBUS, previous, null_mut());
            }
        }
    }
}

/// Systems without SIGBUS: Windows raises an exception of its own, and refuses to truncate a mapped file.
#[cfg(not(unix))]
mod without_signals {
    use std::io;

    pub struct Registration;

    impl Registration {
        #[expect(clippy::unnecessary_wraps, reason = "the signature of Unix")]
        pub fn new(_start: usize, _size: usize) -> io::Result<Self> {
            Ok(Self)
        }

        #[expect(clippy::unused_self, reason = "the signature of Unix")]
        pub fn failed(&self) -> bool {
            false
        }
    }
}
