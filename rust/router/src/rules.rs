//! Rules: ordered conditions on packets, compiled so that a packet is compared only with those that name its message.

use crate::addressing::{COMMAND_IDS, Summary};
use crate::bucket::TokenBucket;
use crate::event::NOTICE_INTERVAL;
use mavstack_core::layout::Dialect;
use std::collections::HashMap;

/// The result of a rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Action {
    #[default]
    Pass,
    Drop,
    /// The program decides.
    Inspect,
}

/// One rule. All conditions must hold; an empty one always holds.
#[derive(Clone, Debug, Default)]
pub struct Rule {
    pub action: Action,
    pub messages: Vec<u32>,
    /// Ids of the source.
    pub systems: Vec<u8>,
    pub components: Vec<u8>,
    pub target_systems: Vec<u8>,
    /// Commands of a COMMAND_LONG or COMMAND_INT.
    pub commands: Vec<u16>,
    /// Packets per second that the rule lets pass; more are dropped.
    pub rate: Option<f64>,
    pub name: String,
    /// Count only, and continue with the next rule.
    pub dry_run: bool,
}

/// Counters of one rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RuleCounters {
    pub matched: u64,
    /// Packets that the rule dropped, or would have dropped in a dry run.
    pub dropped: u64,
}

/// The decision about a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Pass,
    /// Dropped by the rule with this index, or by the default.
    Drop(Option<usize>),
    Inspect,
}

/// A set of numbers up to 255; `None`: all.
type Ids = Option<Box<[u64; 4]>>;

fn ids(numbers: &[u8]) -> Ids {
    (!numbers.is_empty()).then(|| {
        let mut bits = Box::new([0; 4]);
        for &number in numbers {
            bits[usize::from(number / 64)] |= 1 << (number % 64);
        }
        bits
    })
}

#[inline]
fn holds(ids: &Ids, number: u8) -> bool {
    ids.as_ref().is_none_or(|bits| bits[usize::from(number / 64)] >> (number % 64) & 1 == 1)
}

#[derive(Debug)]
struct Compiled {
    action: Action,
    systems: Ids,
    components: Ids,
    target_systems: Ids,
    commands: Vec<u16>,
    bucket: Option<TokenBucket>,
    dry_run: bool,
    name: String,
    counters: RuleCounters,
    reported_at: Option<u64>,
}

impl Compiled {
    fn new(rule: Rule) -> Self {
        let mut commands = rule.commands;
        commands.sort_unstable();
        Self {
            action: rule.action,
            systems: ids(&rule.systems),
            components: ids(&rule.components),
            target_systems: ids(&rule.target_systems),
            commands,
            bucket: rule.rate.map(|rate| TokenBucket::new(rate, rate.max(1.0))),
            dry_run: rule.dry_run,
            name: rule.name,
            counters: RuleCounters::default(),
            reported_at: None,
        }
    }

    #[inline]
    fn matches(&self, packet: &Summary) -> bool {
        holds(&self.systems, packet.system)
            && holds(&self.components, packet.component)
            && holds(&self.target_systems, packet.target_system)
            && (self.commands.is_empty()
                || packet.command.is_some_and(|command| self.commands.binary_search(&command).is_ok()))
    }

    fn decide(&mut self, now: u64) -> Action {
        self.counters.matched += 1;
        let has_token = self.bucket.as_mut().is_none_or(|bucket| bucket.take(1.0, 0.0, now));
        let action = if has_token { self.action } else { Action::Drop };
        self.counters.dropped += u64::from(action == Action::Drop);
        action
    }
}

/// The rules of one direction of an endpoint. The first rule that matches decides.
#[derive(Debug, Default)]
pub struct Rules {
    ordered: Vec<Compiled>,
    default: Action,
    /// Lists of indices of rules, in order; the first list has the rules that name no message.
    candidates: Vec<Vec<u16>>,
    /// The list of each message of the dialect; empty if no rule names a message.
    by_slot: Vec<u16>,
    /// The lists of messages that the dialect lacks.
    by_id: HashMap<u32, u16>,
}

