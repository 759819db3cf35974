//! The walk from message to message, and the search for the next message after damage.
//!
//! A message is *certain* if its kind fixes its size and content: a record of a subscribed id with the size of its
//! definition, a synchronisation mark, a dropout. It is *likely* if its text looks as it must, and *possible* if only
//! its header makes sense: a record of an unknown id or of another size, a kind of a later version. A likely or possible
//! message is accepted if a certain one follows within a few messages, so that a damaged size does not swallow the
//! messages after it.

use super::catalog::Catalog;
use super::header::{HEADER, Header, MESSAGE_HEADER};
use super::layout::Format;
use super::u16_at;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Body of a synchronisation mark.
pub const SYNC: &[u8] = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12";
/// Maximum size of a message of an unknown kind; a larger one is taken for damage.
const MAX_UNKNOWN: usize = 10_000;
/// Number of messages after an uncertain one that are examined.
const LOOKAHEAD: usize = 8;
/// Number of bytes of a text that are examined, so that the search takes constant time per byte.
const MAX_EXAMINED: usize = 300;
/// Size of the flag bits, in the version of the format that is known.
const FLAG_BITS: usize = 40;
/// Sizes of the fixed parts of logged texts.
const TEXT: usize = 9;
const TAGGED_TEXT: usize = 11;

/// A message of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Message<'a> {
    pub kind: u8,
    /// Position of its header.
    pub start: usize,
    pub body: &'a [u8],
}

impl Message<'_> {
    /// Position of the message after it.
    #[must_use]
    pub fn end(&self) -> usize {
        self.start + MESSAGE_HEADER + self.body.len()
    }
}

/// Everything that was not read, and why.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Damage {
    /// Bytes that belong to no message, and the number of places where they are.
    pub bad_bytes: u64,
    pub gaps: u64,
    /// Bytes of messages that the end of the file or of a section cuts off.
    pub truncated_bytes: u64,
    /// Records whose size does not match their definition.
    pub wrong_size: u64,
    /// Definitions and subscriptions that cannot be used.
    pub bad_definitions: u64,
    /// Records by their id without a usable subscription.
    pub unsubscribed: BTreeMap<u16, u64>,
    /// Messages of unknown kinds.
    pub unknown_kinds: BTreeMap<u8, u64>,
}

impl Damage {
    /// Adds the counts of a later part of the file.
    pub fn add(&mut self, other: Self) {
        self.bad_bytes += other.bad_bytes;
        self.gaps += other.gaps;
        self.truncated_bytes += other.truncated_bytes;
        self.wrong_size += other.wrong_size;
        self.bad_definitions += other.bad_definitions;
        for (id, count) in other.unsubscribed {
            *self.unsubscribed.entry(id).or_default() += count;
        }
        for (kind, count) in other.unknown_kinds {
            *self.unknown_kinds.entry(kind).or_default() += count;
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Certain,
    Likely,
    Possible,
    Bad,
}

/// State of a scan between two messages.
#[derive(Debug, Clone)]
pub struct State {
    pub position: usize,
    pub catalog: Arc<Catalog>,
}

impl Default for State {
    fn default() -> Self {
        Self { position: HEADER, catalog: Arc::default() }
    }
}

/// Walks over the messages of a file.
#[derive(Debug)]
pub struct Scanner<'a> {
    data: &'a [u8],
    header: &'a Header,
    pub state: State,
    pub damage: Damage,
    section_end: usize,
}

impl<'a> Scanner<'a> {
    #[must_use]
    pub fn new(data: &'a [u8], header: &'a Header, state: State) -> Self {
        let section_end = header.section_end(state.position, data.len());
        Self { data, header, state, damage: Damage::default(), section_end }
    }

