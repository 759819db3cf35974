//! A descriptor that is readable while events wait, so that event loops can wait for it.

use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicU8, Ordering};

#[cfg(unix)]
type Pipe = std::os::unix::net::UnixStream;
#[cfg(not(unix))]
type Pipe = std::net::TcpStream;

#[cfg(unix)]
fn pair() -> io::Result<(Pipe, Pipe)> {
    Pipe::pair()
}

/// Two connected sockets; a connection from elsewhere is refused.
#[cfg(not(unix))]
fn pair() -> io::Result<(Pipe, Pipe)> {
    let listener = std::net::TcpListener::bind(("127.0.0.1", 0))?;
    let reader = Pipe::connect(listener.local_addr()?)?;
    loop {
        let (writer, address) = listener.accept()?;
        if address == reader.local_addr()? {
            return Ok((reader, writer));
        }
    }
}

/// Both ends of the signal.
#[derive(Debug)]
pub struct Notifier {
    reader: Pipe,
    writer: Pipe,
    /// Whether there may be a byte to read: it saves the system calls that would find none.
    state: AtomicU8,
}

/// There is no byte to read.
const UNSET: u8 = 0;
/// A byte is being written: the program may read it before the thread that wrote it runs again.
const SETTING: u8 = 1;
/// There may be a byte to read.
const SET: u8 = 2;

impl Notifier {
    pub fn new() -> io::Result<Self> {
        let (reader, writer) = pair()?;
        reader.set_nonblocking(true)?;
        writer.set_nonblocking(true)?;
        Ok(Self { reader, writer, state: AtomicU8::new(UNSET) })
    }

    /// Makes the descriptor readable.
    pub fn set(&self) {
        self.state.store(SETTING, Ordering::Release);
        // A full pipe is readable already.
        let _ = (&self.writer).write(&[1]);
        // Only now: a `clear` before the byte came leaves it to the next one.
        self.state.store(SET, Ordering::Release);
    }

    /// Makes the descriptor unreadable.
    pub fn clear(&self) {
        // The state of a write that is under way stays: its byte may still come.
        let found = self.state.compare_exchange(SET, UNSET, Ordering::AcqRel, Ordering::Acquire);
        if found == Err(UNSET) {
            return;
        }
        let mut bytes = [0; 64];
        // A short read empties it.
        while matches!((&self.reader).read(&mut bytes), Ok(count) if count == bytes.len()) {}
    }

    #[cfg(unix)]
    #[must_use]
    pub fn descriptor(&self) -> i64 {
        i64::from(std::os::fd::AsRawFd::as_raw_fd(&self.reader))
    }

    #[cfg(windows)]
    #[must_use]
    pub fn descriptor(&self) -> i64 {
        std::os::windows::io::AsRawSocket::as_raw_socket(&self.reader) as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(notifier: &Notifier) -> usize {
        let mut bytes = [0; 64];
        (&notifier.reader).read(&mut bytes).unwrap_or(0)
    }

    #[test]
    fn what_was_signalled_is_cleared() {
        let notifier = Notifier::new().expect("sockets");
        notifier.clear();
        notifier.set();
        notifier.set();
        assert_eq!(bytes(&notifier), 2);
        notifier.set();
        notifier.clear();
        assert_eq!(bytes(&notifier), 0);
    }

    #[test]
    fn a_signal_is_cleared_before_the_thread_that_set_it_runs_again() {
        let notifier = Notifier::new().expect("sockets");
        notifier.state.store(SETTING, Ordering::Release);
        notifier.clear(); // the byte is not there yet
        let _ = (&notifier.writer).write(&[1]);
        notifier.clear();
        assert_eq!(bytes(&notifier), 0, "an event loop would wake again and again");
        notifier.state.store(SET, Ordering::Release);
        notifier.set();
        notifier.clear();
        assert_eq!(bytes(&notifier), 0);
    }

    #[test]
    fn a_signal_that_comes_while_another_thread_clears_is_not_lost() {
        let notifier = Notifier::new().expect("sockets");
        let _ = (&notifier.writer).write(&[1]); // the first half of `set`
        notifier.clear();
        assert_eq!(bytes(&notifier), 1, "the descriptor stays readable");
        notifier.set();
        notifier.clear();
        assert_eq!(bytes(&notifier), 0);
    }
}
