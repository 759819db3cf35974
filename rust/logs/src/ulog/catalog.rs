//! Definitions and subscriptions that a scan has met so far.

use super::layout::{Format, Layout};
use super::{u16_at, u64_at};
use std::collections::HashMap;

/// Maximum number of tables, and of the fields of all of them: a hostile file must not fill the memory with names.
const MAX_TABLES: usize = 1 << 13;
const MAX_FIELDS: usize = 1 << 18;

/// A topic.
#[derive(Debug, Clone)]
pub struct Table {
    pub name: String,
    pub layout: Layout,
}

/// The table and instance that the records of an id belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Subscription {
    pub table: u32,
    pub instance: u8,
    min_size: u16,
    max_size: u16,
    /// Position of the time in a record.
    timestamp: Option<u16>,
}

impl Subscription {
    /// Returns whether a record of that many bytes is complete.
    #[must_use]
    pub fn accepts(&self, size: usize) -> bool {
        (usize::from(self.min_size)..=usize::from(self.max_size)).contains(&size)
    }

    /// Returns the time of a record in microseconds since boot.
    #[must_use]
    pub fn time_of(&self, record: &[u8]) -> Option<u64> {
        u64_at(record, self.timestamp?.into())
    }
}

/// Definitions and subscriptions. Tables are only added, never changed.
#[derive(Debug, Clone)]
pub struct Catalog {
    formats: HashMap<String, Format>,
    tables: Vec<Table>,
    numbers: HashMap<String, u32>,
    subscriptions: Vec<Option<Subscription>>,
    /// Number of fields that may still be examined.
    budget: usize,
}

impl Default for Catalog {
    fn default() -> Self {
        let (formats, numbers) = (HashMap::new(), HashMap::new());
        Self { formats, tables: Vec::new(), numbers, subscriptions: Vec::new(), budget: MAX_FIELDS }
    }
}

impl Catalog {
    /// The topics, in the order of their first subscription.
    #[must_use]
    pub fn tables(&self) -> &[Table] {
        &self.tables
    }

    /// Number of the table of a topic.
    #[must_use]
    pub fn table(&self, name: &str) -> Option<usize> {
        self.numbers.get(name).map(|&number| number as usize)
    }

    /// Subscription with an id.
    #[inline]
    #[must_use]
    pub fn subscription(&self, id: u16) -> Option<&Subscription> {
        self.subscriptions.get(usize::from(id))?.as_ref()
    }

    /// Returns whether a topic was defined.
    #[must_use]
    pub fn defines(&self, name: &str) -> bool {
        self.formats.contains_key(name)
    }

    /// Returns whether a definition is known already, so that adding it would change nothing.
    #[must_use]
    pub fn has_format(&self, format: &Format) -> bool {
        self.formats.get(&format.name) == Some(format)
    }

    /// Adds a definition, unless a table with another one exists.
    ///
    /// Returns whether it was added.
    pub fn define(&mut self, format: Format) -> bool {
        let free = !self.numbers.contains_key(&format.name);
        if free {
            self.formats.insert(format.name.clone(), format);
        }
        free
    }

    /// Reads the body of a subscription: instance, id, name of the topic; None if it is malformed.
    #[must_use]
    pub fn parse_subscription(body: &[u8]) -> Option<(u16, u8, &str)> {
        let (&instance, id) = (body.first()?, u16_at(body, 1)?);
        Some((id, instance, std::str::from_utf8(&body[3..]).ok()?))
    }

    /// Returns whether an id stands for that topic and instance already.
    #[must_use]
    pub fn has_subscription(&self, (id, instance, name): (u16, u8, &str)) -> bool {
        let same = |known: &Subscription| {
            known.instance == instance && self.tables.get(known.table as usize).is_some_and(|table| table.name == name)
        };
        self.subscription(id).is_some_and(same)
    }

    /// Adds a subscription; returns whether its topic has a usable definition.
    pub fn subscribe(&mut self, (id, instance, name): (u16, u8, &str)) -> bool {
        let subscription = self.add_table(name).map(|table| {
            let layout = &self.tables[table].layout;
            Subscription {
                table: table as u32,
                instance,
                min_size: layout.min_record as u16,
                max_size: layout.max_record as u16,
                timestamp: layout.timestamp.map(|position| position as u16),
            }
        });
        let id = usize::from(id);
        if self.subscriptions.len() <= id {
            self.subscriptions.resize(id + 1, None);
        }
        self.subscriptions[id] = subscription;
        subscription.is_some()
    }

    fn add_table(&mut self, name: &str) -> Option<usize> {
        if let Some(table) = self.table(name) {
            return Some(table);
        }
        if self.tables.len() >= MAX_TABLES {
            return None;
        }
        let layout = Layout::build(name, &self.formats, &mut self.budget)?;
        self.numbers.insert(name.to_owned(), self.tables.len() as u32);
        self.tables.push(Table { name: name.to_owned(), layout });
        Some(self.tables.len() - 1)
    }
}