    /// Returns the next message; None at the end of the file.
    #[inline]
    pub fn next_message(&mut self) -> Option<Message<'a>> {
        loop {
            let position = self.state.position;
            if position < self.section_end {
                let (verdict, message) = self.assess(position);
                let found = match (verdict, message) {
                    (Verdict::Certain, Some(message)) => match self.damaged_until(&message) {
                        None => Some(message),
                        Some(inner) => {
                            self.skip_to(inner);
                            continue;
                        }
                    },
                    (Verdict::Bad, _) | (_, None) => None,
                    (Verdict::Likely, Some(message)) => Some(message).filter(|message| self.has_successors(message)),
                    // Only its header speaks for this message: it must not swallow others.
                    (Verdict::Possible, Some(message)) => Some(message).filter(|message| {
                        self.has_successors(message) && self.search(message.start + 1..message.end()).is_none()
                    }),
                };
                if let Some(message) = found {
                    self.state.position = message.end();
                    return Some(message);
                }
                if let Some(message) = self.recover(verdict, message) {
                    return Some(message);
                }
            } else if self.section_end < self.data.len() {
                self.section_end = self.header.section_end(position, self.data.len());
            } else {
                return None;
            }
        }
    }

    /// Returns where the next message begins if it is inside this record, of which bytes were lost then.
    ///
    /// A record directly before another message is complete.
    #[inline]
    fn damaged_until(&self, message: &Message<'_>) -> Option<usize> {
        let end = message.end();
        let complete = end == self.section_end || matches!(self.assess(end).0, Verdict::Certain | Verdict::Likely);
        if complete { None } else { self.search(message.start + 1..end) }
    }

    fn skip_to(&mut self, position: usize) {
        self.damage.bad_bytes += (position - self.state.position) as u64;
        self.damage.gaps += 1;
        self.state.position = position;
    }

    /// Assesses the message at a position of the section.
    #[inline]
    fn assess(&self, position: usize) -> (Verdict, Option<Message<'a>>) {
        let section = &self.data[..self.section_end];
        let start = position + MESSAGE_HEADER;
        let (Some(size), Some(&kind)) = (u16_at(section, position), section.get(start - 1)) else {
            return (Verdict::Bad, None);
        };
        let Some(body) = section.get(start..start + usize::from(size)) else {
            return (Verdict::Bad, None);
        };
        let message = Message { kind, start: position, body };
        (self.assess_body(kind, body), Some(message))
    }

    #[inline]
    fn assess_body(&self, kind: u8, body: &[u8]) -> Verdict {
        let (certain, likely) = match kind {
            b'D' => {
                let subscription = u16_at(body, 0).and_then(|id| self.state.catalog.subscription(id));
                (subscription.is_some_and(|subscription| subscription.accepts(body.len() - 2)), false)
            }
            b'S' => (body == SYNC, false),
            b'O' => (body.len() == 2, false),
            _ => (false, self.is_likely(kind, body)),
        };
        match () {
            () if certain => Verdict::Certain,
            () if likely => Verdict::Likely,
            () if kind == 0 || body.is_empty() || !is_known(kind) && body.len() > MAX_UNKNOWN => Verdict::Bad,
            () => Verdict::Possible,
        }
    }

    fn is_likely(&self, kind: u8, body: &[u8]) -> bool {
        let is_level =
            |size: usize| body.len() >= size && body.first().is_some_and(|level| (b'0'..b'8').contains(level));
        match kind {
            b'L' => is_level(TEXT),
            b'C' => is_level(TAGGED_TEXT),
            b'I' | b'P' => has_key(body),
            b'M' => body.first().is_some_and(|&continued| continued <= 1) && has_key(&body[1..]),
            b'Q' => body.first().is_some_and(|types| (1..=3).contains(types)) && has_key(&body[1..]),
            b'F' => {
                let head = &body[..body.len().min(MAX_EXAMINED)];
                head.contains(&b':') && head.iter().all(|byte| (b' '..0x7F).contains(byte))
            }
            b'A' if body.len() <= MAX_EXAMINED => {
                Catalog::parse_subscription(body).is_some_and(|(_, _, name)| self.state.catalog.defines(name))
            }
            b'B' => body.len() == FLAG_BITS,
            _ => false,
        }
    }

    /// Returns whether the messages after one make sense: a certain one or the end of the section follows.
    fn has_successors(&self, message: &Message<'_>) -> bool {
        let mut position = message.end();
        for _ in 0..LOOKAHEAD {
            if position == self.section_end {
                return true;
            }
            match self.assess(position) {
                (Verdict::Certain, _) => return true,
                (Verdict::Likely | Verdict::Possible, Some(next)) => position = next.end(),
                // A message that the end of the section cuts off.
                _ => return false,
            }
        }
        true
    }

