// Elementary functions with the same bits on every x86-64 machine.
//
// The C library's sin, cos, asin, atan2 and pow take another path where the processor has fused multiply-add and
// then differ in 0.02 to 0.08 % of results. SLEEF's `cinz_..._purec` functions are plain C without it (1 ulp).
// Whatever decides an answer or makes a mesh uses these. All give NaN for NaN.
#pragma once

namespace geometry::portable {

/// NaN for an infinity.
double sin(double radians);
double cos(double radians);

/// In [-pi/2, pi/2]; NaN outside [-1, 1]: an argument that rounding may carry beyond is clamped by the caller.
double asin(double sine);

/// In [-pi, pi]; signed zeros and infinities as C's atan2: atan2(0, 0) is 0, atan2(0, -1) is pi.
double atan2(double y, double x);

}  // namespace geometry::portable
