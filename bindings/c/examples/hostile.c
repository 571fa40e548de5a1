/* Runs the guard, and the wall with each control law, with random motions and forces, and prints a digest of the results for each law. A Rust
 * test must get the same digests. Needs no floating point. */
#define TS_NO_FLOAT
#include "touchstone.h"
#include <stdio.h>

/* All laws together run more than a million control periods. */
#ifndef TICKS_PER_LAW
#define TICKS_PER_LAW 150000u
#endif

static uint32_t state = 0x2545F491u;
static uint32_t next(void) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

static uint64_t digest;
static void add(int32_t value) { digest = (digest ^ (uint32_t)value) * 0x100000001B3u; }

static ts_guard guard;
static ts_settings settings;
static ts_wall wall;
static ts_estimator estimator;

static int run(const char *law) {
  if (ts_settings_set(&settings, "law.kind", law) != TS_OK) return 3;
  if (ts_wall_init(&wall, &settings) != TS_OK) return 4;
  if (ts_estimator_init(&estimator, &settings) != TS_OK) return 5;
  digest = 0xCBF29CE484222325u;
  for (uint32_t tick = 0; tick < TICKS_PER_LAW; tick++) {
    uint32_t chance = next();
    /* Most motions are small; one in a thousand is any 32-bit number. */
    int32_t moved = chance % 1000u == 0 ? (int32_t)next() : (int32_t)(next() % 1000001u) - 500000;
    int32_t wanted = (int32_t)next();
    int32_t allowed = 0, force = 0, expected = 0, per_tick = 0;
    int status = ts_guard_tick_with_change(&guard, moved, moved / 3, wanted, &allowed);
    add(allowed);
    add(status);
    if (status == TS_OVERSPEED) ts_guard_resume(&guard);
    if (chance % 7u == 0) ts_guard_commanded(&guard, allowed / 2);
    int32_t place = (int32_t)(next() % 200001u) - 100000 + (chance % 5000u == 0 ? (int32_t)next() / 4 : 0);
    status = ts_wall_tick(&wall, place, &force);
    add(force);
    add(status);
    if (status == TS_OVERSPEED) ts_wall_resume(&wall, &settings);
    if (chance % 5u == 0) ts_wall_commanded(&wall, force / 2);
    add(ts_estimator_tick(&estimator, place, &expected, &per_tick));
    add(expected);
    add(per_tick);
    ts_estimator_commanded(&estimator, force);
  }
  printf("%s %016llx\n", law, (unsigned long long)digest);
  return 0;
}

int main(void) {
  static const char *const laws[] = {"spring", "spring-damper", "tdpa", "fba", "sfa", "sfa-continuous", "enhanced-sfa"};
  ts_guard_config config;
  ts_guard_defaults(&config);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(0.5);
  config.count = TS_SI(0.000157079633);
  config.damping = TS_SI(0.0004);
  config.delay = 0;
  config.change_is_measured = 1;
  if (ts_guard_init(&guard, &config) != TS_OK) return 1;
  ts_settings_init(&settings);
  if (ts_settings_set(&settings, "wall.k_desired_n_m_per_rad", "14") != TS_OK) return 2;
  int result = 0;
  for (unsigned i = 0; i < sizeof laws / sizeof laws[0] && result == 0; i++) result = run(laws[i]);
  return result;
}
