/* Runs a wall with each control law and prints a digest of its forces, or the words with which a library without the law refuses it. */
#define TS_NO_FLOAT
#include "touchstone.h"
#include <stdio.h>

static ts_settings settings;
static ts_wall wall;
static char words[200];

static void run(const char *law) {
  ts_settings_init(&settings);
  ts_settings_set(&settings, "wall.k_desired_n_m_per_rad", "14");
  ts_settings_set(&settings, "law.k_soft_n_m_per_rad", "0.5"); /* below the wall's, so that the laws are no plain springs */
  ts_settings_set(&settings, "law.velocity.from", "foaw");
  ts_settings_set(&settings, "law.kind", law);
  if (ts_settings_check(&settings, words, sizeof words) != TS_OK) {
    printf("%s: %s\n", law, words);
    return;
  }
  if (ts_wall_init(&wall, &settings) != TS_OK) printf("check and init differ\n");
  uint64_t digest = 0xCBF29CE484222325u;
  uint32_t state = 0x2545F491u;
  for (int tick = 0; tick < 20000; tick++) {
    state ^= state << 13, state ^= state >> 17, state ^= state << 5;
    ts_force force;
    ts_status status = ts_wall_tick(&wall, (int32_t)(state % 200001u) - 100000, &force);
    digest = (digest ^ (uint32_t)force ^ (uint32_t)status) * 0x100000001B3u;
  }
  printf("%s %016llx\n", law, (unsigned long long)digest);
}

int main(void) {
  static const char *const laws[] = {"spring", "spring-damper", "tdpa", "fba", "sfa", "sfa-continuous", "enhanced-sfa"};
  for (unsigned i = 0; i < sizeof laws / sizeof laws[0]; i++) run(laws[i]);
  return 0;
}
