/* Libraries whose table breaks one rule of algorithms/plugin.h each: the one that -D names. With none of them it is
 * right. */
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "plugin.h"

struct collision_method {
  int unused;
};

static collision_method *create(const collision_bodies *bodies, const collision_value *knobs, char *error) {
  (void)bodies, (void)knobs, (void)error;
  return calloc(1, sizeof(collision_method));
}

static int prepare(collision_method *method, const collision_pose *poses, double enlarge, char *error) {
  (void)method, (void)poses, (void)enlarge, (void)error;
  return 0;
}

static int answer(collision_method *method, const collision_run *runs, uint64_t run_count, collision_hits *hits,
                  char *error) {
  (void)method, (void)runs, (void)run_count, (void)hits, (void)error;
  return 0;
}

static void destroy(collision_method *method) { free(method); }

#ifndef NAME
#define NAME "plain"
#endif
#ifndef SECOND_NAME
#define SECOND_NAME "plain_2"
#endif
#ifndef ABI
#define ABI COLLISION_ABI
#endif
#ifndef ROWS
#define ROWS 2
#endif
#ifndef PROMISE
#define PROMISE COLLISION_NONE
#endif
#ifndef ANSWER
#define ANSWER answer
#endif
#ifndef KNOB
#define KNOB .name = "size", .unit = "m", .what = "a size", .type = COLLISION_REAL, .preset = {.real = 1}, .most = 2
#endif

static const collision_knob knobs[] = {{KNOB}};
static const collision_row first = {.name = NAME,
                                    .what = "reports nothing",
                                    .precision = "double",
                                    .promise = PROMISE,
                                    .knobs = knobs,
                                    .knob_count = 1,
                                    .create = create,
                                    .prepare = prepare,
                                    .answer = ANSWER,
                                    .destroy = destroy};
static const collision_row second = {.name = SECOND_NAME,
                                     .what = "reports nothing",
                                     .precision = "double",
                                     .create = create,
                                     .prepare = prepare,
                                     .answer = answer,
                                     .destroy = destroy};

#ifdef CONSTRUCTOR
__attribute__((constructor)) static void at_load(void) { CONSTRUCTOR; }
#endif

#ifdef OTHER_SYMBOL
#define collision_plugin OTHER_SYMBOL
const collision_table *OTHER_SYMBOL(void);
#endif

COLLISION_EXPORT const collision_table *collision_plugin(void) {
#ifdef NULL_ROW
  static const collision_row *const rows[] = {&first, NULL};
#else
  static const collision_row *const rows[] = {&first, &second};
#endif
  static const collision_table table = {.abi = ABI, .row_count = ROWS, .row = rows};
#ifdef GIVES
  return GIVES;
#else
  return &table;
#endif
}
