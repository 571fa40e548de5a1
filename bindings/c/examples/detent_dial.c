/* A dial with 24 detents, a click at each and two end stops, on a simulated knob at 1 kHz. A hand turns it through some detents and lets go; it
 * comes to rest in a detent. Then the hand pushes it against the end stop.
 *
 *     cargo build --release -p touchstone-c
 *     cc -Ibindings/c/include bindings/c/examples/detent_dial.c target/release/libtouchstone_c.a -lm -o detent_dial && ./detent_dial
 */
#include "touchstone.h"
#include <math.h>
#include <stdio.h>

#define COUNTS_PER_REV 16384
static const double pitch = 6.283185307179586 / 24;

static ts_settings settings;
static ts_feel feel;
static double angle, speed;

static int set_up(void) {
  static ts_feel_config config; /* some 500 bytes */
  char problem[160];
  ts_settings_init(&settings); /* the device is Touchstone's simulated knob: 1e-4 kg*m^2, 4e-4 N*m*s/rad */
  ts_feel_defaults(&config);
  config.counts_per_rev = COUNTS_PER_REV;
  config.detents.per_turn = 24;
  config.detents.strength = TS_SI(0.03);
  config.click.per_turn = 24;
  config.click.centre = TS_SI(6.283185307 / 48); /* halfway between two detents */
  config.click.strength = TS_SI(0.01);
  config.click.duration = TS_SI(0.006);
  config.damper.damping = TS_SI(0.001);
  config.damper.bandwidth_hz = TS_SI(100);
  config.walls[0].surface = TS_SI(2.0);
  config.walls[0].stiffness = TS_SI(3);
  config.walls[1].surface = TS_SI(-2.0);
  config.walls[1].stiffness = TS_SI(3);
  config.walls[1].solid_below = 1;
  if (ts_feel_init(&feel, &settings, &config) == TS_OK) return 0;
  ts_feel_check(&settings, &config, problem, sizeof problem);
  fprintf(stderr, "feel: %s\n", problem);
  return -1;
}

/* The hand pushes with a torque for some milliseconds. */
static int push(double torque, int ticks) {
  ts_force force;
  for (int tick = 0; tick < ticks; tick++) {
    if (ts_feel_tick(&feel, (int64_t)floor(angle * COUNTS_PER_REV / 6.283185307179586 + 0.5), &force) != TS_OK) return -1;
    for (int step = 0; step < 50; step++) {
      speed += (torque - ts_to_float(force) - 4e-4 * speed) / 1e-4 * 2e-5;
      angle += speed * 2e-5;
    }
  }
  return 0;
}

int main(void) {
  if (set_up() != 0) return 1;
  if (push(0.035, 150) != 0 || push(0.0, 1000) != 0) return 2;
  const double rests = angle / pitch;
  printf("let go: rests %.3f detents from the start\n", rests);
  if (push(0.1, 1000) != 0) return 3;
  printf("pushed with 0.1 N*m: %.3f rad, the end stop begins at 2 rad\n", angle);
  return rests > 0.5 && fabs(rests - floor(rests + 0.5)) < 0.02 && angle > 2.0 && angle < 2.06 ? 0 : 4;
}
