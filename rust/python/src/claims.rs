//! Python interface of the claims of senders. `mavstack.security.senders` is its typed face.

use mavstack_core::claims::{self as core, Authority, Claim, Contradiction, Party, Roster};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

const AUTHORITIES: [Authority; 5] =
    [Authority::None, Authority::Session, Authority::Ticket, Authority::Certificate, Authority::Key];

/// Sender, authority, time of the first and of the last packet, and whether it leads, has the clock, is a station.
type ClaimValues = (usize, u8, f64, f64, bool, bool, bool);
/// Beginning, last contradiction, senders and numbers of the contradictions.
type ConflictValues = (f64, f64, Vec<usize>, Vec<u8>);

/// The claims of senders on addresses, in numbers; see `mavstack.security.senders`.
///
/// Args:
///     silence: Seconds without a packet after which another sender may hold an address.
#[pyclass(module = "mavstack._core")]
pub struct Claims {
    claims: core::Claims,
    roster: Roster,
}

fn microseconds(seconds: f64) -> u64 {
    (seconds.max(0.0) * 1e6).round() as u64
}

fn seconds(microseconds: u64) -> f64 {
    microseconds as f64 / 1e6
}

pub fn authority_of(number: u8) -> PyResult<Authority> {
    let found = AUTHORITIES.get(usize::from(number)).copied();
    found.ok_or_else(|| PyValueError::new_err(format!("authority must be 0 to 4, got {number}")))
}

fn values(claim: &Claim) -> ClaimValues {
    let (since, heard_at) = (seconds(claim.since), seconds(claim.heard_at));
    (claim.sender, claim.authority as u8, since, heard_at, claim.leads, claim.has_clock, claim.is_station)
}

impl Claims {
    /// The proof of a packet: its own, or that of its sender.
    fn proof(&self, sender: usize, authority: u8) -> PyResult<Authority> {
        let party = self.roster.get(sender);
        let party = party.ok_or_else(|| PyValueError::new_err(format!("sender {sender} is not open")))?;
        Ok(authority_of(authority)?.max(party.authority))
    }
}

#[pymethods]
impl Claims {
    #[new]
    #[pyo3(signature = (silence = 2.5))]
    fn new(silence: f64) -> Self {
        Self { claims: core::Claims::new(microseconds(silence)), roster: Roster::default() }
    }

    /// Add a sender.
    ///
    /// Args:
    ///     place: Number of the link that it belongs to.
    ///     group: Number of the group of redundant links that its link belongs to; 0: none.
    ///     host: Number of the host that it comes from.
    ///     authority: The proof of its identity, 0 to 4.
    ///     now: Time in seconds.
    ///
    /// Returns:
    ///     Its number; None: there are 4,096 senders.
    ///
    /// Raises:
    ///     ValueError: There is no such authority.
    fn open(&mut self, place: usize, group: usize, host: u64, authority: u8, now: f64) -> PyResult<Option<usize>> {
        let (authority, now) = (authority_of(authority)?, microseconds(now));
        Ok(self.roster.open(Party { place, group, host, authority, opened_at: now, heard_at: now }))
    }

    /// Remove a sender and its claims. Idempotent.
    ///
    /// Args:
    ///     sender: Its number.
    fn close(&mut self, sender: usize) {
        if self.roster.close(sender) {
            self.claims.remove(sender);
        }
    }

    /// Change the proof of a sender's identity; what an earlier one proved is withdrawn.
    ///
    /// Args:
    ///     sender: Its number.
    ///     authority: The proof of its identity, 0 to 4.
    ///
    /// Raises:
    ///     ValueError: The sender is not open, or there is no such authority.
    fn set_authority(&mut self, sender: usize, authority: u8) -> PyResult<()> {
        let authority = authority_of(authority)?;
        self.proof(sender, 0)?;
        if let Some(party) = self.roster.get_mut(sender) {
            party.authority = authority;
        }
        self.claims.withdraw(sender);
        Ok(())
    }

    /// Record that bytes came from a sender, whatever they are.
    ///
    /// Args:
    ///     sender: Its number.
    ///     now: Time in seconds.
    fn touch(&mut self, sender: usize, now: f64) {
        if let Some(party) = self.roster.get_mut(sender) {
            party.heard_at = microseconds(now);
        }
    }

    /// Record a packet.
    ///
    /// Args:
    ///     sender: Number of the sender that it came from.
    ///     system: System id of the packet.
    ///     component: Component id of the packet.
    ///     authority: The proof of this packet, 0 to 4; that of the sender counts too.
    ///     now: Time in seconds.
    ///
    /// Returns:
    ///     The standing: 0 held, 1 new, 2 shared, 3 contested, 4 outranked.
    ///
    /// Raises:
    ///     ValueError: The sender is not open, or there is no such authority.
    fn hear(&mut self, sender: usize, system: u8, component: u8, authority: u8, now: f64) -> PyResult<u8> {
        let proof = self.proof(sender, authority)?;
        self.touch(sender, now);
        Ok(self.claims.hear((system, component), sender, proof, microseconds(now), &self.roster) as u8)
    }

