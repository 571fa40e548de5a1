use super::*;

fn started() -> BridgeTimer {
    started_with(0)
}

fn started_with(idle_levels: u32) -> BridgeTimer {
    let mut tim = BridgeTimer::default();
    tim.write(CR2, 7 << 20 | idle_levels << 8, 0);
    tim.write(ARR, 4_250, 0);
    tim.write(CCMR1, 0x6868, 0);
    tim.write(CCMR2, 0x7868, 0);
    tim.write(CCR1, 2_125, 0);
    tim.write(0x40, 4_230, 0);
    tim.write(CCER, 0x555, 0);
    tim.write(AF1, 1, 0);
    tim.write(BDTR, BKE | 1 << 8 | 85, 0);
    tim.write(EGR, 1, 0);
    tim.write(SR, 0, 0);
    tim.write(DIER, 1 << 7, 0);
    tim.write(CR1, CEN | 1 << 5, 100);
    tim
}

#[test]
fn edges_come_in_order_and_the_trigger_before_the_top() {
    let mut tim = started();
    let mut edges = Vec::new();
    while let Some(edge) = tim.next_edge(100 + 17_000) {
        edges.push(edge);
    }
    assert_eq!(
        edges,
        [
            (4_330, Edge::Trigger),
            (4_350, Edge::Top),
            (8_600, Edge::Bottom),
            (12_830, Edge::Trigger),
            (12_850, Edge::Top),
            (17_100, Edge::Bottom),
        ]
    );
    assert_eq!(tim.read(CNT, 17_100 + 4_260), 4_240);
    assert_eq!(tim.read(CR1, 17_100 + 4_260) & 0x10, 0x10);
}

#[test]
fn duty_counts_from_the_next_update_on() {
    let mut tim = started();
    tim.write(BDTR, BKE | MOE, 0);
    assert_eq!(tim.duty()[0], Some(0.5));
    tim.write(CCR1, 4_250, 200);
    assert_eq!(tim.duty()[0], Some(0.5));
    while tim.next_edge(4_350).is_some() {}
    assert_eq!(tim.duty()[0], Some(1.0));
}

#[test]
fn off_is_what_the_drivers_take_for_off() {
    // The outputs are off and the idle levels low. Drivers with active-high inputs read this as off.
    let mut tim = started();
    tim.write(BDTR, BKE | OSSI, 200);
    assert_eq!(tim.duty(), [None; 3]);
    // Drivers with active-low inputs for the lower transistors read the same levels as on: all phases are connected to ground.
    let mut tim = BridgeTimer {
        gates: GateDriver::L6398,
        ..started()
    };
    tim.write(BDTR, BKE | OSSI, 200);
    assert_eq!(tim.duty(), [Some(0.0); 3]);
    assert!(tim.is_on());
    // While the outputs switch, both inputs of a pair request on or off at the same time. The driver refuses this.
    tim.write(BDTR, BKE | OSSI | MOE, 300);
    assert_eq!(tim.duty(), [None; 3]);
    // With the polarity that the driver needs, the outputs are off as intended.
    let mut tim = BridgeTimer {
        gates: GateDriver::L6398,
        ..started_with(0b10_1010)
    };
    tim.write(CCER, 0xddd, 400);
    tim.write(BDTR, BKE | OSSI | MOE, 400);
    assert_eq!(tim.duty()[0], Some(0.5));
    tim.write(BDTR, BKE | OSSI, 500);
    assert_eq!(tim.duty(), [None; 3]);
}

#[test]
fn a_lock_holds_polarity_and_idle_levels() {
    let mut tim = started();
    tim.write(BDTR, BKE | OSSI | 2 << 8, 0);
    // `started` has already set lock level 1, which protects the idle levels from changes.
    tim.write(CR2, 7 << 20 | 0x3f << 8, 10);
    assert_eq!(tim.read(CR2, 10), 7 << 20);
    let mut tim = BridgeTimer::default();
    tim.write(CCER, 0x555, 0);
    tim.write(BDTR, BKE | OSSI | 2 << 8, 0);
    tim.write(CCER, 0xddd, 10);
    tim.write(BDTR, 0, 10);
    assert_eq!(tim.read(CCER, 10), 0x555);
    assert_eq!(tim.read(BDTR, 10), BKE | OSSI | 2 << 8);
}

