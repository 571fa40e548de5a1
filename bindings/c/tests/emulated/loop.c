/* A firmware's main loop with a part of the library, to measure its size: compile it with -DPART=GUARD, ESTIMATOR, WALL or FEEL. */
#define TS_NO_FLOAT
#include "touchstone.h"

#define GUARD 1
#define ESTIMATOR 2
#define WALL 3
#define FEEL 4

volatile int32_t encoder, motor, asked;

#if PART == GUARD
static ts_guard guard;
#else
static ts_settings settings;
#endif
#if PART == ESTIMATOR
static ts_estimator estimator;
#elif PART == WALL
static ts_wall wall;
#elif PART == FEEL
static ts_feel feel;
static ts_feel_config config;
#endif

int main(void) {
#if PART == GUARD
  ts_guard_config config;
  ts_guard_defaults(&config);
  config.rate_hz = 1000, config.force_limit = TS_SI(0.5), config.count = TS_SI(0.0001), config.damping = TS_SI(0.0004),
  config.delay = 0;
  if (ts_guard_init(&guard, &config) != TS_OK) return 1;
  int32_t last = encoder;
#else
  ts_settings_init(&settings);
  ts_settings_set(&settings, "law.force_limit_n_m", "0.4");
#endif
#if PART == ESTIMATOR
  if (ts_estimator_init(&estimator, &settings) != TS_OK) return 1;
#elif PART == WALL
  if (ts_wall_init(&wall, &settings) != TS_OK) return 1;
#elif PART == FEEL
  ts_feel_defaults(&config);
  config.counts_per_rev = 16384, config.detents.per_turn = 24, config.detents.strength = TS_SI(0.02);
  if (ts_feel_init(&feel, &settings, &config) != TS_OK) return 1;
#endif
  for (;;) {
    ts_force force = 0;
    const int32_t now = encoder;
#if PART == GUARD
    ts_guard_tick(&guard, ts_moved(now - last, TS_POSITION(0.0001)), asked, &force);
    last = now;
#elif PART == ESTIMATOR
    ts_position moved;
    ts_estimator_tick(&estimator, now, &force, &moved);
    ts_estimator_commanded(&estimator, asked);
#elif PART == WALL
    ts_wall_tick(&wall, ts_penetration(now, 16384, TS_SI(0.5)), &force);
#elif PART == FEEL
    ts_feel_tick(&feel, now, &force);
#endif
    motor = force;
  }
}
