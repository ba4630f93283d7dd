/* plugin.h: a collision method of your own as a shared library, in any language that speaks C.
 *
 * A library exports one function, collision_plugin(), which gives a table of methods ("rows"). The pipeline lists them
 * beside its own, asks them the same questions on the same poses, and times them: prepare and answer, once a step.
 * Whole examples in C, C++ and Rust stand in algorithms/plugin/, the steps to build and run one in
 * algorithms/README.md.
 *
 * The order of calls, per method of a run:
 *
 *     create                                once, not part of a step's time
 *       prepare, count                      each step, not timed
 *       prepare, answer                     each step, timed, as often as the run repeats: the same answers each time
 *       remember                            each step, not timed
 *       forget                              now and then, not timed
 *     destroy                               once
 *
 * Processes   The library is loaded, and each method of a run lives, in a child process of its own. What crashes, hangs
 *             or breaks a rule below ends that method's answers, with the reason stored, and nothing else. Whatever is
 *             written to stdout is dropped; the last lines of stderr come into the reason.
 * Threads     One: all calls come from the same thread, one at a time, and a method starts no thread of its own.
 * Lifetimes   What the pipeline hands to create as `bodies`, with all that it points to, stays as it is until destroy:
 *             keep pointers, copy nothing. `poses` stay until the next prepare. All else is valid during the call only.
 *             What the table points to stays as it is as long as the library is loaded; a library is never unloaded.
 * Memory      Each side frees what it allocated. What create allocates is the library's until destroy.
 * Alignment   Every pointer is aligned as its type wants (8 for what holds doubles or pointers, 4 for 32-bit integers);
 *             do not count on more. Arrays are contiguous, structs as a C compiler for this processor lays them out.
 * Texts       NUL-terminated UTF-8, one line, at most 1000 bytes. Those of the table are never NULL but where it is
 * said. Numbers     Metres and doubles of IEEE 754. Leave the rounding mode as it is, and do not link with -ffast-math.
 * Errors      create gives NULL, other functions anything but 0, after writing a text into `error`, which has
 *             COLLISION_ERROR_SIZE bytes and begins empty. No C++ exception and no Rust panic may leave a function.
 * Determinism The same question gives the same answer: on every machine, in every repeat, whatever was asked before.
 *
 * C99 and C++11 or later; needs nothing but the two headers below. */
#ifndef COLLISION_PLUGIN_H
#define COLLISION_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of everything in this file. A library is loaded only by a pipeline of the same one. */
#define COLLISION_ABI 1u

/* Bytes of every `error`, its NUL included. */
#define COLLISION_ERROR_SIZE 512

/* Before the definition of collision_plugin: it is seen from outside also with -fvisibility=hidden. */
#if defined(__GNUC__)
#define COLLISION_EXPORT __attribute__((visibility("default")))
#else
#define COLLISION_EXPORT
#endif

/* ---- What a run consists of ------------------------------------------------------------------------------------- */

/* A triangle mesh in its own frame; several bodies may share one. */
typedef struct collision_mesh {
  const char *name;
  const double *vertices;    /* x y z of each, m */
  uint64_t vertex_count;     /* so many times 3 doubles */
  const uint32_t *triangles; /* three indices of vertices each, counter-clockwise seen from outside */
  uint64_t triangle_count;   /* so many times 3 integers; at least 1 */
  double sphere_radius;      /* m, where the mesh approximates a sphere: that sphere's; else 0 */
  const char *shape;         /* JSON: kind and parameters of a built-in shape, or the file it was read from */
} collision_mesh;

/* All bodies of a run. They are numbered from 0; columns have one entry per body. */
typedef struct collision_bodies {
  uint32_t body_count;
  uint32_t mesh_count;
  const collision_mesh *mesh; /* mesh_count of them */
  const char *const *name;    /* of each body */
  const uint32_t *body_mesh;  /* which mesh each body has */
  const uint8_t *fixed;       /* 1: the body never moves; pairs of two fixed bodies are not asked about */
  const uint8_t *chosen;      /* NULL: all pairs count; else those of which a body has 1 here */
  double closed_within;       /* corners of a mesh nearer than this, times its size, count as one where it is asked
                                 whether the mesh is closed, and a body inside it counts as meeting it */
} collision_bodies;

/* Where a body is: p_world = R(orientation) p_local + position. All seven are NaN while a body is not yet born. */
typedef struct collision_pose {
  double orientation[4]; /* a unit quaternion, w x y z */
  double position[3];    /* m */
} collision_pose;

/* ---- What is asked and answered ---------------------------------------------------------------------------------- */

/* The pairs (a, first), (a, first + 1), ... (a, last - 1); a < first < last. */
typedef struct collision_run {
  uint32_t a, first, last;
} collision_run;

/* Two bodies, a < b. */
typedef struct collision_pair {
  uint32_t a, b;
} collision_pair;

/* The answer to a step: a buffer of the pipeline's, empty at the start of a call. */
typedef struct collision_hits {
  collision_pair *pair; /* write pair[size], then count size up */
  uint64_t size;        /* pairs that are reported */
  uint64_t capacity;    /* pairs that fit */
  /* Makes room for `more` pairs after pair[size - 1]; `pair` and `capacity` may change. 0, or not 0 without memory. */
  int (*grow)(struct collision_hits *hits, uint64_t more);
  void *owner; /* the pipeline's: leave it as it is */
} collision_hits;

/* ---- Knobs: parameters that a user may set ----------------------------------------------------------------------- */

