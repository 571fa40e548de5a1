/* Runs guard and wall for a million control periods with random motions and forces, and prints a digest of the results. A Rust test
 * must get the same digest. Needs no floating point. */
#define TS_NO_FLOAT
#include "touchstone.h"
#include <stdio.h>

static uint32_t state = 0x2545F491u;
static uint32_t next(void) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

static uint64_t digest = 0xCBF29CE484222325u;
static void add(int32_t value) { digest = (digest ^ (uint32_t)value) * 0x100000001B3u; }

int main(void) {
  ts_guard_config config;
  ts_guard guard;
  ts_settings settings;
  ts_wall wall;
  ts_guard_defaults(&config);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(0.5);
  config.count = TS_SI(0.000157079633);
  config.damping = TS_SI(0.0004);
  if (ts_guard_init(&guard, &config) != TS_OK) return 1;
  ts_settings_init(&settings);
  if (ts_settings_set(&settings, "wall.k_desired_n_m_per_rad", "14") != TS_OK) return 2;
  if (ts_settings_set(&settings, "law.kind", "enhanced-sfa") != TS_OK) return 3;
  if (ts_wall_init(&wall, &settings) != TS_OK) return 4;
  int32_t place = 0;
  for (uint32_t tick = 0; tick < 1000000u; tick++) {
    uint32_t chance = next();
    /* Most motions are small; one in a thousand is any 32-bit number. */
    int32_t moved = chance % 1000u == 0 ? (int32_t)next() : (int32_t)(next() % 1000001u) - 500000;
    int32_t wanted = (int32_t)next();
    int32_t allowed = 0, force = 0;
    int status = ts_guard_tick_with_change(&guard, moved, moved / 3, wanted, &allowed);
    add(allowed);
    add(status);
    if (status == TS_OVERSPEED) ts_guard_resume(&guard);
    if (chance % 7u == 0) ts_guard_commanded(&guard, allowed / 2);
    place = (int32_t)(next() % 200001u) - 100000 + (chance % 5000u == 0 ? (int32_t)next() / 4 : 0);
    status = ts_wall_tick(&wall, place, &force);
    add(force);
    add(status);
    if (status == TS_OVERSPEED) ts_wall_resume(&wall, &settings);
  }
  printf("%016llx\n", (unsigned long long)digest);
  return 0;
}