#[test]
fn the_break_switches_off_and_holds_off() {
    let mut tim = started();
    tim.write(BDTR, MOE, 200);
    assert!(tim.is_on());
    tim.set_break(false, 0, 300);
    assert!(!tim.is_on());
    assert_eq!(tim.lines(), 1 << 24);
    tim.write(BDTR, MOE, 400);
    assert!(!tim.is_on(), "not while the break is active");
    tim.set_break(true, 0, 500);
    assert!(!tim.is_on(), "not by itself");
    tim.write(SR, !BIF, 600);
    tim.write(BDTR, MOE, 600);
    assert!(tim.is_on());
    assert_eq!(tim.changes, [(200, true), (300, false), (600, true)]);
}

#[test]
fn a_break_passes_its_filter_first() {
    // Filter BKF 3 takes eight samples, one per clock cycle. BKF 15 takes eight samples, one per 32 cycles. CKD 1 halves the clock.
    for (bkf, ckd, cycles) in [
        (0, 0, 0),
        (1, 0, 2),
        (3, 1, 8),
        (10, 0, 80),
        (15, 0, 256),
        (15, 1, 512),
    ] {
        let mut tim = BridgeTimer::default();
        tim.write(CCER, 0x555, 0);
        tim.write(AF1, 1, 0);
        tim.write(CR1, CEN | ckd << 8, 0);
        tim.write(BDTR, BKE | bkf << 16 | MOE, 0);
        assert!(tim.is_on());
        if cycles > 0 {
            tim.set_break(false, 0, 1_000);
            tim.pass(1_000 + cycles - 1);
            assert!(tim.is_on(), "{bkf}: too short");
            tim.set_break(true, 0, 1_000 + cycles - 1);
            tim.pass(3_000);
            assert!(tim.is_on(), "{bkf}: it was over");
        }
        tim.set_break(false, 0, 4_000);
        assert_eq!(tim.is_on(), cycles > 0);
        if cycles > 0 {
            assert!(
                tim.next_event() <= 4_000 + cycles,
                "{bkf}: looked at in time"
            );
        }
        tim.pass(4_000 + cycles);
        assert!(!tim.is_on(), "{bkf}");
    }
}

/// A timer for an STSPIN830 whose enables are wired to the complementary outputs. Those outputs have their enable bit cleared, and
/// are inactive when high.
fn with_enables(idle_levels: u32) -> BridgeTimer {
    let mut tim = started_with(idle_levels);
    tim.gates = GateDriver::Stspin830;
    tim.write(CCER, 0x999, 0);
    tim
}

#[test]
fn enables_fall_with_the_main_output() {
    let mut tim = with_enables(0);
    let idle = BKE | OSSI | OSSR;
    assert!(!tim.is_on());
    tim.write(BDTR, idle | MOE, 0);
    assert_eq!(tim.duty(), [Some(0.5), Some(0.0), Some(0.0)]);
    tim.set_break(false, 0, 10);
    assert!(!tim.is_on(), "a break takes them down");
    tim.set_break(true, 0, 20);
    tim.write(SR, 0, 20);
    // Without OSSR the timer does not drive the enable outputs.
    tim.write(BDTR, BKE | OSSI | MOE, 30);
    assert!(!tim.is_on());
    tim.write(BDTR, idle | MOE, 40);
    assert!(tim.is_on());
    // The driver switches itself off.
    tim.set_stage_off(true, 50);
    assert!(!tim.is_on());
    tim.set_stage_off(false, 60);
    assert!(tim.is_on());
    // With idle levels that are high, off is a brake: all three lower transistors conduct.
    let mut brake = with_enables(0x2a);
    brake.write(BDTR, idle, 0);
    assert_eq!(brake.duty(), [Some(0.0); 3]);
    assert!(brake.is_on());
}
