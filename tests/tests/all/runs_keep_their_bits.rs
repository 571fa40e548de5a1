//! Tests that every shipped scene file, with every combination of effects, gives the same results bit for bit as the stored hashes.
//!
//! The program's structure may change, its results may not. A hash covers every column of every control period and the measures of
//! the simulation. For an intended change of behaviour, `cargo test -p touchstone-tests runs_keep_their_bits:: -- --nocapture` prints
//! the new hashes. They are then entered in the same commit as that change, and with no other.
//!
//! The bits are the same on every machine: sums are calculated in one order, and sines and exponentials are those of `libm`.

use touchstone_sim::run::{self, record::Run};
use touchstone_sim::scene::{self, Scene};
use touchstone_tests::thesis;

/// State of an FNV-1a hash with 64 bits.
struct Hash(u64);

impl Hash {
    fn bytes(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn float(&mut self, x: f64) {
        self.bytes(x.to_bits().to_le_bytes());
    }

    fn run(&mut self, run: &Run) {
        let trace = run.trace.as_ref().expect("a run with a trace");
        // Without the last column, the guard's account: these scenes have no guard.
        for column in &trace.columns()[..13] {
            column.iter().for_each(|&x| self.float(x));
        }
        let summary = &run.summary;
        for number in [
            summary.k_displayed,
            summary.limit_cycle_peak_to_peak,
            Some(summary.energy_true_min),
            Some(summary.energy_user_min),
            summary.energy_observed_min,
            Some(summary.force_max),
            Some(summary.contact_ticks as f64),
        ] {
            self.float(number.unwrap_or(-1.0));
        }
    }
}

/// The simulation with each of the 32 combinations of five effects: encoder, torque limit, amplifier steps, delay, dry friction.
fn combinations(scene: &Scene) -> Vec<Scene> {
    let mut all = Vec::new();
    for choice in 0..32_u32 {
        let on = |bit: u32| choice >> bit & 1 == 1;
        let mut sets = Vec::new();
        if on(0) {
            sets.push("encoder.counts_per_rev=16384");
        }
        if on(1) {
            sets.push("device.torque_limit_n_m=0.08");
        }
        if on(2) {
            sets.push("device.amplifier_step_n_m=1e-3");
        }
        if on(3) {
            // A delay of more than a period, or of less, alternately.
            sets.push(if on(0) {
                "timing.computational_delay_s=3e-4"
            } else {
                "timing.computational_delay_s=1.3e-3"
            });
        }
        if on(4) {
            sets.push("device.friction.kinetic_n_m=1e-3");
        }
        let mut bare = scene.clone();
        bare.encoder = None;
        bare.device.torque_limit_n_m = None;
        bare.device.amplifier_step_n_m = None;
        bare.device.friction = None;
        bare.timing.computational_delay_s = 0.0;
        all.push(bare.with_overrides(&sets).unwrap());
    }
    all
}

fn hash(scene: &Scene) -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    hash.run(&run::run(scene, true).unwrap());
    for scene in combinations(scene) {
        let traced = run::run(&scene, true).unwrap();
        hash.run(&traced);
        let bare = run::run(&scene, false).unwrap().summary;
        assert_eq!(
            bare.energy_user_min.to_bits(),
            traced.summary.energy_user_min.to_bits()
        );
    }
    hash.0
}

#[test]
fn every_scene_with_every_effect_keeps_its_bits() {
    let mut wrong = Vec::new();
    for name in scene::names() {
        let found = hash(&thesis(name));
        println!("    (\"{name}\", 0x{found:016x}),");
        let known = KNOWN.iter().find(|(known, _)| *known == name);
        if known.map(|(_, hash)| *hash) != Some(found) {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "other bits than before: {wrong:?}");
}

const KNOWN: &[(&str, u64)] = &[
    ("thesis-knob", 0xe23f_18c4_dc94_4d6d),
    ("press-hold", 0xd2d1_d19b_d666_38a0),
    ("press-wiggle-release", 0x3344_08d4_d88f_ce33),
    ("tap", 0x042b_d40c_4853_6156),
    ("free-release", 0x562f_5265_9a23_41d6),
    ("low-stiffness", 0x8947_fbdf_6c30_f360),
    ("gimbal-knob", 0xe020_62f5_0a5c_e59f),
    ("voltage-knob", 0x1bd7_590a_9692_49cc),
    ("identify", 0x3a0b_e09c_1748_4722),
];
