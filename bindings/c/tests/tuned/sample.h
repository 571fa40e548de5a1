// enhanced successive force augmentation with the scene's settings for voltage-knob:
// found by touchstone tune (seed 1, 1 settings tried).
// The device: 1000 control periods a second, inertia 3e-5 kg·m², damping 9e-6 N·m·s/rad,
// 16384 encoder counts a turn, force limit 0.045 N·m, delay 6.25e-5 s from reading to torque, torque lag 1.89877049739794e-4 s.
// The guard relies on 7.200054824352264e-6 N·m·s/rad of the damping. It assumes that the encoder is read once per control period.
// Measure your own device: the energy bound fails with less damping, a larger count, or another delay or lag.
// Settings that are missing here have the library's defaults; use program and library of the same release.

#ifndef TUNED_SETTINGS_H
#define TUNED_SETTINGS_H

#include "touchstone.h"

/* Sets all settings. Returns TS_OK, or why a setting was not set. */
static inline ts_status tuned_settings(ts_settings *settings) {
  static const char *const values[][2] = {
    {"timing.rate_hz", "1000"}, /* Hz */
    {"wall.k_desired_n_m_per_rad", "2"}, /* N·m/rad */
    {"law.k_soft_n_m_per_rad", "6.1"}, /* N·m/rad */
    {"law.virtual_damping_n_m_s_per_rad", "0.0058"}, /* N·m·s/rad */
    {"law.step_of_ideal_per_ms", "0.1692"},
    {"law.limit_of_force_per_ms", "0.3322"},
    {"law.limit_of_penetration_per_ms", "0.5238"},
    {"law.force_limit_n_m", "0.045"}, /* N·m */
    {"law.position_error_rad", "0"}, /* rad */
    {"law.filter.mass_kg_m2", "0.0000009234"}, /* kg·m² */
    {"law.filter.stiffness_n_m_per_rad", "23.97"}, /* N·m/rad */
    {"law.filter.damping_n_m_s_per_rad", "0.009071"}, /* N·m·s/rad */
    {"law.filter.ground_damping_n_m_s_per_rad", "0.00125"}, /* N·m·s/rad */
    {"law.estimator.bandwidth_hz", "71"}, /* Hz */
    {"law.estimator.inertia_kg_m2", "0.00003"}, /* kg·m² */
    {"law.estimator.damping_n_m_s_per_rad", "0.000009"}, /* N·m·s/rad */
    {"law.estimator.delay_s", "0.0009"}, /* s */
    {"law.guard.on", "true"},
    {"law.guard.capacity_j", "0.045"}, /* J */
    {"law.guard.refill_w", "0.0005882743"}, /* W */
    {"law.guard.damping_n_m_s_per_rad", "0.000009"}, /* N·m·s/rad */
    {"law.guard.share_of_damping", "0.8"},
    {"law.guard.overspeed_rad_per_s", "60"}, /* rad/s */
    {"law.guard.delay_s", "0.0000625"}, /* s */
    {"law.guard.lag_s", "0.000189877"}, /* s */
    {"law.guard.change", "estimated"},
  };
  ts_status status = ts_settings_init(settings);
  size_t i;
  for (i = 0; status == TS_OK && i < sizeof values / sizeof values[0]; i++) {
    status = ts_settings_set(settings, values[i][0], values[i][1]);
  }
  if (status == TS_OK) {
    status = ts_settings_set_counts_per_rev(settings, 16384);
  }
  return status;
}

#endif
