//! The router's knowledge from accepted packets: the claims of their senders, and how far their peers are proven.

use super::{Evidence, Passing, Router, Senders, Stage, Time};
use crate::addressing::{Kind, Summary};
use crate::event::Notice;
use crate::ports::PortId;
use mavstack_core::claims::{Authority, BootClock, Contradiction, Standing};

/// Microseconds for which a claim is contested before it is a conflict.
const CONTEST_TIME: u64 = 3_000_000;
/// Messages without a target that answer one: PARAM_VALUE, COMMAND_ACK, TIMESYNC, AUTOPILOT_VERSION.
const ANSWERS: [u32; 4] = [22, 77, 111, 148];

impl Router {
    /// Records the claim of a packet on its address.
    #[inline]
    pub(super) fn hear(&mut self, from: PortId, passing: &Passing<'_>, time: Time) -> Standing {
        let own = self.endpoints[self.ports[from].endpoint].authority;
        let authority = if passing.admission.verified { Authority::Key } else { own };
        let address = (passing.summary.system, passing.summary.component);
        let senders = Senders { ports: &self.ports, endpoints: &self.endpoints };
        self.claims.hear(address, from, authority, time.now, &senders)
    }

    /// Notes that a peer that is not proven sent a packet that is accepted.
    #[cold]
    pub(super) fn advance(&mut self, from: PortId, passing: &Passing<'_>) {
        let summary = &passing.summary;
        let has_target = summary.target_system != 0
            && self.targets(summary).is_some_and(|ports| ports.iter().any(|port| port != from));
        let evidence = if passing.admission.verified {
            Evidence::Verified
        } else if has_target || ANSWERS.contains(&summary.message_id) {
            Evidence::Answered
        } else {
            Evidence::Accepted
        };
        if evidence == Evidence::Accepted && self.ports[from].stage == Stage::Accepted {
            return; // as before, like most packets of a sender that answers nothing
        }
        if !self.progress.contains(&(from, evidence)) {
            self.progress.push((from, evidence));
        }
    }

    /// Learns from the content of a packet whose claim was recorded.
    #[inline]
    pub(super) fn learn(&mut self, from: PortId, summary: &Summary, time: Time) {
        let address = (summary.system, summary.component);
        if summary.kind == Kind::Heartbeat {
            self.claims.note_ground_station(address, from, summary.is_station);
        }
        if let Some(boot_time) = summary.boot_time {
            match self.claims.note_boot_time(address, from, boot_time, time.now) {
                BootClock::Rebooted => self.notice(from, Notice::Rebooted, summary, time),
                BootClock::Agrees | BootClock::Differs => {}
            }
        }
    }

    /// Takes note of a packet from a sender that does not hold its address.
    ///
    /// One that does not lead there must not hide the packet of the holder, if it guessed its bytes and came first. A
    /// claim that stays contested is reported: the boot clock of a redundant link needs a moment to be known.
    pub(super) fn note_other(&mut self, from: PortId, standing: Standing, passing: &Passing<'_>, time: Time) {
        let summary = &passing.summary;
        let address = (summary.system, summary.component);
        let own = self.claims.claims_on(address.0, address.1).find(|claim| claim.sender == from);
        let (since, leads) = own.map_or((time.now, false), |claim| (claim.since, claim.leads));
        if !leads {
            self.duplicates.forget(passing.packet.raw, self.ports[from].serial);
        }
        if standing == Standing::Contested
            && time.now.saturating_sub(since) >= CONTEST_TIME
            && self.claims.contradict(address, from, Contradiction::Sender, time.now)
        {
            self.notice(from, Notice::Contested, summary, time);
        }
    }
}
