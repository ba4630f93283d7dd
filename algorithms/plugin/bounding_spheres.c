/* bounding_spheres_c: the built-in bounding_sphere as a library in C99. Balls around the bodies' positions, each as
 * long as the half diagonal of its mesh, overlap. Answers are equal to the built-in ones, pair by pair.
 *
 *     cc -std=c99 -O3 -fPIC -shared -fvisibility=hidden -I algorithms algorithms/plugin/bounding_spheres.c -lm
 *         -o libbounding_spheres_c.so
 *
 * -std=c99 also forbids fused multiply-add, which would round otherwise where the processor has it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plugin.h"

/* The hot loop is built twice, for any x86-64 and for AVX2; the bits are the same. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PROCESSOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PROCESSOR_CLONES
#endif

struct collision_method {
  uint32_t bodies;
  double *x, *y, *z, *r; /* m, at this step */
  double *radius;        /* m, not enlarged */
  uint8_t *hit;          /* of one run, and 8 bytes more */
};

static void destroy(collision_method *m) {
  free(m->x);
  free(m->hit);
  free(m);
}

static collision_method *create(const collision_bodies *bodies, const collision_value *knobs, char *error) {
  const size_t n = bodies->body_count;
  collision_method *m = calloc(1, sizeof *m);
  if (m != NULL) {
    m->bodies = bodies->body_count;
    m->x = malloc((5 * n + 1) * sizeof(double));
    m->hit = malloc(n + 8);
  }
  if (m == NULL || m->x == NULL || m->hit == NULL) {
    if (m != NULL) destroy(m);
    collision_fail(error, "out of memory");
    return NULL;
  }
  m->y = m->x + n;
  m->z = m->y + n;
  m->r = m->z + n;
  m->radius = m->r + n;
  for (size_t body = 0; body < n; ++body) {
    const collision_mesh *mesh = &bodies->mesh[bodies->body_mesh[body]];
    double half[3] = {0, 0, 0};
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; ++i) half[i % 3] = fmax(half[i % 3], fabs(mesh->vertices[i]));
    m->radius[body] = knobs[0].real * sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
  }
  return m;
}

static int prepare(collision_method *m, const collision_pose *poses, double enlarge, char *error) {
  (void)error;
  for (uint32_t body = 0; body < m->bodies; ++body) {
    const double *t = poses[body].position;
    m->x[body] = t[0];
    m->y[body] = t[1];
    m->z[body] = t[2];
    m->r[body] = m->radius[body];
    if (enlarge > 0) m->r[body] += enlarge * (m->radius[body] + sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
  }
  return 0;
}

/* The definition. */
static int overlap(const collision_method *m, uint32_t a, uint32_t b) {
  const double dx = m->x[a] - m->x[b], dy = m->y[a] - m->y[b], dz = m->z[a] - m->z[b];
  return m->r[a] + m->r[b] > sqrt(dx * dx + dy * dy + dz * dz);
}

/* hit[i] for the pairs (a, first + i), by squares; 0 when one came so close that only the square root may decide. */
PROCESSOR_CLONES static int overlap_run(const double *x, const double *y, const double *z, const double *r, uint32_t a,
                                        uint32_t first, uint32_t last, uint8_t *hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  uint8_t doubt = 0;
  for (uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    const double square = dx * dx + dy * dy + dz * dz, reach_square = reach * reach;
    hit[b - first] = square < reach_square;
    doubt |= fabs(square - reach_square) <= reach_square * 0x1p-50 + 1e-290;
  }
  return !doubt;
}

static int answer(collision_method *m, const collision_run *runs, uint64_t run_count, collision_hits *hits,
                  char *error) {
  for (uint64_t i = 0; i < run_count; ++i) {
    const collision_run run = runs[i];
    const uint32_t size = run.last - run.first;
    if (!overlap_run(m->x, m->y, m->z, m->r, run.a, run.first, run.last, m->hit))
      for (uint32_t k = 0; k < size; ++k) m->hit[k] = (uint8_t)overlap(m, run.a, run.first + k);
    memset(m->hit + size, 0, 8);
    for (uint32_t k = 0; k < size; k += 8) { /* hits are rare: eight answers are skipped at once */
      uint64_t eight;
      memcpy(&eight, m->hit + k, 8);
      if (eight == 0) continue;
      for (uint32_t j = k; j < k + 8; ++j)
        if (m->hit[j] && collision_hit(hits, run.a, run.first + j)) return collision_fail(error, "out of memory");
    }
  }
  return 0;
}

static int count(collision_method *m, const collision_run *runs, uint64_t run_count, collision_hits *hits,
                 uint64_t *operations, char *error) {
  for (uint64_t i = 0; i < run_count; ++i)
    for (uint32_t b = runs[i].first; b < runs[i].last; ++b) {
      ++*operations;
      if (overlap(m, runs[i].a, b) && collision_hit(hits, runs[i].a, b)) return collision_fail(error, "out of memory");
    }
  return 0;
}

static const collision_knob knobs[] = {{.name = "scale",
                                        .unit = "1",
                                        .what = "balls are so many times as large",
                                        .type = COLLISION_REAL,
                                        .preset = {.real = 1},
                                        .least = 1,
                                        .most = 1000}};

static const collision_row row = {.name = "bounding_spheres_c",
                                  .what = "balls of the half diagonal about the bodies' positions overlap",
                                  .unit = "distances",
                                  .precision = "double",
                                  .promise = COLLISION_CONSERVATIVE,
                                  .scope = COLLISION_PAIR,
                                  .knobs = knobs,
                                  .knob_count = 1,
                                  .create = create,
                                  .prepare = prepare,
                                  .answer = answer,
                                  .count = count,
                                  .destroy = destroy};

COLLISION_EXPORT const collision_table *collision_plugin(void) {
  static const collision_row *const rows[] = {&row};
  static const collision_table table = {.abi = COLLISION_ABI, .row_count = 1, .row = rows, .version = "1"};
  return &table;
}
