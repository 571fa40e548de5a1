/* Runs feels with every part through random motions, and prints a digest of the results. A Rust test must get the same digest. */
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
static void add(int64_t value) { digest = (digest ^ (uint64_t)value) * 0x100000001B3u; }

static ts_settings settings;
static ts_feel feel;
static ts_feel_config config;

/* Walls above, below and far away, and all other parts; `around` says whether distances are given per turn. */
static void all_parts(int around) {
  ts_feel_defaults(&config);
  config.counts_per_rev = 16384;
  config.walls[0] = (ts_feel_wall){TS_SI(1.0), TS_SI(5), 0};
  config.walls[2] = (ts_feel_wall){TS_SI(-1.0), TS_SI(4), 1};
  config.walls[5] = (ts_feel_wall){TS_SI(700.0), TS_SI(5), 0};
  config.detents = (ts_feel_detents){TS_SI(0.03125), around ? 24 : 0, TS_SI(0.25), TS_SI(0.125)};
  config.spring = (ts_feel_spring){TS_SI(0.0625), TS_SI(0.25), TS_SI(0.5)};
  config.damper = (ts_feel_damper){TS_SI(0.0009765625), TS_SI(100)};
  config.dry_friction = (ts_feel_dry_friction){TS_SI(0.015625), TS_SI(0.0078125)};
  config.click = (ts_feel_click){TS_SI(0.03125), around ? 36 : 0, TS_SI(0.1875), TS_SI(0.0625), TS_SI(0.0078125)};
  config.inertia = (ts_feel_inertia){TS_SI(0.00000762939453125), TS_SI(12)};
  config.profile.strength = TS_SI(0.0625);
  config.profile.per_turn = around ? 3 : 0;
  config.profile.start = TS_SI(-0.5);
  config.profile.end = TS_SI(1.5);
  config.profile.count = 7;
  for (int i = 0; i < 7; i++) config.profile.points[i] = (int16_t)((i * 7919) % 20001 - 10000);
}

int main(void) {
  int64_t count = 0, account = 0;
  ts_settings_init(&settings);
  for (int around = 0; around < 2; around++) {
    all_parts(around);
    if (ts_feel_init(&feel, &settings, &config) != TS_OK) return 1 + around;
    for (uint32_t tick = 0; tick < 50000u; tick++) {
      uint32_t chance = next();
      int32_t force = 0;
      /* Mostly small steps about the origin, at times a jump far away or back. */
      count += (int64_t)(next() % 41u) - 20;
      if (chance % 3000u == 0) count = (int64_t)next() * (int32_t)next();
      if (chance % 3000u == 1) count = (int64_t)(next() % 6000u) - 3000;
      int status = ts_feel_tick(&feel, count, &force);
      add(force);
      add(status);
      if (chance % 5u == 0) ts_feel_commanded(&feel, force / 2);
      if (chance % 1000u == 2) ts_feel_switched_off(&feel);
      if (chance % 1000u == 2 || status == TS_OVERSPEED) ts_feel_resume(&feel);
      ts_feel_account(&feel, &account);
      add(account);
    }
  }
  printf("%016llx\n", (unsigned long long)digest);
  return 0;
}