    /// Passes over damage, and returns the message before it if that one is complete.
    #[cold]
    fn recover(&mut self, verdict: Verdict, message: Option<Message<'a>>) -> Option<Message<'a>> {
        let position = self.state.position;
        let next = self.search(position + 1..self.section_end);
        // No other message begins inside this one: the damage is behind it.
        if let Some(message) = message.filter(|message| verdict != Verdict::Bad && is_known(message.kind))
            && next.unwrap_or(self.section_end) >= message.end()
        {
            self.state.position = message.end();
            return Some(message);
        }
        self.state.position = next.unwrap_or(self.section_end);
        let skipped = (self.state.position - position) as u64;
        if next.is_none() && self.is_cut_off(position) {
            self.damage.truncated_bytes += skipped;
        } else {
            self.damage.bad_bytes += skipped;
            self.damage.gaps += 1;
        }
        None
    }

    /// Returns whether the message at a position makes sense, but is longer than the section.
    fn is_cut_off(&self, position: usize) -> bool {
        let section = &self.data[..self.section_end];
        let end = u16_at(section, position).map(|size| position + MESSAGE_HEADER + usize::from(size));
        let kind = section.get(position + MESSAGE_HEADER - 1);
        end.is_none_or(|end| end > self.section_end) && kind.is_none_or(|&kind| is_known(kind))
    }

    /// Finds the first position of a range from which messages follow each other.
    fn search(&self, range: Range<usize>) -> Option<usize> {
        (range.start..range.end.min(self.section_end.saturating_sub(MESSAGE_HEADER)))
            .find(|&position| is_known(self.data[position + MESSAGE_HEADER - 1]) && self.is_start(position))
    }

    fn is_start(&self, position: usize) -> bool {
        let (verdict, message) = self.assess(position);
        let Some(message) = message.filter(|_| matches!(verdict, Verdict::Certain | Verdict::Likely)) else {
            return false;
        };
        let follows = || {
            message.end() == self.section_end
                || matches!(self.assess(message.end()).0, Verdict::Certain | Verdict::Likely)
        };
        message.kind == b'S' || follows()
    }

    /// Finds a position in a range from which messages follow each other, to start another scan there.
    #[must_use]
    pub fn find_start(
        data: &'a [u8],
        header: &'a Header,
        catalog: &Arc<Catalog>,
        range: Range<usize>,
    ) -> Option<usize> {
        let state = State { position: range.start, catalog: Arc::clone(catalog) };
        let mut scanner = Self::new(data, header, state);
        scanner.section_end = scanner.section_end.min(range.end);
        scanner.search(range)
    }
}

fn is_known(kind: u8) -> bool {
    matches!(kind, b'A'..=b'D' | b'F' | b'I' | b'L'..=b'M' | b'O'..=b'S')
}

/// Returns whether a body begins with the key of a value: its length, then `type name`.
fn has_key(body: &[u8]) -> bool {
    let key = body.split_first().and_then(|(&size, rest)| rest.get(..usize::from(size)));
    key.is_some_and(|key| {
        key.first().is_some_and(u8::is_ascii_lowercase)
            && key.contains(&b' ')
            && key.iter().all(|byte| (b' '..0x7F).contains(byte))
    })
}

impl Scanner<'_> {
    /// Takes in a definition or a subscription; other messages teach nothing.
    pub(super) fn learn(&mut self, kind: u8, body: &[u8]) {
        match kind {
            b'F' => self.define(body),
            b'A' => self.subscribe(body),
            _ => {}
        }
    }

    fn define(&mut self, body: &[u8]) {
        let Some(format) = Format::parse(body) else {
            self.damage.bad_definitions += 1;
            return;
        };
        if !self.state.catalog.has_format(&format) && !Arc::make_mut(&mut self.state.catalog).define(format) {
            self.damage.bad_definitions += 1;
        }
    }

    fn subscribe(&mut self, body: &[u8]) {
        let Some(subscription) = Catalog::parse_subscription(body) else {
            self.damage.bad_definitions += 1;
            return;
        };
        if !self.state.catalog.has_subscription(subscription)
            && !Arc::make_mut(&mut self.state.catalog).subscribe(subscription)
        {
            self.damage.bad_definitions += 1;
        }
    }
}