impl Rules {
    /// Compiles rules, at most 65,535; `default` applies where none matches.
    #[must_use]
    pub fn new(rules: Vec<Rule>, default: Action, dialect: &Dialect) -> Self {
        let named: Vec<Vec<u32>> = rules.iter().map(messages_of).collect();
        let candidates_of = |id: Option<u32>| -> Vec<u16> {
            let applies = |messages: &Vec<u32>| messages.is_empty() || id.is_some_and(|id| messages.contains(&id));
            (0u16..).zip(&named).filter(|(_, messages)| applies(messages)).map(|(index, _)| index).collect()
        };
        let mut compiled = Self { default, candidates: vec![candidates_of(None)], ..Self::default() };
        for id in named.iter().flatten().copied() {
            compiled.by_id.entry(id).or_insert_with(|| {
                compiled.candidates.push(candidates_of(Some(id)));
                (compiled.candidates.len() - 1) as u16
            });
        }
        if !compiled.by_id.is_empty() {
            let list_of = |id: u32| compiled.by_id.get(&id).copied().unwrap_or(0);
            compiled.by_slot = dialect.layouts().iter().map(|layout| list_of(layout.id)).collect();
        }
        compiled.ordered = rules.into_iter().map(Compiled::new).collect();
        compiled
    }

    /// Returns whether everything passes, whatever it is.
    #[inline]
    #[must_use]
    pub fn pass_all(&self) -> bool {
        self.ordered.is_empty() && self.default == Action::Pass
    }

    /// Decides about a packet.
    pub fn decide(&mut self, packet: &Summary, now: u64, mut on_dry_run: impl FnMut(usize)) -> Verdict {
        let list = match packet.slot {
            _ if self.by_id.is_empty() => 0,
            Some(slot) => self.by_slot[usize::from(slot)],
            None => self.by_id.get(&packet.message_id).copied().unwrap_or(0),
        };
        for &index in &self.candidates[usize::from(list)] {
            let rule = &mut self.ordered[usize::from(index)];
            if !rule.matches(packet) {
                continue;
            }
            let action = rule.decide(now);
            match action {
                Action::Drop if rule.dry_run => on_dry_run(usize::from(index)),
                _ if rule.dry_run => {}
                Action::Pass => return Verdict::Pass,
                Action::Drop => return Verdict::Drop(Some(usize::from(index))),
                Action::Inspect => return Verdict::Inspect,
            }
        }
        self.default_verdict()
    }

    fn default_verdict(&self) -> Verdict {
        match self.default {
            Action::Pass => Verdict::Pass,
            Action::Drop => Verdict::Drop(None),
            Action::Inspect => Verdict::Inspect,
        }
    }

    /// The name of a rule that dropped a packet, if a report is due.
    pub fn name_to_report(&mut self, index: usize, now: u64) -> Option<&str> {
        let rule = &mut self.ordered[index];
        let is_due = rule.reported_at.is_none_or(|at| now.saturating_sub(at) >= NOTICE_INTERVAL);
        is_due.then(|| {
            rule.reported_at = Some(now);
            rule.name.as_str()
        })
    }

    /// Names and counters of all rules, in order.
    pub fn counters(&self) -> impl Iterator<Item = (&str, RuleCounters)> {
        self.ordered.iter().map(|rule| (rule.name.as_str(), rule.counters))
    }
}

/// The messages that a rule can match; empty: all. Only some messages have a command.
fn messages_of(rule: &Rule) -> Vec<u32> {
    let is_for_commands = rule.messages.is_empty() && !rule.commands.is_empty();
    if is_for_commands { COMMAND_IDS.to_vec() } else { rule.messages.clone() }
}

#[cfg(test)]
#[path = "rules_tests.rs"]
mod tests;
