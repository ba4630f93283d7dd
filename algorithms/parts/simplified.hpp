// A mesh with fewer facets that keeps close to it everywhere: edges are collapsed one after the other, the cheapest
// first.
//
// Source: M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", 1997. A corner that two become
// goes where the squared distances from the planes of all facets that went into it, by their area, are least: on
// rounded bodies a little outside. Borders are kept by planes across them. A collapse that would turn a facet over or
// pinch the surface is not made, so what is closed stays closed. The same bits on every machine.
#pragma once
#include <cstddef>

#include "geometry/mesh.hpp"

namespace geometry {

/// At most `facets` facets where collapses lead there, else as few as they lead to. Vertices of equal coordinates are
/// one and facets that name one twice are left out; a mesh that has no more facets than asked for is returned as it is.
Mesh simplified(const Mesh& mesh, std::size_t facets);

}  // namespace geometry
