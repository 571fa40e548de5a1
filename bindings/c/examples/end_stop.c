/* The end stop of a force-feedback wheel at 1 kHz, on a simulated wheel: a stiff spring with the delay of a USB link gains energy at
 * each bounce, and the wheel moves faster and faster after the hand has let go. The guard bounds the energy that the same spring can give.
 *
 *     cargo build --release -p touchstone-c
 *     cc -Ibindings/c/include bindings/c/examples/end_stop.c target/release/libtouchstone_c.a -o end_stop && ./end_stop
 */
#include "touchstone.h"
#include <stdio.h>

/* Your control law: from the position in rad, the torque in N*m that pushes the wheel back. */
static float your_law(float angle) {
  const float stop = 0.5f, stiffness = 400.0f;
  if (angle > stop) return stiffness * (angle - stop);
  if (angle < -stop) return stiffness * (angle + stop);
  return 0.0f;
}

/* Simulates a wheel that is thrown at the stop with 10 rad/s and let go. Returns its largest kinetic energy afterwards, J. */
static double throw_wheel(int guarded) {
  ts_guard_config config;
  ts_guard guard;
  char problem[160];
  ts_guard_defaults(&config);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(20.0);
  config.count = TS_SI(6.283185 / 65536);
  config.damping = TS_SI(0.01);
  config.capacity = TS_SI(0.5);
  config.delay = TS_SI(0.0005);
  if (ts_guard_init(&guard, &config) != TS_OK) {
    ts_guard_check(&config, problem, sizeof problem);
    fprintf(stderr, "guard: %s\n", problem);
    return -1.0;
  }
  const double inertia = 0.02, damping = 0.01, count = 6.283185 / 65536;
  double angle = 0.0, speed = 10.0, torque = 0.0, largest = 0.0;
  ts_position last = 0;
  int reached = 0;
  for (int tick = 0; tick < 5000; tick++) {
    /* Read the encoder. */
    ts_position position = ts_from_float((float)((double)(long)(angle / count) * count));
    ts_force wanted = ts_from_float(your_law(ts_to_float(position)));
    ts_force limit = ts_from_float(20.0f);
    ts_force allowed = wanted > limit ? limit : wanted < -limit ? -limit : wanted;
    if (guarded && ts_guard_tick(&guard, position - last, allowed, &allowed) != TS_OK) return -2.0;
    last = position;
    /* The motor has the old torque for half a tick, then the new one: a delay of 0.5 ms. */
    for (int half = 0; half < 2; half++) {
      if (half == 1) torque = ts_to_float(allowed);
      for (int step = 0; step < 50; step++) {
        speed += (-torque - damping * speed) / inertia * 1e-5;
        angle += speed * 1e-5;
      }
    }
    if (angle > 0.5) reached = 1;
    double energy = 0.5 * inertia * speed * speed;
    if (reached && angle < 0.5 && angle > -0.5 && energy > largest) largest = energy;
  }
  return largest;
}

int main(void) {
  double thrown = 0.5 * 0.02 * 10.0 * 10.0;
  double alone = throw_wheel(0), guarded = throw_wheel(1);
  printf("thrown with %.2f J; afterwards at most %.2f J without the guard, %.2f J with it (at most %.2f J)\n", thrown,
         alone, guarded, thrown + 0.5);
  return alone > thrown + 0.5 && guarded >= 0.0 && guarded <= thrown + 0.5 ? 0 : 1;
}
