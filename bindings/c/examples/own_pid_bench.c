/* Runs the firmware `own_pid.c` on a simulated knob that a hand holds lightly. The derivative part of the PID has the wrong sign and the
 * torque comes half a tick late, so the knob swings up and gives the hand energy without end. The guard bounds that energy.
 *
 *     cargo build --release -p touchstone-c
 *     cc -Ibindings/c/include bindings/c/examples/own_pid.c bindings/c/examples/own_pid_bench.c target/release/libtouchstone_c.a \
 *       -lm -o own_pid && ./own_pid
 *
 * Compile both files with `-Dts_guard_tick=without_guard` to see it without the guard. */
#include "touchstone.h"
#include <math.h>
#include <stdio.h>

extern float kp, kd;
ts_status set_up(void);
void every_tick(void);

static double angle_rad, asked_n_m;
static int is_off;

int32_t read_encoder(void) { return (int32_t)floor(angle_rad * 16384 / 6.283185307179586 + 0.5); }
void set_motor(float torque_n_m) { asked_n_m = torque_n_m; }
void motor_off(void) { is_off = 1; }

/* For a run without the guard: only the motor's limit is left. */
ts_status without_guard(ts_guard *guard, ts_position moved, ts_force wanted, ts_force *allowed) {
  const ts_force limit = ts_from_float(0.3f);
  (void)guard, (void)moved;
  *allowed = wanted > limit ? limit : wanted < -limit ? -limit : wanted;
  return TS_OK;
}

int main(void) {
  /* Inertia and damping of the knob, damping of the hand's light grip. */
  const double inertia = 1e-4, damping = 4e-4, grip = 2e-4, step_s = 1e-5;
  const int seconds = 10;
  double speed = 0.5, torque = 0.0, taken_j = 0.0;
  const double start_j = 0.5 * inertia * speed * speed;
  kp = 0.5f, kd = -0.002f;
  if (set_up() != TS_OK) return 2;
  for (int tick = 0; tick < 1000 * seconds; tick++) {
    every_tick();
    for (int step = 0; step < 100; step++) {
      if (step == 50) torque = is_off ? 0.0 : asked_n_m;
      speed += (torque - (damping + grip) * speed) / inertia * step_s;
      angle_rad += speed * step_s;
      taken_j += grip * speed * speed * step_s;
    }
  }
  const double out_j = taken_j + 0.5 * inertia * speed * speed;
  /* Capacity, refill and half a count under the largest torque, and the energy with which the knob started. */
  const double promised_j = 0.02 + 0.0005 * seconds + 0.3 * 0.5 * 6.283185307179586 / 16384 + start_j;
  printf("in %d s hand and knob got %.1f mJ; the guard promises at most %.1f mJ\n", seconds, 1e3 * out_j, 1e3 * promised_j);
  return out_j <= promised_j ? 0 : 1;
}
