//! Tests when a contact ends if each axis has its own control law (§4.4.1 of the DLR thesis), which shifts the surface on its axis
//! by an offset. Each figure of that section is a test, under three rules. Each axis ends its contact alone (decoupled), all end as
//! soon as one does (any axis), or all end when the penetration is longer than the offset's projection on it (projection).

use touchstone_control::space::environment::Cuboid;
use touchstone_control::space::{Along, Leaving, PerAxis, Rule, SurfacePoint};
use touchstone_control::{AnyLaw, LawKind};
use touchstone_tests::space::{F, Push, UNIT, at, in_mm, omega, push_in_n};

const RULES: [Leaving; 3] = [Leaving::Decoupled, Leaving::AnyAxis, Leaving::Projection];

/// A box with edges of 40 mm, its top at z = 0 and its right face at x = 0.
fn block() -> Cuboid<F> {
    Cuboid {
        centre: at(-20.0, 0.0, -20.0),
        half: at(20.0, 20.0, 20.0),
    }
}

struct Hand {
    point: SurfacePoint<F>,
    shell: PerAxis<F, AnyLaw<F>>,
    at: [f64; 3],
    force: Push,
}

impl Hand {
    /// A hand that touches the top of the box 1 mm from the box's right edge, and rests 0.3 mm deep until the control laws have
    /// shifted the surface outwards.
    fn pressing(leaving: Leaving) -> Self {
        let law = UNIT
            .law::<F>(&omega(LawKind::EnhancedSfa, 25.0))
            .expect("settings");
        let mut hand = Self {
            point: SurfacePoint::new(Rule::Closest),
            shell: PerAxis::new([law; 3], leaving),
            at: [-1.0, 0.0, 0.2],
            force: Push::default(),
        };
        hand.go([-1.0, 0.0, -0.35], 50);
        hand.go([-1.0, 0.0, -0.3], 10);
        hand.go([-1.0, 0.0, -0.3], 4000);
        assert!(
            (push_in_n(hand.force)[2] - 7.5).abs() < 0.1,
            "k_de is shown: {:?}",
            push_in_n(hand.force)
        );
        assert!(hand.offset()[2] > 1.5, "by an offset: {:?}", hand.offset());
        hand
    }

    fn go(&mut self, to: [f64; 3], ticks: u32) -> &mut Self {
        let from = self.at;
        for tick in 1..=ticks {
            let share = f64::from(tick) / f64::from(ticks);
            self.at = std::array::from_fn(|i| from[i] + share * (to[i] - from[i]));
            let [x, y, z] = self.at;
            let touch = self.point.tick(&block(), at(x, y, z));
            self.force = self.shell.tick(&touch);
        }
        self
    }

    fn offset(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| in_mm(self.shell.laws[i].view().offset))
    }
}

/// Checks Fig. 4.7 of the DLR thesis: the hand leaves the box through its side. If each axis ends its contact alone, the law of the
/// vertical axis goes on pushing in free air. If all axes end their contact together, no force remains.
#[test]
fn figure_4_7_a_force_remains_after_the_side_is_left() {
    for leaving in RULES {
        let mut hand = Hand::pressing(leaving);
        // To a place where the side is closer than the top, and out through the side by more than any offset of that axis.
        hand.go([-0.1, 0.0, -0.3], 20).go([6.0, 0.0, -0.3], 60);
        let [x, y, z] = push_in_n(hand.force);
        println!("Fig. 4.7 {leaving:?}: 6 mm outside {x:.2} {y:.2} {z:.2} N");
        match leaving {
            Leaving::Decoupled => assert!(z > 3.0, "the force that Fig. 4.7 shows"),
            Leaving::AnyAxis | Leaving::Projection => assert_eq!([x, y, z], [0.0; 3]),
        }
    }
}

/// Checks Fig. 4.8 of the DLR thesis. The hand is a little above the box's top, but within the shift of the surface by the control
/// law, and a little past the box's edge. The axis across that edge has no shift and ends its contact. With the rule that all axes
/// then end their contact, the force drops at once.
#[test]
fn figure_4_8_a_small_coordinate_drops_the_force() {
    for leaving in RULES {
        let mut hand = Hand::pressing(leaving);
        hand.go([-0.001, 0.0, 0.2], 40);
        let before = push_in_n(hand.force);
        hand.go([0.02, 0.0, 0.2], 1);
        let after = push_in_n(hand.force);
        println!("Fig. 4.8 {leaving:?}: {before:.2?} N, then {after:.2?} N");
        assert!(before[2] > 2.0, "still held by the offset");
        match leaving {
            Leaving::AnyAxis => assert_eq!(after, [0.0; 3], "the drop that Fig. 4.8 shows"),
            Leaving::Decoupled | Leaving::Projection => {
                assert!((after[2] - before[2]).abs() < 0.5, "no drop");
            }
        }
    }
}

/// Checks Fig. 4.9 of the DLR thesis. With the rule "projection" the contact ends no later than where the distance from the object
/// equals the projection of the surface's shift (by the control laws) on this distance.
#[test]
fn figure_4_9_the_projection_ends_the_contact_at_the_offset() {
    let mut hand = Hand::pressing(Leaving::Projection);
    hand.go([0.3, 0.0, 0.3], 60);
    let mut left = false;
    for step in 1..400 {
        let was = hand.offset();
        let out = 0.3 + 0.01 * f64::from(step);
        hand.go([0.3 * out / 0.3, 0.0, out], 1);
        let touches = hand.shell.laws.iter().any(Along::touches);
        // The distance to the edge, and the offset's part O' along it.
        let distance = out * 2.0_f64.sqrt();
        let reach = (was[0] + was[2]) / 2.0_f64.sqrt();
        if !touches {
            left = true;
            println!("left at {distance:.3} mm, O' {reach:.3} mm");
            assert_eq!(push_in_n(hand.force), [0.0; 3]);
            // The laws may end the contact earlier, but the contact must not last beyond the offset.
            assert!(distance < reach + 0.1, "not later than the offset ends");
            break;
        }
        assert!(
            distance <= reach + 0.02,
            "held beyond the offset: {distance} {reach}"
        );
    }
    assert!(left, "it was never left");
}

/// Shows that equation (4.8) of the DLR thesis has a wrong sign: as printed, its condition `α < 1` for a contact holds wherever the
/// hand is outside the object, so that no contact ends.
#[test]
fn equation_4_8_as_printed_never_ends_a_contact() {
    for out in [0.1, 1.0, 10.0, 1000.0] {
        // Outside, the penetration `e` and the offset `O` have opposite signs.
        let (e, o) = ([0.0, 0.0, out], [0.0, 0.0, -1.5]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // O' = s e, so e = α O' has α = 1/s.
        let alpha = dot(e, e) / dot(e, o);
        assert!(alpha < 1.0, "b_i = true {out} mm outside");
    }
}
