// Vectors of three numbers. Sums are added in the order of geometry/vec.hpp, so that what the pipeline computed comes
// out here bit for bit.
"use strict";

const vectors = {
  sub: (p, q) => [p[0] - q[0], p[1] - q[1], p[2] - q[2]],
  add: (p, q) => [p[0] + q[0], p[1] + q[1], p[2] + q[2]],
  dot: (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2],
  cross: (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]],
  along: (p, d, t) => [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]],
  length: (p) => Math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]),
};