    /// Return the standing that a packet would have, and record nothing; see `hear`.
    fn standing(&self, sender: usize, system: u8, component: u8, authority: u8, now: f64) -> PyResult<u8> {
        let proof = self.proof(sender, authority)?;
        Ok(self.claims.standing((system, component), sender, proof, microseconds(now), &self.roster) as u8)
    }

    /// Record whether the heartbeat of a sender for an address is that of a ground station.
    fn note_ground_station(&mut self, sender: usize, system: u8, component: u8, is_station: bool) {
        self.claims.note_ground_station((system, component), sender, is_station);
    }

    /// Record a boot time.
    ///
    /// Args:
    ///     sender: Number of the sender.
    ///     system: System id of the packet.
    ///     component: Component id of the packet.
    ///     boot_time: Milliseconds since the boot.
    ///     now: Time in seconds.
    ///
    /// Returns:
    ///     0: the clock agrees; 1: the source rebooted; 2: another clock, of a sender that does not hold the address.
    fn note_boot_time(&mut self, sender: usize, system: u8, component: u8, boot_time: u32, now: f64) -> u8 {
        self.claims.note_boot_time((system, component), sender, boot_time, microseconds(now)) as u8
    }

    /// Return the senders that lead to a target; None: its system was never heard.
    fn routes(&self, system: u8, component: u8) -> Option<Vec<usize>> {
        self.claims.routes(system, component).map(|routes| routes.iter().collect())
    }

    /// Return the claims on an address, the holder's first, each as a tuple of its attributes.
    fn claims_on(&self, system: u8, component: u8) -> Vec<ClaimValues> {
        self.claims.claims_on(system, component).map(values).collect()
    }

    /// Return whether an authenticated sender holds an address.
    fn is_authenticated(&self, system: u8, component: u8) -> bool {
        self.claims.is_authenticated(system, component)
    }

    /// Return all claimed addresses, ordered.
    fn addresses(&self) -> Vec<(u8, u8)> {
        self.claims.addresses()
    }

    /// Record a contradiction.
    ///
    /// Args:
    ///     sender: Number of the sender of the newer packet.
    ///     system: System id of the packet.
    ///     component: Component id of the packet.
    ///     contradiction: Its number: 0 sender, 1 boot time, 2 unique id, 3 type, 4 position.
    ///     now: Time in seconds.
    ///
    /// Returns:
    ///     True if a conflict begins.
    ///
    /// Raises:
    ///     ValueError: There is no such contradiction.
    fn contradict(
        &mut self,
        sender: usize,
        system: u8,
        component: u8,
        contradiction: usize,
        now: f64,
    ) -> PyResult<bool> {
        let kind = Contradiction::ALL.get(contradiction).copied();
        let kind =
            kind.ok_or_else(|| PyValueError::new_err(format!("contradiction must be 0 to 4, got {contradiction}")))?;
        Ok(self.claims.contradict((system, component), sender, kind, microseconds(now)))
    }

    /// Return the conflict about an address as a tuple of its attributes; None: there is no conflict.
    fn conflict(&self, system: u8, component: u8) -> Option<ConflictValues> {
        let conflict = self.claims.conflict(system, component)?;
        let kinds = conflict.contradictions().filter_map(|kind| {
            let number = Contradiction::ALL.iter().position(|known| *known == kind);
            number.map(|number| number as u8)
        });
        let (began_at, contradicted_at) = (seconds(conflict.began_at), seconds(conflict.contradicted_at));
        Some((began_at, contradicted_at, conflict.senders.clone(), kinds.collect()))
    }

    /// End the conflicts without a contradiction in 30 seconds, and return their addresses.
    fn end_conflicts(&mut self, now: f64) -> Vec<(u8, u8)> {
        self.claims.end_conflicts(microseconds(now))
    }

    /// Return the sender that makes room for a new one; None: no sender does, and the new one is refused.
    ///
    /// Args:
    ///     place: Number of the link whose senders may make room, and of the new one; None: all links.
    ///     host: Number of the host that the new sender comes from.
    ///     authority: The proof of its identity, 0 to 4.
    ///     now: Time in seconds.
    ///
    /// Raises:
    ///     ValueError: There is no such authority.
    fn first_to_evict(&self, place: Option<usize>, host: u64, authority: u8, now: f64) -> PyResult<Option<usize>> {
        let (authority, now) = (authority_of(authority)?, microseconds(now));
        let (here, group) = (place.unwrap_or_default(), 0);
        let newcomer = Party { place: here, group, host, authority, opened_at: now, heard_at: now };
        Ok(self.roster.first_to_evict(&newcomer, place, now))
    }
}
