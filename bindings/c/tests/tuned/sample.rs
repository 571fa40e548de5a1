// enhanced successive force augmentation with the scene's settings for voltage-knob:
// found by touchstone tune (seed 1, 1 settings tried).
// The device: 1000 control periods a second, inertia 3e-5 kg·m², damping 9e-6 N·m·s/rad,
// 16384 encoder counts a turn, force limit 0.045 N·m, delay 6.25e-5 s from reading to torque, torque lag 1.89877049739794e-4 s.
// The guard relies on 7.200054824352264e-6 N·m·s/rad of the damping. It assumes that the encoder is read once per control period.
// Measure your own device: the energy bound fails with less damping, a larger count, or another delay or lag.
// Settings that are missing here have the library's defaults; use program and library of the same release.

use touchstone_control::{
    ChangeOfForce, Device, EstimatorSettings, FilterSettings, GuardSettings, PositionSettings,
    Settings, Si,
};

/// The tuned settings.
pub fn tuned_settings() -> Settings {
    Settings {
        rate_hz: 1000, // Hz
        k_desired: Si::lit("2"), // N·m/rad
        k_soft: Si::lit("6.1"), // N·m/rad
        virtual_damping: Si::lit("0.0058"), // N·m·s/rad
        step_of_ideal: Si::lit("0.1692"),
        limit_of_force: Si::lit("0.3322"),
        limit_of_penetration: Si::lit("0.5238"),
        force_limit: Si::lit("0.045"), // N·m
        position_error: Si::lit("0"), // rad
        filter: FilterSettings {
            mass: Si::lit("0.0000009234"), // kg·m²
            stiffness: Si::lit("23.97"), // N·m/rad
            damping: Si::lit("0.009071"), // N·m·s/rad
            ground_damping: Si::lit("0.00125"), // N·m·s/rad
        },
        estimator: EstimatorSettings {
            bandwidth_hz: Si::lit("71"), // Hz
            inertia: Si::lit("0.00003"), // kg·m²
            damping: Si::lit("0.000009"), // N·m·s/rad
            delay_s: Si::lit("0.0009"), // s
        },
        guard: GuardSettings {
            on: true,
            capacity: Si::lit("0.045"), // J
            refill: Si::lit("0.0005882743"), // W
            damping: Si::lit("0.000009"), // N·m·s/rad
            share_of_damping: Si::lit("0.8"),
            overspeed: Si::lit("60"), // rad/s
            delay: Si::lit("0.0000625"), // s
            lag: Si::lit("0.000189877"), // s
            change: ChangeOfForce::Estimated,
        },
        position: PositionSettings::of_counts_per_rev(16384),
        ..Settings::default()
    }
}

/// The device for which the settings were tuned: `tuned_device().own_force()` puts a force of your own before its guard.
pub fn tuned_device() -> Device {
    Device {
        rate_hz: 1000, // Hz
        inertia: Si::lit("0.00003"), // kg·m²
        damping: Si::lit("0.000009"), // N·m·s/rad
        position_error: Si::lit("0"), // rad
        force_limit: Si::lit("0.045"), // N·m
        delay: Si::lit("0.0000625"), // s
        lag: Si::lit("0.000189877"), // s
        position: PositionSettings::of_counts_per_rev(16384),
    }
}
