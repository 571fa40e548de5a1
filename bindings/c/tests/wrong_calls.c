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
  ts_estimator estimator;
  ts_feel feel;
  ts_feel_config parts;
  ts_position position = 77, moved = 77;
  ts_force force = 77;
  ts_energy account = 77;
  char words[160] = "";
  memset(&guard, 0, sizeof guard);
  memset(&settings, 0, sizeof settings);
  memset(&wall, 0xA5, sizeof wall);
  memset(&estimator, 0, sizeof estimator);
  memset(&feel, 0xA5, sizeof feel);

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
  IS(strstr(words, "delay_s") != NULL, 1);
  config.delay = 0;
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
  /* No force beyond the limit, also with a full account. */
  IS(ts_guard_tick(&guard, 0, INT32_MAX, &force), TS_OK);
  IS(force, TS_SI(0.5) >> 8);
  IS(ts_guard_tick(&guard, 0, INT32_MIN, &force), TS_OK);
  IS(force, -(TS_SI(0.5) >> 8));
  IS(ts_moved(3, TS_POSITION(0.0001)), 3 * 1678);
  IS(ts_moved(INT32_MIN / 2, TS_POSITION(0.0001)), INT32_MIN);

  /* After an over-speed the force is 0 until `ts_guard_resume`. After a refused configuration the guard is not initialised. */
  IS(ts_guard_tick(&guard, 1 << 30, 1 << 20, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_guard_resume(&guard), TS_OK);
  IS(ts_guard_tick(&guard, 0, 0, &force), TS_OK);

  /* The tick function must be that of the configuration. A wrong tick gives no force, and empties the account if a force acted. */
  IS(ts_guard_init(&guard, &config), TS_OK);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_OK);
  IS(force > 0, 1);
  IS(ts_guard_account(&guard, &account), TS_OK);
  IS(account > 0, 1);
  IS(ts_guard_tick_with_change(&guard, 0, 0, 1 << 20, &force), TS_WRONG_TICK);
  IS(force, 0);
  IS(ts_guard_account(&guard, &account), TS_OK);
  IS(account, 0);
  config.change_is_measured = 1;
  IS(ts_guard_init(&guard, &config), TS_OK);
  IS(ts_guard_tick_with_change(&guard, 0, 0, 1 << 20, &force), TS_OK);
  IS(force > 0, 1);
  IS(ts_guard_tick(&guard, 0, 1 << 20, &force), TS_WRONG_TICK);
  IS(force, 0);
  IS(ts_guard_tick_with_change(&guard, 0, 0, 1 << 20, NULL), TS_NULL_POINTER);
  config.change_is_measured = 0;

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

  /* Walls and feels get one position a tick. A guard that relies on a second one is refused. */
  IS(ts_settings_set(&settings, "law.guard.change", "measured"), TS_OK);
  IS(ts_settings_check(&settings, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "law.guard.change = measured") != NULL, 1);
  IS(ts_wall_resume(&wall, &settings), TS_OUT_OF_RANGE);
  IS(ts_wall_init(&wall, &settings), TS_OUT_OF_RANGE);
  IS(ts_wall_tick(&wall, 1 << 17, &force), TS_NOT_INITIALISED);
  IS(ts_feel_defaults(&parts), TS_OK);
  parts.counts_per_rev = 16384;
  strcpy(words, "");
  IS(ts_feel_check(&settings, &parts, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "law.guard.change = measured") != NULL, 1);
  IS(ts_feel_init(&feel, &settings, &parts), TS_OUT_OF_RANGE);
  IS(ts_feel_tick(&feel, 1, &force), TS_NOT_INITIALISED);
  IS(ts_settings_set(&settings, "law.guard.on", "false"), TS_OK);
  IS(ts_settings_check(&settings, words, sizeof words), TS_OK);
  IS(ts_wall_init(&wall, &settings), TS_OK);

  IS(ts_settings_init(&settings), TS_OK);
  IS(ts_estimator_tick(&estimator, 1, &position, &moved), TS_NOT_INITIALISED);
  IS(position == 0 && moved == 0, 1);
  IS(ts_estimator_commanded(&estimator, 1), TS_NOT_INITIALISED);
  IS(ts_estimator_init(&estimator, &settings), TS_OK);
  IS(ts_estimator_tick(&estimator, 1 << 20, &position, &moved), TS_OK);
  IS(position == 1 << 20 && moved == 0, 1);
  IS(ts_estimator_tick(&estimator, 1 << 20, &position, NULL), TS_NULL_POINTER);
  IS(position, 0);
  IS(ts_settings_set(&settings, "law.estimator.bandwidth_hz", "-1"), TS_OK);
  IS(ts_estimator_init(&estimator, &settings), TS_OUT_OF_RANGE);
  IS(ts_estimator_tick(&estimator, 1, &position, &moved), TS_NOT_INITIALISED);

  IS(ts_settings_init(&settings), TS_OK);
  force = 77, account = 77;
  IS(ts_feel_tick(&feel, 1, &force), TS_NOT_INITIALISED);
  IS(force, 0);
  IS(ts_feel_account(&feel, &account), TS_NOT_INITIALISED);
  IS(account, 0);
  IS(ts_feel_defaults(NULL), TS_NULL_POINTER);
  IS(ts_feel_defaults(&parts), TS_OK);
  IS(ts_feel_init(&feel, &settings, &parts), TS_OUT_OF_RANGE);
  IS(ts_feel_check(&settings, &parts, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "counts_per_rev = 0") != NULL, 1);
  parts.counts_per_rev = 16384;
  IS(ts_feel_init(&feel, &settings, &parts), TS_OK);
  parts.detents.strength = TS_SI(0.02);
  parts.detents.per_turn = 70000;
  IS(ts_feel_check(&settings, &parts, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "1 to 6283") != NULL, 1);
  IS(ts_feel_init(&feel, &settings, &parts), TS_OUT_OF_RANGE);
  IS(ts_feel_tick(&feel, 1, &force), TS_NOT_INITIALISED);
  parts.detents.per_turn = 24;
  parts.profile.strength = TS_SI(0.02);
  parts.profile.count = TS_FEEL_POINTS + 1;
  IS(ts_feel_check(&settings, &parts, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "97 points") != NULL, 1);
  IS(ts_feel_init(&feel, &settings, &parts), TS_OUT_OF_RANGE);
  IS(ts_feel_tick(&feel, 1, &force), TS_NOT_INITIALISED);
  parts.profile.strength = 0;
  parts.walls[3].surface = TS_SI(1);
  parts.walls[3].stiffness = TS_SI(-5);
  IS(ts_feel_check(&settings, &parts, words, sizeof words), TS_OUT_OF_RANGE);
  IS(strstr(words, "walls[3]") != NULL, 1);
  parts.walls[3].stiffness = TS_SI(5);
  IS(ts_feel_init(&feel, &settings, NULL), TS_NULL_POINTER);
  IS(ts_feel_init(&feel, &settings, &parts), TS_OK);
  IS(ts_feel_tick(&feel, 0, NULL), TS_NULL_POINTER);
  IS(ts_feel_tick(&feel, 85, &force), TS_OK);
  IS(ts_feel_tick(&feel, 170, &force), TS_OK); /* nearly a quarter of a pitch past a detent */
  IS(force > TS_SI(0.0198) >> 8 && force <= TS_SI(0.02) >> 8, 1);
  IS(ts_feel_tick(&feel, 1 << 20, &force), TS_OVERSPEED);
  IS(force, 0);
  IS(ts_feel_resume(&feel), TS_OK);
  IS(ts_feel_tick(&feel, 0, &force), TS_OK);
  for (int status = -1; status < 9; status++) IS(ts_status_text(status) != NULL, 1);
  return 0;
}
