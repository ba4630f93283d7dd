// Elementary functions with the same bits on every x86-64 machine.
//
// The C library's sin, cos, asin, atan2 and pow take another path where the processor has fused multiply-add and
// then differ in 0.02 to 0.08 % of results. SLEEF's `cinz_..._purec` functions are plain C without it (1 ulp).
// Whatever decides an answer or makes a mesh uses these.
#pragma once

namespace geometry::portable {

double sin(double radians);
double cos(double radians);
double asin(double sine);
double atan2(double y, double x);

}  // namespace geometry::portable
