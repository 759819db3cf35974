//! Stream endpoints: TCP, Unix sockets, serial ports, terminals.

use crate::engine::framing::Decoder;
use crate::engine::lanes::Lanes;
use crate::ports::PortId;
use crate::router::{Origin, QueueFull};
use mio::event::Source;
use std::io::{self, Read, Write};

#[cfg(unix)]
type Handle = std::fs::File;
#[cfg(not(unix))]
type Handle = mio::net::TcpStream;

/// A stream without a port of its own yet.
#[derive(Debug)]
pub struct RawStream(pub(super) Handle);

impl RawStream {
    /// Takes over a stream; it becomes non-blocking.
    #[cfg(unix)]
    pub fn new(stream: std::os::fd::OwnedFd) -> io::Result<Self> {
        rustix::io::ioctl_fionbio(&stream, true)?;
        Ok(Self(Handle::from(stream)))
    }

    /// Takes over a socket; it becomes non-blocking.
    #[cfg(windows)]
    pub fn new(stream: std::os::windows::io::OwnedSocket) -> io::Result<Self> {
        let stream = std::net::TcpStream::from(stream);
        stream.set_nonblocking(true)?;
        Ok(Self(Handle::from_std(stream)))
    }
}

impl RawStream {
    /// Reads into `buffer`; returns the number of bytes, and 0 at the end of the stream.
    pub fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }

    /// Calls `use_source` with the event source.
    pub fn with_source(&mut self, use_source: impl FnOnce(&mut dyn Source) -> io::Result<()>) -> io::Result<()> {
        #[cfg(unix)]
        {
            use std::os::fd::AsRawFd;
            use_source(&mut mio::unix::SourceFd(&self.0.as_raw_fd()))
        }
        #[cfg(not(unix))]
        use_source(&mut self.0)
    }
}

/// The division of a stream into packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// Packets alone.
    None,
    /// A 4-byte big-endian length before each packet; received frames may hold several packets.
    Length,
}

/// Bytes that are taken from the lanes at a time. Those that a slow stream does not accept wait before all others.
const CHUNK: usize = 4096;

/// A stream with the packets that wait to be sent.
#[derive(Debug)]
pub struct StreamLink {
    pub stream: RawStream,
    pub port: PortId,
    framing: Option<Decoder>,
    lanes: Lanes,
    /// The bytes that are sent next, of which `sent` are sent already.
    chunk: Vec<u8>,
    sent: usize,
    /// The system accepts no more bytes.
    is_blocked: bool,
    /// Bytes that may wait; a packet that exceeds them is dropped.
    limit: usize,
}

impl StreamLink {
    pub fn new(stream: RawStream, port: PortId, framing: Framing, limit: usize) -> Self {
        let framing = (framing == Framing::Length).then(Decoder::default);
        let (lanes, chunk) = (Lanes::default(), Vec::new());
        Self { stream, port, framing, lanes, chunk, sent: 0, is_blocked: false, limit }
    }

    /// Reads into `buffer`; returns the number of bytes, and 0 at the end of the stream.
    pub fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.read(buffer)
    }

    /// Appends the content of received frames to `content`; returns whether the stream consists of frames.
    pub fn decode(&mut self, data: &[u8], content: &mut Vec<u8>) -> Result<bool, String> {
        let Some(decoder) = &mut self.framing else {
            return Ok(false);
        };
        let fed = decoder.feed(data, |part| content.extend_from_slice(part));
        fed.map_err(|error| format!("a frame of {} bytes, so it is no stream of frames", error.0))?;
        Ok(true)
    }

    #[must_use]
    pub fn queued(&self) -> usize {
        self.lanes.len() + self.chunk.len() - self.sent
    }

    #[inline]
    pub fn send(&mut self, packet: &[u8], origin: Origin) -> Result<(), QueueFull> {
        let added = self.add(packet, origin);
        if added.is_err() && !self.is_blocked && self.flush().is_ok() {
            return self.add(packet, origin);
        }
        added
    }

    #[inline]
    fn add(&mut self, packet: &[u8], origin: Origin) -> Result<(), QueueFull> {
        let length = (packet.len() as u32).to_be_bytes();
        let prefix = if self.framing.is_some() { &length[..] } else { &[] };
        let free = self.limit.saturating_sub(self.queued());
        self.lanes.push(origin, prefix, packet, free)
    }

    /// Writes what waits, until the system accepts no more.
    pub fn flush(&mut self) -> io::Result<()> {
        self.is_blocked = false;
        loop {
            if self.sent == self.chunk.len() {
                self.chunk.clear();
                self.sent = 0;
                self.lanes.take(&mut self.chunk, CHUNK);
            }
            if self.chunk.is_empty() {
                return Ok(());
            }
            match self.stream.0.write(&self.chunk[self.sent..]) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => self.sent += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    self.is_blocked = true;
                    return Ok(());
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
}
