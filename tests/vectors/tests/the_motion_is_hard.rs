//! Tests that the motion of the test vectors reaches the special cases for which it was made, in both number formats.

use std::collections::BTreeSet;

use touchstone_control::law::Contact;
use touchstone_control::{Controller, CountScale, Fixed16, Fixed32, Force, Position};
use touchstone_vectors::{Bits, COUNTS_PER_TURN, Case, Machine, SEGMENTS, Segment, cases, play};

/// The special cases that occurred while a test case ran.
#[derive(Default)]
struct Seen {
    last: Option<i32>,
    contacts: BTreeSet<u8>,
    crossings: u32,
    still: u32,
    one_count: u32,
    lowest: i32,
    highest: i32,
    strongest: i32,
    digests: Vec<u64>,
}

impl<N: Bits> Machine<N> for Seen {
    fn penetration(&mut self, scale: &CountScale, count: i64) -> Position<N> {
        scale.penetration(count)
    }
    fn tick(&mut self, wall: &mut Controller<N>, e: Position<N>) -> Force<N> {
        let force = wall.tick(e);
        let bits = N::signal_bits(e.0);
        if let Some(last) = self.last.replace(bits) {
            let count = N::signal_bits(N::saturating_signal(
                touchstone_control::Si::lit("6.2831853") / i64::from(COUNTS_PER_TURN),
            ));
            self.crossings += u32::from((last > 0) != (bits > 0));
            self.still += u32::from(last == bits);
            self.one_count += u32::from(bits.abs_diff(last).abs_diff(count.unsigned_abs()) <= 1);
        }
        self.lowest = self.lowest.min(bits);
        self.highest = self.highest.max(bits);
        self.strongest = self.strongest.max(N::signal_bits(force.0));
        self.contacts.insert(match wall.view().contact {
            Contact::Free => 0,
            Contact::First => 1,
            Contact::Augmenting => 2,
        });
        force
    }
    fn segment_done(&mut self, _: &Case, _: &Segment, digest: u64) {
        self.digests.push(digest);
    }
}

fn seen<N: Bits>(case: &Case) -> Seen {
    let mut seen = Seen::default();
    play::<N>(case, &mut seen).unwrap_or_else(|error| panic!("{}: {error}", case.name));
    seen
}

fn check<N: Bits>(lowest: i32, highest: i32) {
    let mut last: BTreeSet<u64> = BTreeSet::new();
    for case in cases() {
        let seen = seen::<N>(&case);
        let name = format!("{} {}", case.name, N::NAME);
        assert!(seen.crossings > 1_000, "{name}: {}", seen.crossings);
        assert!(seen.still > 1_000, "{name}: {}", seen.still);
        assert!(seen.one_count > 1_000, "{name}: {}", seen.one_count);
        assert_eq!((seen.lowest, seen.highest), (lowest, highest), "{name}");
        let limit = N::signal(case.settings.force_limit).map(N::signal_bits);
        assert_eq!(Some(seen.strongest), limit, "{name}");
        let augments = case.name.starts_with("sfa") || case.name.starts_with("enhanced");
        assert_eq!(seen.contacts.contains(&2), augments, "{name}");
        assert_eq!(seen.digests.len(), SEGMENTS.len(), "{name}");
        last.extend(seen.digests.last());
    }
    // Cases with different settings give different forces.
    assert_eq!(last.len(), cases().len());
}

#[test]
fn every_case_meets_every_hardship_in_32_bits() {
    check::<Fixed32>(i32::MIN, i32::MAX);
}

#[test]
fn every_case_meets_every_hardship_in_16_bits() {
    check::<Fixed16>(i16::MIN.into(), i16::MAX.into());
}
