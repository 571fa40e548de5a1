/* Prints each setting that a file of `touchstone tune` sets, then a digest of the wall's forces with these settings. */
#define TS_NO_FLOAT
#include "touchstone.h"
#include <stdio.h>

static ts_status set(ts_settings *settings, const char *path, const char *value) {
  printf("%s %s\n", path, value);
  return ts_settings_set(settings, path, value);
}

static ts_status set_counts(ts_settings *settings, uint32_t counts) {
  printf("counts %u\n", (unsigned)counts);
  return ts_settings_set_counts_per_rev(settings, counts);
}

#define ts_settings_set set
#define ts_settings_set_counts_per_rev set_counts
#include TUNED

int main(void) {
  static ts_settings settings;
  static ts_wall wall;
  uint32_t digest = 0, tick;
  if (tuned_settings(&settings) != TS_OK) return 1;
  if (ts_wall_init(&wall, &settings) != TS_OK) return 2;
  for (tick = 0; tick < 2000; tick++) {
    int32_t force;
    /* In and out again, 8 mrad deep. */
    int32_t depth = (int32_t)(tick % 200 < 100 ? tick % 200 : 200 - tick % 200) * 1342;
    if (ts_wall_tick(&wall, depth, &force) != TS_OK) return 3;
    digest = digest * 31 + (uint32_t)force;
  }
  printf("digest %u\n", (unsigned)digest);
  return 0;
}
