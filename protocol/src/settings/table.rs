//! The table of a device's own settings. The table of the control law is [`touchstone_control::law_settings`].
//!
//! A row of the table generates everything else: the field of [`DeviceSettings`](super::DeviceSettings), its default, its range,
//! its encoding on the wire and in flash, and its text in `touchstone config`. A row reads
//!
//! ```text
//! name: kind(range) = default, "unit", "meaning";
//! ```
//!
//! The kinds are those of the control law's table, plus `u8` and `u16`. A name ends in its unit. The narrower limits of each
//! board are in `Hardware` of the crate `touchstone_drive`.

use touchstone_control::choice;

choice! {
    /// The type of the connected encoder.
    EncoderKind {
        /// Incremental encoder: its tracks A and B go to a timer that counts edges.
        Incremental = "incremental",
        /// AS5047P, an absolute magnetic encoder over SPI: 14 bits, checked by parity.
        #[default]
        As5047p = "as5047p",
        /// MT6701, an absolute magnetic encoder over SPI (SSI frame): 14 bits, checked by CRC.
        Mt6701 = "mt6701",
    }
}
choice! {
    /// The type of drive that turns the shaft.
    DriveKind {
        /// The board's three-phase bridge, with the board's current loop.
        #[default]
        ThreePhase = "three-phase",
        /// An external servo amplifier, which controls the motor's current. The board gives it the command as an analogue voltage.
        Analogue = "analogue",
    }
}

/// Passes the rows of the control law's table and of the device's own table to the macro `$with`.
macro_rules! device_settings {
    ($with:ident) => {
        touchstone_control::law_settings! { $with
            // The default is a sixth of a turn from the zero of the calibration, so that a knob is outside the wall just after a
            // calibration.
            own_wall {
                surface_rad: number("-100", "100") = "1", "rad",
                    "the angle of the surface from the zero of the calibration (larger angles are inside the wall)";
            }
            own {
                /// Rate of the interrupt that runs the control law.
                timing TimingSettings {
                    rate_hz: u32(500, 10_000) = 1000, "Hz",
                        "the control rate, a whole fraction of 20000 Hz";
                }
                /// The encoder on the motor's shaft.
                encoder EncoderSettings {
                    kind: choice(EncoderKind) = As5047p, "",
                        "which encoder is connected";
                    counts_per_rev: u32(4, 1_000_000) = 16_384, "counts/rev",
                        "the counts of a revolution, all edges counted (16384 for as5047p and mt6701)";
                    reversed: flag() = false, "",
                        "whether turning the other way is positive";
                    bad_readings: u8(1, 10) = 3, "",
                        "how many bad readings in a row make a fault (the outputs are off from the first)";
                }
                /// The drive that turns the shaft.
                drive DriveSettings {
                    kind: choice(DriveKind) = ThreePhase, "",
                        "what moves the shaft";
                    analogue_full_scale_n_m: number("0.01", "100") = "1", "N·m",
                        "analogue: the torque at the upper end of the output (its negative at the lower, none in the middle)";
                }
                /// The motor. Resistance and inductance are those of one phase to the star point: half of what is measured between
                /// two wires.
                motor MotorSettings {
                    pole_pairs: u8(1, 50) = 7, "",
                        "the pole pairs (the calibration compares them with what it finds)";
                    resistance_ohm: number("0.01", "100") = "6", "Ω",
                        "the resistance of one phase to the star point, half of that between two wires";
                    inductance_h: number("0.000005", "0.1") = "0.003", "H",
                        "the inductance of one phase to the star point, half of that between two wires";
                    torque_constant_n_m_per_a: number("0.001", "10") = "0.25", "N·m/A",
                        "the torque for a q-axis current of 1 A (the amplitude of a phase current)";
                    current_limit_a: number("0.05", "25") = "2", "A",
                        "the largest commanded current, at most the trip current";
                    // 1.5 R i^2 is 4.4 W with the 6 ohm above, an estimate for a motor of 40 mm without a heat sink. No data sheet
                    // was available.
                    continuous_current_a: number("0.05", "25") = "0.7", "A",
                        "the largest current that the motor withstands continuously (a larger current is reduced as the motor warms up)";
                    // Windings warm up in some 10 to 60 s, the motor around them in minutes. The shorter time is the safe one.
                    heating_time_s: number("0.5", "1000") = "20", "s",
                        "the time constant with which the windings warm up";
                    // With this bandwidth there is no overshoot even with a delay of 1.5 periods of 50 µs; the delay is one period
                    // (`current::ACTS_AFTER_PERIODS`).
                    current_bandwidth_hz: number("50", "1500") = "600", "Hz",
                        "the bandwidth of the current loop";
                }
                /// Limits beyond which the device switches its outputs off.
                limits LimitSettings {
                    trip_current_a: number("0.05", "25") = "4", "A",
                        "the phase current that switches off (at most 15 on nucleo-g474re, 2.5 with an X-NUCLEO-IHM16M1)";
                    bus_min_v: number("10", "48") = "18", "V",
                        "the bus voltage below which it switches off (at least 10, where the gate drivers work)";
                    bus_max_v: number("10", "48") = "30", "V",
                        "the bus voltage above which it switches off (at most 26 on b-g431b-esc1)";
                    derate_from_celsius: number("20", "109") = "70", "°C",
                        "the temperature from which the current is reduced";
                    fault_from_celsius: number("30", "110") = "90", "°C",
                        "the temperature that switches off (the reduced current reaches zero here)";
                    // Fingers that flick the rim of a knob of 40 mm diameter at 2 m/s turn it at 100 rad/s.
                    max_speed_rad_per_s: number("1", "1000") = "100", "rad/s",
                        "the speed above which the device switches off (against a force, the guard's overspeed switches off)";
                    // A browser may run the page of a hidden tab only once a second.
                    host_silence_s: number("0", "60") = "2", "s",
                        "the time without a request from the computer after which the device switches off (0: it needs no computer)";
                    fade_in_s: number("0", "10") = "0.2", "s",
                        "the time over which the torque fades in after arming";
                }
                /// How a calibration aligns the encoder with the motor, and whether it measures the motor.
                calibration CalibrationSettings {
                    current_a: number("0.05", "25") = "1", "A",
                        "the current of the field that turns the shaft, at most the current limit";
                    electrical_turns_per_s: number("0.2", "20") = "4", "turns/s",
                        "the speed of that field, electrical turns";
                    measures: flag() = false, "",
                        "whether a calibration also measures the motor (the shaft SPINS, both ways)";
                }
                /// The data that the device sends without a request.
                telemetry TelemetrySettings {
                    decimation: u16(0, 1_000) = 1, "",
                        "the number of control periods for each record sent (0 sends none)";
                }
            }
        }
    };
}
pub(super) use device_settings;