enum { COLLISION_FLAG = 0, COLLISION_INTEGER = 1, COLLISION_REAL = 2, COLLISION_CHOICE = 3 };

/* A value of a knob: the one member that belongs to the knob's type counts. */
typedef struct collision_value {
  int64_t integer;  /* of an integer; of a flag 0 or 1 */
  double real;      /* of a real */
  const char *text; /* of a choice */
} collision_value;

/* A knob. Values that its rules do not allow never come to create. A flag "containment" tells whether bodies inside
 * others are to be reported; where the user is silent it follows the truth by which the run scores. */
typedef struct collision_knob {
  const char *name;           /* 1 to 64 of A-Z a-z 0-9 _ - and no key of every algorithm: name, label, optional,
                                 step_budget, time_budget, memory_budget */
  const char *unit;           /* "m", "deg", ...; "1" for counts, flags, choices and ratios */
  const char *what;           /* one line for the user */
  uint32_t type;              /* COLLISION_FLAG, ... */
  collision_value preset;     /* used where the user is silent; allowed by the rules below */
  double least, most;         /* of integers and reals: bounds, inclusive; -HUGE_VAL and HUGE_VAL for none */
  const char *const *choices; /* of choices: what is allowed, ending with NULL; each as a method's name. Else NULL */
} collision_knob;

/* ---- A method ---------------------------------------------------------------------------------------------------- */

/* Never misses a pair that truly meets, outside rounding; or neither misses nor invents; or promises nothing. */
enum { COLLISION_NONE = 0, COLLISION_CONSERVATIVE = 1, COLLISION_EXACT = 2 };

/* Visits every pair that it is asked about; or has a broad phase of its own. */
enum { COLLISION_PAIR = 0, COLLISION_SCENE = 1 };

/* A method set up for the bodies of a run. The library defines this struct as it likes. */
typedef struct collision_method collision_method;

/* A row of the table: a method as data. A function that may be NULL says so. */
typedef struct collision_row {
  const char *name;            /* as users write it: 1 to 64 of A-Z a-z 0-9 _ . + -, taken by no other method */
  const char *what;            /* one line: when it reports a pair */
  const char *unit;            /* what `count` counts: "distances", "triangle pairs", ...; NULL without `count` */
  const char *precision;       /* of the arithmetic that decides: "double", "single", ... */
  uint32_t promise;            /* COLLISION_NONE, ...: checked against the truth */
  uint32_t scope;              /* COLLISION_PAIR or COLLISION_SCENE */
  const collision_knob *knobs; /* knob_count of them; NULL for none */
  uint64_t knob_count;

  /* Sets the method up for `bodies`; knobs[i] is the value of row.knobs[i]. NULL, with the reason in `error`, when
     these bodies or knobs do not suit it. */
  collision_method *(*create)(const collision_bodies *bodies, const collision_value *knobs, char *error);

  /* The work of a step that depends on one body only; one pose per body. With enlarge > 0 boxes and radii grow by
     enlarge * (size + |position|): asked of conservative methods only, to tell a rounding from a broken promise. */
  int (*prepare)(collision_method *method, const collision_pose *poses, double enlarge, char *error);

  /* Reports the pairs among the runs that the method takes to meet, each once, a < b, in any order. Runs are sorted by
     a, then by b, and name each pair that counts at the step once: no unborn body, no two fixed ones. */
  int (*answer)(collision_method *method, const collision_run *runs, uint64_t run_count, collision_hits *hits,
                char *error);

  /* The same answers, and in *operations (0 at first) how many elementary tests `answer` makes for them: the cost that
     is the same on every machine. NULL: not known. */
  int (*count)(collision_method *method, const collision_run *runs, uint64_t run_count, collision_hits *hits,
               uint64_t *operations, char *error);

  /* What the last answer or count learned becomes the memory from which the next ones start. Until then they leave the
     memory as it is, so that every repeat of a step does the same work. NULL: the method learns nothing. */
  void (*remember)(collision_method *method);

  /* Empties the memory: the next step is answered as the first of all. NULL: there is none. */
  void (*forget)(collision_method *method);

  /* Frees the method. */
  void (*destroy)(collision_method *method);
} collision_row;

/* What a library consists of. */
typedef struct collision_table {
  uint32_t abi;                    /* COLLISION_ABI; first, so that every version can read it */
  uint32_t row_count;              /* at least 1 */
  const collision_row *const *row; /* so many, none of them NULL */
  const char *version;             /* of the library, stored with its answers: "1.4.2", a commit, ...; or NULL */
} collision_table;

/* What a library exports. */
COLLISION_EXPORT const collision_table *collision_plugin(void);

/* ---- Conveniences: nothing below is part of the contract ----------------------------------------------------------
 */

/* Reports a pair. Not 0 when there is no memory left. */
static inline int collision_hit(collision_hits *hits, uint32_t a, uint32_t b) {
  if (hits->size == hits->capacity && hits->grow(hits, 1) != 0) return 1;
  hits->pair[hits->size].a = a;
  hits->pair[hits->size].b = b;
  ++hits->size;
  return 0;
}

/* Writes `text` into `error`, cut where it is too long, and gives 1: return collision_fail(error, "out of memory"); */
static inline int collision_fail(char *error, const char *text) {
  size_t i = 0;
  for (; text[i] != '\0' && i + 1 < COLLISION_ERROR_SIZE; ++i) error[i] = text[i];
  error[i] = '\0';
  return 1;
}

#ifdef __cplusplus
}
#endif

#endif
