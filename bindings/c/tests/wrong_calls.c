/* Tests that wrong calls return the right status and a force of 0. Prints the number of the first line that fails, and exits with 1. */
#include "touchstone.h"
#include <stdio.h>
#include <string.h>

#define IS(call, answer)                                                      \
  do {                                                                        \
    if ((call) != (answer)) {                                                 \
      printf("line %d: %s\n", __LINE__, words);                                          \
      return 1;                                                               \
    }                                                                         \
  } while (0)

int main(void) {
  ts_guard guard;
  ts_guard_config config;
  ts_settings settings;
  ts_wall wall;
  ts_force force = 77;
  ts_energy account = 77;
  char words[120] = "";
  memset(&guard, 0, sizeof guard);
  memset(&settings, 0, sizeof settings);
  memset(&wall, 0xA5, sizeof wall);

  IS(ts_guard_tick(&guard, 1, 2, &force), TS_NOT_INITIALISED);
  IS(force, 0);
  force = 77;
  IS(ts_guard_tick(NULL, 1, 2, &force), TS_NULL_POINTER);
  IS(force, 0);
  force = 77;
  IS(ts_wall_tick(&wall, 1 << 20, &force), TS_NOT_INITIALISED);
  IS(force, 0);
  IS(ts_guard_account(&guard, &account), TS_NOT_INITIALISED);
  IS(account, 0);
  IS(ts_guard_init(&guard, NULL), TS_NULL_POINTER);
  IS(ts_guard_init(NULL, &config), TS_NULL_POINTER);
  IS(ts_guard_defaults(NULL), TS_NULL_POINTER);

  /* Properties of the user's device have no default. */
  IS(ts_guard_defaults(&config), TS_OK);
  IS(ts_guard_init(&guard, &config), TS_OUT_OF_RANGE);
  IS(ts_guard_check(&config, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "rate_hz") != NULL, 1);
  IS(ts_guard_check(&config, words, 5), TS_OUT_OF_RANGE);
  IS(strlen(words), 4u);
  IS(ts_guard_check(&config, NULL, 0), TS_OUT_OF_RANGE);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(0.5);
  config.count = TS_SI(0.0001);
  config.damping = TS_SI(0.0004);
  IS(ts_guard_init(&guard, &config), TS_OK);
  IS(ts_guard_tick(&guard, 1, 1 << 20, NULL), TS_NULL_POINTER);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_OK);
  IS(force > 0, 1);

  /* After an over-speed the force is 0 until `ts_guard_resume`. After a refused configuration the guard is not initialised. */
  IS(ts_guard_tick(&guard, 1 << 30, 1 << 20, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_guard_resume(&guard), TS_OK);
  IS(ts_guard_tick(&guard, 0, 0, &force), TS_OK);
  config.share_of_damping = TS_SI(1.5);
  IS(ts_guard_init(&guard, &config), TS_OUT_OF_RANGE);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_NOT_INITIALISED);

  IS(ts_settings_set(&settings, "law.kind", "tdpa"), TS_NOT_INITIALISED);
  IS(ts_wall_init(&wall, &settings), TS_NOT_INITIALISED);
  IS(ts_settings_init(&settings), TS_OK);
  IS(ts_settings_set(&settings, "law.kindd", "tdpa"), TS_UNKNOWN_SETTING);
  IS(ts_settings_set(&settings, "law.kind", "TDPA"), TS_BAD_VALUE);
  IS(ts_settings_set(&settings, "law.force_limit_n_m", "0,5"), TS_BAD_VALUE);
  IS(ts_settings_set(&settings, "law.force_limit_n_m", "\xff"), TS_BAD_VALUE);
  IS(ts_settings_set(&settings, NULL, "1"), TS_NULL_POINTER);
  IS(ts_settings_set(&settings, "law.force_limit_n_m", NULL), TS_NULL_POINTER);
  IS(ts_settings_set_counts_per_rev(&settings, 0), TS_BAD_VALUE);
  IS(ts_settings_set(&settings, "law.guard.share_of_damping", "1.5"), TS_OK);
  IS(ts_settings_check(&settings, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "law.guard.share_of_damping = 1.5") != NULL, 1);
  IS(ts_wall_init(&wall, &settings), TS_OUT_OF_RANGE);
  IS(ts_settings_set(&settings, "law.guard.share_of_damping", "0.8"), TS_OK);
  IS(ts_wall_init(&wall, &settings), TS_OK);
  IS(ts_wall_tick(&wall, 1 << 17, &force), TS_OK);
  IS(ts_wall_tick(&wall, 1 << 30, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_wall_resume(&wall, &settings), TS_OK);
  IS(ts_penetration(100, 0, 0), 0);
  for (int status = -1; status < 9; status++) IS(ts_status_text(status) != NULL, 1);
  return 0;
}
